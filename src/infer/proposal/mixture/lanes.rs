//! Components side by side: one instruction does for eight of them what each
//! needs for its density.

use super::student::{Component, FREEDOM};
use crate::scalar::fused;

const LANES: usize = 8;

/// A number for each of eight components.
type Eight = [f64; LANES];

/// All components of a mixture, eight at a time; the last are padded with some
/// that have no density.
#[derive(Debug, Clone)]
pub(super) struct Lanes {
    blocks: Vec<Block>,
}

#[derive(Debug, Clone)]
struct Block {
    /// The rows of the inverse factors, each after minus what it makes of the
    /// mean.
    whitening: Vec<Eight>,
    /// The densities at the means.
    heights: Eight,
}

impl Lanes {
    pub(super) fn of(components: &[Component]) -> Self {
        Self { blocks: components.chunks(LANES).map(Block::of).collect() }
    }

    /// The squared distances of eight components at a time from a place, and
    /// their weighted densities there.
    pub(super) fn at(
        &self,
        z: &[f64],
    ) -> impl Iterator<Item = (Eight, Eight)> {
        self.blocks.iter().map(move |block| {
            let distances = block.distances(z);
            (distances, block.densities(&distances, z.len()))
        })
    }
}

impl Block {
    fn of(components: &[Component]) -> Self {
        let numbers = components.first().map_or(0, |c| c.whitening.len());
        let mut whitening = vec![[0.0; LANES]; numbers];
        let mut heights = [0.0; LANES];
        for (lane, component) in components.iter().enumerate() {
            heights[lane] = component.weight * component.log_constant.exp();
            for (eight, own) in whitening.iter_mut().zip(&component.whitening)
            {
                eight[lane] = *own;
            }
        }
        Self { whitening, heights }
    }

    fn distances(&self, z: &[f64]) -> Eight {
        let (mut sums, mut rest) = ([0.0; LANES], &self.whitening[..]);
        for i in 1..=z.len() {
            let (row, after) = rest.split_at(i + 1);
            let mut white = row[0];
            for (shares, z) in row[1..].iter().zip(z) {
                for lane in 0..LANES {
                    white[lane] = fused(shares[lane], *z, white[lane]);
                }
            }
            for lane in 0..LANES {
                sums[lane] = fused(white[lane], white[lane], sums[lane]);
            }
            rest = after;
        }
        sums
    }

    /// (1 + d/nu)^(-(nu + n)/2), by whole powers and a root.
    fn densities(&self, distances: &Eight, dimension: usize) -> Eight {
        let power = FREEDOM as usize + dimension;
        let falling = distances.map(|d| 1.0 / (1.0 + d / FREEDOM));
        let mut densities = self.heights;
        if power % 2 == 1 {
            for lane in 0..LANES {
                densities[lane] *= falling[lane].sqrt();
            }
        }
        for _ in 0..power / 2 {
            for lane in 0..LANES {
                densities[lane] *= falling[lane];
            }
        }
        densities
    }
}
