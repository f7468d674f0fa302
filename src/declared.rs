//! A block as a model declared it.
//!
//! Only declared blocks slide and only they score residuals: what a model
//! declares is what a change to the model can reach, and a law that it could
//! not reach is a compile error instead of a silent miss.

use std::ops::Deref;

use crate::context::Context;
use crate::error::Stop;
use crate::noise::{Conditional, Grid, Noise};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// A block declared by a model, with the context it is evaluated in.
#[derive(Debug)]
pub struct Declared<'r, K: Kind, B> {
    block: B,
    context: &'r Context<K>,
}

impl<'r, K: Kind, B> Declared<'r, K, B> {
    /// Declares a block. Models do so through [`Run::declare`].
    ///
    /// [`Run::declare`]: crate::Run::declare
    pub fn new(block: B, context: &'r Context<K>) -> Self {
        Self { block, context }
    }

    /// The context of the evaluation.
    pub fn context(&self) -> &'r Context<K> {
        self.context
    }

    /// The block itself.
    pub fn block(&self) -> &B {
        &self.block
    }
}

impl<K: Kind, B> Deref for Declared<'_, K, B> {
    type Target = B;
    fn deref(&self) -> &B {
        &self.block
    }
}

impl<K: Kind, N: Noise<K>> Noise<K> for Declared<'_, K, N> {
    fn check(&self, at: &Grid) -> crate::Result<()> {
        self.block.check(at)
    }

    #[inline]
    fn walk(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
        visit: &mut dyn FnMut(Conditional<K>),
    ) -> Result<(), Stop> {
        self.block.walk(at, residuals, visit)
    }

    fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
        self.block.draw(at, rng)
    }

    #[inline]
    fn log_likelihood(
        &self,
        at: &Grid,
        residuals: &[Real<K>],
    ) -> Result<Real<K>, Stop> {
        self.block.log_likelihood(at, residuals)
    }
}
