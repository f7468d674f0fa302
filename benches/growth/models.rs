//! Models of any size: what is known of them is how many there are of each.

use couloir::model::Together;
use couloir::prelude::*;
use couloir::prior::{Gamma, HalfNormal, InverseGamma, Normal, Uniform};

use crate::reference;

/// Normal values about normal centres: hardly any arithmetic beside the
/// priors'.
pub(crate) struct Hierarchy {
    data: Vec<f64>,
}

impl Hierarchy {
    /// Of `parameters`, two at least.
    pub(crate) fn new(parameters: usize) -> Self {
        let values = 0..parameters - 2;
        Self { data: values.map(|i| (i as f64).sin()).collect() }
    }
}

impl Program for Hierarchy {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mean =
            run.scalar(Label::new("mean", "1"), Normal::new(0.0, 5.0))?;
        let spread =
            run.scalar(Label::new("spread", "1"), HalfNormal::new(2.0))?;
        for (i, y) in self.data.iter().enumerate() {
            let label = Label::new("centre", "1").at(i);
            let centre = run.scalar(label, Normal::new(mean, spread))?;
            run.observe_each(y, Normal::new(centre, 1.0))?;
        }
        Ok(())
    }
}

/// A friction that is another one on each section of the track.
struct BySection<'a, K: Kind> {
    mu: &'a [Real<K>],
    xi: Real<K>,
    length: f64,
}

impl<K: Kind> Friction<K> for BySection<'_, K> {
    fn varies(&self) -> Varies {
        Varies::WithPlace
    }

    fn rate(&self, at: &Site, speed: Real<K>) -> Rate<K> {
        let share = at.distance / self.length * self.mu.len() as f64;
        let section = (share as usize).min(self.mu.len() - 1);
        Voellmy { mu: self.mu[section], xi: self.xi }.rate(at, speed)
    }
}

/// One avalanche over a track of many sections.
pub(crate) struct Sections {
    event: Event,
    sections: usize,
}

impl Sections {
    pub(crate) fn new(parameters: usize) -> Self {
        Self { event: reference::event(), sections: parameters - 1 }
    }
}

impl Program for Sections {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let xi =
            run.scalar(Label::new("xi", "m/s2"), Gamma::new(2.5, 400.0))?;
        let mu = Label::new("mu", "1");
        let mu = run.vector(mu, self.sections, Gamma::new(9.0, 0.03))?;
        let length = self.event.track().length();
        let law = BySection { mu: &mu, xi, length };
        let law = run.declare_as("sections", law);
        let errors = run.declare(Iid { sigma2: Real::new(9.0) });
        let flow = self.event.slide(&law)?;
        run.observe(&self.event.velocity, flow.velocity(), &errors)
    }
}

/// One avalanche on its own.
pub(crate) struct Avalanche(Event);

impl Program for Avalanche {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mu = run.scalar(Label::new("mu", "1"), Gamma::new(9.0, 0.03))?;
        let xi =
            run.scalar(Label::new("xi", "m/s2"), Gamma::new(2.5, 400.0))?;
        let sigma2 = Label::new("sigma2", "m2/s2");
        let sigma2 = run.scalar(sigma2, InverseGamma::new(3.0, 20.0))?;
        let friction = run.declare(Voellmy { mu, xi });
        let errors = run.declare(Iid { sigma2 });
        let flow = self.0.slide(&friction)?;
        run.observe(&self.0.velocity, flow.velocity(), &errors)
    }
}

/// Several avalanches that have nothing in common.
pub(crate) fn avalanches(
    events: usize,
) -> Result<Together<(Avalanche, Event)>> {
    let event = reference::event();
    let member = |_| (Avalanche(event.clone()), event.clone());
    Together::new((0..events).map(member).collect())
}

/// Speeds recorded so often within 50 s; with `gaps`, every tenth is missing.
fn recorded(values: usize, gaps: bool) -> Result<Series> {
    let at = |i: usize| (i + 1) as f64 * 50.0 / values as f64;
    let there = (0..values).filter(|i| !gaps || i % 10 != 5);
    let times: Vec<f64> = there.map(at).collect();
    let count = times.len();
    Series::velocity(times, vec![20.0; count])
}

/// A concave slope of 2 km, from 40 degrees to 7, of so many pieces.
fn slope(pieces: usize) -> Result<Track> {
    let along = |i: usize| i as f64 * 2000.0 / pieces as f64;
    let x: Vec<f64> = (0..=pieces).map(along).collect();
    let height = |x: &f64| 0.00018 * (2000.0 - x).powi(2) - 0.12 * x;
    Track::from_points(&x, &x.iter().map(height).collect::<Vec<_>>())
}

/// One avalanche over so many pieces, recorded so often.
pub(crate) fn long_slope(pieces: usize, values: usize) -> Result<Avalanche> {
    let series = recorded(values, false)?;
    Ok(Avalanche(Event::on(slope(pieces)?).velocity(series).build()?))
}

/// The same with errors of second order and values missing.
pub(crate) struct Gappy(Event);

impl Gappy {
    pub(crate) fn new(values: usize) -> Result<Self> {
        let series = recorded(values, true)?;
        Ok(Self(Event::on(slope(300)?).velocity(series).build()?))
    }
}

impl Program for Gappy {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let mu = run.scalar(Label::new("mu", "1"), Gamma::new(9.0, 0.03))?;
        let phi = Label::new("phi", "1");
        let phi = run.vector(phi, 2, Uniform::new(-1.0, 1.0))?;
        let friction = run.declare(Coulomb { mu });
        let errors = run.declare(Ar { phi, sigma2: Real::new(9.0) });
        let flow = self.0.slide(&friction)?;
        run.observe(&self.0.velocity, flow.velocity(), &errors)
    }
}
