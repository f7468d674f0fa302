//! What a model keeps beside its parameters: a column of the draws for each
//! quantity that it works out or draws.

use super::label::Label;
use super::run::Run;
use crate::block::List;
use crate::error::Outcome;
use crate::prior::Distribution;
use crate::scalar::{Kind, Real};

/// What can be kept: a number, or a list of what can be kept.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be kept",
    label = "what is kept is a number, or a list of numbers"
)]
pub trait Keep {
    /// Hands each number to `say`, by its label.
    fn each(&self, label: Label<'_>, say: &mut dyn FnMut(Label<'_>, f64));
}

impl<K: Kind> Keep for Real<K> {
    fn each(&self, label: Label<'_>, say: &mut dyn FnMut(Label<'_>, f64)) {
        say(label, self.value());
    }
}

impl Keep for f64 {
    fn each(&self, label: Label<'_>, say: &mut dyn FnMut(Label<'_>, f64)) {
        say(label, *self);
    }
}

impl Keep for bool {
    fn each(&self, label: Label<'_>, say: &mut dyn FnMut(Label<'_>, f64)) {
        say(label, f64::from(u8::from(*self)));
    }
}

impl<V: Keep> Keep for [V] {
    fn each(&self, label: Label<'_>, say: &mut dyn FnMut(Label<'_>, f64)) {
        for (i, one) in self.iter().enumerate() {
            one.each(label.at(i), say);
        }
    }
}

macro_rules! as_slice {
    ($([$($bounds:tt)*] $list:ty),* $(,)?) => {$(
        impl<V: Keep, $($bounds)*> Keep for $list {
            fn each(
                &self,
                label: Label<'_>,
                say: &mut dyn FnMut(Label<'_>, f64),
            ) {
                self[..].each(label, say);
            }
        }
    )*};
}
as_slice!([] Vec<V>, [] List<V>, [const N: usize] [V; N]);

impl<V: Keep + ?Sized> Keep for &V {
    fn each(&self, label: Label<'_>, say: &mut dyn FnMut(Label<'_>, f64)) {
        (**self).each(label, say);
    }
}

impl<K: Kind> Run<'_, K> {
    /// Keeps a quantity that follows from the parameters as a column of the
    /// draws; of a list each value has a column of its own.
    pub fn keep(&mut self, label: Label<'_>, value: &(impl Keep + ?Sized)) {
        let event = self.event();
        let Some(listener) = self.listener() else { return };
        value.each(label, &mut |label, value| {
            listener.kept(&label.of_event(event), value);
        });
    }

    /// Keeps a draw from a distribution, new for each draw of the parameters.
    pub fn keep_draw(
        &mut self,
        label: Label<'_>,
        distribution: impl Distribution<K>,
    ) {
        let event = self.event();
        let Some(listener) = self.listener() else { return };
        if let Some(rng) = listener.chance() {
            let draw = distribution.draw(rng).unwrap_or(f64::NAN);
            listener.kept(&label.of_event(event), draw);
        }
    }

    /// Adds to the log likelihood what no distribution says, as one datum.
    ///
    /// # Errors
    /// [`Stop::Reject`](crate::error::Stop::Reject) where it is minus
    /// infinity.
    pub fn increment(&mut self, log_density: impl Into<Real<K>>) -> Outcome {
        self.score_one(log_density.into())
    }
}
