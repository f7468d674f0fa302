//! What came out of a slide: the motion at the moments that were asked for.

use super::event::Event;
use super::moments::{Moments, MotionKind};
use super::series::{Quantity, Series};
use crate::declared::Declared;
use crate::error::{Error, Stop};
use crate::physics::{Friction, Rest, is_exact, sample_exact};
use crate::scalar::{Kind, Real};

/// The motion of one event under one friction law.
#[derive(Debug)]
pub struct Flow<'a, K: Kind, L> {
    event: &'a Event,
    friction: &'a Declared<'a, K, L>,
    moments: Moments<'a, K>,
}

impl Event {
    /// Solves the motion under a declared friction law.
    ///
    /// Only what a model declared can slide, so that no law escapes a change
    /// to the model. This does not compile:
    ///
    /// ```compile_fail,E0308
    /// use couloir::prelude::*;
    /// fn undeclared<K: Number>(event: &Event, mu: Real<K>) -> Outcome {
    ///     let law = Coulomb { mu };
    ///     event.slide(&law)?; // expected `&Declared<..>`
    ///     Ok(())
    /// }
    /// ```
    ///
    /// With `let law = run.declare(Coulomb { mu })` it does.
    ///
    /// # Errors
    /// [`Stop::Reject`] where the law has no flow with these values.
    #[inline]
    pub fn slide<'a, K: MotionKind, L: Friction<K>>(
        &'a self,
        friction: &'a Declared<'_, K, L>,
    ) -> Result<Flow<'a, K, L>, Stop> {
        let context = friction.context();
        context.count_slide();
        let speed_only = self.velocity.window() == 0.0
            && self.position.is_empty()
            && self.acceleration.is_empty();
        let mut moments = Moments::new(context, speed_only);
        let (path, law) = (self.path(), friction.block());
        let change = friction.change().filter(|change| change.moves());
        if change.is_none() && is_exact(&path, law) {
            let visit = |state| moments.push(state);
            let (release, samples) = (self.release(), self.samples());
            sample_exact(&path, law, release, samples, speed_only, visit)?;
        } else {
            K::moved(self, law, change, &mut moments)?;
        }
        Ok(Flow { event: self, friction, moments })
    }
}

impl<K: MotionKind, L: Friction<K>> Flow<'_, K, L> {
    /// The speed as the event's velocity series records it.
    pub fn velocity(&self) -> Recorded<'_, K> {
        self.recorded(Quantity::Velocity)
    }

    /// The distance since the release, as the position series records it.
    pub fn position(&self) -> Recorded<'_, K> {
        self.recorded(Quantity::Position)
    }

    /// The acceleration, as the acceleration series records it.
    pub fn acceleration(&self) -> Recorded<'_, K> {
        self.recorded(Quantity::Acceleration)
    }

    /// Whichever quantity.
    pub fn recorded(&self, quantity: Quantity) -> Recorded<'_, K> {
        Recorded {
            quantity,
            start: self.event.start(),
            samples: self.event.samples(),
            speed: &self.moments.speed,
            distance: &self.moments.distance,
            acceleration: &self.moments.acceleration,
        }
    }

    /// Where and when the mass comes to rest, beyond the recording if need
    /// be; `None` if it never does. Solves the motion once more.
    ///
    /// # Errors
    /// [`Stop::Reject`] where the law has no flow with these values.
    pub fn rest(&self) -> Result<Option<Rest<K>>, Stop> {
        self.friction.context().count_slide();
        let law = self.friction.block();
        K::rest(self.event, law, self.friction.change())
    }

    /// The distance along the slope from the release to where the mass comes
    /// to rest \[m\].
    ///
    /// # Errors
    /// [`Stop::Reject`] where it never does.
    pub fn runout(&self) -> Result<Real<K>, Stop> {
        let rest = self.rest()?.ok_or(Stop::Reject("the mass never stops"))?;
        Ok(rest.distance - self.event.start())
    }
}

