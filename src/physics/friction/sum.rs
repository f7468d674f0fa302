//! The sum of two laws.

use super::{Friction, Rate, Site, Varies};
use crate::block::Sum;
use crate::scalar::{Kind, Real};

impl<K: Kind, A: Friction<K>, B: Friction<K>> Friction<K> for Sum<A, B> {
    fn varies(&self) -> Varies {
        self.first.varies().max(self.second.varies())
    }

    #[inline(always)]
    fn rate(&self, at: &Site, speed: Real<K>) -> Rate<K> {
        self.first.rate(at, speed) + self.second.rate(at, speed)
    }
}
