//! The state of all processes of a noise, and what a filter says of it.

use crate::noise::part::{Lapse, Memory, Square, Whole};
use crate::scalar::{Kind, Real};

/// Goes from value to value, and says of each what is expected of it given
/// those before.
pub(super) trait Follows<K: Kind> {
    /// What is expected of the next value, after a lapse, with errors of such
    /// a variance of its own.
    fn expect(&mut self, lapse: Lapse, own: Real<K>) -> Expected<K>;

    /// Takes it in: by how much it differs from that, and one over the
    /// variance that was expected.
    fn learn(&mut self, error: Real<K>, precision: Real<K>);
}

/// What a filter expects of a value.
#[derive(Clone, Copy)]
pub(super) struct Expected<K: Kind> {
    pub(super) mean: Real<K>,
    pub(super) variance: Real<K>,
    /// Whether that is what it was for the value before, but for round-off.
    pub(super) is_same: bool,
}

pub(super) type Matrix<K, const N: usize> = [[Real<K>; N]; N];

/// Which states are the processes' values. Not their places: what is looked
/// up by place is kept in memory, and each value waits for the one before.
pub(super) type Values<const N: usize> = [bool; N];

/// Of the processes of a noise, one after the other, with the first state of
/// each.
pub(super) fn blocks<'a, K: Kind>(
    whole: &Whole<'a, K>,
) -> impl Iterator<Item = (usize, &'a dyn Memory<K>)> {
    let mut next = 0;
    whole.memories().map(move |memory| {
        next += memory.states();
        (next - memory.states(), memory)
    })
}

/// Which states are the processes' values.
pub(super) fn values<K: Kind, const N: usize>(
    whole: &Whole<'_, K>,
) -> Values<N> {
    let mut values = [false; N];
    blocks(whole).for_each(|(first, _)| values[first] = true);
    values
}

/// The covariance of the state at any time.
pub(super) fn stationary<K: Kind, const N: usize>(
    whole: &Whole<'_, K>,
) -> Matrix<K, N> {
    let mut covariance = [[Real::new(0.0); N]; N];
    for (first, memory) in blocks(whole) {
        let states = memory.states();
        place(&mut covariance, first, states, &memory.covariance());
    }
    covariance
}

/// Puts a block on the diagonal.
pub(super) fn place<K: Kind, const N: usize>(
    matrix: &mut Matrix<K, N>,
    first: usize,
    states: usize,
    block: &Square<K>,
) {
    for (i, row) in block.chunks_exact(states.max(1)).enumerate() {
        matrix[first + i][first..first + states].copy_from_slice(row);
    }
}

/// The sum of the processes' values.
#[inline(always)]
pub(super) fn sum<K: Kind, const N: usize>(
    values: &Values<N>,
    x: &[Real<K>; N],
) -> Real<K> {
    // The first state is a value, or there is no process and it is 0.
    let mut sum = x[0];
    for i in 1..N {
        if values[i] {
            sum += x[i];
        }
    }
    sum
}

/// F x.
#[inline(always)]
pub(super) fn times<K: Kind, const N: usize>(
    matrix: &Matrix<K, N>,
    x: &[Real<K>; N],
) -> [Real<K>; N] {
    std::array::from_fn(|i| dot(&matrix[i], x))
}

#[inline(always)]
pub(super) fn dot<K: Kind, const N: usize>(
    x: &[Real<K>; N],
    y: &[Real<K>; N],
) -> Real<K> {
    let mut sum = x[0] * y[0];
    for i in 1..N {
        sum += x[i] * y[i];
    }
    sum
}

/// Whether it can be seen that nothing changes any more: a tape has its
/// derivatives later.
pub(super) const fn settles<K: Kind>() -> bool {
    K::DIRECTIONS > 0 || !K::DIFFERENTIATES
}

/// Whether two numbers differ by round-off alone.
#[inline(always)]
pub(super) fn are_same<K: Kind>(a: Real<K>, b: Real<K>) -> bool {
    /// The share of a number that is round-off.
    const ROUND_OFF: f64 = 1e-14;
    a.is_near(b, ROUND_OFF)
}
