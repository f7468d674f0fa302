//! A noise as an event file names it.

use std::fmt::Debug;

use super::{Noise, Part};
use crate::block::Field;
use crate::error::Stop;
use crate::scalar::{Grad, Kind, Plain, Real, Reverse, of_each_kind};

/// Builds a noise of number kind `K` from the values of its parameters.
pub trait NoiseFor<K: Kind> {
    /// Calls `then` with the noise that has these values, in the order of
    /// [`NoiseEntry::parameters`].
    ///
    /// # Errors
    /// [`Stop::Fail`], without the call, where they are not as many.
    fn with(
        &self,
        values: &[Real<K>],
        then: &mut dyn FnMut(&dyn Noise<K>),
    ) -> Result<(), Stop>;

    /// The same as a summand of a noise.
    ///
    /// # Errors
    /// The same, and where it is none.
    fn part(
        &self,
        values: &[Real<K>],
        then: &mut dyn FnMut(&dyn Part<K>),
    ) -> Result<(), Stop>;
}

/// A noise as an event file names it, its parameters still open.
pub trait NoiseEntry:
    NoiseFor<Plain>
    + NoiseFor<Grad<4>>
    + NoiseFor<Grad<8>>
    + NoiseFor<Grad<16>>
    + NoiseFor<Reverse>
    + Debug
    + Send
    + Sync
{
    /// Its name with its argument, such as "ar(2)".
    fn name(&self) -> String;

    /// The name and field of each parameter; a list of one is called as its
    /// field (`phi`), a longer one `phi[1]`, `phi[2]` and so on.
    fn parameters(&self) -> Vec<(String, Field)>;

    /// How many these are.
    fn dimension(&self) -> usize;

    /// Hands the name of each of its blocks, without arguments, to `say`.
    fn blocks(&self, say: &mut dyn FnMut(&'static str));

    /// The name of each of its blocks, with the field that each parameter of
    /// that is a value of.
    fn terms(&self) -> Vec<(&'static str, Vec<Field>)>;
}

/// Kinds that a named noise can be built with.
pub trait NoiseKind: Kind {
    /// The noise's builder for this kind of number.
    fn noise(entry: &dyn NoiseEntry) -> &dyn NoiseFor<Self>;
}

macro_rules! noise_kind {
    ($($kind:ty),*) => {
        $(impl NoiseKind for $kind {
            fn noise(entry: &dyn NoiseEntry) -> &dyn NoiseFor<Self> {
                entry
            }
        })*
    };
}
of_each_kind!(noise_kind);
