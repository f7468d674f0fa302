//! Whether a model scores what its events recorded, in their order.

use crate::diagnosis::compare::checks::recordings;
use crate::error::{Error, Outcome, Result};
use crate::model::{AnyProgram, Listener, Point};
use crate::noise::Noise;
use crate::observe::{Event, Quantity, Series};
use crate::scalar::{Plain, Real};

/// A series as far as it tells which it is: its quantity and its times \[s\].
type Heading = (Quantity, Vec<f64>);

/// Refuses a model that scores other series than its events have, or in
/// another order: what it predicts is held against what they recorded, one
/// after the other.
///
/// # Errors
/// Events without a recording, such a model, or one that fails.
pub(crate) fn check_scored(
    program: &dyn AnyProgram,
    events: &[&Event],
) -> Result<()> {
    let recorded = recordings(events);
    if recorded.is_empty() {
        return Err(Error::input("the event has no recording"));
    }
    let mut scored = Scored::default();
    let density = program.evaluate(Point::Middle, Some(&mut scored))?;
    // Where it has no flow, it may have scored but a part.
    if density.rejected.is_some() {
        return Ok(());
    }
    let recorded: Vec<Heading> =
        recorded.into_iter().map(|(_, series)| heading(series)).collect();
    if scored.0 == recorded {
        return Ok(());
    }
    Err(Error::input(format!(
        "the model scores {}, but recorded are {}: expected each recording of \
         an event scored once, velocity before position before acceleration; \
         mend the likelihood, or leave out what it does not score",
        told(&scored.0),
        told(&recorded)
    )))
}

/// Hears which series a model scores.
#[derive(Default)]
struct Scored(Vec<Heading>);

impl Listener<Plain> for Scored {
    fn series(
        &mut self,
        series: &Series,
        _: &[Real<Plain>],
        _: &dyn Noise<Plain>,
    ) -> Outcome {
        self.0.push(heading(series));
        Ok(())
    }
}

fn heading(series: &Series) -> Heading {
    (series.quantity(), series.times().to_vec())
}

/// "velocity (21 values) and position (5 values)".
fn told(all: &[Heading]) -> String {
    let one = |(quantity, times): &Heading| {
        format!("{} ({} values)", quantity.name(), times.len())
    };
    match all {
        [] => "no series".to_owned(),
        all => all.iter().map(one).collect::<Vec<_>>().join(" and "),
    }
}
