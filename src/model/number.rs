//! The kinds of number that models are evaluated with.
//!
//! A model's body is generic; it is compiled for plain numbers, for four
//! widths of gradient and for the tape.

use crate::context::Context;
use crate::mechanism::ChangeKind;
use crate::noise::NoiseKind;
use crate::observe::MotionKind;
use crate::physics::friction::LawKind;
use crate::scalar::{Grad, Kind, Plain, Reverse};

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
number!(Plain, Grad<2>, Grad<4>, Grad<8>, Grad<16>, Reverse);
