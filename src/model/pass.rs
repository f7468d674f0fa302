//! One run of a program's body, and what came of it.

use super::any_program::AnyProgram;
use super::density::Density;
use super::listener::Listener;
use super::number::Number;
use super::run::{Run, SAME_PARAMETERS, Source};
use crate::error::{Error, Result, Stop};
use crate::scalar::Real;

/// The density; ln of the prior, of the Jacobian and of the likelihood.
pub(super) type Parts<K> = (Density, Real<K>, Real<K>, Real<K>);

/// How many directions a pass takes at the least: each width is another copy of
/// every model, noise and law, and one of 2 hardly takes less time.
const FEWEST: usize = 4;

/// How so many coordinates are taken forward: where each pass begins, and how
/// many directions its numbers carry: the most at a time, and at last no more
/// than what is left needs.
pub(super) fn passes(
    count: usize,
    most: usize,
) -> impl Iterator<Item = (usize, usize)> {
    let mut first = 0;
    std::iter::from_fn(move || {
        let left = count.checked_sub(first).filter(|left| *left > 0)?;
        let (begin, wide) =
            (first, left.next_power_of_two().clamp(FEWEST, most));
        first += wide;
        Some((begin, wide))
    })
}

/// One run of the body, its failures sorted into density zero and the rest.
pub(super) fn run<K: Number>(
    program: &dyn AnyProgram,
    source: Source<'_>,
    expected: Option<usize>,
    listener: Option<&mut dyn Listener<K>>,
) -> Result<Parts<K>> {
    K::with_context(|context| {
        let before = context.slides();
        let listener = listener.map(|l| l as &mut dyn Listener<K>);
        let mut run = Run::new(context, source, listener);
        let outcome = K::run_any(program, &mut run);
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

#[cfg(test)]
mod tests {
    use super::passes;

    #[test]
    fn passes_are_no_wider_than_what_is_left_needs() {
        let of = |count, most| passes(count, most).collect::<Vec<_>>();
        assert_eq!(of(0, 8), []);
        assert_eq!(of(1, 8), [(0, 4)]);
        assert_eq!(of(3, 8), [(0, 4)]);
        assert_eq!(of(11, 8), [(0, 8), (8, 4)]);
        assert_eq!(of(16, 8), [(0, 8), (8, 8)]);
        assert_eq!(of(17, 16), [(0, 16), (16, 4)]);
    }
}
