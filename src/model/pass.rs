//! One run of a program's body, and what came of it.

use super::density::Density;
use super::listener::Listener;
use super::number::Number;
use super::program::Program;
use super::run::{Run, SAME_PARAMETERS, Source};
use crate::error::{Error, Result, Stop};
use crate::scalar::Real;

/// The density; ln of the prior, of the Jacobian and of the likelihood.
pub(super) type Parts<K> = (Density, Real<K>, Real<K>, Real<K>);

/// One run of the body, its failures sorted into density zero and the rest.
pub(super) fn run<K: Number, P: Program>(
    program: &P,
    source: Source<'_>,
    expected: Option<usize>,
    listener: Option<&mut dyn Listener<K>>,
) -> Result<Parts<K>> {
    K::with_context(|context| {
        let before = context.slides();
        let listener = listener.map(|l| l as &mut dyn Listener<K>);
        let mut run = Run::new(context, source, listener);
        let outcome = program.run(&mut run);
        let slides = context.slides() - before;
        let parts = (run.log_prior, run.log_jacobian, run.log_likelihood);
        let zero = |reason| {
            let none = Real::new(0.0);
            (Density::zero(reason, slides), none, none, none)
        };
        match outcome {
            Err(Stop::Fail(error)) => return Err(error),
            Err(Stop::Reject(reason)) => return Ok(zero(reason)),
            Ok(()) => {}
        }
        if expected.is_some_and(|n| n != run.position()) {
            return Err(Error::input(format!(
                "there are values for {} parameters, and the model asked for \
                 {}; {SAME_PARAMETERS}",
                expected.unwrap_or(0),
                run.position()
            )));
        }
        let density = Density {
            log_prior: parts.0.value(),
            log_jacobian: parts.1.value(),
            log_likelihood: parts.2.value(),
            slides,
            rejected: None,
        };
        if density.on_line().is_nan() {
            return Ok(zero("the density is not a number"));
        }
        Ok((density, parts.0, parts.1, parts.2))
    })
}
