//! A mechanism that is each event's own.

use std::ops::Range;
use std::sync::Arc;

use super::of_events::{of_event, says_as};
use super::{
    Candidate, Change, ChangeKind, ChangeOf, Concern, Family, Mechanism, Noun,
    Reach, Unknown,
};
use crate::physics::forces::Axis;
use crate::scalar::Real;

/// An event's own mechanism.
#[derive(Debug, Clone)]
struct Own {
    /// Which event.
    event: usize,
    mechanism: Arc<dyn Mechanism>,
    /// How much is unknown about it.
    count: usize,
}

/// A mechanism that each of several events has in an amount of its own.
#[derive(Debug)]
pub(crate) struct PerEvent {
    each: Vec<Own>,
    events: usize,
    unknowns: Vec<Unknown>,
}

impl PerEvent {
    /// One mechanism for each event, of one name, or none where it does not
    /// apply; `None` if it applies to no event.
    pub(crate) fn new(
        each: Vec<Option<Box<dyn Mechanism>>>,
        labels: &[String],
    ) -> Option<Self> {
        let events = each.len();
        let (mut own, mut unknowns) = (Vec::new(), Vec::new());
        for (event, mechanism) in each.into_iter().enumerate() {
            let Some(mechanism) = mechanism else { continue };
            let label = labels.get(event).map_or("", String::as_str);
            let added = mechanism.unknowns();
            let (mechanism, count) = (Arc::from(mechanism), added.len());
            own.push(Own { event, mechanism, count });
            unknowns.extend(added.iter().map(|one| of_event(one, label)));
        }
        (!own.is_empty()).then_some(Self { each: own, events, unknowns })
    }

    fn one(&self) -> &dyn Mechanism {
        self.each[0].mechanism.as_ref()
    }
}

impl Candidate for PerEvent {
    says_as!(one);

    fn amplitudes(&self) -> Vec<Range<usize>> {
        let mut next = 0;
        let of = |own: &Own| {
            let all = next..next + own.count;
            next = all.end;
            all
        };
        self.each.iter().map(of).collect()
    }
}

impl<K: ChangeKind> ChangeOf<K> for PerEvent {
    fn change_of(&self, values: &[Real<K>]) -> Change<K> {
        let mut own = vec![Change::default(); self.events];
        let mut rest = values;
        for Own { event, mechanism, count } in &self.each {
            let (values, others) = rest.split_at(*count);
            own[*event] = K::change(mechanism.as_ref(), values);
            rest = others;
        }
        Change { own, ..Change::default() }
    }
}

impl Mechanism for PerEvent {
    fn of_event(&self, event: usize) -> Concern {
        let mut begin = 0;
        let mut mechanism: Option<Box<dyn Mechanism>> = None;
        for own in &self.each {
            let unknowns = &self.unknowns[begin..begin + own.count];
            begin += own.count;
            if own.event == event {
                mechanism = Some(Box::new(Self {
                    each: vec![own.clone()],
                    events: self.events,
                    unknowns: unknowns.to_vec(),
                }));
            }
        }
        Concern::Own { common: 0, mechanism }
    }
}
