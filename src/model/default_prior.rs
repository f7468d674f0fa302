//! Priors that a user has not given: those of the blocks, with the scales of
//! the event.

use crate::block::Field;
use crate::error::Result;
use crate::noise::Spacing;
use crate::observe::Event;
use crate::prior::AnyPrior;

/// Whether a recording has uneven times.
pub(super) fn is_uneven(event: &Event) -> bool {
    event.recordings().any(|s| *s.grid().spacing() == Spacing::Uneven)
}

/// The block's default; on uneven times an autocorrelation is positive.
pub(super) fn default_prior(field: &Field, event: &Event) -> Result<AnyPrior> {
    let text = match field.name {
        "phi" if is_uneven(event) => "Uniform(0, 1)",
        _ => field.prior,
    };
    AnyPrior::parse(&scaled(text, event))
}

/// A block's default with the scales of an event put in: `size`, the largest
/// value recorded, its square `size2`, and the `duration` of the recording
/// \[s\], each after a number, and after `ln` where a logarithm is meant.
fn scaled(text: &str, event: &Event) -> String {
    let (mut size, mut duration) = (0.0_f64, 0.0_f64);
    for series in event.recordings() {
        let sizes = series.values().iter().map(|v| v.abs());
        size = sizes.fold(size, f64::max);
        let times = series.times();
        let last = times.last().zip(times.first()).map_or(0.0, |(b, a)| b - a);
        duration = duration.max(last);
    }
    let or_one = |x: f64| if x > 0.0 { x } else { 1.0 };
    let (size, duration) = (or_one(size), or_one(duration));
    let scale = |word: &str| match word {
        "size" => Some(size),
        "size2" => Some(size * size),
        "duration" => Some(duration),
        _ => None,
    };
    let Some((name, arguments)) = text.split_once('(') else {
        return text.to_owned();
    };
    let of = |argument: &str| {
        let (is_log, rest) = match argument.strip_prefix("ln ") {
            Some(rest) => (true, rest),
            None => (false, argument),
        };
        let (number, word) = rest.split_once(' ')?;
        let value = number.parse::<f64>().ok()? * scale(word)?;
        let value = if is_log { value.ln() } else { value };
        Some(format!("{value:.3}"))
    };
    let arguments = arguments.trim_end_matches(')').split(',').map(str::trim);
    let all: Vec<String> =
        arguments.map(|a| of(a).unwrap_or_else(|| a.to_owned())).collect();
    format!("{name}({})", all.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::Series;
    use crate::physics::Track;

    #[test]
    fn scales_are_those_of_the_event() {
        let track = Track::incline(35.0, 500.0).unwrap();
        let seen = Series::velocity(vec![1.0, 3.0, 5.0], vec![2.0, 8.0, 5.0]);
        let event = Event::on(track).velocity(seen.unwrap()).build().unwrap();
        let found = |text: &str| scaled(text, &event);
        // The largest is 8 m/s, and 4 s pass: ln 0.16, ln 0.0064, ln 0.12.
        let of = "LogNormal(ln 0.02 size, 1)";
        assert_eq!(found(of), "LogNormal(-1.833, 1)");
        let of = "LogNormal(ln 1e-4 size2, 2)";
        assert_eq!(found(of), "LogNormal(-5.051, 2)");
        let of = "LogNormal(ln 0.03 duration, 1)";
        assert_eq!(found(of), "LogNormal(-2.120, 1)");
        assert_eq!(found("HalfNormal(0.5 size)"), "HalfNormal(4.000)");
        assert_eq!(found("Uniform(-1, 1)"), "Uniform(-1, 1)");
    }
}
