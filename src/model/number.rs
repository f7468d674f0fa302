//! The kinds of number that models are evaluated with.
//!
//! A model's body is generic; it is compiled for plain numbers, for four
//! widths of gradient and for the tape.

use super::any_program::AnyProgram;
use super::run::Run;
use crate::context::Context;
use crate::error::Outcome;
use crate::mechanism::ChangeKind;
use crate::noise::NoiseKind;
use crate::observe::MotionKind;
use crate::physics::friction::LawKind;
use crate::scalar::{Kind, of_each_kind};

/// A kind of number with a home for its buffers on every thread.
pub trait Number:
    Kind + LawKind + NoiseKind + ChangeKind + MotionKind
{
    /// Runs `work` with this thread's context for this kind.
    fn with_context<R>(work: impl FnOnce(&Context<Self>) -> R) -> R;

    /// Runs the body of a program of any type with numbers of this kind.
    ///
    /// # Errors
    /// As [`Program::run`](super::Program::run).
    fn run_any(program: &dyn AnyProgram, run: &mut Run<'_, Self>) -> Outcome;
}

macro_rules! number {
    ($($kind:ty),*) => {
        $(impl Number for $kind {
            #[inline]
            fn with_context<R>(
                work: impl FnOnce(&Context<Self>) -> R,
            ) -> R {
                thread_local! {
                    static CONTEXT: Context<$kind> =
                        const { Context::new() };
                }
                CONTEXT.with(work)
            }

            fn run_any(
                program: &dyn AnyProgram,
                run: &mut Run<'_, Self>,
            ) -> Outcome {
                program.run_of(run)
            }
        })*
    };
}
of_each_kind!(number);
