//! The unknowns of mechanisms, as a run asks for them.

use super::label::Label;
use super::number::Number;
use super::run::Run;
use crate::block::List;
use crate::error::Stop;
use crate::mechanism::{Role, Unknown};
use crate::prior::{AnyPrior, Prior as _, Uniform};
use crate::scalar::{Kind, Plain, Real};

impl Unknown {
    /// The prior of a length that has to end within the run, given the amount
    /// before it, where its stretch begins; `None` where its own prior holds.
    fn left<K: Kind>(&self, before: Option<Real<K>>) -> Option<Uniform<K>> {
        let (AnyPrior::Uniform(shortest, _), Role::Length { until }) =
            (self.prior, self.role)
        else {
            return None;
        };
        let left = Real::new(until) - before?;
        // At the very end the shortest one has to have room.
        let least = Real::new(2.0 * shortest);
        let longest = if left > least { left } else { least };
        Some(Uniform::new(shortest, longest))
    }

    /// The middle of its prior, given the value before it; `None` for a flat
    /// one.
    pub(crate) fn middle(&self, before: Option<f64>) -> Option<f64> {
        match self.left(before.map(Real::<Plain>::new)) {
            Some(left) => left.quantile(0.5),
            None => self.prior.quantile(0.5),
        }
    }
}

impl<K: Number> Run<'_, K> {
    /// The parameters of mechanisms, in order.
    pub(super) fn amounts<'u>(
        &mut self,
        all: impl IntoIterator<Item = &'u Unknown>,
    ) -> Result<List<Real<K>>, Stop> {
        let mut values = List::new();
        for unknown in all {
            let label = Label::new(&unknown.name, unknown.unit);
            // An edge comes just before the length of its stretch.
            let value = match unknown.left(values.last().copied()) {
                Some(left) => self.scalar(label, left),
                None => self.scalar(label, unknown.prior),
            };
            values.push(value?);
        }
        Ok(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Outcome;
    use crate::model::{Point, Posterior, Program};
    use crate::physics::forces::Axis;
    use crate::seed::Seed;

    /// A stretch from somewhere in 0 to 10 on, at least 1 long.
    struct Stretch;

    impl Program for Stretch {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let axis = Axis::Place;
            run.amounts(&[
                Unknown::edge("from", axis, [0.0, 10.0]),
                Unknown::length("length", axis, [1.0, 10.0], 10.0),
            ])
            .map(|_| ())
        }
    }

    #[test]
    fn a_stretch_ends_within_the_run_and_its_prior_is_proper() {
        let posterior = Posterior::new(&Stretch).unwrap();
        let density = |x: [f64; 2]| {
            posterior.density(Point::Natural(&x)).unwrap().log_prior
        };
        // 1/10 for where it begins, and 1/5 of 1 to 6, 1 of 1 to 2.
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        near(density([4.0, 3.0]), -(50.0_f64.ln()));
        near(density([9.5, 1.7]), -(10.0_f64.ln()));
        assert_eq!(density([4.0, 6.1]), f64::NEG_INFINITY);
        let mut rng = Seed::new(1).rng();
        for _ in 0..1000 {
            let (_, drawn) = posterior.draw_prior(&mut rng).unwrap();
            let [from, length] = drawn.natural[..] else { panic!() };
            assert!(from + length <= f64::max(10.0, from + 2.0));
        }
    }
}
