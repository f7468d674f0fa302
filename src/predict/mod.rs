//! What a model predicts: bands of the flow alone and with its errors, and
//! recordings that it might have led to, with figures of them.

mod statistics;

pub use statistics::Statistic;

use crate::draws::{Draws, quantile};
use crate::error::{Error, Outcome, Result};
use crate::model::{Listener, Model, Point, Posterior, Replicates};
use crate::noise::Noise;
use crate::observe::Series;
use crate::parallel;
use crate::prior::Distribution;
use crate::scalar::{Plain, Real};
use crate::seed::{Rng, Seed};

/// A prediction over time: the median flow and 90 % bands about it.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Bands {
    /// Times, increasing \[s\].
    pub times: Vec<f64>,
    /// Median of the flow.
    pub median: Vec<f64>,
    /// 5 % quantile of the flow alone.
    pub flow_low: Vec<f64>,
    /// 95 % quantile of the flow alone.
    pub flow_high: Vec<f64>,
    /// 5 % quantile of the flow with errors.
    pub full_low: Vec<f64>,
    /// 95 % quantile of the flow with errors.
    pub full_high: Vec<f64>,
}

/// A flow's predictions and one replicate of the recording.
type Pair = (Vec<f64>, Vec<f64>);

/// Numbers kept at the most: what the bands are quantiles of.
const MOST_NUMBERS: usize = 20_000_000;

/// How many draws a band over `length` values is made of.
fn draws_for(length: usize) -> usize {
    (MOST_NUMBERS / length.max(1)).clamp(50, 2000)
}

/// The posterior predictive bands of the model's first series, whose times
/// \[s\] are given.
///
/// # Errors
/// A model that fails, or draws without a single flow.
pub fn posterior_predictive(
    posterior: &Posterior<'_>,
    draws: &Draws,
    times: &[f64],
    seed: Seed,
) -> Result<Bands> {
    let all = predictive_of_all(posterior, draws, &[times], seed)?;
    all.into_iter()
        .next()
        .ok_or_else(|| Error::inference("the model predicts no series"))
}

/// The same of the model's first recording, with figures of it beside those
/// of its replicates.
///
/// # Errors
/// As [`posterior_predictive`].
pub fn posterior_checked(
    posterior: &Posterior<'_>,
    draws: &Draws,
    series: &Series,
    seed: Seed,
) -> Result<(Bands, Vec<Statistic>)> {
    let (times, values) = (series.times(), series.values());
    let sets = replicates(posterior, draws, times.len(), seed)?;
    let pairs: Vec<&Pair> =
        sets.iter().flatten().filter_map(|set| set.first()).collect();
    let made = pairs.iter().map(|(_, made)| made.as_slice());
    let unit = series.quantity().unit();
    let figures = statistics::statistics(times, values, unit, &made);
    Ok((bands(&pairs, times)?, figures))
}

/// The same of each of the model's series, whose times \[s\] are given.
///
/// # Errors
/// As [`posterior_predictive`].
pub fn predictive_of_all(
    posterior: &Posterior<'_>,
    draws: &Draws,
    times: &[&[f64]],
    seed: Seed,
) -> Result<Vec<Bands>> {
    let length = times.iter().map(|t| t.len()).sum();
    let sets = replicates(posterior, draws, length, seed)?;
    let of = |k: usize| -> Vec<&Pair> {
        sets.iter().flatten().filter_map(|s| s.get(k)).collect()
    };
    let series = times.iter().enumerate();
    series.map(|(k, times)| bands(&of(k), times)).collect()
}

/// The same before any recording is seen: `count` draws from the prior.
///
/// # Errors
/// An improper prior, or a model that fails.
pub fn prior_predictive(
    posterior: &Posterior<'_>,
    count: usize,
    times: &[f64],
    seed: Seed,
) -> Result<Bands> {
    posterior.require_proper("a prior predictive band")?;
    let count = count.min(draws_for(times.len()));
    let pairs = parallel::try_map(0..count as u64, |i| {
        let mut rng = seed.child(i).rng();
        let all = replicate(posterior, Point::Prior(&mut rng), seed.child(i))?;
        Ok(all.and_then(|all| all.into_iter().next()))
    })?;
    bands(&pairs.iter().flatten().collect::<Vec<_>>(), times)
}

