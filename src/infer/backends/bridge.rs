//! Bridge sampling: the evidence from posterior draws and as many from a
//! proposal fitted to them.
//!
//! Z = E_q[h p] / E_p[h q] for any h; the h of least error is that of Meng
//! and Wong (1996), 1 / (s1 p / Z + s2 q), which holds Z itself and is found
//! by iteration. As in the R package bridgesampling (Gronau et al. 2017), the
//! proposal q is fitted to one half of the draws and the estimate made with
//! the other, the draws count as many as are effective, and the error is that
//! of Fruehwirth-Schnatter (2004). h stays bounded wherever p or q does, so
//! that neither's tails can spoil it as they do importance sampling.

use crate::draws::{Draws, ess_mean, median, rhat};
use crate::error::{Error, Result};
use crate::infer::proposal::Mixture;
use crate::infer::proposal::{Base, Particle, population};
use crate::infer::{
    Backend, Effort, Evidence, Inference, MetropolisHastings, Progress, Smc,
};
use crate::model::Posterior;
use crate::parallel;
use crate::seed::Seed;

/// Bridge sampling on the draws of another backend.
///
/// A mode that no draw has seen is not in the evidence, and where all chains
/// fell into the same of several, R-hat cannot tell. The command's `bridge`
/// therefore works on particles.
///
/// ```
/// use couloir::infer::{Bridge, Effort};
/// let on_chains = Bridge::default();
/// let on_particles = Bridge::on_particles(&Effort::default());
/// assert_eq!(on_chains.draws, on_particles.draws);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Bridge<B = MetropolisHastings> {
    /// What explores the posterior: chains, or the particles of [`Smc`].
    pub sampler: B,
    /// How many draws of the proposal are made.
    pub draws: usize,
}

impl Default for Bridge {
    fn default() -> Self {
        Self::of_effort(&Effort::default())
    }
}

impl Bridge {
    /// On adaptive chains of an effort.
    pub fn of_effort(effort: &Effort) -> Self {
        Self {
            sampler: MetropolisHastings::adaptive(effort),
            draws: (effort.chains * effort.draws / 4).max(1000),
        }
    }
}

impl Bridge<Smc> {
    /// On the particles of sequential Monte Carlo, which keep to every mode.
    pub fn on_particles(effort: &Effort) -> Self {
        let draws = Bridge::of_effort(effort).draws;
        Self { sampler: Smc::of_effort(effort), draws }
    }
}

/// The most draws of the posterior, a half, that are looked at.
const MOST: usize = 20_000;

/// The most draws that the proposal is fitted to.
const FITTED: usize = 4000;

/// The most components of the proposal.
const COMPONENTS: usize = 6;

/// Above which R-hat the chains do not agree; the paper on it asks for 1.01
/// of results to be reported, the evidence is more lenient.
const DISAGREE: f64 = 1.05;

/// Above which relative error the evidence is a poor one (Gronau et al. 2017
/// call 10 % too high for most purposes).
const POOR: f64 = 0.1;

impl<B: Backend> Bridge<B> {
    /// The evidence from draws that there already are, and what to know
    /// before trusting it.
    ///
    /// # Errors
    /// An improper prior, draws to which no proposal can be fitted, or a
    /// model that fails.
    pub fn from_draws(
        &self,
        posterior: &Posterior<'_>,
        draws: &Draws,
        seed: Seed,
    ) -> Result<(Evidence, Vec<String>)> {
        posterior.require_proper("bridge sampling")?;
        let (first, second) = halves(draws);
        let base = proposal(posterior, &first, seed.child(0))?;
        let theirs = population(posterior, &base, self.draws, seed.child(1))?;
        let ours = second
            .iter()
            .map(|chain| placed(posterior, &base, chain))
            .collect::<Result<Vec<_>>>()?;
        let ours: Vec<Vec<f64>> = ours.iter().map(|c| ratios(c)).collect();
        let found = estimate(&ours, &ratios(&theirs)).ok_or_else(|| {
            Error::inference(
                "bridge sampling finds no common ground between the draws \
                 and the proposal fitted to them: give it more draws",
            )
        })?;
        let mut warnings = Vec::from_iter(disagreement(draws));
        warnings.extend(poor(found.1));
        let method = "bridge sampling by a Student-t mixture".into();
        Ok((Evidence { log: found.0, se: found.1, method }, warnings))
    }
}

