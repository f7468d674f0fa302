//! A posterior to second order, put together from its groups.

use super::{Group, Grouped};
use crate::error::Result;
use crate::model::{
    Density, Information, Listener, Model, Point, Posterior, Weights,
};
use crate::scalar::Plain;

/// The same model as the whole, whose information costs each group no more
/// derivatives than it has coordinates.
pub(super) struct Assembly<'a> {
    whole: &'a Posterior<'a>,
    common: &'a Group<'a>,
    groups: &'a [Group<'a>],
}

impl<'a> Assembly<'a> {
    pub(super) fn new(
        grouped: &'a Grouped<'_>,
        common: &'a Group<'_>,
    ) -> Self {
        Self { whole: grouped.whole, common, groups: &grouped.groups }
    }
}

impl Model for Assembly<'_> {
    fn evaluate(
        &self,
        point: Point<'_>,
        listener: Option<&mut dyn Listener<Plain>>,
    ) -> Result<Density> {
        self.whole.model().evaluate(point, listener)
    }

    fn gradient(
        &self,
        z: &[f64],
        weights: Weights,
        gradient: &mut [f64],
    ) -> Result<Density> {
        self.whole.model().gradient(z, weights, gradient)
    }

    /// The sum of the groups', each of which counts the prior of what is in
    /// common.
    fn information(&self, z: &[f64]) -> Result<Information> {
        let mut all = Information::zero(z.len());
        for group in self.groups {
            all.add(&group.information(z)?, &group.places, 1.0);
            if all.density.rejected.is_some() {
                return Ok(all);
            }
        }
        let again = 1.0 - self.groups.len() as f64;
        let common = self.common.information(z)?;
        all.add(&common, &self.common.places, again);
        Ok(all)
    }
}

impl Group<'_> {
    /// At a place of the whole.
    fn information(&self, whole: &[f64]) -> Result<Information> {
        let z: Vec<f64> = self.places.iter().map(|&i| whole[i]).collect();
        self.posterior.information(&z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Outcome;
    use crate::model::{Label, Number, Program, Run};
    use crate::prior::{AnyPrior, Normal};
    use crate::scalar::Real;

    /// a ~ N(0, 1); for each of some events b ~ Exponential(2), and 0.5 was
    /// seen of N(a b, 1).
    struct Events(&'static [usize]);

    impl Program for Events {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let a = AnyPrior::Normal(0.0, 1.0);
            let a = run.scalar(Label::new("a", "1"), a)?;
            for &event in self.0 {
                let b = AnyPrior::Exponential(2.0);
                let b = run.scalar(Label::new("b", "1").at(event), b)?;
                run.observe_each(&0.5, Normal::new(a * b, Real::new(1.0)))?;
            }
            Ok(())
        }
    }

    #[test]
    fn groups_add_up_to_the_whole() {
        let programs = [&[0, 1, 2][..], &[], &[0], &[1], &[2]].map(Events);
        let [whole, common, groups @ ..] =
            programs.each_ref().map(|p| Posterior::new(p).unwrap());
        let common = Group { posterior: &common, places: vec![0] };
        let groups = groups
            .iter()
            .enumerate()
            .map(|(i, posterior)| Group { posterior, places: vec![0, 1 + i] });
        let groups = groups.collect();
        let grouped = Grouped { whole: &whole, common: None, groups };
        let z = [0.7, -0.3, 0.4, 1.1];
        let known = whole.information(&z).unwrap();
        let found = Assembly::new(&grouped, &common).information(&z).unwrap();
        // Round-off, and that of differences of the priors.
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} {b}");
        let parts = |of: &Information| {
            let Density { log_prior, log_jacobian, log_likelihood, .. } =
                of.density;
            let numbers = [log_prior, log_jacobian, log_likelihood];
            let derivatives = of.gradient.iter().chain(of.precision.iter());
            numbers.into_iter().chain(derivatives.copied().collect::<Vec<_>>())
        };
        assert_eq!(found.density.rejected, None);
        parts(&known).zip(parts(&found)).for_each(|(a, b)| near(a, b));
    }
}