/// A replicate of each recording, all together of `length` values, at some of
/// the draws; `None` where the model rejects one.
fn replicates(
    posterior: &Posterior<'_>,
    draws: &Draws,
    length: usize,
    seed: Seed,
) -> Result<Vec<Option<Vec<Pair>>>> {
    let rows = draws.thinned(draws_for(length));
    parallel::try_map((0..).zip(rows), |(i, row)| {
        replicate(posterior, Point::Natural(row), seed.child(i))
    })
}

/// The flow at a point and one replicate of each recording; `None` where the
/// model rejects the point.
fn replicate(
    posterior: &Posterior<'_>,
    point: Point<'_>,
    seed: Seed,
) -> Result<Option<Vec<Pair>>> {
    let mut rng = seed.child(1).rng();
    let mut heard =
        Predicted { flows: Vec::new(), replicates: Replicates::new(&mut rng) };
    let density = posterior.hear(point, &mut heard)?;
    let Predicted { flows, replicates } = heard;
    let pairs = || flows.into_iter().zip(replicates.series).collect();
    Ok(density.rejected.is_none().then(pairs))
}

/// Hears what a model predicts for each series, and draws a replicate of it.
struct Predicted<'a> {
    flows: Vec<Vec<f64>>,
    replicates: Replicates<'a>,
}

impl Listener<Plain> for Predicted<'_> {
    fn series(
        &mut self,
        series: &Series,
        residuals: &[Real<Plain>],
        noise: &dyn Noise<Plain>,
    ) -> Outcome {
        let values = series.values().iter();
        let flow = values.zip(residuals).map(|(v, r)| v - r.value());
        self.flows.push(flow.collect());
        self.replicates.series(series, residuals, noise)
    }

    fn element(
        &mut self,
        value: f64,
        log_density: Real<Plain>,
        distribution: &dyn Distribution<Plain>,
    ) {
        self.replicates.element(value, log_density, distribution);
    }
}

fn bands(pairs: &[&Pair], times: &[f64]) -> Result<Bands> {
    if pairs.is_empty() {
        return Err(Error::inference("no draw has a flow to predict with"));
    }
    if let Some((flow, _)) = pairs.iter().find(|(f, _)| f.len() != times.len())
    {
        return Err(Error::input(format!(
            "{} times of a series of {} values; expected the times at which \
             the model is compared with it",
            times.len(),
            flow.len()
        )));
    }
    let mut result = Bands { times: times.to_vec(), ..Bands::default() };
    let mut flow = vec![0.0; pairs.len()];
    let mut full = flow.clone();
    for i in 0..times.len() {
        for (k, (f, r)) in pairs.iter().enumerate() {
            (flow[k], full[k]) = (f[i], r[i]);
        }
        flow.sort_by(f64::total_cmp);
        full.sort_by(f64::total_cmp);
        result.median.push(quantile(&flow, 0.5));
        result.flow_low.push(quantile(&flow, 0.05));
        result.flow_high.push(quantile(&flow, 0.95));
        result.full_low.push(quantile(&full, 0.05));
        result.full_high.push(quantile(&full, 0.95));
    }
    Ok(result)
}

impl Bands {
    /// The share of the values inside the band with errors.
    pub fn coverage(&self, values: &[f64]) -> f64 {
        let band = self.full_low.iter().zip(&self.full_high);
        let inside = values
            .iter()
            .zip(band)
            .filter(|(v, (low, high))| (*low..=*high).contains(v))
            .count();
        inside as f64 / values.len() as f64
    }

    /// The root mean square of values minus median flow.
    pub fn rmse(&self, values: &[f64]) -> f64 {
        rmse(values, &self.median)
    }
}

/// The root mean square of values minus predictions.
pub(crate) fn rmse(values: &[f64], predicted: &[f64]) -> f64 {
    let squares = values.iter().zip(predicted).map(|(v, p)| (v - p).powi(2));
    (squares.sum::<f64>() / values.len() as f64).sqrt()
}

/// What a model might have shown: its series, and the values that it scores
/// one by one (`v ~ Normal(..)`). It reads as the list of its series.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Synthetic {
    /// Its series, in the order scored.
    pub series: Vec<Series>,
    /// Its single values, in the order scored.
    pub elements: Vec<f64>,
}

impl std::ops::Deref for Synthetic {
    type Target = [Series];
    fn deref(&self) -> &[Series] {
        &self.series
    }
}

impl IntoIterator for Synthetic {
    type Item = Series;
    type IntoIter = std::vec::IntoIter<Series>;
    fn into_iter(self) -> Self::IntoIter {
        self.series.into_iter()
    }
}