/// The first half of each chain and the second, thinned where too long.
type Half<'d> = Vec<Vec<&'d [f64]>>;

fn halves(draws: &Draws) -> (Half<'_>, Half<'_>) {
    let middle = draws.iterations() / 2;
    let step = (draws.chains() * middle).div_ceil(MOST).max(1);
    let of = |from: usize, to: usize| {
        let chain = |c| (from..to).step_by(step).map(move |i| draws.row(c, i));
        (0..draws.chains()).map(|c| chain(c).collect()).collect()
    };
    (of(0, middle), of(middle, draws.iterations()))
}

/// The proposal, with a share of the prior.
fn proposal(
    posterior: &Posterior<'_>,
    half: &Half<'_>,
    seed: Seed,
) -> Result<Base> {
    let total: usize = half.iter().map(Vec::len).sum();
    let step = total.div_ceil(FITTED).max(1);
    let rows = half
        .iter()
        .flatten()
        .step_by(step)
        .map(|row| posterior.line(row))
        .collect::<Result<Vec<_>>>()?;
    let even = vec![1.0 / rows.len() as f64; rows.len()];
    Mixture::fit(&rows, &even, COMPONENTS, &mut seed.rng())
        .map(Base::Mixture)
        .ok_or_else(|| {
            Error::inference(
                "the draws have no spread in some direction, or are too few: \
                 no proposal fits them",
            )
        })
}

/// Draws as places with both densities.
fn placed(
    posterior: &Posterior<'_>,
    base: &Base,
    rows: &[&[f64]],
) -> Result<Vec<Particle>> {
    parallel::try_map(rows, |row| {
        base.particle(posterior, posterior.line(row)?)
    })
}

/// ln p - ln q.
fn ratios(particles: &[Particle]) -> Vec<f64> {
    particles.iter().map(Particle::log_weight).collect()
}

/// The most rounds of the iteration; it doubles its digits every few.
const ROUNDS: usize = 1000;

/// ln Z and its standard error from ln p/q at draws of p, chain by chain, and
/// of q. The iteration runs twice: its first result tells how many draws of p
/// are effective in what is averaged over them.
fn estimate(ours: &[Vec<f64>], theirs: &[f64]) -> Option<(f64, f64)> {
    let n = ours.iter().map(Vec::len).sum::<usize>() as f64;
    let rough = iterate(ours, theirs, n)?;
    let size = effective(&shares(ours, theirs, rough, n)).clamp(1.0, n);
    let log = iterate(ours, theirs, size)?;
    let shares = shares(ours, theirs, log, size);
    let size = effective(&shares).clamp(1.0, n);
    let bridged = |l: &f64| bridge(l - log, size, theirs.len() as f64).0;
    let numerator: Vec<f64> = theirs.iter().map(bridged).collect();
    let first = relative_variance(&numerator) / theirs.len() as f64;
    let second = relative_variance(&shares.concat()) / size;
    Some((log, (first + second).sqrt()))
}

/// At a ratio r = p / (Z q), with s1 and s2 the shares of both kinds of
/// draws: r / (s1 r + s2) and 1 / (s1 r + s2), without overflow.
fn bridge(log_ratio: f64, ours: f64, theirs: f64) -> (f64, f64) {
    let s1 = ours / (ours + theirs);
    let s2 = 1.0 - s1;
    if log_ratio > 0.0 {
        let inverse = (-log_ratio).exp();
        let whole = 1.0 / (s1 + s2 * inverse);
        (whole, whole * inverse)
    } else {
        let ratio = log_ratio.exp();
        let whole = 1.0 / (s1 * ratio + s2);
        (whole * ratio, whole)
    }
}

/// What is averaged over the draws of p, chain by chain.
fn shares(
    ours: &[Vec<f64>],
    theirs: &[f64],
    log: f64,
    size: f64,
) -> Vec<Vec<f64>> {
    let share = |l: &f64| bridge(l - log, size, theirs.len() as f64).1;
    ours.iter().map(|chain| chain.iter().map(share).collect()).collect()
}

