//! The state of all processes of a noise, and what a filter says of it.

use crate::noise::part::{Lapse, Memory, Square, Whole};
use crate::scalar::{Kind, Real};

/// Goes from value to value, and says of each what is expected of it given
/// those before.
pub(super) trait Follows<K: Kind> {
    /// Goes on to the next value, after a lapse, with errors of such a
    /// variance of its own; whether the variance expected of it is that of the
    /// value before, but for round-off.
    fn expect(&mut self, lapse: Lapse, own: &Real<K>) -> bool;

    /// The mean expected of it.
    fn mean(&self) -> Real<K>;

    /// The variance expected of it.
    fn variance(&self) -> &Real<K>;

    /// Takes it in: by how much it differs from that mean.
    fn learn(&mut self, error: &Real<K>);
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

/// How the state moves, and which of its entries are not 0 whatever the
/// parameters: processes know nothing of each other, and a product by 0 costs
/// as much as any along many directions.
#[derive(Clone, Copy)]
pub(super) struct Motion<K: Kind, const N: usize> {
    matrix: Matrix<K, N>,
    links: [[bool; N]; N],
}

impl<K: Kind, const N: usize> Motion<K, N> {
    /// Over a lapse, with the covariance of what comes on the way.
    pub(super) fn over(
        whole: &Whole<'_, K>,
        lapse: Lapse,
    ) -> (Self, Matrix<K, N>) {
        let mut matrix = [[Real::new(0.0); N]; N];
        let mut noise = matrix;
        for (first, memory) in blocks(whole) {
            let (over, states) = (memory.over(lapse), memory.states());
            place(&mut matrix, first, states, &over.matrix);
            place(&mut noise, first, states, &over.noise);
        }
        let links = matrix.map(|row| row.map(|x| !x.is_constantly_zero()));
        (Self { matrix, links }, noise)
    }

    /// One number of F x.
    #[inline(always)]
    pub(super) fn row(&self, i: usize, x: &[Real<K>; N]) -> Real<K> {
        let mut sum = Real::new(0.0);
        for (j, x) in x.iter().enumerate() {
            if K::DIRECTIONS == 0 || self.links[i][j] {
                sum.add_product(&self.matrix[i][j], x);
            }
        }
        sum
    }

    /// F x.
    #[inline(always)]
    pub(super) fn times(&self, x: &[Real<K>; N]) -> [Real<K>; N] {
        std::array::from_fn(|i| self.row(i, x))
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

/// After how many values in a row that told no more than the one before none
/// will: of a memory of so many states a few may, as where the third counts
/// alone.
pub(super) const fn sure(states: usize) -> usize {
    states + 1
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
