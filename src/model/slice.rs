//! A model of which some parameters are known.

use nalgebra::DMatrix;

use super::along::unit_directions;
use super::density::{Density, Weights};
use super::face::{Model, Point};
use super::information::Information;
use super::label::Label;
use super::listener::{Collector, Declaration, Listener};
use super::posterior::Posterior;
use crate::error::{Outcome, Result};
use crate::noise::Noise;
use crate::observe::Series;
use crate::prior::{Distribution, Prior};
use crate::scalar::{Plain, Real};
use crate::seed::Rng;

/// A model at given values of some of its parameters, whose priors depend on
/// none of the unknown ones: a model of those. Its density is
/// p(unknown, data | known).
pub struct Slice<'a> {
    model: &'a dyn Model,
    /// All parameters, those known at their values: on the line, as named.
    line: Vec<f64>,
    natural: Vec<f64>,
    /// Which are unknown, in ascending order.
    unknown: Vec<usize>,
    /// The unknown ones as directions of all.
    directions: DMatrix<f64>,
    /// ln of the prior density of the known ones, and of their Jacobian.
    known: (f64, f64),
}

impl std::fmt::Debug for Slice<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Slice")
            .field("line", &self.line)
            .field("unknown", &self.unknown)
            .finish_non_exhaustive()
    }
}

impl<'a> Slice<'a> {
    /// The model of a posterior with all parameters but the `unknown` ones,
    /// in ascending order, as at a place on the real line.
    ///
    /// # Errors
    /// As [`Posterior::density`].
    pub fn new(
        posterior: &Posterior<'a>,
        line: &[f64],
        unknown: &[usize],
    ) -> Result<Self> {
        let mut known = Known { unknown, declared: 0, sum: (0.0, 0.0) };
        let model = posterior.model();
        model.evaluate(Point::Line(line), Some(&mut known))?;
        Ok(Self {
            model,
            natural: posterior.natural(line)?,
            line: line.to_vec(),
            unknown: unknown.to_vec(),
            directions: unit_directions(unknown, line.len()),
            known: known.sum,
        })
    }

    /// A density without the known ones' prior; on the line also without
    /// their Jacobian.
    fn given(&self, density: Density, on_line: bool) -> Density {
        let (log_prior, log_jacobian) = self.known;
        Density {
            log_prior: density.log_prior - log_prior,
            log_jacobian: match on_line {
                true => density.log_jacobian - log_jacobian,
                false => density.log_jacobian,
            },
            ..density
        }
    }

    /// All coordinates, with the unknown ones as given.
    fn filled(&self, known: &[f64], unknown: &[f64]) -> Vec<f64> {
        let mut all = known.to_vec();
        for (&i, x) in self.unknown.iter().zip(unknown) {
            all[i] = *x;
        }
        all
    }

    /// The place of a draw from the prior of all; `None` where it was cut
    /// short, with the density that it has.
    fn drawn(
        &self,
        rng: &mut crate::seed::Rng,
    ) -> Result<(Density, Option<Vec<f64>>)> {
        // Its own prior may depend on what is held.
        let mut known = self.natural.clone();
        known.resize(self.line.len(), f64::NAN);
        self.unknown.iter().for_each(|&i| known[i] = f64::NAN);
        let mut collector = Collector::default();
        let point = Point::PriorGiven(&known, rng);
        let density = self.model.evaluate(point, Some(&mut collector))?;
        let found = collector.collected.line;
        let whole = found.len() == self.line.len();
        let own = || self.unknown.iter().map(|&i| found[i]).collect();
        Ok((density, whole.then(own)))
    }
}

impl Model for Slice<'_> {
    fn evaluate(
        &self,
        point: Point<'_>,
        listener: Option<&mut dyn Listener<Plain>>,
    ) -> Result<Density> {
        let unknown = &self.unknown;
        let mut heard =
            listener.map(|listener| Heard { listener, unknown, declared: 0 });
        let heard = heard.as_mut().map(|l| l as &mut dyn Listener<Plain>);
        let line = match point {
            Point::Line(z) => self.filled(&self.line, z),
            Point::Prior(rng) | Point::PriorGiven(_, rng) => {
                match self.drawn(rng)? {
                    (density, None) => return Ok(density),
                    (_, Some(own)) => self.filled(&self.line, &own),
                }
            }
            Point::Natural(x) => {
                let natural = self.filled(&self.natural, x);
                let point = Point::Natural(&natural);
                let density = self.model.evaluate(point, heard)?;
                return Ok(self.given(density, false));
            }
            Point::Middle => return self.model.evaluate(Point::Middle, heard),
        };
        let density = self.model.evaluate(Point::Line(&line), heard)?;
        Ok(self.given(density, true))
    }

    fn gradient(
        &self,
        z: &[f64],
        weights: Weights,
        gradient: &mut [f64],
    ) -> Result<Density> {
        let line = self.filled(&self.line, z);
        let mut all = vec![0.0; line.len()];
        let density = self.model.gradient(&line, weights, &mut all)?;
        for (slot, &i) in gradient.iter_mut().zip(&self.unknown) {
            *slot = all[i];
        }
        Ok(self.given(density, true))
    }

    fn information(&self, z: &[f64]) -> Result<Information> {
        let line = self.filled(&self.line, z);
        let mut own = self.model.information_along(&line, &self.directions)?;
        own.density = self.given(own.density, true);
        Ok(own)
    }
}

