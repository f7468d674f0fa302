//! The sum of two laws.

use super::{Friction, Rate, Site, Varies};
use crate::block::Named;
use crate::scalar::{Kind, Real};

/// Both laws at once; what `+` between blocks stands for.
#[derive(Debug, Clone, Copy)]
pub struct Sum<A, B>(A, B);

impl<A, B> Sum<A, B> {
    /// The sum of two laws.
    pub fn new(first: A, second: B) -> Self {
        Self(first, second)
    }
}

impl<K: Kind, A: Friction<K>, B: Friction<K>> Friction<K> for Sum<A, B> {
    fn varies(&self) -> Varies {
        self.0.varies().max(self.1.varies())
    }

    #[inline(always)]
    fn rate(&self, at: &Site, speed: Real<K>) -> Rate<K> {
        self.0.rate(at, speed) + self.1.rate(at, speed)
    }
}

impl<K, A, B> Named<Real<K>> for Sum<A, B>
where
    K: Kind,
    A: Named<Real<K>>,
    B: Named<Real<K>>,
{
    fn names(&self, say: &mut dyn FnMut(&str)) {
        self.0.names(say);
        self.1.names(say);
    }
}
