//! A block as a model declared it.
//!
//! Only declared blocks slide and only they score residuals: what a model
//! declares is what a change to the model can reach, and a law that it could
//! not reach is a compile error instead of a silent miss.

use std::ops::Deref;

use crate::block::{Named, Sum};
use crate::context::Context;
use crate::mechanism::Change;
use crate::noise::{Noise, noise_like};
use crate::scalar::{Kind, Real};

/// A block declared by a model, with the context it is evaluated in.
#[derive(Debug)]
pub struct Declared<'r, K: Kind, B: ?Sized> {
    context: &'r Context<K>,
    change: Option<&'r Change<K>>,
    block: B,
}

impl<'r, K: Kind, B> Declared<'r, K, B> {
    /// Declares a block. Models do so through [`Run::declare`].
    ///
    /// [`Run::declare`]: crate::Run::declare
    pub fn new(block: B, context: &'r Context<K>) -> Self {
        Self { block, context, change: None }
    }

    /// The same block under a change to its model.
    #[must_use]
    pub fn under(self, change: Option<&'r Change<K>>) -> Self {
        Self { change, ..self }
    }

    /// The change to the model that it is a block of.
    pub fn change(&self) -> Option<&'r Change<K>> {
        self.change
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

/// A sum is known by the names of its terms.
impl<K, A, B> Named<Real<K>> for Sum<A, B>
where
    K: Kind,
    A: Named<Real<K>>,
    B: Named<Real<K>>,
{
    fn names(&self, say: &mut dyn FnMut(&str)) {
        self.first.names(say);
        self.second.names(say);
    }
}

// A declared noise scores as its block does, and so does a borrowed one.
noise_like!(impl[N: Noise<K> + ?Sized] &N, self => (**self));
noise_like! {
    impl[N: Noise<K> + ?Sized] Declared<'_, K, N>, self => self.block
}
