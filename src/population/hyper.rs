//! The posterior of a population's own parameters.

use super::member::{Member, Weighed};
use crate::error::{Error, Outcome, Result};
use crate::model::{Label, Number, Program, Run};
use crate::prior::{HalfNormal, Normal};

/// The most parameters that a population is of.
pub(super) const MOST: usize = 8;

/// 95 % less 5 % of a normal distribution, in standard deviations.
const NINETY: f64 = 2.0 * 1.644_853_626_951_472_7;

/// A parameter of the population.
#[derive(Debug, Clone)]
pub(super) struct Scale {
    pub(super) name: String,
    pub(super) unit: String,
    /// Whether the population is normal in its logarithm.
    pub(super) in_log: bool,
    /// The middle and the standard deviation of the members' priors.
    centre: f64,
    width: f64,
    /// What its mean and its spread are called.
    labels: [String; 2],
}

/// A population with its members.
#[derive(Debug, Clone)]
pub(super) struct Hyper {
    pub(super) scales: Vec<Scale>,
    pub(super) members: Vec<Weighed>,
}

/// Means and spreads, by parameter.
pub(super) type Law = ([f64; MOST], [f64; MOST]);

impl Hyper {
    /// # Errors
    /// Members that do not go together, or cannot be weighed.
    pub(super) fn of(members: &[Member]) -> Result<Self> {
        let first = &members[0].draws;
        if first.dimension() > MOST {
            return Err(Error::input(format!(
                "a population of {} parameters; expected {MOST} at most",
                first.dimension()
            )));
        }
        for member in members {
            let names = member.draws.names();
            if names != first.names() || member.priors.len() != names.len() {
                return Err(Error::input(format!(
                    "its parameters are {}, those of {} are {}: expected \
                     events calibrated under the same law",
                    names.join(", "),
                    members[0].name,
                    first.names().join(", ")
                ))
                .within(&member.name));
            }
            member.check()?;
        }
        let scales: Vec<Scale> = (0..first.dimension())
            .map(|k| Scale::of(members, k))
            .collect::<Result<_>>()?;
        let in_log: Vec<bool> = scales.iter().map(|s| s.in_log).collect();
        let members = members.iter().map(|member| member.weighed(&in_log));
        let members = members.collect::<Result<_>>()?;
        Ok(Self { scales, members })
    }

    /// The population's law of a row of draws.
    pub(super) fn law(&self, row: &[f64]) -> Law {
        let mut law = ([0.0; MOST], [0.0; MOST]);
        for k in 0..self.scales.len() {
            (law.0[k], law.1[k]) = (row[2 * k], row[2 * k + 1]);
        }
        law
    }

    /// ln p(draw | law) / prior(draw), but for a constant.
    pub(super) fn log_weight(
        &self,
        member: &Weighed,
        draw: usize,
        (mean, spread): &Law,
    ) -> f64 {
        let dimension = self.scales.len();
        let places = &member.places[draw * dimension..][..dimension];
        let mut log = member.base[draw];
        for ((place, mean), spread) in places.iter().zip(mean).zip(spread) {
            let z = (place - mean) / spread;
            log -= 0.5 * z * z;
        }
        log
    }

    /// ln of a member's likelihood by some of its draws, and how many draws
    /// those are worth.
    pub(super) fn log_likelihood(
        &self,
        member: &Weighed,
        draws: impl Iterator<Item = usize> + Clone,
        law: &Law,
    ) -> (f64, f64) {
        let logs = draws.map(|draw| self.log_weight(member, draw, law));
        let most = logs.clone().fold(f64::NEG_INFINITY, f64::max);
        let (mut count, mut once, mut twice) = (0.0, 0.0, 0.0);
        for log in logs {
            let weight = (log - most).exp();
            count += 1.0;
            once += weight;
            twice += weight * weight;
        }
        let spreads: f64 =
            law.1[..self.scales.len()].iter().map(|s| s.ln()).sum();
        ((once / count).ln() + most - spreads, once * once / twice)
    }

