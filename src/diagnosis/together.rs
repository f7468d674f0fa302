//! What several events may lack: the catalogue, spread over them.
//!
//! A mechanism of the physics or of the sensor is the same in all of them, or
//! each event has an amount of its own about a common one; what belongs to a
//! start or a clock is each event's own, and so are sensors that do
//! not record the same quantity.

use crate::mechanism::catalogue::{Catalogue, applies};
use crate::mechanism::{Family, Mechanism, PerEvent, Pooled};
use crate::model::{Member, Together};
use crate::observe::Event;

/// How far a mechanism of the physics or of a sensor is the same in all
/// events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    /// The same amplitude at the same places.
    Shared,
    /// The same places; each event's amplitude is drawn from a common
    /// distribution.
    Pooled,
}

impl<M: Member> Together<M> {
    /// Every mechanism of a catalogue that applies: those of the physics and
    /// of sensors to all events, with amounts shared as told; the others to
    /// each on its own.
    pub fn catalogue(
        &self,
        known: &Catalogue,
        sharing: Sharing,
    ) -> Vec<Box<dyn Mechanism>> {
        let all = known.of(&self.extent(), &[]).into_iter();
        all.filter_map(|mechanism| self.spread(known, mechanism, sharing))
            .collect()
    }

    /// Whether it can be missing from every event's model.
    fn applies(&self, mechanism: &dyn Mechanism) -> bool {
        self.blocks().iter().all(|blocks| applies(mechanism, blocks))
    }

    /// A mechanism of the catalogue as it is for several events; `None` where
    /// the model of any has what is shared, or of all what is each one's own.
    fn spread(
        &self,
        known: &Catalogue,
        mechanism: Box<dyn Mechanism>,
        sharing: Sharing,
    ) -> Option<Box<dyn Mechanism>> {
        match sharing {
            _ if self.is_each_ones(mechanism.as_ref()) => {
                self.each(known, mechanism.as_ref())
            }
            _ if !self.applies(mechanism.as_ref()) => None,
            Sharing::Shared => Some(mechanism),
            Sharing::Pooled => {
                Some(Box::new(Pooled::new(mechanism, self.labels())))
            }
        }
    }

    /// Whether no amount of it is common to the events: sensors may be one
    /// and the same only where all record the same, on ground.
    fn is_each_ones(&self, mechanism: &dyn Mechanism) -> bool {
        let recorded = |event: &Event| {
            let what = event.recordings().map(|s| (s.quantity(), s.window()));
            (what.collect::<Vec<_>>(), event.extent().carried)
        };
        let alike = || {
            let mut all = self.events().map(recorded);
            let first = all.next();
            all.all(|other| Some(other) == first)
        };
        let sensor = mechanism.family() == Family::Measurement;
        mechanism.is_each_events_own() || (sensor && !alike())
    }

