//! The posterior by quadrature: a tensor grid of Gauss and Legendre's nodes.
//!
//! No sampling, so no Monte Carlo error: what the other backends are held to
//! where there are four parameters or fewer. A variance that is conjugate
//! (given the rest, its density on the line is c - alpha z - B exp(-z), that
//! of an inverse gamma distribution) is found by its form and integrated in
//! closed form: ln of the integral is c + ln Gamma(alpha) - alpha ln B.

use statrs::function::gamma::{gamma_ur, ln_gamma};

use super::legendre::{Cumulative, gauss_legendre};
use super::smc::Smc;
use crate::draws::{Draws, quantile};
use crate::error::{Error, Result};
use crate::infer::{
    Backend, Evidence, Inference, LEVELS, Marginal, Progress, draws_of,
    log_sum_exp,
};
use crate::model::{Point, Posterior};
use crate::parallel;
use crate::seed::Seed;

/// Quadrature on a tensor grid, for up to four parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    /// Nodes along each axis; as many as the dimension allows where `None`.
    pub nodes: Option<usize>,
    /// The run that finds where the posterior lies.
    pub pilot: Smc,
}

impl Default for Quadrature {
    fn default() -> Self {
        let pilot = Smc { particles: 500, refine: false, ..Smc::default() };
        Self { nodes: None, pilot }
    }
}

impl Backend for Quadrature {
    fn name(&self) -> &'static str {
        "quadrature"
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        check_dimension(posterior)?;
        let pilot = self.pilot.explore(posterior, seed.child(0), progress)?;
        let draws = pilot.draws.unwrap_or(draws_of(posterior)?);
        self.from_draws(posterior, &draws, progress)
    }
}

fn check_dimension(posterior: &Posterior<'_>) -> Result<()> {
    posterior.require_proper("quadrature")?;
    match posterior.dimension() {
        0..=MOST => Ok(()),
        n => Err(Error::input(format!(
            "quadrature is for up to {MOST} parameters, the model has {n}; \
             use smc for its evidence"
        ))),
    }
}

/// The most parameters that a grid has axes for.
const MOST: usize = 4;
/// Nodes along each of 1, 2, .. axes.
const NODES: [usize; MOST] = [96, 48, 24, 20];
/// Nodes along each axis while the grid looks for its box.
const COARSE: usize = 8;
/// The share of the highest marginal density that is negligible at an edge: it
/// is also about what the integral lacks.
const NEGLIGIBLE: f64 = 1e-6;

impl Quadrature {
    /// The same without a pilot run, about posterior draws that there are.
    ///
    /// # Errors
    /// More than four parameters, an improper prior, priors that depend on
    /// other parameters, or a model that fails.
    pub fn from_draws(
        &self,
        posterior: &Posterior<'_>,
        draws: &Draws,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        check_dimension(posterior)?;
        let rows: Vec<Vec<f64>> = draws
            .thinned(500)
            .into_iter()
            .map(|row| posterior.line(row))
            .collect::<Result<_>>()?;
        let grid = Grid::about(posterior, &rows)?;
        progress.begin("quadrature", None);
        let grid = grid.settled()?;
        let axes = grid.axes.len();
        let nodes = match (self.nodes, axes) {
            (Some(nodes), _) => nodes.max(2),
            (None, 0) => 1,
            (None, _) => NODES[axes - 1],
        };
        let found = grid.integrated(nodes)?;
        let rough = grid.integrated((3 * nodes).div_ceil(4))?;
        let marginals = grid.marginals(&found)?;
        let se = (found.log - rough.log).abs().max(1e-9);
        let mut warnings = Vec::new();
        if se > 0.01 {
            warnings.push(format!(
                "the evidence changes by {se:.2} with the number of nodes: \
                 the grid is too coarse for this posterior"
            ));
        }
        let method = "quadrature".to_owned();
        Ok(Inference {
            marginals,
            evidence: Some(Evidence { log: found.log, se, method }),
            warnings,
            ..Inference::default()
        })
    }
}

/// An axis: the real line of one parameter, z = centre + scale sinh(t), over
/// a stretch of t. Nodes lie densest in the bulk and still reach the tails.
#[derive(Debug, Clone, Copy)]
struct Axis {
    parameter: usize,
    centre: f64,
    scale: f64,
    low: f64,
    high: f64,
}

