//! Metropolis-Hastings with a normal random walk.
//!
//! Two proposals: the paper's, in the parameters as named with a covariance
//! tuned beforehand and then held (Heredia et al. 2020, equations 8-9), and
//! an adaptive one on the real line whose covariance goes on learning, every
//! step counting alike (Haario, Saksman, Tamminen 2001), from a warm-up that
//! learns faster and sets the scale too (Andrieu, Thoms 2008).

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use crate::error::{Error, Result};
use crate::infer::start::apart;
use crate::infer::{Backend, Effort, Inference, Progress, draws_of};
use crate::model::{Point, Posterior};
use crate::parallel;
use crate::seed::{Rng, Seed};

/// How the next place is proposed.
#[derive(Debug, Clone, PartialEq)]
pub enum Proposal {
    /// A normal step in the parameters as named, its covariance tuned during
    /// warm-up towards an acceptance of 0.25 and then held.
    RandomWalk,
    /// The same with a covariance of one's own, held from the start.
    Fixed(DMatrix<f64>),
    /// A normal step on the real line that goes on adapting.
    Adaptive,
}

/// Several independent Metropolis-Hastings chains.
///
/// ```
/// use couloir::infer::{Effort, MetropolisHastings};
/// let effort = Effort::new().chains(3).draws(25_000).warmup(25_000);
/// let as_in_the_paper = MetropolisHastings::random_walk(&effort);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MetropolisHastings {
    /// How many chains.
    pub chains: usize,
    /// Draws kept of each.
    pub draws: usize,
    /// Steps before those.
    pub warmup: usize,
    /// How steps are proposed.
    pub proposal: Proposal,
    /// Where the chains start, parameters as named, in turn; far apart among
    /// good draws from the prior where empty.
    pub starts: Vec<Vec<f64>>,
}

impl Default for MetropolisHastings {
    /// The adaptive walk, four chains of 10 000 draws.
    fn default() -> Self {
        Self::adaptive(&Effort::default())
    }
}

impl MetropolisHastings {
    /// The paper's random walk.
    pub fn random_walk(effort: &Effort) -> Self {
        Self {
            chains: effort.chains,
            draws: effort.draws,
            warmup: effort.warmup,
            proposal: Proposal::RandomWalk,
            starts: Vec::new(),
        }
    }

    /// The adaptive walk on the real line.
    pub fn adaptive(effort: &Effort) -> Self {
        Self { proposal: Proposal::Adaptive, ..Self::random_walk(effort) }
    }

