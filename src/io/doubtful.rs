//! What a recording shows that could be true and hardly is: it is warned of,
//! with the slip that would explain it.

use std::f64::consts::FRAC_PI_2;

use super::plausible::scatter;
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

/// The warnings that an event with its one recording deserves.
pub(super) fn doubts(event: &Event, slope: Option<f64>) -> Vec<String> {
    let Some(series) = event.recordings().next() else { return Vec::new() };
    [
        in_radians(event, slope),
        too_fast(event, series),
        late(series),
        below_zero(series),
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
        Quantity::Acceleration => None,
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
    let mend = match km_h {
        true => "if these are km/h, divide them by 3.6; if not, see to",
        false => "see to the unit of the values,",
    };
    Some(format!(
        "the recording shows up to {factor:.1} times what gravity gives a mass \
         on this track without any friction: {mend} release.velocity, the \
         times and the track"
    ))
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

/// A slope that hardly anything slides down, and that would be a common one
/// in radians.
fn in_radians(event: &Event, slope: Option<f64>) -> Option<String> {
    let slope = slope.filter(|s| may_be_radians(*s))?;
    (event.release_speed() == 0.0).then(|| {
        format!(
            "the slope is {slope} degrees, on which hardly anything begins to \
             slide; if these are radians, write slope = {:.1}",
            slope.to_degrees()
        )
    })
}

fn may_be_radians(slope: f64) -> bool {
    (0.1..FRAC_PI_2).contains(&slope)
}

/// Why a constant slope cannot be degrees: the recording is faster than
/// gravity allows on it, and is not where they are radians.
pub(super) fn slope_in_radians(event: &Event, slope: f64) -> Option<String> {
    let series = event.recordings().next()?;
    beyond_gravity(event, series).filter(|_| may_be_radians(slope))?;
    let length = event.track().length();
    let steep = Track::incline(slope.to_degrees(), length).ok()?;
    let steep = Event::on(steep).release(0.0, event.release_speed());
    let steep = steep.series(series.clone()).build().ok()?;
    let explained = beyond_gravity(&steep, steep.recordings().next()?);
    explained.is_none().then(|| {
        format!(
            "is {slope}; expected degrees, and on so many the recording would \
             be faster than gravity lets it be: are these radians? write \
             slope = {:.1}",
            slope.to_degrees()
        )
    })
}

/// What would make a recording that is too long for its track fit it.
pub(super) fn would_fit(still: &Event, series: &Series) -> &'static str {
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