impl Axis {
    /// About places on the line.
    fn about(parameter: usize, mut places: Vec<f64>) -> Self {
        places.sort_by(f64::total_cmp);
        let centre = quantile(&places, 0.5);
        let spread = quantile(&places, 0.84) - quantile(&places, 0.16);
        let scale = (0.75 * spread).max(1e-9 * centre.abs().max(1.0));
        let reach = |z: f64| ((z - centre) / scale).asinh();
        let (low, high) = (places[0], places[places.len() - 1]);
        let (low, high) = (reach(low) - 0.3, reach(high) + 0.3);
        Self { parameter, centre, scale, low, high }
    }

    fn t(&self, node: f64) -> f64 {
        self.low + (1.0 + node) * 0.5 * (self.high - self.low)
    }

    /// The place of a node in \[-1, 1\].
    fn at(&self, node: f64) -> f64 {
        self.centre + self.scale * self.t(node).sinh()
    }

    /// dz/dnode.
    fn slope(&self, node: f64) -> f64 {
        0.5 * (self.high - self.low) * self.scale * self.t(node).cosh()
    }
}

/// A parameter whose density on the line, given the rest, is
/// c - alpha z - B exp(-z).
#[derive(Debug, Clone, Copy)]
struct Conjugate {
    parameter: usize,
    alpha: f64,
    /// Where on the line it is looked at.
    places: [f64; 2],
}

struct Grid<'p, 'm> {
    posterior: &'p Posterior<'m>,
    /// A place in the bulk.
    base: Vec<f64>,
    axes: Vec<Axis>,
    conjugate: Option<Conjugate>,
}

/// The integrand on all nodes.
struct Integrated {
    rule: Vec<(f64, f64)>,
    /// ln(weight x density) of each node, the last axis fastest.
    logs: Vec<f64>,
    /// B of the conjugate parameter there.
    rates: Vec<f64>,
    /// ln of the integral.
    log: f64,
}

impl<'p, 'm> Grid<'p, 'm> {
    fn about(posterior: &'p Posterior<'m>, rows: &[Vec<f64>]) -> Result<Self> {
        let [first, .., second] = rows else {
            return Err(Error::inference(
                "quadrature needs draws to know where the posterior lies",
            ));
        };
        check_separate(posterior, first, second)?;
        let conjugate = find_conjugate(posterior, first, second)?;
        let axes = (0..posterior.dimension())
            .filter(|i| conjugate.is_none_or(|c| c.parameter != *i))
            .map(|parameter| {
                let places = rows.iter().map(|row| row[parameter]);
                Axis::about(parameter, places.collect())
            })
            .collect();
        Ok(Self { posterior, base: first.clone(), axes, conjugate })
    }

    /// The same with a box outside of which nothing is left, and that is not
    /// much larger than it need be.
    fn settled(mut self) -> Result<Self> {
        for _ in 0..12 {
            let found = self.integrated(COARSE)?;
            let mut still = true;
            for k in 0..self.axes.len() {
                let density = found.along(k, self.axes.len());
                let top = density.iter().copied().fold(0.0, f64::max);
                let share = |i: usize| density[i] / top;
                let axis = &mut self.axes[k];
                let width = axis.high - axis.low;
                let (low, high) = (axis.low, axis.high);
                if share(0) > NEGLIGIBLE {
                    axis.low -= 0.25 * width;
                } else if share(2) < NEGLIGIBLE {
                    axis.low += 0.1 * width;
                }
                if share(COARSE - 1) > NEGLIGIBLE {
                    axis.high += 0.25 * width;
                } else if share(COARSE - 3) < NEGLIGIBLE {
                    axis.high -= 0.1 * width;
                }
                still &= axis.low == low && axis.high == high;
            }
            if still {
                break;
            }
        }
        Ok(self)
    }

