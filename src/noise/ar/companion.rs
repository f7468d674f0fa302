//! An autoregression as a summand, in companion form.

use smallvec::{SmallVec, smallvec};

use super::Ar;
use super::first::First;
use crate::error::Stop;
use crate::noise::part::{Lapse, Memory, Part, Square, Transition, Whole};
use crate::noise::{Grid, Noise};
use crate::scalar::{Kind, Real};

impl<K: Kind> Part<K> for Ar<Real<K>> {
    fn join<'a>(&'a self, whole: &mut Whole<'a, K>) {
        whole.remember(self);
    }
}

/// The state is the last k values, latest first.
impl<K: Kind> Memory<K> for Ar<Real<K>> {
    fn states(&self) -> usize {
        self.phi.len()
    }

    fn exists(&self, at: &Grid) -> crate::Result<()> {
        Noise::<K>::check(self, at)
    }

    fn allows(&self, at: &Grid) -> Result<(), Stop> {
        Ar::admit(self, at)
    }

    fn covariance(&self) -> Square<K> {
        let k = self.phi.len();
        let gamma = self.autocovariances(k);
        let at = |n: usize| gamma[(n / k).abs_diff(n % k)];
        (0..k * k).map(at).collect()
    }

    fn over(&self, lapse: Lapse) -> Transition<K> {
        if let [phi] = *self.phi {
            let (a, q) = First::new(phi, self.sigma2).transition(lapse.steps);
            return Transition { matrix: smallvec![a], noise: smallvec![q] };
        }
        let mut leap = self.one_step();
        let mut left = lapse.steps as usize;
        let mut all: Option<Transition<K>> = None;
        while left > 0 {
            if left & 1 == 1 {
                all = Some(match all {
                    None => leap.clone(),
                    Some(all) => all.then(&leap, self.phi.len()),
                });
            }
            left >>= 1;
            if left > 0 {
                leap = leap.then(&leap, self.phi.len());
            }
        }
        all.unwrap_or(leap)
    }
}

impl<K: Kind> Ar<Real<K>> {
    fn one_step(&self) -> Transition<K> {
        let k = self.phi.len();
        let zero: Square<K> = SmallVec::from_elem(Real::new(0.0), k * k);
        let (mut matrix, mut noise) = (zero.clone(), zero);
        matrix[..k].copy_from_slice(&self.coefficients());
        for i in 1..k {
            matrix[i * k + i - 1] = Real::new(1.0);
        }
        noise[0] = self.sigma2;
        Transition { matrix, noise }
    }
}

impl<K: Kind> Transition<K> {
    /// This one and another after it, of so many states: F2 F1 and
    /// F2 Q1 F2' + Q2.
    fn then(&self, next: &Self, states: usize) -> Self {
        let product = |a: &Square<K>, b: &dyn Fn(usize, usize) -> Real<K>| {
            let entry = |n: usize| {
                let (i, j) = (n / states, n % states);
                (0..states).map(|k| a[i * states + k] * b(k, j)).sum()
            };
            (0..states * states).map(entry).collect::<Square<K>>()
        };
        let matrix =
            product(&next.matrix, &|k, j| self.matrix[k * states + j]);
        let half = product(&next.matrix, &|k, j| self.noise[k * states + j]);
        let mut noise = product(&half, &|k, j| next.matrix[j * states + k]);
        for (sum, q) in noise.iter_mut().zip(&next.noise) {
            *sum += *q;
        }
        Self { matrix, noise }
    }
}
