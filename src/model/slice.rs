//! A model of which some parameters are known.

use nalgebra::DVector;

use super::information::Information;
use super::listener::{Collector, Declaration, Listener};
use super::posterior::Posterior;
use super::program::{Density, Model, Point, Weights};
use crate::error::{Outcome, Result};
use crate::noise::Noise;
use crate::observe::Series;
use crate::prior::Prior;
use crate::scalar::{Plain, Real};

/// A model at given values of some of its parameters: a model of the others.
/// Its density is that of all, so that it integrates to p(known, data).
pub struct Slice<'a> {
    model: &'a dyn Model,
    /// All parameters, those known at their values: on the line, as named.
    line: Vec<f64>,
    natural: Vec<f64>,
    /// Which are unknown, in ascending order.
    unknown: Vec<usize>,
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
        Ok(Self {
            model: posterior.model(),
            natural: posterior.natural(line)?,
            line: line.to_vec(),
            unknown: unknown.to_vec(),
        })
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
        let mut collector = Collector::default();
        let density =
            self.model.evaluate(Point::Prior(rng), Some(&mut collector))?;
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
        let mut heard = listener.map(|listener| Unknown {
            listener,
            unknown,
            declared: 0,
        });
        let heard = heard.as_mut().map(|l| l as &mut dyn Listener<Plain>);
        match point {
            Point::Line(z) => {
                let line = self.filled(&self.line, z);
                self.model.evaluate(Point::Line(&line), heard)
            }
            Point::Natural(x) => {
                let natural = self.filled(&self.natural, x);
                self.model.evaluate(Point::Natural(&natural), heard)
            }
            Point::Prior(rng) => match self.drawn(rng)? {
                (density, None) => Ok(density),
                (_, Some(own)) => {
                    let line = self.filled(&self.line, &own);
                    self.model.evaluate(Point::Line(&line), heard)
                }
            },
            Point::Middle => self.model.evaluate(Point::Middle, heard),
        }
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
        Ok(density)
    }

    fn information(&self, z: &[f64]) -> Result<Information> {
        let line = self.filled(&self.line, z);
        let Information { density, gradient, precision } =
            self.model.information(&line)?;
        let own = self.unknown.iter().map(|&i| gradient[i]);
        let gradient = DVector::from_iterator(z.len(), own);
        let rows = precision.select_rows(&self.unknown);
        let precision = rows.select_columns(&self.unknown);
        Ok(Information { density, gradient, precision })
    }
}

/// Hears only of the parameters that are unknown.
struct Unknown<'l> {
    listener: &'l mut dyn Listener<Plain>,
    unknown: &'l [usize],
    declared: usize,
}

impl Listener<Plain> for Unknown<'_> {
    fn parameter(&mut self, declaration: &Declaration<'_, Plain>) {
        if self.unknown.contains(&self.declared) {
            self.listener.parameter(declaration);
        }
        self.declared += 1;
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
        distribution: &dyn Prior<Plain>,
    ) {
        self.listener.element(value, log_density, distribution);
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
        assert_eq!(found.density, all.density);
        assert_eq!(found.gradient[0], all.gradient[1]);
        assert_eq!(found.precision[(0, 0)], all.precision[(1, 1)]);
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