    fn chain(
        &self,
        posterior: &Posterior<'_>,
        (index, start): (usize, Vec<f64>),
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<(Vec<f64>, f64)> {
        let mut rng = seed.child(index as u64).rng();
        let mut walk = Walk::new(posterior, &self.proposal, start)?;
        for step in 0..self.warmup {
            walk.step(&mut rng)?;
            let gain = (step as f64 / 4.0 + 2.0).powf(-0.66);
            walk.learn_scale(gain);
            walk.learn_shape(gain, step);
            tell(progress, step);
        }
        walk.accepted = 0;
        let mut rows = Vec::with_capacity(self.draws * walk.place.len());
        for step in 0..self.draws {
            walk.step(&mut rng)?;
            if self.proposal == Proposal::Adaptive {
                // Every step so far counts alike (Haario et al. 2001). A rate
                // that vanishes slower, or a scale that goes on following
                // the acceptance, was seen to cut tails off.
                let total = self.warmup + step;
                walk.learn_shape(1.0 / (total as f64 + 2.0), total);
            }
            rows.extend_from_slice(&walk.place);
            tell(progress, step);
        }
        if walk.on_line {
            to_natural(posterior, &mut rows, walk.place.len())?;
        }
        Ok((rows, walk.accepted as f64 / self.draws.max(1) as f64))
    }

    /// Where each chain starts, in the parameters as named.
    fn places(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
    ) -> Result<Vec<Vec<f64>>> {
        if self.starts.is_empty() {
            return apart(posterior, self.chains, seed);
        }
        let given = self.starts.iter().cycle().take(self.chains).enumerate();
        given
            .map(|(index, start)| {
                let density = posterior.density(Point::Natural(start))?;
                match density.rejected {
                    None => Ok(start.clone()),
                    Some(reason) => Err(Error::input(format!(
                        "chain {} cannot start at {start:?}: {reason}",
                        index + 1
                    ))),
                }
            })
            .collect()
    }
}

/// Progress is told every so many steps, so that telling costs nothing.
const TELL_EVERY: usize = 512;

fn tell(progress: &dyn Progress, step: usize) {
    if step % TELL_EVERY == TELL_EVERY - 1 {
        progress.advance(TELL_EVERY as u64);
    }
}

/// Turns rows on the real line into rows of the parameters as named.
pub(in crate::infer) fn to_natural(
    posterior: &Posterior<'_>,
    rows: &mut [f64],
    dimension: usize,
) -> Result<()> {
    let mut last: Option<(Vec<f64>, Vec<f64>)> = None;
    for row in rows.chunks_mut(dimension) {
        match &last {
            Some((z, x)) if z == row => row.copy_from_slice(x),
            _ => {
                let x = posterior.natural(row)?;
                let z = row.to_vec();
                row.copy_from_slice(&x);
                last = Some((z, x));
            }
        }
    }
    Ok(())
}

/// By how much a normal proposal of the target's own covariance is best
/// scaled (Gelman, Roberts, Gilks 1996).
fn best_log_scale(dimension: usize) -> f64 {
    (2.38 / (dimension as f64).sqrt()).ln()
}

/// One chain's state.
struct Walk<'p, 'm> {
    posterior: &'p Posterior<'m>,
    on_line: bool,
    held: bool,
    place: Vec<f64>,
    proposed: Vec<f64>,
    density: f64,
    /// Cholesky factor of the proposal's covariance, without the scale.
    factor: DMatrix<f64>,
    log_scale: f64,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
    acceptance: f64,
    accepted: u64,
}

/// The acceptance rate aimed at (Roberts, Rosenthal 2001; the paper's 0.25).
const TARGET_ACCEPTANCE: f64 = 0.25;

/// A covariance of so many parameters.
fn square(given: &DMatrix<f64>, n: usize) -> Result<DMatrix<f64>> {
    match given.shape() {
        shape if shape == (n, n) => Ok(given.clone()),
        (rows, columns) => Err(Error::input(format!(
            "the proposal's covariance is {rows} x {columns}; expected {n} x \
             {n}, one row for each parameter"
        ))),
    }
}

impl<'p, 'm> Walk<'p, 'm> {
    fn new(
        posterior: &'p Posterior<'m>,
        proposal: &Proposal,
        start: Vec<f64>,
    ) -> Result<Self> {
        let n = start.len();
        let on_line = *proposal == Proposal::Adaptive;
        let place = if on_line { posterior.line(&start)? } else { start };
        let spread = |i: usize| {
            if on_line { 0.1 } else { 0.05 * place[i].abs().max(1e-3) }
        };
        let mut covariance = DMatrix::from_fn(n, n, |i, j| {
            if i == j { spread(i).powi(2) } else { 0.0 }
        });
        let mut log_scale = best_log_scale(n);
        if let Proposal::Fixed(given) = proposal {
            covariance = square(given, n)?;
            log_scale = 0.0;
        }
        let factor = covariance.clone().cholesky().ok_or_else(|| {
            Error::input("the proposal's covariance is not positive definite")
        })?;
        let mut walk = Self {
            posterior,
            on_line,
            held: matches!(proposal, Proposal::Fixed(_)),
            proposed: place.clone(),
            density: f64::NEG_INFINITY,
            factor: factor.l(),
            log_scale,
            mean: DVector::from_column_slice(&place),
            covariance,
            acceptance: 0.0,
            accepted: 0,
            place,
        };
        walk.density = walk.density_at_proposed()?;
        Ok(walk)
    }

