//! What the values of a filter tell of the parameters: of the place e/sqrt(S)
//! of a prediction error e of variance S, and of its size ln(S)/2.

use super::innovation::Innovation;
use crate::noise::student::Known;
use crate::scalar::{Kind, Real};

/// What values of one variance tell of the parameters.
pub(super) struct Scale<K: Kind> {
    /// What is known of tails, where there are any.
    known: Option<Known<K>>,
    inverse_width: f64,
    /// What each tells of its size.
    size: Real<K>,
}

impl<K: Kind> Scale<K> {
    /// Of values before the first.
    pub(super) fn new(nu: Option<Real<K>>) -> Self {
        let size = Real::new(0.0);
        let known = nu.map(Known::of);
        Self { known, inverse_width: 1.0, size }
    }

    /// From here on values have this variance.
    pub(super) fn change(&mut self, variance: &Real<K>) {
        self.inverse_width = variance.value().sqrt().recip();
        let log_width = 0.5 * variance.ln();
        let known = self.known.as_ref();
        self.size = known.map_or(log_width, |known| known.size(log_width));
    }

    /// What a value tells of its place and its size.
    #[inline(always)]
    pub(super) fn inform(
        &self,
        next: &Innovation<'_, K>,
        hear: &mut dyn FnMut(&Real<K>),
    ) {
        let (error, by) = (&next.error, self.inverse_width);
        let per_size = match &self.known {
            None => {
                // The derivatives of e/sqrt(S).
                let bend = -0.5 * error.value() * by * by * by;
                let terms = [(error, by), (next.variance, bend)];
                hear(&Real::combine(error.value() * by, terms));
                1.0
            }
            Some(known) => {
                hear(&known.place(error, by));
                known.size
            }
        };
        match &next.log_size {
            None => hear(&self.size),
            Some(log_size) => hear(&(self.size + *log_size * per_size)),
        }
    }

    /// What so many values tell of the tails, where there are any.
    pub(super) fn inform_of_shape(
        &self,
        count: usize,
        hear: &mut dyn FnMut(&Real<K>),
    ) {
        if let Some(known) = &self.known {
            hear(&known.shape(count));
        }
    }
}
