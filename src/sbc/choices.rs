//! Posterior probabilities of models held against the models that were true.
//!
//! Over replications whose model is drawn from the prior, the mean posterior
//! probability of a model is its prior probability; and of the cases that
//! give it a probability p, it is true in a share p (Schad, Nicenboim,
//! Bürkner, Betancourt, Vasishth 2022).

/// One recording whose model is known.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Choice {
    /// The index of the model that it was drawn from.
    pub truth: usize,
    /// The posterior probability of each model.
    pub probability: Vec<f64>,
    /// How many draws without a flow went before.
    pub redrawn: usize,
}

/// Recordings drawn from models, and how probable each model is given them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Choices {
    /// The models' names, that of the model as it is first.
    pub names: Vec<String>,
    /// Their prior probabilities.
    pub prior: Vec<f64>,
    /// The recordings.
    pub cases: Vec<Choice>,
}

/// A mean that has an expectation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Held {
    /// How many figures it is the mean of.
    pub count: usize,
    /// The mean.
    pub mean: f64,
    /// What it is if the probabilities are right.
    pub expected: f64,
    /// The standard error of their difference.
    pub se: f64,
}

impl Held {
    /// How many standard errors the mean is off.
    pub fn z(&self) -> f64 {
        (self.mean - self.expected) / self.se
    }
}

/// The limits of the bins that probabilities are counted in.
const LIMITS: [f64; 8] = [0.0, 0.02, 0.1, 0.3, 0.7, 0.9, 0.98, 1.0];

/// The least variance of the number of true cases in a bin with which that
/// number is nearly normal.
const NORMAL: f64 = 5.0;

impl Choices {
    /// The mean posterior probability of a model, which is to be its prior
    /// one.
    ///
    /// Where draws without a flow were drawn again, model and all, the prior
    /// is that of models given a flow: [`Choices::share`] holds even so.
    pub fn mean(&self, model: usize) -> Held {
        let all = || self.cases.iter().map(|case| case.probability[model]);
        let count = self.cases.len();
        let n = count as f64;
        let mean = all().sum::<f64>() / n;
        let square = all().map(|p| (p - mean).powi(2)).sum::<f64>();
        let se = (square / (n * (n - 1.0))).sqrt();
        Held { count, mean, expected: self.prior[model], se }
    }

    /// The share of cases in which a model is true, which is to be the mean
    /// of its probabilities: a case is true or not with variance p (1 - p).
    pub fn share(&self, model: usize) -> Held {
        held(self.cases.iter().map(|case| case.pair(model)))
    }

    /// The shares of true ones among all models with probabilities between
    /// two limits, bin by bin; empty bins are left out.
    ///
    /// The models of one case exclude each other, so that the standard errors
    /// are, if anything, too large.
    pub fn reliability(&self) -> Vec<(f64, f64, Held)> {
        let models = 0..self.names.len();
        let of = |case| models.clone().map(move |i| Choice::pair(case, i));
        let pairs: Vec<(f64, bool)> = self.cases.iter().flat_map(of).collect();
        LIMITS
            .windows(2)
            .map(|limits| {
                let (from, to) = (limits[0], limits[1]);
                let last = to == 1.0;
                let inside = |p: f64| p >= from && (p < to || last);
                let pairs = pairs.iter().copied();
                (from, to, held(pairs.filter(|(p, _)| inside(*p))))
            })
            .filter(|(_, _, held)| held.count > 0)
            .collect()
    }

    /// The mean log probability of the true model, which is to be the mean of
    /// sum p ln p: below it if the probabilities are too sure of themselves,
    /// above it if they are not sure enough.
    pub fn log_score(&self) -> Held {
        let count = self.cases.len();
        let n = count as f64;
        let (mut mean, mut expected, mut variance) = (0.0, 0.0, 0.0);
        for case in &self.cases {
            let probable = case.probability.iter().filter(|p| **p > 0.0);
            let first: f64 = probable.clone().map(|p| p * p.ln()).sum();
            let second: f64 = probable.map(|p| p * p.ln().powi(2)).sum();
            mean += case.probability[case.truth].ln() / n;
            expected += first / n;
            variance += second - first * first;
        }
        Held { count, mean, expected, se: variance.sqrt() / n }
    }

