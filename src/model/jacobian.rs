//! Derivatives of all data along all directions, which are coordinates unless
//! others are asked for.

use std::array;

use nalgebra::{DMatrix, DVector};

use crate::scalar::{Forward, Real, fused};

/// How many coordinates are held together: a square of so many sums stays in
/// registers.
const BLOCK: usize = 8;

/// The derivatives of the innovations and of their scales, a row for each
/// coordinate and a column for each number; columns are padded with zeros to
/// whole blocks.
#[derive(Debug, Clone)]
pub(crate) struct Jacobian {
    blocks: Vec<[f64; BLOCK]>,
    /// How many blocks a column has.
    width: usize,
    /// How many coordinates there are.
    dimension: usize,
}

impl Jacobian {
    /// Without columns.
    pub(super) fn new(dimension: usize) -> Self {
        let width = dimension.div_ceil(BLOCK);
        Self { blocks: Vec::new(), width, dimension }
    }

    /// Makes room for so many columns more than there are.
    pub(super) fn reserve(&mut self, columns: usize) {
        self.blocks.reserve(columns * self.width);
    }

    /// Writes the derivatives that a number carries into a column, from the
    /// row `first` on, which begins a block; makes the column if it is a new
    /// one.
    #[inline]
    pub(super) fn write<K: Forward>(
        &mut self,
        column: usize,
        first: usize,
        x: &Real<K>,
    ) {
        debug_assert_eq!(first % BLOCK, 0, "a pass begins a block");
        let begin = column * self.width;
        if self.blocks.len() < begin + self.width {
            self.blocks.resize(begin + self.width, [0.0; BLOCK]);
        }
        let column = &mut self.blocks[begin..begin + self.width];
        let parts = x.partials().chunks(BLOCK);
        for (block, part) in column[first / BLOCK..].iter_mut().zip(parts) {
            // A whole one by a few instructions, others by a call.
            match part.try_into() {
                Ok(whole) => *block = whole,
                Err(_) => block[..part.len()].copy_from_slice(part),
            }
        }
    }

    /// Keeps so many columns; those that are missing are zero.
    pub(super) fn resize(&mut self, columns: usize) {
        self.blocks.resize(columns * self.width, [0.0; BLOCK]);
    }

    /// How many columns there are.
    pub(crate) fn count(&self) -> usize {
        self.blocks.len().checked_div(self.width).unwrap_or(0)
    }

    /// The derivatives along one coordinate.
    pub(crate) fn row(&self, coordinate: usize) -> DVector<f64> {
        let (block, place) = (coordinate / BLOCK, coordinate % BLOCK);
        let columns = self.blocks.chunks_exact(self.width.max(1));
        let numbers = columns.map(|column| column[block][place]);
        DVector::from_iterator(self.count(), numbers)
    }

    /// The products of some rows with what has a number for each column.
    pub(crate) fn times(
        &self,
        coordinates: &[usize],
        numbers: &DVector<f64>,
    ) -> DVector<f64> {
        let of = |&i: &usize| self.row(i).dot(numbers);
        DVector::from_iterator(coordinates.len(), coordinates.iter().map(of))
    }

    /// The products of all rows with each other, block by block: far fewer
    /// rows than columns are too few for a general product.
    pub(super) fn squared(&self) -> DMatrix<f64> {
        let n = self.dimension;
        let mut product = DMatrix::zeros(n, n);
        for top in 0..self.width {
            for left in 0..=top {
                let sums = self.block(top, left);
                let (down, across) = (BLOCK * top, BLOCK * left);
                for i in 0..BLOCK.min(n - down) {
                    for j in 0..BLOCK.min(n - across) {
                        product[(down + i, across + j)] = sums[i][j];
                        product[(across + j, down + i)] = sums[i][j];
                    }
                }
            }
        }
        product
    }

    /// Kept out of line, where the compiler holds the square in registers.
    #[inline(never)]
    fn block(&self, top: usize, left: usize) -> [[f64; BLOCK]; BLOCK] {
        let mut sums = [[0.0; BLOCK]; BLOCK];
        for column in self.blocks.chunks_exact(self.width) {
            let (down, across) = (column[top], column[left]);
            let with = |sums: [f64; BLOCK], by: f64| {
                array::from_fn(|j| fused(by, across[j], sums[j]))
            };
            sums = array::from_fn(|i| with(sums[i], down[i]));
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Grad;

    /// The derivative of a datum along a coordinate.
    fn slope(datum: usize, coordinate: usize) -> f64 {
        (0.37 * (datum * 50 + coordinate) as f64).sin()
    }

    #[test]
    fn nothing_has_no_products() {
        let none = Jacobian::new(3);
        assert_eq!((none.count(), none.row(2).len()), (0, 0));
        assert_eq!(none.squared(), DMatrix::zeros(3, 3));
        assert_eq!(Jacobian::new(0).squared().len(), 0);
    }

    #[test]
    fn products_are_those_of_dense_matrices() {
        // Within a block, of two and a half, and of three passes of 16.
        for dimension in [1, 7, 20, 45] {
            let mut jacobian = Jacobian::new(dimension);
            for first in (0..dimension).step_by(16) {
                for datum in 0..30 {
                    let partials: Vec<f64> = (first..dimension)
                        .take(16)
                        .map(|i| slope(datum, i))
                        .collect();
                    let x = Real::<Grad<16>>::assembled(0.0, &partials);
                    jacobian.write(datum, first, &x);
                }
            }
            assert_eq!(jacobian.count(), 30);
            let dense = DMatrix::from_fn(dimension, 30, |i, j| slope(j, i));
            let product = &dense * dense.transpose();
            // Sums of 30 products below 1.
            assert!((jacobian.squared() - product).amax() < 30.0 * 1e-15);
            let last = dimension - 1;
            assert_eq!(jacobian.row(last), dense.row(last).transpose());
            let numbers = DVector::from_fn(30, |j, _| slope(j, 3));
            let times = jacobian.times(&[last, 0], &numbers);
            let expected = dense.select_rows(&[last, 0]) * &numbers;
            assert!((times - expected).amax() < 30.0 * 1e-15);
        }
    }
}