/// A flow as a series records it.
#[derive(Debug, Clone, Copy)]
pub struct Recorded<'a, K: Kind> {
    quantity: Quantity,
    start: f64,
    samples: &'a [f64],
    speed: &'a [Real<K>],
    distance: &'a [Real<K>],
    acceleration: &'a [Real<K>],
}

/// What a model predicts for the values of a series.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a prediction",
    label = "left of `+` stands what is predicted: `flow.velocity()`, or a \
             list of numbers as long as the series"
)]
pub trait Prediction<K: Kind> {
    /// Hands the predicted value for each value of the series to `visit`.
    ///
    /// # Errors
    /// A prediction that does not belong to this series.
    fn predict(
        &self,
        series: &Series,
        visit: impl FnMut(Real<K>),
    ) -> Result<(), Stop>;
}

impl<K: Kind> Recorded<'_, K> {
    fn check(&self, series: &Series) -> Result<(), Stop> {
        if series.quantity() != self.quantity {
            return Err(Stop::Fail(Error::input(format!(
                "a {} series is compared with the flow's {}; expected the \
                 same quantity",
                series.quantity(),
                self.quantity
            ))));
        }
        let known = series.at.last().map(|&i| self.samples.get(i).copied());
        if known != Some(series.times().last().copied()) {
            return Err(Stop::Fail(Error::input(format!(
                "the event whose flow is compared has no such {} series; \
                 give it to the event when it is built",
                series.quantity()
            ))));
        }
        Ok(())
    }
}

impl<K: Kind> Prediction<K> for Recorded<'_, K> {
    #[inline]
    fn predict(
        &self,
        series: &Series,
        mut visit: impl FnMut(Real<K>),
    ) -> Result<(), Stop> {
        self.check(series)?;
        let spans = series.at.iter().zip(&series.since);
        match (self.quantity, series.window() > 0.0) {
            (Quantity::Velocity, false) => {
                series.at.iter().for_each(|&i| visit(self.speed[i]));
            }
            (Quantity::Velocity, true) => spans.for_each(|(&i, &j)| {
                visit(self.mean_rate(self.distance, self.speed, i, j));
            }),
            (Quantity::Position, _) => {
                for &i in &series.at {
                    visit(self.distance[i] - self.start);
                }
            }
            (Quantity::Acceleration, false) => {
                series.at.iter().for_each(|&i| visit(self.acceleration[i]));
            }
            (Quantity::Acceleration, true) => spans.for_each(|(&i, &j)| {
                visit(self.mean_rate(self.speed, self.acceleration, i, j));
            }),
        }
        Ok(())
    }
}

impl<K: Kind> Recorded<'_, K> {
    /// The mean rate of change of `x` between two samples; its rate where
    /// they are one.
    fn mean_rate(
        &self,
        x: &[Real<K>],
        rate: &[Real<K>],
        to: usize,
        from: usize,
    ) -> Real<K> {
        if to == from {
            return rate[to];
        }
        (x[to] - x[from]) / (self.samples[to] - self.samples[from])
    }
}

impl<K: Kind> Prediction<K> for [Real<K>] {
    fn predict(
        &self,
        series: &Series,
        visit: impl FnMut(Real<K>),
    ) -> Result<(), Stop> {
        if self.len() != series.len() {
            return Err(Stop::Fail(Error::input(format!(
                "{} predicted values for a {} series of {}",
                self.len(),
                series.quantity(),
                series.len()
            ))));
        }
        self.iter().copied().for_each(visit);
        Ok(())
    }
}

impl<K: Kind> Prediction<K> for Vec<Real<K>> {
    fn predict(
        &self,
        series: &Series,
        visit: impl FnMut(Real<K>),
    ) -> Result<(), Stop> {
        self.as_slice().predict(series, visit)
    }
}

impl<K: Kind, P: Prediction<K> + ?Sized> Prediction<K> for &P {
    fn predict(
        &self,
        series: &Series,
        visit: impl FnMut(Real<K>),
    ) -> Result<(), Stop> {
        (**self).predict(series, visit)
    }
}
