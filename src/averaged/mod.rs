//! A calibration averaged over what is not known beside the law: which noise
//! made the errors, and which other forces act.
//!
//! A law's parameters depend on both. Noises are weighed as a diagnosis weighs
//! them, and the model is calibrated under each that is kept; a force of free
//! form leaves the rest of the physics open.

mod law;
mod mix;
mod noises;

use std::time::Instant;

use crate::calibrate::Calibration;
use crate::diagnosis::fit;
use crate::diagnosis::noises as weighed;
use crate::error::Result;
use crate::infer::{Backend, LaplaceMixture, Progress};
use crate::model::Assembled;
use crate::seed::Seed;

use noises::{Under, averaged, under_each, under_one};

/// What is left open in a calibration.
///
/// ```
/// use couloir::averaged::Open;
/// let open = Open::default().with_noise().with_rest();
/// assert!(open.noise && open.rest);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Open {
    /// Which noise made the errors.
    pub noise: bool,
    /// Which forces act beside those of the model.
    pub rest: bool,
}

impl Open {
    /// The same, averaged over noises.
    #[must_use]
    pub fn with_noise(self) -> Self {
        Self { noise: true, ..self }
    }

    /// The same, with the law's parameters beside a force of free form too.
    #[must_use]
    pub fn with_rest(self) -> Self {
        Self { rest: true, ..self }
    }
}

/// Calibrates a model, as [`calibrate`](crate::calibrate::calibrate) does,
/// with what is to be left open.
///
/// ```no_run
/// use couloir::averaged::{Open, calibrate_open};
/// use couloir::infer::{LaplaceMixture, Quiet};
/// use couloir::prelude::*;
/// # fn of(model: &couloir::model::Assembled) -> Result<()> {
/// let open = Open::default().with_noise();
/// let backend = LaplaceMixture::default();
/// let found = calibrate_open(model, open, &backend, 1, &Quiet)?;
/// println!("{:?}", found.report.noises);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// A backend without draws, an improper prior where something is left open, or
/// a model that fails.
pub fn calibrate_open(
    model: &Assembled,
    open: Open,
    backend: &dyn Backend,
    seed: u64,
    progress: &dyn Progress,
) -> Result<Calibration> {
    if !open.noise {
        let one = under_one(model, backend, seed, progress)?;
        return concluded(model, vec![one], open, seed, progress);
    }
    let begun = Instant::now();
    progress.begin("weighing noises", None);
    let (named, extent) = (model.noise(), model.event().extent());
    // The survey that a diagnosis of this seed makes.
    let survey = Seed::new(seed).child(1);
    let found = weighed(model, &named, &extent, survey)?;
    let under = under_each(model, &found, backend, seed, progress)?;
    let mut found = concluded(model, under, open, seed, progress)?;
    found.report.seconds = begun.elapsed().as_secs_f64();
    Ok(found)
}

/// One calibration of those under each noise.
fn concluded(
    model: &Assembled,
    mut under: Vec<Under<'_>>,
    open: Open,
    seed: u64,
    progress: &dyn Progress,
) -> Result<Calibration> {
    let seed = Seed::new(seed).called("rest");
    if open.rest && !open.noise {
        let backend = LaplaceMixture::default();
        for one in &mut under {
            one.none = Some(fit(one.program(), &[], &backend, seed.child(0))?);
        }
    }
    let forced = match open.rest {
        true => Some(law::forced(model, &under, seed, progress)?),
        false => None,
    };
    let mut found = averaged(model, under, open.noise)?;
    found.report.law = forced.map(|law| law.beside(model, &found.report));
    Ok(found)
}