/// Synthetic recordings: what each series of the model, and each value that
/// it scores by itself, might have shown if its parameters had the values
/// `truth`. The series say when; the values that they hold are not looked at.
///
/// ```
/// use couloir::prelude::*;
/// model! {
///     struct Dry { event: Event }
///     friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
///     errors ~ Iid { sigma2: InverseGamma(3.0, 1.0) };
///     likelihood {
///         let flow = event.slide(&friction)?;
///         event.velocity ~ flow.velocity() + errors;
///     }
/// }
/// let plan = Event::on(Track::incline(35.0, 500.0)?)
///     .velocity(Series::velocity(vec![1.0, 2.0, 3.0], vec![0.0; 3])?)
///     .build()?;
/// let seen = simulate(&Dry::new(plan.clone()), &[0.3, 0.01], Seed::new(1))?;
/// let event = plan.with_recording(seen[0].clone())?;
/// assert!((event.velocity.values()[2] - 9.65).abs() < 0.5);
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// Values scored by themselves come in the order in which they are:
///
/// ```
/// use couloir::prelude::*;
/// model! {
///     struct Runouts { seen: Vec<f64> }
///     mean ~ Normal(300.0, 50.0);
///     likelihood { seen ~ Normal(mean, 5.0); }
/// }
/// let plan = Runouts::new(vec![0.0; 3]);
/// let made = simulate(&plan, &[250.0], Seed::new(1))?;
/// assert_eq!(made.elements.len(), 3);
/// assert!(made.elements.iter().all(|x| (x - 250.0).abs() < 25.0));
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// Values with which there is no flow or noise, or a distribution that has no
/// draws.
pub fn simulate(
    model: &dyn Model,
    truth: &[f64],
    seed: Seed,
) -> Result<Synthetic> {
    let mut rng = seed.rng();
    let mut made = Made { rng: &mut rng, made: Synthetic::default() };
    let density = model.evaluate(Point::Natural(truth), Some(&mut made))?;
    if let Some(reason) = density.rejected {
        return Err(Error::input(format!(
            "nothing can be simulated with the values {truth:?}: {reason}"
        )));
    }
    let elements = &made.made.elements;
    match elements.iter().position(|x| x.is_nan()) {
        None => Ok(made.made),
        Some(i) => Err(Error::input(format!(
            "value {} of the {} that the model scores one by one has no \
             draws: its distribution is improper, or its arguments are \
             impossible with the values {truth:?}",
            i + 1,
            elements.len()
        ))),
    }
}

/// Collects synthetic recordings.
struct Made<'a> {
    rng: &'a mut Rng,
    made: Synthetic,
}