/// The fixed point of Meng and Wong's iteration.
fn iterate(ours: &[Vec<f64>], theirs: &[f64], size: f64) -> Option<f64> {
    let count = theirs.len() as f64;
    let mut log = median(&ours.concat());
    for _ in 0..ROUNDS {
        let top = mean(theirs.iter().map(|l| bridge(l - log, size, count).0));
        let below = ours.iter().flatten();
        let below = mean(below.map(|l| bridge(l - log, size, count).1));
        let step = (top / below).ln();
        if !step.is_finite() {
            return None;
        }
        log += step;
        if step.abs() < 1e-10 {
            return Some(log);
        }
    }
    None
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), x| (s + x, n + 1.0));
    sum / count
}

/// The variance over the squared mean.
fn relative_variance(values: &[f64]) -> f64 {
    let centre = mean(values.iter().copied());
    let off = values.iter().map(|x| (x / centre - 1.0).powi(2)).sum::<f64>();
    off / (values.len() as f64 - 1.0).max(1.0)
}

/// How many draws are effective; all where they are alike to the last digit.
fn effective(chains: &[Vec<f64>]) -> f64 {
    let size = ess_mean(chains);
    let all = chains.iter().map(Vec::len).sum::<usize>() as f64;
    if size.is_finite() { size } else { all }
}

/// A warning where chains do not agree: their draws do not weigh the modes as
/// the posterior does, and a mode that none has seen is not in the evidence.
fn disagreement(draws: &Draws) -> Option<String> {
    let worst = (0..draws.dimension())
        .map(|i| (rhat(&draws.column(i)), i))
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    (worst.0 > DISAGREE || worst.0.is_nan()).then(|| {
        format!(
            "the chains do not agree on {} (R-hat {:.2}, above {DISAGREE}): \
             the evidence may miss a mode; use smc, or longer chains",
            draws.names()[worst.1],
            worst.0
        )
    })
}

fn poor(se: f64) -> Option<String> {
    (se > POOR).then(|| {
        format!(
            "the evidence has a relative error of {:.0} %, above {:.0} %: \
             use more draws",
            100.0 * se,
            100.0 * POOR
        )
    })
}

impl<B: Backend> Backend for Bridge<B> {
    fn name(&self) -> &'static str {
        "bridge"
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Inference> {
        posterior.require_proper("bridge sampling")?;
        let sampler = &self.sampler;
        let mut found = sampler.explore(posterior, seed.child(0), progress)?;
        let Some(draws) = &found.draws else {
            return Err(Error::input(format!(
                "bridge sampling needs draws, and {} gives none",
                sampler.name()
            )));
        };
        progress.begin("bridge sampling", None);
        let (evidence, warnings) =
            self.from_draws(posterior, draws, seed.child(1))?;
        found.evidence = Some(evidence);
        found.warnings.extend(warnings);
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_distr::{Distribution, Normal, StandardNormal};

    use super::*;
    use crate::error::Outcome;
    use crate::infer::{Quiet, infer};
    use crate::model::{Label, Number, Program, Run};
    use crate::prior::AnyPrior;
    use crate::scalar::Real;

    /// Draws of N(0, 1) under q = N(shift, spread^2), as ln p/q; p times Z.
    fn ratios_of_normals(
        log_z: f64,
        shift: f64,
        spread: f64,
        seed: u64,
    ) -> (Vec<Vec<f64>>, Vec<f64>) {
        let mut rng = Seed::new(seed).rng();
        let q = Normal::new(shift, spread).unwrap();
        let ratio = |x: f64| {
            let off = (x - shift) / spread;
            log_z - 0.5 * x * x + 0.5 * off * off + spread.ln()
        };
        let ours = (0..4)
            .map(|_| {
                let draw = |_| ratio(StandardNormal.sample(&mut rng));
                (0..1000).map(draw).collect()
            })
            .collect();
        let theirs = (0..4000).map(|_| ratio(q.sample(&mut rng))).collect();
        (ours, theirs)
    }

    #[test]
    fn a_normal_with_a_known_constant() {
        let mut squares = 0.0;
        for seed in 0..100 {
            let (ours, theirs) = ratios_of_normals(-300.0, 0.7, 1.3, seed);
            let (log, se) = estimate(&ours, &theirs).unwrap();
            squares += ((log + 300.0) / se).powi(2);
            assert!(se < 0.03, "{se}");
        }
        // 100 standardised errors: 0.8 to 1.2 but for 4 in 1000.
        let sd = (squares / 100.0_f64).sqrt();
        assert!((0.8..1.2).contains(&sd), "{sd}");
    }

    #[test]
    fn the_error_counts_effective_draws() {
        let (independent, theirs) = ratios_of_normals(5.0, 0.7, 1.3, 1);
        // Every draw said ten times over, as a chain that seldom moves.
        let sticky: Vec<Vec<f64>> = independent
            .iter()
            .map(|c| c[..100].iter().flat_map(|l| [*l; 10]).collect())
            .collect();
        let (_, se) = estimate(&independent, &theirs).unwrap();
        let (_, worse) = estimate(&sticky, &theirs).unwrap();
        // A tenth of the draws of p; those of q, which are all there, take
        // over most of the weight.
        assert!(worse > 1.1 * se, "{worse} {se}");
    }

    #[test]
    fn no_overlap_is_no_estimate() {
        let nothing = [f64::NEG_INFINITY; 100];
        assert_eq!(estimate(&[vec![0.0; 100]], &nothing), None);
        assert_eq!(estimate(&[], &[0.0]), None);
    }

    /// y = a t + error, a ~ N(0, 2^2), errors N(0, 1): all in closed form.
    struct Line {
        t: Vec<f64>,
        y: Vec<f64>,
    }

    impl Program for Line {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let prior = AnyPrior::Normal(0.0, 2.0);
            let a = run.scalar(Label::new("a", "1"), prior)?;
            let b = run.scalar(Label::new("b", "1"), prior)?;
            for (t, y) in self.t.iter().zip(&self.y) {
                let residual = a * *t + b - *y;
                run.observe_each(
                    &0.0,
                    crate::prior::Normal::new(residual, Real::new(1.0)),
                )?;
            }
            Ok(())
        }
    }

