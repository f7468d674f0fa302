//! A state and its derivatives as one vector of plain numbers, and back.

use std::cell::Cell;
use std::marker::PhantomData;

use nalgebra::allocator::Allocator;
use nalgebra::{DefaultAllocator, Dim, OVector};
use ode_solvers::System;

use crate::scalar::{Kind, Real};

/// Writes first the values, then for each its derivatives along all
/// directions.
pub(super) fn write<K: Kind, const N: usize>(
    state: &[Real<K>; N],
    all: &mut [f64],
) {
    for (i, x) in state.iter().enumerate() {
        all[i] = x.value();
        for j in 0..K::DIRECTIONS {
            all[N + i * K::DIRECTIONS + j] = x.direction(j);
        }
    }
}

/// The state of such numbers.
pub(super) fn gathered<K: Kind, const N: usize>(all: &[f64]) -> [Real<K>; N] {
    std::array::from_fn(|i| {
        let begin = N + i * K::DIRECTIONS;
        Real::assembled(all[i], &all[begin..begin + K::DIRECTIONS])
    })
}

/// The right side as the solver asks for it, with a note of a rate that was
/// not finite: the solver itself would step on for long.
pub(super) struct Spread<'f, F, K, const N: usize> {
    rate: &'f F,
    failed: &'f Cell<bool>,
    kind: PhantomData<K>,
}

impl<'f, F, K, const N: usize> Spread<'f, F, K, N> {
    pub(super) fn new(rate: &'f F, failed: &'f Cell<bool>) -> Self {
        Self { rate, failed, kind: PhantomData }
    }
}

impl<F, K, D, const N: usize> System<f64, OVector<f64, D>>
    for Spread<'_, F, K, N>
where
    K: Kind,
    D: Dim,
    DefaultAllocator: Allocator<D>,
    F: Fn(f64, [Real<K>; N]) -> [Real<K>; N],
{
    fn system(
        &self,
        time: f64,
        all: &OVector<f64, D>,
        rates: &mut OVector<f64, D>,
    ) {
        // What keeps a record of how it was formed has no part in the steps.
        let state = match K::DIRECTIONS {
            0 => std::array::from_fn(|i| Real::new(all[i])),
            _ => gathered(all.as_slice()),
        };
        write(&(self.rate)(time, state), rates.as_mut_slice());
        if !rates.iter().all(|rate| rate.is_finite()) {
            self.failed.set(true);
            rates.fill(0.0);
        }
    }

    fn solout(
        &mut self,
        _: f64,
        _: &OVector<f64, D>,
        _: &OVector<f64, D>,
    ) -> bool {
        self.failed.get()
    }
}
