//! A log density in its parts, and how these are weighted.

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

    pub(super) fn zero(reason: &'static str, slides: u64) -> Self {
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