    fn integrated(&self, nodes: usize) -> Result<Integrated> {
        let rule = gauss_legendre(nodes);
        let count = nodes.pow(self.axes.len() as u32);
        let cells = parallel::try_map(0..count, |index| {
            self.cell(&rule, index, &mut self.base.clone())
        })?;
        let logs: Vec<f64> = cells.iter().map(|(log, _)| *log).collect();
        let rates = cells.iter().map(|(_, rate)| *rate).collect();
        let log = log_sum_exp(logs.iter().copied());
        if !log.is_finite() {
            return Err(Error::inference(
                "quadrature found no place of positive density",
            ));
        }
        Ok(Integrated { rule, logs, rates, log })
    }

    /// ln(weight x density) at a node, and the conjugate parameter's rate.
    fn cell(
        &self,
        rule: &[(f64, f64)],
        mut index: usize,
        z: &mut [f64],
    ) -> Result<(f64, f64)> {
        let mut log_weight = 0.0;
        for axis in self.axes.iter().rev() {
            let (node, weight) = rule[index % rule.len()];
            index /= rule.len();
            z[axis.parameter] = axis.at(node);
            log_weight += (weight * axis.slope(node)).ln();
        }
        let Some(c) = self.conjugate else {
            return Ok((log_weight + height(self.posterior, z)?, 0.0));
        };
        let [a, b] = c.places;
        z[c.parameter] = a;
        let at_a = height(self.posterior, z)?;
        z[c.parameter] = b;
        let at_b = height(self.posterior, z)?;
        let spread = (-a).exp() - (-b).exp();
        let rate = (at_b - at_a + c.alpha * (b - a)) / spread;
        if rate <= 0.0 || rate.is_nan() {
            return Ok((f64::NEG_INFINITY, 0.0));
        }
        let constant = at_a + c.alpha * a + rate * (-a).exp();
        let integral = constant + ln_gamma(c.alpha) - c.alpha * rate.ln();
        Ok((log_weight + integral, rate))
    }

    fn marginals(&self, found: &Integrated) -> Result<Vec<Marginal>> {
        let parameters = self.posterior.parameters();
        let mut marginals = Vec::with_capacity(parameters.len());
        for (i, parameter) in parameters.iter().enumerate() {
            let axis = self.axes.iter().position(|a| a.parameter == i);
            let (mean, sd, quantiles) = match (axis, self.conjugate) {
                (Some(k), _) => self.along_axis(found, k)?,
                (None, Some(c)) => found.of_conjugate(c.alpha),
                (None, None) => continue,
            };
            let (name, unit) =
                (parameter.name.clone(), parameter.unit.clone());
            marginals.push(Marginal { name, unit, mean, sd, quantiles });
        }
        Ok(marginals)
    }

    /// Mean, standard deviation and quantiles of the parameter of an axis.
    fn along_axis(
        &self,
        found: &Integrated,
        k: usize,
    ) -> Result<(f64, f64, [f64; 7])> {
        let axis = &self.axes[k];
        let mut z = self.base.clone();
        let mut natural = |node: f64| -> Result<f64> {
            z[axis.parameter] = axis.at(node);
            Ok(self.posterior.natural(&z)?[axis.parameter])
        };
        let density = found.along(k, self.axes.len());
        let rule = || found.rule.iter().zip(&density);
        let total: f64 = rule().map(|((_, w), d)| w * d).sum();
        let (mut mean, mut square) = (0.0, 0.0);
        for ((node, weight), density) in rule() {
            let (x, share) = (natural(*node)?, weight * density / total);
            mean += share * x;
            square += share * x * x;
        }
        let cumulative = Cumulative::of(&found.rule, &density);
        let mut quantiles = [0.0; 7];
        for (q, level) in quantiles.iter_mut().zip(LEVELS) {
            *q = natural(cumulative.quantile(level))?;
        }
        Ok((mean, (square - mean * mean).max(0.0).sqrt(), quantiles))
    }
}

impl Integrated {
    /// The marginal density along an axis at its nodes, up to a factor.
    fn along(&self, k: usize, axes: usize) -> Vec<f64> {
        let n = self.rule.len();
        let stride = n.pow((axes - 1 - k) as u32);
        let mut sums = vec![0.0; n];
        for (index, log) in self.logs.iter().enumerate() {
            sums[index / stride % n] += (log - self.log).exp();
        }
        let weights = self.rule.iter().map(|(_, weight)| weight);
        sums.iter().zip(weights).map(|(sum, weight)| sum / weight).collect()
    }

