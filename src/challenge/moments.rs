//! A motion that was: where the mass was when, and how fast.

/// Where and how the mass starts at t = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Start {
    /// Distance along the slope \[m\].
    pub(super) place: f64,
    /// Speed \[m/s\].
    pub(super) speed: f64,
}

/// A moment of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    /// Distance along the slope \[m\].
    pub(super) s: f64,
    /// Speed \[m/s\].
    pub(super) u: f64,
    /// Time \[s\].
    pub(super) t: f64,
    /// A place between the same two borders as `s`: which side of an edge a
    /// moment is on must not depend on rounding.
    pub(super) place: f64,
    /// A time between the same two borders as `t`.
    pub(super) time: f64,
}

/// What was the motion.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Run {
    pub(super) t: Vec<f64>,
    pub(super) s: Vec<f64>,
    pub(super) u: Vec<f64>,
    /// When the mass came to rest \[s\], if it did.
    pub(super) rest: Option<f64>,
    /// The least friction coefficient that acted.
    pub(super) least_mu: f64,
}

impl Run {
    /// The index of the step that holds a time, and how far in it that is.
    fn find(&self, t: f64) -> (usize, f64) {
        let after = self.t.partition_point(|x| *x <= t);
        let i = after.clamp(1, self.t.len() - 1) - 1;
        let span = self.t[i + 1] - self.t[i];
        (i, ((t - self.t[i]) / span).clamp(0.0, 1.0))
    }

    /// The speed at a time \[m/s\]; 0 before the release and after the stop.
    pub(super) fn speed(&self, t: f64) -> f64 {
        if t < 0.0 || self.rest.is_some_and(|rest| t >= rest) {
            return 0.0;
        }
        let (i, part) = self.find(t);
        self.u[i] + part * (self.u[i + 1] - self.u[i])
    }

    /// The place at a time \[m\].
    pub(super) fn place(&self, t: f64) -> f64 {
        let (i, part) = self.find(t);
        let span = self.t[i + 1] - self.t[i];
        // The speed is taken as linear within a step.
        let bent = 0.5 * (self.u[i + 1] - self.u[i]) * part * part;
        self.s[i] + span * (self.u[i] * part + bent)
    }

    /// When the mass reaches a place \[s\], if it does.
    pub(super) fn when(&self, place: f64) -> Option<f64> {
        let i = self.s.partition_point(|s| *s < place);
        if i == 0 {
            return Some(0.0);
        }
        let (a, b) = (self.s[i - 1], self.s.get(i)?);
        let part = (place - a) / (b - a);
        Some(self.t[i - 1] + part * (self.t[i] - self.t[i - 1]))
    }
}
