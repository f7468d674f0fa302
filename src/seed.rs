//! Where every random draw starts.
//!
//! A [`Seed`] is a path in a tree: a run has one, each chain, particle or
//! replicate takes a child of it. Work can therefore go to any thread in any
//! order and still draw the same numbers.
//!
//! ```
//! use couloir::Seed;
//! use couloir::rand::Rng;
//! let chain = |i| Seed::new(1).child(i).rng().next_u64();
//! assert_eq!(chain(3), chain(3));
//! assert_ne!(chain(3), chain(4));
//! ```

use rand::SeedableRng;
use rand::rngs::StdRng;

/// The generator behind every draw.
pub type Rng = StdRng;

/// A reproducible source of random generators.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Seed(u64);

impl Seed {
    /// The seed of a run.
    pub fn new(number: u64) -> Self {
        Self(mix(number ^ 0x636f_756c_6f69_7221))
    }

    /// The seed of the `index`-th part of this one's work.
    #[must_use]
    pub fn child(self, index: u64) -> Self {
        Self(mix(self.0 ^ mix(index.wrapping_add(0x9e37_79b9_7f4a_7c15))))
    }

    /// The seed of the part of this one's work that has a name.
    #[must_use]
    pub fn called(self, name: &str) -> Self {
        name.bytes().map(u64::from).fold(self, Self::child)
    }

    /// A generator that starts here.
    pub fn rng(self) -> Rng {
        Rng::seed_from_u64(self.0)
    }
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014), a bijection that
/// leaves no visible relation between neighbouring inputs.
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