    /// The largest |z| of all these, bins with too few cases left out.
    pub fn largest_z(&self) -> f64 {
        let models = || 0..self.names.len();
        let bins = self.reliability().into_iter().map(|(_, _, held)| held);
        let sure =
            |held: &Held| (held.se * held.count as f64).powi(2) >= NORMAL;
        models()
            .map(|i| self.mean(i))
            .chain(models().map(|i| self.share(i)))
            .chain(bins.filter(sure))
            .chain([self.log_score()])
            .map(|held| held.z().abs())
            .fold(0.0, f64::max)
    }

    /// What they were if the evidence of one model were too large by a factor:
    /// an error planted to see whether it is caught.
    #[must_use]
    pub fn with_error(&self, model: usize, factor: f64) -> Self {
        let mut wrong = self.clone();
        for case in &mut wrong.cases {
            case.probability[model] *= factor;
            let sum: f64 = case.probability.iter().sum();
            case.probability.iter_mut().for_each(|p| *p /= sum);
        }
        wrong
    }
}

impl Choice {
    /// The probability of a model, and whether it is true.
    fn pair(&self, model: usize) -> (f64, bool) {
        (self.probability[model], self.truth == model)
    }
}

/// The share of true ones against the mean of their probabilities.
fn held(pairs: impl Iterator<Item = (f64, bool)>) -> Held {
    let (mut count, mut right, mut sum, mut variance) = (0, 0, 0.0, 0.0);
    for (p, is_true) in pairs {
        count += 1;
        right += usize::from(is_true);
        sum += p;
        variance += p * (1.0 - p);
    }
    let n = count as f64;
    let (mean, expected) = (f64::from(right as u32) / n, sum / n);
    Held { count, mean, expected, se: variance.sqrt() / n }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::seed::Seed;

    /// Means of unit normal values: zero, or drawn from Normal(0, 1). With
    /// n values of mean y the Bayes factor is known:
    /// (1 + n)^(-1/2) exp(n^2 y^2 / (2 (1 + n))).
    fn normal(count: usize, power: f64) -> Choices {
        const VALUES: f64 = 5.0;
        let mut rng = Seed::new(7).rng();
        let mut normal = move || -> (f64, f64) {
            (rng.random(), StandardNormal.sample(&mut rng))
        };
        let cases = (0..count).map(|_| {
            let (u, effect) = normal();
            let truth = usize::from(u < 0.5);
            let error = normal().1 / VALUES.sqrt();
            let y = truth as f64 * effect + error;
            let exponent = (VALUES * y).powi(2) / (2.0 * (1.0 + VALUES));
            let factor = exponent.exp() / (1.0 + VALUES).sqrt();
            let one = 1.0 / (1.0 + factor.powf(-power));
            let probability = vec![1.0 - one, one];
            Choice { truth, probability, redrawn: 0 }
        });
        Choices {
            names: vec!["none".into(), "some".into()],
            prior: vec![0.5, 0.5],
            cases: cases.collect(),
        }
    }

    /// 4: exceeded by one of the eleven figures in one of 1400 runs that are
    /// right.
    const LIMIT: f64 = 4.0;

    #[test]
    fn exact_probabilities_pass() {
        let z = normal(1000, 1.0).largest_z();
        assert!(z < LIMIT, "{z}");
    }

    #[test]
    fn an_evidence_off_by_a_factor_is_caught() {
        let right = normal(1000, 1.0);
        for (model, log_factor) in [(0, 0.7), (1, 0.7), (0, -0.7)] {
            let wrong = right.with_error(model, f64::exp(log_factor));
            let z = wrong.mean(model).z();
            assert!(z * log_factor > 0.0, "{model} {log_factor}: {z}");
            let z = wrong.largest_z();
            assert!(z > LIMIT, "{model} {log_factor}: {z}");
        }
    }

    #[test]
    fn probabilities_that_are_too_sure_are_caught() {
        let z = normal(1000, 1.8).log_score().z();
        assert!(z < -LIMIT, "{z}");
        let z = normal(1000, 0.4).log_score().z();
        assert!(z > LIMIT, "{z}");
    }

    #[test]
    fn a_true_model_without_probability_is_never_right() {
        let mut choices = normal(20, 1.0);
        let case = &mut choices.cases[0];
        case.probability = vec![0.0, 0.0];
        case.probability[1 - case.truth] = 1.0;
        assert_eq!(choices.largest_z(), f64::INFINITY);
    }
}
