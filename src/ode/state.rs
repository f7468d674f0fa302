//! A state and its derivatives as one vector of plain numbers, and back.

use std::cell::Cell;

use nalgebra::DVector;
use ode_solvers::System;

use crate::scalar::{Kind, Real};

/// First the values, then for each its derivatives along all directions.
pub(super) fn spread<K: Kind, const N: usize>(
    state: &[Real<K>; N],
) -> DVector<f64> {
    let mut all = DVector::zeros(N * (1 + K::DIRECTIONS));
    write(state, all.as_mut_slice());
    all
}

fn write<K: Kind, const N: usize>(state: &[Real<K>; N], all: &mut [f64]) {
    for (i, x) in state.iter().enumerate() {
        all[i] = x.value();
        for j in 0..K::DIRECTIONS {
            all[N + i * K::DIRECTIONS + j] = x.direction(j);
        }
    }
}

/// The state of such a vector.
pub(super) fn gathered<K: Kind, const N: usize>(all: &[f64]) -> [Real<K>; N] {
    std::array::from_fn(|i| {
        let begin = N + i * K::DIRECTIONS;
        Real::assembled(all[i], &all[begin..begin + K::DIRECTIONS])
    })
}

/// The right side as the solver asks for it, with a note of a rate that was
/// not finite: the solver itself would step on for long.
pub(super) struct Spread<'f, F, K, const N: usize> {
    pub(super) rate: &'f F,
    pub(super) failed: &'f Cell<bool>,
    pub(super) kind: std::marker::PhantomData<K>,
}

impl<F, K, const N: usize> System<f64, DVector<f64>> for Spread<'_, F, K, N>
where
    K: Kind,
    F: Fn(f64, [Real<K>; N]) -> [Real<K>; N],
{
    fn system(&self, time: f64, all: &DVector<f64>, rates: &mut DVector<f64>) {
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

    fn solout(&mut self, _: f64, _: &DVector<f64>, _: &DVector<f64>) -> bool {
        self.failed.get()
    }
}
