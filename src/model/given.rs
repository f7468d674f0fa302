//! Unknowns that depend on each other, and unknowns that may be data.

use super::data::Data;
use super::label::Label;
use super::run::Run;
use crate::block::List;
use crate::error::Stop;
use crate::prior::{Distribution, Joint, Prior, Support};
use crate::scalar::{Kind, Real};
use crate::seed::Rng;

/// A datum that may be missing: an `Option`, or a number that is NaN.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a datum that may be missing",
    label = "behind `given` stands an `Option<f64>`, or an `f64` that is NaN \
             where it is missing"
)]
pub trait Given {
    /// The value, where there is one.
    fn given(&self) -> Option<f64>;
}

impl<D: Data> Given for Option<D> {
    fn given(&self) -> Option<f64> {
        self.as_ref().map(|datum| datum.value(0))
    }
}

impl Given for f64 {
    fn given(&self) -> Option<f64> {
        (!self.is_nan()).then_some(*self)
    }
}

impl<G: Given + ?Sized> Given for &G {
    fn given(&self) -> Option<f64> {
        (**self).given()
    }
}

impl<K: Kind> Run<'_, K> {
    /// A quantity of that distribution: where it was observed a datum, else
    /// an unknown.
    ///
    /// # Errors
    /// As [`Run::scalar`] and [`Run::observe_each`].
    pub fn given<P: Prior<K>>(
        &mut self,
        label: Label<'_>,
        datum: &(impl Given + ?Sized),
        prior: P,
    ) -> Result<Real<K>, Stop> {
        match datum.given() {
            None => self.scalar(label, prior),
            Some(value) => {
                self.observe_each(&value, prior)?;
                Ok(Real::new(self.made().unwrap_or(value)))
            }
        }
    }

    /// Declares `n` parameters that depend on each other. What those before
    /// it determine is kept beside them.
    ///
    /// # Errors
    /// As [`Run::scalar`]; [`Stop::Fail`] where there cannot be `n` of them.
    pub fn joint(
        &mut self,
        label: Label<'_>,
        n: usize,
        joint: &impl Joint<K>,
    ) -> Result<List<Real<K>>, Stop> {
        joint
            .check(n)
            .map_err(|error| Stop::Fail(error.within(label.name())))?;
        let drawn = match self.draws_prior() {
            Some(rng) => Some(joint.draw(n, rng).ok_or(NO_DRAWS)?),
            None => None,
        };
        let determined = joint.determines_last();
        let mut values = List::new();
        for i in 0..n - usize::from(determined) {
            let drawn = drawn.as_ref().map(|all| all[i]);
            let prior = Drawn { prior: joint.next(n, &values), drawn };
            let value = self.scalar(label.at(i), prior)?;
            values.push(value);
        }
        if determined {
            let last = joint.last(&values);
            self.keep(label.at(n - 1), &last);
            values.push(last);
        }
        Ok(values)
    }
}

const NO_DRAWS: Stop = Stop::Reject(
    "a prior has no draws: it is improper, or its arguments are impossible",
);

/// The prior of one of several numbers that were drawn together.
struct Drawn<P> {
    prior: P,
    drawn: Option<f64>,
}

impl<K: Kind, P: Prior<K>> Distribution<K> for Drawn<P> {
    fn log_density(&self, x: Real<K>) -> Real<K> {
        self.prior.log_density(x)
    }

    fn draw(&self, _: &mut Rng) -> Option<f64> {
        self.drawn
    }
}

impl<K: Kind, P: Prior<K>> Prior<K> for Drawn<P> {
    fn support(&self) -> Support<K> {
        self.prior.support()
    }

    fn is_proper(&self) -> bool {
        self.prior.is_proper()
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        self.prior.quantile(p)
    }
}