    /// A mechanism in an amount of each event's own, where its model has none.
    fn each(
        &self,
        known: &Catalogue,
        mechanism: &dyn Mechanism,
    ) -> Option<Box<dyn Mechanism>> {
        let label = mechanism.label();
        let of = |(event, blocks): (&Event, &Vec<String>)| {
            known.find(&label, &event.extent(), blocks).ok()
        };
        let each = self.events().zip(self.blocks()).map(of).collect();
        let own = PerEvent::new(each, self.labels())?;
        Some(Box::new(own))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use nalgebra::DMatrix;

    use super::*;
    use crate::model::{Assembled, ByEvent, Information, Posterior, With};
    use crate::noise;
    use crate::observe::Series;
    use crate::physics::Track;
    use crate::physics::friction::Laws;
    use crate::seed::Seed;

    /// Three events on inclines, with errors of different kinds.
    fn events(one_law: bool) -> Together {
        let of = |(i, errors): (usize, &str)| {
            let i = i as f64;
            let times: Vec<f64> =
                (1..30).map(|t| 0.5 * f64::from(t)).collect();
            let speed = |t: &f64| (1.5 + 0.2 * i) * t + (2.0 * t).sin();
            let speeds = times.iter().map(speed).collect();
            let track = Track::incline(30.0 + i, 900.0).unwrap();
            let event = Event::on(track)
                .named(format!("e{i}"))
                .velocity(Series::velocity(times, speeds).unwrap())
                .build()
                .unwrap();
            let law = Laws::default().parse("coulomb + turbulent").unwrap();
            let noise = noise::parse(errors).unwrap();
            Assembled::new(event, law, noise, &BTreeMap::new()).unwrap()
        };
        let errors = ["ar(1)", "iid", "ou + white + tails"];
        let events = errors.into_iter().enumerate().map(of).collect();
        match one_law {
            true => Together::with_one_law(events).unwrap(),
            false => Together::new(events).unwrap(),
        }
    }

    /// Differences of numbers of about 1 to 1e3, by round-off, and by that of
    /// second differences of the priors.
    fn assert_alike(found: &Information, known: &Information) {
        let near = |a: &f64, b: &f64| {
            let off = (a - b).abs() / b.abs().max(1.0);
            assert!(off < 1e-6, "{a} for {b}");
        };
        let (a, b) = (found.density, known.density);
        assert_eq!((a.rejected, b.rejected), (None, None));
        near(&a.log_prior, &b.log_prior);
        near(&a.log_jacobian, &b.log_jacobian);
        near(&a.log_likelihood, &b.log_likelihood);
        let pairs = found.gradient.iter().zip(known.gradient.iter());
        pairs.for_each(|(a, b)| near(a, b));
        let pairs = found.precision.iter().zip(known.precision.iter());
        pairs.for_each(|(a, b)| near(a, b));
    }

    /// What a program with mechanisms has for derivatives, taken of all events
    /// at once and event by event.
    fn assert_by_event(program: &Together, own: &[&dyn Mechanism]) {
        let whole = With::new(program, own);
        let apart = ByEvent::new(program, own).unwrap();
        assert_eq!(apart.added(), whole.added());
        assert_eq!(apart.events().len(), 3);
        let whole = Posterior::new(&whole).unwrap();
        let apart = Posterior::new(&apart).unwrap();
        let n = whole.dimension();
        let mut rng = Seed::new(5).rng();
        let z = whole.draw_place(&mut rng).unwrap().unwrap();
        let known = whole.information(&z).unwrap();
        assert_alike(&apart.information(&z).unwrap(), &known);
        // Mixed directions, and one that single events know nothing of.
        let wave = |i, j| (0.7 * (i * n + j) as f64).sin();
        let mixed = DMatrix::from_fn(5, n, wave);
        let mut last = DMatrix::zeros(1, n);
        last[(0, n - 1)] = 1.0;
        for directions in [mixed, last] {
            let known = whole.information_along(&z, &directions).unwrap();
            let found = apart.information_along(&z, &directions).unwrap();
            assert_alike(&found, &known);
        }
    }

    #[test]
    fn derivatives_by_event_add_up_to_those_of_the_whole() {
        let sets: [&[&str]; 4] = [
            &[],
            &["friction-patch"],
            &["release-position"],
            &["release-position", "friction-patch"],
        ];
        for (one_law, sharing) in [
            (true, Sharing::Shared),
            (true, Sharing::Pooled),
            (false, Sharing::Shared),
            (false, Sharing::Pooled),
        ] {
            let program = events(one_law);
            let all = program.catalogue(&Catalogue::default(), sharing);
            for names in sets {
                let own = all.iter().map(AsRef::as_ref);
                let own =
                    own.filter(|m: &&dyn Mechanism| names.contains(&m.name()));
                let own: Vec<&dyn Mechanism> = own.collect();
                assert_eq!(own.len(), names.len());
                assert_by_event(&program, &own);
            }
        }
    }
}