impl Listener<Plain> for Made<'_> {
    fn series(
        &mut self,
        series: &Series,
        residuals: &[Real<Plain>],
        noise: &dyn Noise<Plain>,
    ) -> Outcome {
        let mut one = Replicates::new(self.rng);
        one.series(series, residuals, noise)?;
        let values = one.series.into_iter().flatten().collect();
        self.made.series.push(series.with_values(values)?);
        Ok(())
    }

    fn element(
        &mut self,
        value: f64,
        log_density: Real<Plain>,
        distribution: &dyn Distribution<Plain>,
    ) {
        let mut one = Replicates::new(self.rng);
        one.element(value, log_density, distribution);
        self.made.elements.append(&mut one.elements);
    }

    fn scores(&self) -> bool {
        false
    }

    fn made(&self) -> Option<f64> {
        self.made.elements.last().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::{Block, Field};
    use crate::error::Stop;
    use crate::infer::{Effort, MetropolisHastings, Quiet, infer};
    use crate::model::{Label, Number, Program, Run, Weights};
    use crate::noise::{Conditional, Grid, Iid};
    use crate::observe::Event;
    use crate::physics::Track;
    use crate::physics::friction::Coulomb;
    use crate::prior::{Exponential, Normal};
    use crate::scalar::Kind;

    /// Errors of the standard deviation `share` times the speed.
    struct Relative<S> {
        share: S,
    }

    impl<S: Copy> Block<S> for Relative<S> {
        const NAME: &'static str = "relative";
        const FIELDS: &'static [Field] =
            &[Field::new("share", "1", "Exponential(0.1)")];

        fn from_values(values: &[S]) -> Self {
            Self { share: values[0] }
        }
    }

    impl<K: Kind> Noise<K> for Relative<Real<K>> {
        fn check(&self, _: &Grid) -> Result<()> {
            Ok(())
        }

        fn walk(
            &self,
            at: &Grid,
            residuals: &[Real<K>],
            visit: &mut dyn FnMut(Conditional<K>),
        ) -> Result<(), Stop> {
            let sigma2 = self.share * self.share;
            Iid { sigma2 }.walk(at, residuals, visit)
        }

        fn draw(&self, at: &Grid, rng: &mut Rng) -> Result<Vec<f64>, Stop> {
            let sigma2 = self.share * self.share;
            Iid { sigma2 }.draw(at, rng)
        }

        fn width(&self, predicted: Real<K>) -> Option<Real<K>> {
            Some(predicted.abs())
        }
    }

    struct Scattered(Event);

    impl Program for Scattered {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let mu =
                run.scalar(Label::new("mu", "1"), Normal::new(0.3, 0.1))?;
            let share = Label::new("share", "1");
            let share = run.scalar(share, Exponential::new(0.1))?;
            let law = run.declare(Coulomb { mu });
            let flow = self.0.slide(&law)?;
            let errors = run.declare(Relative { share });
            run.observe(&self.0.velocity, flow.velocity(), &errors)
        }
    }

    const TRUTH: [f64; 2] = [0.3, 0.1];

    fn event() -> Event {
        let times: Vec<f64> = (1..=60).map(|i| 0.25 * f64::from(i)).collect();
        let blank = vec![0.0; times.len()];
        let track = Track::incline(35.0, 2000.0).unwrap();
        let series = Series::velocity(times, blank).unwrap();
        let plan = Event::on(track).velocity(series).build().unwrap();
        let model = Scattered(plan.clone());
        let made = simulate(&model, &TRUTH, Seed::new(3)).unwrap();
        plan.with_recording(made[0].clone()).unwrap()
    }

    #[test]
    fn scatter_that_grows_with_the_speed_is_scored_as_its_density_says() {
        let event = event();
        let model = Scattered(event.clone());
        let [mu, share] = TRUTH;
        // dv/dt = g (sin - mu cos) on an incline.
        let (sin, cos) = 35_f64.to_radians().sin_cos();
        let expected: f64 = event
            .velocity
            .times()
            .iter()
            .zip(event.velocity.values())
            .map(|(t, seen)| {
                let speed = 9.81 * (sin - mu * cos) * t;
                let law = Normal::<Plain>::new(speed, share * speed);
                law.log_density(Real::new(*seen)).value()
            })
            .sum();
        let at = Point::Natural(&TRUTH);
        let density = model.evaluate(at, None).unwrap();
        assert!((density.log_likelihood - expected).abs() < 1e-6);
        let posterior = Posterior::new(&model).unwrap();
        let z = posterior.line(&TRUTH).unwrap();
        let mut slope = [0.0; 2];
        posterior.gradient(&z, Weights::LINE, &mut slope).unwrap();
        let on = |h: f64| {
            let near = [z[0] + h, z[1]];
            posterior.density(Point::Line(&near)).unwrap().on_line()
        };
        let difference = (on(1e-6) - on(-1e-6)) / 2e-6;
        assert!((slope[0] - difference).abs() < 1e-3 * slope[0].abs() + 1e-3);
    }

    #[test]
    fn its_bands_widen_with_the_speed() {
        let event = event();
        let model = Scattered(event.clone());
        let posterior = Posterior::new(&model).unwrap();
        let effort = Effort { chains: 2, draws: 4000, warmup: 2000 };
        let walk = MetropolisHastings::adaptive(&effort);
        let found = infer(&walk, &posterior, Seed::new(1), &Quiet).unwrap();
        let draws = found.draws.unwrap();
        // 60 values tell the share to a tenth.
        assert!((draws.mean()[1] - TRUTH[1]).abs() < 0.04);
        let times = event.velocity.times();
        let bands =
            posterior_predictive(&posterior, &draws, times, Seed::new(2))
                .unwrap();
        let width = |i: usize| bands.full_high[i] - bands.full_low[i];
        let ratio = width(59) / width(9);
        // The speed is 6 times as high; 2000 draws tell a band to 5 %.
        assert!((4.8..7.2).contains(&ratio), "{ratio}");
        let inside = bands.coverage(event.velocity.values());
        assert!((0.78..=1.0).contains(&inside), "{inside}");
    }
}
