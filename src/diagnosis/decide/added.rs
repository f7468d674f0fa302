//! What was added to the model, at the draws of the corrected one.

use std::ops::Range;

use crate::draws::median;
use crate::mechanism::{Change, ChangeKind, Family, Mechanism, Reach};
use crate::physics::Site;
use crate::physics::forces::{Moment, Term};
use crate::scalar::{Plain, Real};

/// A mechanism with its posterior draws.
pub(crate) struct Added<'a> {
    mechanism: &'a dyn Mechanism,
    /// Its own values, draw by draw.
    values: Vec<Vec<f64>>,
    /// The law's dry friction, where it has one, draw by draw.
    mu: Vec<f64>,
}

/// Where a mass is, and how it moves there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passing {
    /// On the shared axis \[m\].
    pub(crate) place: f64,
    /// Since the release \[s\].
    pub(crate) time: f64,
    /// In m/s.
    pub(crate) speed: f64,
    /// The ground there.
    pub(crate) site: Site,
}

impl<'a> Added<'a> {
    /// From rows of draws, of which some columns are its own.
    pub(crate) fn new(
        mechanism: &'a dyn Mechanism,
        rows: &[&[f64]],
        own: Range<usize>,
        mu: Option<usize>,
    ) -> Self {
        let values = rows.iter().map(|row| row[own.clone()].to_vec());
        let mu = rows.iter().map(|row| mu.map_or(0.0, |mu| row[mu]));
        Self { mechanism, values: values.collect(), mu: mu.collect() }
    }

    /// Whether it is a force.
    pub(crate) fn is_force(&self) -> bool {
        self.mechanism.family() == Family::Physics
    }

    /// Where it is confined to, by the medians of its edges.
    ///
    /// Of two modes of opposite sign (more friction here, or less everywhere
    /// else) the more probable one counts: medians over both are nowhere.
    pub(crate) fn reach(&self) -> Option<Reach> {
        let up = self.values.iter().filter(|own| own[0] > 0.0).count();
        let sign = if 2 * up >= self.values.len() { 1.0 } else { -1.0 };
        let likelier = self.values.iter().filter(|own| own[0] * sign >= 0.0);
        let edges = likelier.filter_map(|own| self.mechanism.reach(own));
        let edges: Vec<Reach> = edges.collect();
        let middle = |of: fn(&Reach) -> f64| {
            median(&edges.iter().map(of).collect::<Vec<_>>())
        };
        edges.first().map(|one| Reach {
            axis: one.axis,
            from: middle(|r| r.from),
            to: middle(|r| r.to),
        })
    }

    /// The dry friction that it takes away where it takes most, draw by draw.
    pub(crate) fn friction_taken(&self) -> impl Iterator<Item = f64> {
        self.values.iter().map(|own| {
            let change = self.change(own);
            let terms = change.forces.terms.iter();
            terms.map(|term| (-term.rate.mu.value()).max(0.0)).sum()
        })
    }

    /// What it does to a model at values of its own.
    fn change(&self, own: &[f64]) -> Change<Plain> {
        let own: Vec<Real<Plain>> =
            own.iter().map(|&x| Real::new(x)).collect();
        Plain::change(self.mechanism, &own)
    }

    /// The force that it adds at some points of the way of one of several
    /// events, for each draw \[m/s2\]; positive drives the mass.
    pub(crate) fn forces(
        &self,
        event: usize,
        way: &[Passing],
    ) -> Vec<Vec<f64>> {
        let each = self.values.iter().zip(&self.mu);
        each.map(|(own, mu)| {
            let change = self.change(own).of_event(event);
            let terms = &change.forces.terms;
            way.iter()
                .map(|at| -terms.iter().map(|t| held(t, at, *mu)).sum::<f64>())
                .collect()
        })
        .collect()
    }
}

/// What a term holds the mass back with, beside a law of such a dry friction
/// \[m/s2\].
fn held(term: &Term<Plain>, at: &Passing, mu: f64) -> f64 {
    let real = Real::new;
    let moment = Moment {
        place: real(at.place),
        time: real(at.time),
        speed: real(at.speed),
    };
    if !term.acts(&moment) {
        return 0.0;
    }
    // A load that is added is rubbed with the law's own friction.
    let mut with = term.rate.scaled(term.strength(&moment));
    with.mu += mu;
    let load = at.site.load.max(0.0);
    with.resistance(&at.site, moment.speed).value() - mu * load
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::catalogue::find;
    use crate::observe::{Event, Series};
    use crate::physics::Track;

    /// A mass on ground that bends.
    fn passing(place: f64, time: f64, speed: f64) -> Passing {
        let site = Site {
            distance: 0.0,
            pull: 5.0,
            load: 8.0,
            curvature: 0.01,
            depth: 1.0,
        };
        Passing { place, time, speed, site }
    }

    #[test]
    fn forces_are_those_of_the_formulas() {
        let track = Track::incline(35.0, 500.0).unwrap();
        let seen = Series::velocity(vec![1.0, 20.0], vec![2.0, 20.0]);
        let event = Event::on(track).velocity(seen.unwrap()).build().unwrap();
        let extent = event.extent();
        let at = passing(60.0, 5.0, 12.0);
        let force = |label: &str, values: &[f64]| {
            let found = find(label, &extent, &[]).unwrap();
            let n = values.len();
            let row = [values, &[0.3]].concat();
            let added = Added::new(found.as_ref(), &[&row[..]], 0..n, Some(n));
            added.forces(0, &[at])[0][0]
        };
        let near = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        };
        near(force("turbulent-drag", &[0.002]), -0.002 * 144.0);
        near(force("friction-patch", &[0.1, 50.0, 20.0]), -0.8);
        near(force("friction-patch", &[0.1, 70.0, 20.0]), 0.0);
        near(force("spreading", &[0.5, 4.0]), 0.5 * (-1.25_f64).exp());
        let run = (60.0 - extent.begin) / extent.run;
        near(force("depth-change", &[-0.001]), 0.144 * run);
    }

    #[test]
    fn a_load_of_bends_is_rubbed_with_the_laws_friction() {
        let (x, z) = ([0.0, 100.0, 200.0], [80.0, 20.0, 0.0]);
        let track = Track::from_points(&x, &z).unwrap();
        let seen = Series::velocity(vec![1.0, 9.0], vec![2.0, 20.0]);
        let event = Event::on(track).velocity(seen.unwrap()).build().unwrap();
        let found = find("curvature", &event.extent(), &[]).unwrap();
        let added = Added::new(found.as_ref(), &[&[0.9, 0.3]], 0..1, Some(1));
        let at = passing(60.0, 5.0, 10.0);
        // mu c kappa u^2.
        let found = added.forces(0, &[at])[0][0];
        assert!((found + 0.3 * 0.9).abs() < 1e-12, "{found}");
    }
}
