//! The kinds of number that models are evaluated with.
//!
//! A model's body is generic; it is compiled for plain numbers, for four
//! widths of gradient and for the tape.

use crate::context::Context;
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
        })*
    };
}
of_each_kind!(number);
