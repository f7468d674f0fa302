//! Several events taken apart: what each has to itself is fitted by itself.

use crate::error::Result;
use crate::infer::{
    Backend, Group, Grouped, Inference, LaplaceMixture, Precision, Quiet,
};
use crate::model::{ByEvent, Posterior};
use crate::seed::Seed;

/// Evidence and draws of a program with mechanisms: of one event as sharp as can
/// be, of several event by event, as sharp as asked.
///
/// # Errors
/// An improper prior, or a model that fails.
pub(crate) fn estimate(
    program: &ByEvent<'_>,
    whole: &Posterior<'_>,
    backend: &LaplaceMixture,
    precision: Precision,
    seed: Seed,
) -> Result<Inference> {
    let events = program.events();
    if events.is_empty() {
        return backend.explore(whole, seed, &Quiet);
    }
    let posteriors = events.iter().map(|part| Posterior::new(&part.model));
    let posteriors: Vec<_> = posteriors.collect::<Result<_>>()?;
    let common = program.common().map(|part| Posterior::new(&part.model));
    let common = common.transpose()?;
    let group = |(posterior, places): (_, &Vec<usize>)| Group {
        posterior,
        places: places.clone(),
    };
    let places = events.iter().map(|part| &part.places);
    let groups = posteriors.iter().zip(places).map(group).collect();
    let places = program.common().map(|part| &part.places);
    let common = common.as_ref().zip(places).map(group);
    let grouped = Grouped { whole, common, groups };
    backend.estimate_groups(&grouped, precision, seed, &Quiet)
}
