//! What a recording shows that could be true and hardly is: it is warned of,
//! with the slip that would explain it.

use std::f64::consts::FRAC_PI_2;

use super::plausible::scatter;
use crate::draws::median;
use crate::error::{Error, Result};
use crate::observe::{Event, Quantity, Series};
use crate::physics::Track;

/// How far above what gravity gives a value is put down to the start, the
/// terrain and the sensor: a share, and m/s or m.
const ABOVE: (f64, f64) = (1.25, 1.5);

/// How many times its scatter a value may be off.
const SCATTERS: f64 = 4.0;

/// A share of the values, and a number of them, that are no accident.
const MANY: (f64, usize) = (0.1, 3);

/// Late is a start after so many steps, after this share of the recording,
/// and after so many seconds.
const LATE: (f64, f64, f64) = (10.0, 0.25, 2.0);

/// Steps longer than this [s] are no sensor's in a flow.
const SLOW: f64 = 5.0;

/// A mass that slides is not slower than this on average [m/s].
const CREEP: f64 = 0.1;

/// Deeper than nearly any flow on a slope [m].
const DEEP: f64 = 30.0;

/// A slope on which any recording finds room [m].
const LONG: f64 = 1e5;

/// The warnings that an event with its one recording deserves.
pub(super) fn doubts(event: &Event, slope: Option<f64>) -> Vec<String> {
    let Some(series) = event.recordings().next() else { return Vec::new() };
    [
        in_radians(event, series, slope),
        too_fast(event, series).or_else(|| fast_at_once(event, series)),
        in_kilometres(event, series),
        late(series),
        below_zero(series),
        says_nothing(series),
        too_deep(event),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The same event with its values and its times in other units.
fn rescaled(event: &Event, value: f64, time: f64) -> Result<Event> {
    let series = event.recordings().next();
    let series =
        series.ok_or_else(|| Error::input("the event has no recording"))?;
    event.with_recording(scaled(series, value, time)?)
}

fn scaled(series: &Series, value: f64, time: f64) -> Result<Series> {
    let by = |all: &[f64], x: f64| all.iter().map(|v| v * x).collect();
    let values = by(series.values(), value);
    Series::new(series.quantity(), by(series.times(), time), values)?
        .with_window(series.window() * time)
}

/// How many times what gravity alone gives the recording shows at the most,
/// where so many values do that it is no accident.
fn beyond_gravity(event: &Event, series: &Series) -> Option<f64> {
    let allowed = SCATTERS * scatter(series.values()) + ABOVE.1;
    let pairs = series.times().iter().zip(series.values());
    let factors: Vec<f64> = pairs
        .filter_map(|(t, value)| {
            let most = by_gravity(event, series.quantity(), *t)?;
            let beyond = *value > ABOVE.0 * most + allowed;
            beyond.then(|| value / most.max(ABOVE.1))
        })
        .collect();
    let many = (MANY.0 * series.len() as f64).max(MANY.1 as f64);
    let top = factors.iter().copied().fold(1.0, f64::max);
    (factors.len() as f64 >= many).then_some(top)
}

/// The most that gravity gives a mass by a time, without any friction: on the
/// steepest piece from the release on, and no more than the whole drop has.
fn by_gravity(event: &Event, quantity: Quantity, t: f64) -> Option<f64> {
    let (track, speed) = (event.track(), event.release_speed());
    let first = track.piece_at(event.start());
    let pulls = track.pieces()[first..].iter().map(|piece| piece.pull);
    let pull = pulls.fold(0.0, f64::max);
    match quantity {
        Quantity::Velocity => {
            let fallen = drop(track, event.start());
            let whole = speed.powi(2) + 2.0 * crate::physics::GRAVITY * fallen;
            Some((speed + pull * t).min(whole.sqrt()))
        }
        Quantity::Position => Some(speed * t + 0.5 * pull * t * t),
        Quantity::Acceleration => Some(pull),
    }
}

/// How far the ground falls from a place on \[m\].
fn drop(track: &Track, from: f64) -> f64 {
    let (_, z) = track.points();
    let lowest = z.iter().copied().fold(f64::INFINITY, f64::min);
    (track.position(from).1 - lowest).max(0.0)
}

fn too_fast(event: &Event, series: &Series) -> Option<String> {
    let factor = beyond_gravity(event, series)?;
    let km_h = series.quantity() == Quantity::Velocity
        && rescaled(event, 1.0 / 3.6, 1.0).is_ok_and(|other| {
            let series = other.recordings().next();
            series.is_some_and(|s| beyond_gravity(&other, s).is_none())
        });
    let mend = match (km_h, series.quantity()) {
        (true, _) => {
            "if these are km/h, divide them by 3.6; if not, see to \
             release.velocity, the times and the track"
        }
        (false, Quantity::Acceleration) => {
            "see to the unit of the values, to their direction, which is down \
             the track, and to the track"
        }
        (false, _) => {
            "see to the unit of the values, release.velocity, the times and \
             the track"
        }
    };
    Some(format!(
        "the recording shows up to {factor:.1} times what gravity gives a mass \
         on this track without any friction: {mend}"
    ))
}

/// A recording that begins with a speed that no mass has so soon, and goes on
/// with it.
fn fast_at_once(event: &Event, series: &Series) -> Option<String> {
    let (t, value) = (series.times()[0], series.values()[0]);
    let most = by_gravity(event, series.quantity(), t)?;
    let allowed = SCATTERS * scatter(series.values()) + ABOVE.1;
    let goes_on = series.values().get(1).is_none_or(|v| *v > 0.5 * value);
    let is_fast = series.quantity() == Quantity::Velocity
        && value > ABOVE.0 * most + allowed;
    (is_fast && goes_on).then(|| {
        format!(
            "the recording begins with {value} m/s at t = {t}, and by then \
             gravity gives a mass on this track {most:.1} m/s at the most: if \
             it was moving at t = 0, write its speed then as \
             release.velocity, which is {}; if not, see to the unit of the \
             values and to the times",
            event.release_speed()
        )
    })
}

/// Places that hardly change, and would be those of a slide in kilometres.
fn in_kilometres(event: &Event, series: &Series) -> Option<String> {
    let top = series.values().iter().copied().fold(0.0, f64::max);
    let end = series.times()[series.len() - 1];
    let is_slow = series.quantity() == Quantity::Position && top < CREEP * end;
    let other = rescaled(event, 1000.0, 1.0).ok().filter(|_| is_slow)?;
    let explained = beyond_gravity(&other, other.recordings().next()?);
    explained.is_none().then(|| {
        format!(
            "the recording goes {top} m far in {end} s, and hardly anything \
             slides so slowly: if these are kilometres, multiply them by 1000"
        )
    })
}

/// Standard errors that are as large as the values.
fn says_nothing(series: &Series) -> Option<String> {
    let errors = series.grid().standard_errors()?;
    let size = |v: &f64| v.abs();
    let top = series.values().iter().map(size).fold(0.0, f64::max);
    let usual = median(errors);
    (usual > top).then(|| {
        format!(
            "the column sigma has {usual} {} for the usual standard error, and \
             no value is above {top:.3}: such a recording says nothing; see to \
             the unit of sigma, or drop the column if the errors are not known",
            series.quantity().unit()
        )
    })
}

fn too_deep(event: &Event) -> Option<String> {
    let depth = event.depth();
    (depth > DEEP).then(|| {
        format!(
            "the flow depth is {depth} m, and hardly any flow is deeper than \
             {DEEP} m: if these are centimetres, write depth = {}",
            depth / 100.0
        )
    })
}

fn late(series: &Series) -> Option<String> {
    let times = series.times();
    let (begin, end) = (times[0] - series.window(), times[times.len() - 1]);
    let step = series.grid().step();
    let late = (LATE.0 * step).max(LATE.1 * (end - begin)).max(LATE.2);
    (begin > late && times.len() > 1).then(|| {
        format!(
            "the first value is at t = {}, and t = 0 is the release: what \
             the mass did before was not recorded; if it was released then, \
             subtract {} from all times",
            times[0], times[0]
        )
    })
}

fn below_zero(series: &Series) -> Option<String> {
    let least = series.values().iter().copied().fold(0.0, f64::min);
    let scatter = scatter(series.values());
    let explained = (1.25 * SCATTERS * scatter).max(0.5);
    let signed = series.quantity() != Quantity::Acceleration;
    (signed && least < -explained).then(|| {
        format!(
            "the recording goes down to {} = {least}, beyond what its scatter \
             of {scatter:.2} explains, and a mass only goes down the track: \
             drop the rows that are no measurement",
            series.quantity()
        )
    })
}

/// A slope that hardly anything slides down, or not as fast as the recording
/// says, and that would be a common one in radians.
fn in_radians(
    event: &Event,
    series: &Series,
    slope: Option<f64>,
) -> Option<String> {
    let slope = slope.filter(|s| may_be_radians(*s))?;
    let why = if event.release_speed() == 0.0 {
        "hardly anything begins to slide"
    } else if beyond_gravity(event, series).is_some() {
        "the recording would be faster than gravity lets it be"
    } else {
        return None;
    };
    Some(format!(
        "the slope is {slope} degrees, on which {why}; if these are radians, \
         write slope = {:.1}",
        slope.to_degrees()
    ))
}

fn may_be_radians(slope: f64) -> bool {
    (0.1..FRAC_PI_2).contains(&slope)
}

/// Why a constant slope cannot be degrees: a recording of an event is faster
/// than gravity allows on it, and is not where they are radians. Whether it
/// fits the track is another matter.
pub(super) fn slope_in_radians(
    still: &Event,
    series: &Series,
    slope: f64,
) -> Option<String> {
    beyond_gravity(still, series).filter(|_| may_be_radians(slope))?;
    // As far as it goes, for what the track has left is no matter either.
    let steep = Track::incline(slope.to_degrees(), LONG).ok()?;
    let steep = Event::on(steep).release(0.0, still.release_speed());
    let explained = beyond_gravity(&steep.build().ok()?, series);
    explained.is_none().then(|| {
        format!(
            "is {slope}; expected degrees, and on so many the recording would \
             be faster than gravity lets it be: are these radians? write \
             slope = {:.1}",
            slope.to_degrees()
        )
    })
}

/// What would make a recording that is too long for its track fit it, and
/// whether its slope is doubtful besides.
pub(super) fn would_fit(
    still: &Event,
    series: &Series,
    slope: Option<f64>,
) -> String {
    let slope = in_radians(still, series, slope);
    let slope = slope.map_or(String::new(), |s| format!("; besides, {s}"));
    format!("{}{slope}", in_other_units(still, series))
}

fn in_other_units(still: &Event, series: &Series) -> &'static str {
    let fits = |value, time| {
        let scaled = scaled(series, value, time);
        scaled.and_then(|series| still.with_recording(series)).ok()
    };
    if series.grid().step() > SLOW && fits(1.0, 1e-3).is_some() {
        return "; or are the times milliseconds? divide them by 1000";
    }
    let velocity = series.quantity() == Quantity::Velocity;
    let fast = velocity && beyond_gravity(still, series).is_some();
    match fast && fits(1.0 / 3.6, 1.0).is_some() {
        true => "; or are the speeds km/h? divide them by 3.6",
        false => "",
    }
}