    /// The same of a conjugate parameter: a mixture of inverse gamma
    /// distributions of one shape.
    fn of_conjugate(&self, alpha: f64) -> (f64, f64, [f64; 7]) {
        let parts: Vec<(f64, f64)> = self
            .logs
            .iter()
            .zip(&self.rates)
            .map(|(log, rate)| ((log - self.log).exp(), *rate))
            .filter(|(share, _)| *share > 1e-8)
            .collect();
        let sum = |f: &dyn Fn(f64) -> f64| -> f64 {
            parts.iter().map(|(share, rate)| share * f(*rate)).sum()
        };
        let mean = sum(&|rate| rate) / (alpha - 1.0);
        let square =
            sum(&|rate| rate * rate) / ((alpha - 1.0) * (alpha - 2.0));
        let quantiles = LEVELS.map(|level| {
            let (mut low, mut high) = (mean.ln() - 20.0, mean.ln() + 20.0);
            while high - low > 1e-7 {
                let middle = 0.5 * (low + high);
                let x = middle.exp();
                if sum(&|rate| gamma_ur(alpha, rate / x)) < level {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            (0.5 * (low + high)).exp()
        });
        (mean, (square - mean * mean).max(0.0).sqrt(), quantiles)
    }
}

/// The log density on the line, minus infinity where there is none.
fn height(posterior: &Posterior<'_>, z: &[f64]) -> Result<f64> {
    let density = posterior.density(Point::Line(z))?;
    Ok(density.on_line())
}

/// Refuses priors that depend on other parameters: a marginal on the line
/// would say nothing about the parameter as named.
fn check_separate(
    posterior: &Posterior<'_>,
    first: &[f64],
    second: &[f64],
) -> Result<()> {
    let alone = posterior.natural(first)?;
    for i in 0..first.len() {
        let mut z = second.to_vec();
        z[i] = first[i];
        if posterior.natural(&z)?[i] != alone[i] {
            return Err(Error::input(format!(
                "quadrature needs priors that depend on no other parameter, \
                 but that of {} does; use smc",
                posterior.parameters()[i].name
            )));
        }
    }
    Ok(())
}

/// The parameter that is conjugate, where one is.
fn find_conjugate(
    posterior: &Posterior<'_>,
    first: &[f64],
    second: &[f64],
) -> Result<Option<Conjugate>> {
    for parameter in (0..first.len()).rev() {
        let z = first[parameter];
        let scale = posterior.natural(first)?[parameter];
        if (scale.ln() - z).abs() > 1e-12 * z.abs().max(1.0) {
            continue;
        }
        let here = shape(posterior, first, parameter)?;
        let there = shape(posterior, second, parameter)?;
        if let (Some(here), Some(there)) = (here, there)
            && (here - there).abs() < 1e-6 * here
        {
            let places = [z - 0.7, z + 0.7];
            return Ok(Some(Conjugate { parameter, alpha: here, places }));
        }
    }
    Ok(None)
}

/// alpha, if along this parameter the density is c - alpha z - B exp(-z).
fn shape(
    posterior: &Posterior<'_>,
    base: &[f64],
    parameter: usize,
) -> Result<Option<f64>> {
    let mut z = base.to_vec();
    let mut g = [0.0; 4];
    for (step, slot) in g.iter_mut().enumerate() {
        z[parameter] = base[parameter] + step as f64 - 1.0;
        *slot = height(posterior, &z)?;
    }
    let step = |i: usize| g[i + 1] - g[i];
    let (e, inverse) = (1f64.exp(), (-1f64).exp());
    // B exp(-z) at the base, from the second difference.
    let scaled = (step(0) - step(1)) / (e - 2.0 + inverse);
    let alpha = scaled * (1.0 - inverse) - step(1);
    let expected = scaled * (inverse - inverse * inverse) - alpha;
    let size = g.iter().fold(1.0, |top: f64, x| top.max(x.abs()));
    let fits = (step(2) - expected).abs() < 1e-9 * size;
    Ok((fits && alpha > 2.0 && scaled > 0.0).then_some(alpha))
}
