//! A program, and one run of it at a point.

use super::listener::Listener;
use super::number::Number;
use super::run::{Run, SAME_PARAMETERS, Source};
use crate::error::{Error, Outcome, Result, Stop};
use crate::scalar::Real;
use crate::seed::Rng;

/// A model's body: declares parameters, scores data.
///
/// Written by the `model!` macro, or by hand as in the example
/// `without_the_macro`.
pub trait Program: Sync {
    /// Runs the body.
    ///
    /// # Errors
    /// [`Stop::Reject`] gives the point density zero, [`Stop::Fail`] ends
    /// the inference.
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome;

    /// How many events the body passes to [`Run::of_event`], where inference
    /// may take them apart: what they have in common is declared before the
    /// first of them, and all data are scored within them.
    fn events(&self) -> usize {
        1
    }
}

/// A point at which a model is evaluated.
#[derive(Debug)]
pub enum Point<'a> {
    /// Places on the real line, one for each parameter.
    Line(&'a [f64]),
    /// The parameters' values as named.
    Natural(&'a [f64]),
    /// A draw from the prior.
    Prior(&'a mut Rng),
    /// The middle of each parameter's support, to learn what there is.
    Middle,
}

/// The parts of a log density at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Density {
    /// ln p(parameters), in the parameters as named.
    pub log_prior: f64,
    /// ln |dx/dz| of the way to the real line; 0 at a point as named.
    pub log_jacobian: f64,
    /// ln p(data | parameters).
    pub log_likelihood: f64,
    /// How many motions were solved for it.
    pub slides: u64,
    /// Why the density is zero, where the body rejected the point.
    pub rejected: Option<&'static str>,
}

impl Density {
    /// Prior times likelihood in the parameters as named; minus infinity
    /// where the model rejects them.
    pub fn natural(&self) -> f64 {
        if self.rejected.is_some() {
            return f64::NEG_INFINITY;
        }
        self.log_prior + self.log_likelihood
    }

    /// The same, as a density on the real line.
    pub fn on_line(&self) -> f64 {
        self.natural() + self.log_jacobian
    }

    pub(super) const ONE: Self = Self {
        log_prior: 0.0,
        log_jacobian: 0.0,
        log_likelihood: 0.0,
        slides: 0,
        rejected: None,
    };

    /// Multiplies by a power of another density; zero where either was
    /// rejected.
    pub(super) fn multiply(&mut self, other: &Self, power: f64) {
        self.log_prior += power * other.log_prior;
        self.log_jacobian += power * other.log_jacobian;
        self.log_likelihood += power * other.log_likelihood;
        self.slides += other.slides;
        self.rejected = self.rejected.or(other.rejected);
    }

    fn zero(reason: &'static str, slides: u64) -> Self {
        Self {
            log_prior: f64::NEG_INFINITY,
            log_jacobian: 0.0,
            log_likelihood: f64::NEG_INFINITY,
            slides,
            rejected: Some(reason),
        }
    }
}

/// How the parts of a density are weighted in a gradient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// Weight of the log prior.
    pub prior: f64,
    /// Weight of the log Jacobian.
    pub jacobian: f64,
    /// Weight of the log likelihood; between 0 and 1 when tempered.
    pub likelihood: f64,
}

impl Weights {
    /// The posterior in the parameters as named.
    pub const NATURAL: Self =
        Self { prior: 1.0, jacobian: 0.0, likelihood: 1.0 };
    /// The posterior as a density on the real line.
    pub const LINE: Self = Self { prior: 1.0, jacobian: 1.0, likelihood: 1.0 };

    /// The weighted log density.
    pub fn of(&self, density: &Density) -> f64 {
        self.prior * density.log_prior
            + self.jacobian * density.log_jacobian
            + self.likelihood * density.log_likelihood
    }
}

type Parts<K> = (Density, Real<K>, Real<K>, Real<K>);

/// One run of the body, its failures sorted into density zero and the rest.
pub(super) fn run<K: Number, P: Program>(
    program: &P,
    source: Source<'_>,
    expected: Option<usize>,
    listener: Option<&mut dyn Listener<K>>,
) -> Result<Parts<K>> {
    K::with_context(|context| {
        let before = context.slides();
        let listener = listener.map(|l| l as &mut dyn Listener<K>);
        let mut run = Run::new(context, source, listener);
        let outcome = program.run(&mut run);
        let slides = context.slides() - before;
        let parts = (run.log_prior, run.log_jacobian, run.log_likelihood);
        let zero = |reason| {
            let none = Real::new(0.0);
            (Density::zero(reason, slides), none, none, none)
        };
        match outcome {
            Err(Stop::Fail(error)) => return Err(error),
            Err(Stop::Reject(reason)) => return Ok(zero(reason)),
            Ok(()) => {}
        }
        if expected.is_some_and(|n| n != run.position()) {
            return Err(Error::input(format!(
                "there are values for {} parameters, and the model asked for \
                 {}; {SAME_PARAMETERS}",
                expected.unwrap_or(0),
                run.position()
            )));
        }
        let density = Density {
            log_prior: parts.0.value(),
            log_jacobian: parts.1.value(),
            log_likelihood: parts.2.value(),
            slides,
            rejected: None,
        };
        if density.on_line().is_nan() {
            return Ok(zero("the density is not a number"));
        }
        Ok((density, parts.0, parts.1, parts.2))
    })
}