    impl Line {
        /// ln N(y; 0, I + 4 (t t' + 1 1')).
        fn log_evidence(&self) -> f64 {
            let n = self.t.len();
            let covariance = nalgebra::DMatrix::from_fn(n, n, |i, j| {
                let own = if i == j { 1.0 } else { 0.0 };
                own + 4.0 * (self.t[i] * self.t[j] + 1.0)
            });
            let factor = covariance.cholesky().unwrap().l();
            let y = nalgebra::DVector::from_column_slice(&self.y);
            let white = factor.solve_lower_triangular(&y).unwrap();
            let log_det: f64 = factor.diagonal().map(f64::ln).sum();
            let constant = 0.5 * (2.0 * std::f64::consts::PI).ln();
            -0.5 * white.norm_squared() - log_det - n as f64 * constant
        }
    }

    fn line() -> Line {
        let mut rng = Seed::new(3).rng();
        let t: Vec<f64> = (0..12).map(|i| 0.2 * f64::from(i)).collect();
        let y = t.iter().map(|t| 0.5 + t + rng.random_range(-1.5..1.5));
        Line { y: y.collect(), t }
    }

    #[test]
    fn a_linear_calibration_on_chains_and_on_particles() {
        let line = line();
        let expected = line.log_evidence();
        let posterior = Posterior::new(&line).unwrap();
        let effort = Effort { chains: 4, draws: 4000, warmup: 1000 };
        let smc = Smc { particles: 1000, ..Smc::default() };
        let on_particles = Bridge { sampler: smc, draws: 4000 };
        let backends: [&dyn Backend; 2] =
            [&Bridge::of_effort(&effort), &on_particles];
        for backend in backends {
            for seed in 0..5 {
                let seed = Seed::new(seed);
                let found = infer(backend, &posterior, seed, &Quiet).unwrap();
                let Evidence { log, se, .. } = found.evidence.unwrap();
                assert!(se < 0.02, "{se}");
                let off = (log - expected).abs();
                assert!(off < 4.0 * se, "{log} +- {se}, not {expected}");
                assert_eq!(found.warnings, Vec::<String>::new());
            }
        }
    }

    #[test]
    fn chains_in_two_places_are_warned_of() {
        let mut draws =
            Draws::new(vec!["a".into()], vec!["1".into()]).unwrap();
        let mut rng = Seed::new(1).rng();
        for centre in [0.0, 5.0] {
            let row = |_| centre + rng.random::<f64>();
            draws.push_chain((0..100).map(row).collect(), None).unwrap();
        }
        let warning = disagreement(&draws).unwrap();
        assert!(warning.contains("do not agree on a (R-hat"), "{warning}");
        assert!(poor(0.2).unwrap().contains("20 %"));
        assert_eq!(poor(0.05), None);
    }
}