/// Adds up the priors of the known parameters.
struct Known<'l> {
    unknown: &'l [usize],
    declared: usize,
    sum: (f64, f64),
}

impl Listener<Plain> for Known<'_> {
    fn parameter(&mut self, declaration: &Declaration<'_, Plain>) {
        if !self.unknown.contains(&self.declared) {
            let Declaration { value, prior, .. } = declaration;
            let support = prior.support();
            let z = Real::new(support.to_line(*value));
            self.sum.0 += prior.log_density(Real::new(*value)).value();
            self.sum.1 += support.from_line(z).1.value();
        }
        self.declared += 1;
    }
}

/// Lets hear only of the parameters that are unknown.
struct Heard<'l> {
    listener: &'l mut dyn Listener<Plain>,
    unknown: &'l [usize],
    declared: usize,
}

impl Listener<Plain> for Heard<'_> {
    fn parameter(&mut self, declaration: &Declaration<'_, Plain>) {
        if self.unknown.contains(&self.declared) {
            self.listener.parameter(declaration);
        }
        self.declared += 1;
    }

    fn block(&mut self, name: &str) {
        self.listener.block(name);
    }

    fn made(&self) -> Option<f64> {
        self.listener.made()
    }

    fn scores(&self) -> bool {
        self.listener.scores()
    }

    fn has_heard_enough(&self) -> bool {
        self.listener.has_heard_enough()
    }

    fn series(
        &mut self,
        series: &Series,
        residuals: &[Real<Plain>],
        noise: &dyn Noise<Plain>,
    ) -> Outcome {
        self.listener.series(series, residuals, noise)
    }

    fn element(
        &mut self,
        value: f64,
        log_density: Real<Plain>,
        distribution: &dyn Distribution<Plain>,
    ) {
        self.listener.element(value, log_density, distribution);
    }

    fn increment(&mut self, log_density: Real<Plain>) {
        self.listener.increment(log_density);
    }

    fn kept(&mut self, label: &Label<'_>, value: f64) {
        self.listener.kept(label, value);
    }

    fn chance(&mut self) -> Option<&mut Rng> {
        self.listener.chance()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Label, Number, Program, Run};
    use crate::prior::AnyPrior;
    use crate::seed::Seed;

    /// a ~ N(0, 1), b ~ Exponential(2), and 0.5 ~ N(a b, 1) was seen.
    struct Two;

    impl Program for Two {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let a = AnyPrior::Normal(0.0, 1.0);
            let a = run.scalar(Label::new("a", "1"), a)?;
            let b = AnyPrior::Exponential(2.0);
            let b = run.scalar(Label::new("b", "m"), b)?;
            let seen = crate::prior::Normal::new(a * b, Real::new(1.0));
            run.observe_each(&0.5, seen)
        }
    }

    #[test]
    fn a_slice_is_the_whole_where_the_known_are() {
        let whole = Posterior::new(&Two).unwrap();
        let (line, z) = ([0.7, -0.3], [-0.3]);
        let slice = Slice::new(&whole, &line, &[1]).unwrap();
        let own = Posterior::new(&slice).unwrap();
        assert_eq!((own.dimension(), &own.parameters()[0].name[..]), (1, "b"));
        let all = whole.information(&line).unwrap();
        let found = own.information(&z).unwrap();
        let known = AnyPrior::Normal(0.0, 1.0);
        let known =
            Distribution::<Plain>::log_density(&known, Real::new(line[0]));
        let off = all.density.log_prior - found.density.log_prior;
        assert!((off - known.value()).abs() < 1e-12);
        assert_eq!(found.density.log_jacobian, all.density.log_jacobian);
        assert_eq!(found.density.log_likelihood, all.density.log_likelihood);
        assert_eq!(found.gradient[0], all.gradient[1]);
        assert_eq!(found.precision[(0, 0)], all.precision[(1, 1)]);
        let along =
            own.information_along(&z, &DMatrix::identity(1, 1)).unwrap();
        assert_eq!(along.precision, found.precision);
        let all_unknown = Slice::new(&whole, &line, &[0, 1]).unwrap();
        let mixed = DMatrix::from_row_slice(3, 2, &[1., 2., -1., 0.5, 0., 3.]);
        let along =
            all_unknown.information_along(&line, &mixed).unwrap().precision;
        let expected = &mixed * &all.precision * mixed.transpose();
        assert!((along - expected).amax() < 1e-9);
        assert!(own.information_along(&z, &mixed).unwrap_err().is_input());
        let mut gradient = [0.0];
        own.gradient(&z, Weights::LINE, &mut gradient).unwrap();
        assert_eq!(gradient[0], all.gradient[1]);
        let x = own.natural(&z).unwrap();
        assert_eq!(x[..], whole.natural(&line).unwrap()[1..]);
        assert_eq!(own.line(&x).unwrap(), z);
        let (_, drawn) = own.draw_prior(&mut Seed::new(1).rng()).unwrap();
        assert_eq!(drawn.line.len(), 1);
    }
}
