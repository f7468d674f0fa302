//! The unknowns of mechanisms, as a run asks for them.

use super::number::Number;
use super::run::{Label, Run};
use crate::block::List;
use crate::error::Stop;
use crate::mechanism::{Role, Unknown};
use crate::prior::{AnyPrior, Prior as _, Uniform};
use crate::scalar::{Kind, Plain, Real};

/// A parameter of a mechanism, or of a model put together at run time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Amount<'a> {
    pub(super) label: Label<'a>,
    pub(super) prior: AnyPrior,
    pub(super) role: Role,
}

impl<'a> Amount<'a> {
    pub(super) fn of(name: &'a str, unknown: &Unknown) -> Self {
        let Unknown { unit, prior, role, .. } = *unknown;
        Self { label: Label::new(name, unit), prior, role }
    }

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
    pub(super) fn middle(&self, before: Option<f64>) -> Option<f64> {
        match self.left(before.map(Real::<Plain>::new)) {
            Some(left) => left.quantile(0.5),
            None => self.prior.quantile(0.5),
        }
    }
}

impl<K: Number> Run<'_, K> {
    /// The parameters of mechanisms, in order.
    pub(super) fn amounts<'a>(
        &mut self,
        all: impl IntoIterator<Item = Amount<'a>>,
    ) -> Result<List<Real<K>>, Stop> {
        let mut values = List::new();
        for amount in all {
            let value = self.amount(amount, values.last())?;
            values.push(value);
        }
        Ok(values)
    }

    /// `before` is the amount before it, where a stretch begins.
    fn amount(
        &mut self,
        amount: Amount<'_>,
        before: Option<&Real<K>>,
    ) -> Result<Real<K>, Stop> {
        match amount.left(before.copied()) {
            Some(left) => self.scalar(amount.label, left),
            None => self.scalar(amount.label, amount.prior),
        }
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
            let amount = |name, low, role| Amount {
                label: Label::new(name, "m"),
                prior: AnyPrior::Uniform(low, 10.0),
                role,
            };
            let from = amount("from", 0.0, Role::Edge(Axis::Place));
            let within = Role::Length { until: 10.0 };
            run.amounts([from, amount("length", 1.0, within)]).map(|_| ())
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