    fn density_at_proposed(&self) -> Result<f64> {
        let at = &self.proposed;
        if self.on_line {
            let density = self.posterior.density(Point::Line(at))?;
            Ok(density.on_line())
        } else {
            let density = self.posterior.density(Point::Natural(at))?;
            Ok(density.natural())
        }
    }

    /// One proposal, taken or not (the paper's equation 9; the step is
    /// symmetric, so q cancels).
    fn step(&mut self, rng: &mut Rng) -> Result<()> {
        let scale = self.log_scale.exp();
        self.proposed.copy_from_slice(&self.place);
        for j in 0..self.place.len() {
            let z: f64 = StandardNormal.sample(rng);
            let column = self.factor.column(j);
            for i in j..self.place.len() {
                self.proposed[i] += scale * column[i] * z;
            }
        }
        let density = self.density_at_proposed()?;
        let u: f64 = rng.random();
        self.acceptance = (density - self.density).exp().min(1.0);
        if u < self.acceptance {
            std::mem::swap(&mut self.place, &mut self.proposed);
            self.density = density;
            self.accepted += 1;
        }
        Ok(())
    }

    /// Learns the scale from the acceptance of the step just made; it stays
    /// below the best for a normal density of this covariance. Scale and
    /// covariance that grew together made steps long enough, early on, for
    /// all chains to fall into one of two modes.
    fn learn_scale(&mut self, gain: f64) {
        if !self.held {
            let learnt =
                self.log_scale + gain * (self.acceptance - TARGET_ACCEPTANCE);
            self.log_scale = learnt.min(best_log_scale(self.place.len()));
        }
    }

    /// Learns mean and covariance from where the walk stands.
    fn learn_shape(&mut self, gain: f64, step: usize) {
        if self.held {
            return;
        }
        for (i, x) in self.place.iter().enumerate() {
            self.proposed[i] = x - self.mean[i];
            self.mean[i] += gain * self.proposed[i];
        }
        for i in 0..self.place.len() {
            for j in 0..self.place.len() {
                let product = self.proposed[i] * self.proposed[j];
                let c = &mut self.covariance[(i, j)];
                *c += gain * (product - *c);
            }
        }
        if step % 50 == 49 {
            self.refactor();
        }
    }

    fn refactor(&mut self) {
        let n = self.covariance.nrows();
        let mut nudged = self.covariance.clone();
        for i in 0..n {
            nudged[(i, i)] *= 1.0 + 1e-9;
            nudged[(i, i)] += f64::MIN_POSITIVE;
        }
        if let Some(factor) = nudged.cholesky() {
            self.factor = factor.l();
        }
    }
}

impl Backend for MetropolisHastings {
    fn name(&self) -> &'static str {
        if self.proposal == Proposal::Adaptive { "mh" } else { "random-walk" }
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        if self.chains == 0 || self.draws == 0 {
            return Err(Error::input(
                "Metropolis-Hastings needs at least one chain and one draw",
            ));
        }
        let steps = self.chains * (self.warmup + self.draws);
        progress.begin("sampling", Some(steps as u64));
        // A path of its own, beside those of the chains.
        let starts = self.places(posterior, seed.child(self.chains as u64))?;
        let chains =
            parallel::try_map(starts.into_iter().enumerate(), |from| {
                self.chain(posterior, from, seed, progress)
            })?;
        let mut draws = draws_of(posterior)?;
        let mut hints = Vec::new();
        for (index, (rows, acceptance)) in chains.into_iter().enumerate() {
            if !(0.05..=0.7).contains(&acceptance) {
                hints.push(format!(
                    "chain {} accepted {:.0} % of its proposals; 20 to 40 % \
                     is healthy: give it a longer warm-up",
                    index + 1,
                    100.0 * acceptance
                ));
            }
            draws.push_chain(rows, Some(acceptance))?;
        }
        Ok(Inference { draws: Some(draws), hints, ..Inference::default() })
    }
}