    /// ln of all members' likelihood.
    fn log_of_all(&self, law: &Law) -> f64 {
        let each = self.members.iter();
        let of = |m: &Weighed| self.log_likelihood(m, 0..m.base.len(), law).0;
        each.map(of).sum()
    }

    /// The same, and its derivatives by means and spreads: moments of the
    /// weighted draws.
    fn with_slopes(&self, law: &Law) -> (f64, Law) {
        let dimension = self.scales.len();
        let spreads: f64 = law.1[..dimension].iter().map(|s| s.ln()).sum();
        let mut slopes = ([0.0; MOST], [0.0; MOST]);
        let mut sum = 0.0;
        for member in &self.members {
            let all = 0..member.base.len();
            let (log, _) = self.log_likelihood(member, all.clone(), law);
            sum += log;
            let share = log + spreads + (member.base.len() as f64).ln();
            for draw in all {
                let weight =
                    (self.log_weight(member, draw, law) - share).exp();
                let places = &member.places[draw * dimension..];
                for (k, place) in places.iter().take(dimension).enumerate() {
                    let z = (place - law.0[k]) / law.1[k];
                    slopes.0[k] += weight * z / law.1[k];
                    slopes.1[k] += weight * (z * z - 1.0) / law.1[k];
                }
            }
        }
        (sum, slopes)
    }
}

impl Scale {
    /// The parameter at a place, of all members.
    fn of(members: &[Member], k: usize) -> Result<Self> {
        let first = &members[0];
        let name = first.draws.names()[k].clone();
        let low = first.priors[k].quantile(0.0);
        let in_log = low.is_some_and(|low| low >= 0.0);
        let place = |x: f64| if in_log { x.ln() } else { x };
        let (mut centre, mut width) = (0.0, 0.0);
        for member in members {
            let of = |p: f64| member.priors[k].quantile(p).map(place);
            let [Some(low), Some(half), Some(high)] =
                [0.05, 0.5, 0.95].map(of)
            else {
                return Err(Error::input(format!(
                    "the prior of {name} has no quantiles; expected one such \
                     as Gamma or LogNormal"
                ))
                .within(&member.name));
            };
            centre += half / members.len() as f64;
            width += (high - low) / NINETY / members.len() as f64;
        }
        let labels = ["mean", "spread"].map(|of| format!("{of}_{name}"));
        let unit = first.draws.units()[k].clone();
        Ok(Self { name, unit, in_log, centre, width, labels })
    }

    /// The unit of mean and spread.
    fn own_unit(&self) -> &str {
        if self.in_log { "1" } else { &self.unit }
    }
}

impl Program for Hyper {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mut law = ([0.0; MOST], [0.0; MOST]);
        let mut unknown = Vec::with_capacity(self.scales.len());
        for (k, scale) in self.scales.iter().enumerate() {
            let unit = scale.own_unit();
            let [mean, spread] = &scale.labels;
            let prior = Normal::new(scale.centre, scale.width);
            let mean = run.scalar(Label::new(mean, unit), prior)?;
            let prior = HalfNormal::new(scale.width);
            let spread = run.scalar(Label::new(spread, unit), prior)?;
            (law.0[k], law.1[k]) = (mean.value(), spread.value());
            unknown.push((mean, spread));
        }
        if !K::DIFFERENTIATES {
            return run.increment(self.log_of_all(&law));
        }
        // The first derivatives are all that is asked for.
        let (log, slopes) = self.with_slopes(&law);
        run.increment(log)?;
        for (k, (mean, spread)) in unknown.into_iter().enumerate() {
            let mean = (mean - law.0[k]) * slopes.0[k];
            let spread = (spread - law.1[k]) * slopes.1[k];
            run.increment(mean + spread)?;
        }
        Ok(())
    }
}
