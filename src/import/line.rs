//! A line on the ground, and places along it.

use super::crs::Place;

/// A line through places, with the distance of each along it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    places: Vec<Place>,
    at: Vec<f64>,
}

/// Where a place lies beside a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Beside {
    /// The distance along the line of its nearest point \[m\].
    pub(super) along: f64,
    /// How far from the line the place is \[m\].
    pub(super) off: f64,
}

fn apart(a: Place, b: Place) -> f64 {
    (b.0 - a.0).hypot(b.1 - a.1)
}

impl Line {
    /// Through at least two places that are apart.
    pub(super) fn through(places: &[Place]) -> Option<Self> {
        let mut line = Self { places: Vec::new(), at: Vec::new() };
        for place in places {
            let last = line.places.last().zip(line.at.last());
            let at = match last {
                None => 0.0,
                Some((last, at)) => at + apart(*last, *place),
            };
            if line.at.last().is_none_or(|last| at > *last) {
                line.places.push(*place);
                line.at.push(at);
            }
        }
        (line.places.len() > 1 && line.length().is_finite()).then_some(line)
    }

    /// Through places of which each is at least so far from the one before,
    /// and the last: what a sensor shows at rest is no way.
    pub(super) fn thinned(places: &[Place], step: f64) -> Option<Self> {
        let mut kept: Vec<Place> = Vec::new();
        for place in places {
            if kept.last().is_none_or(|last| apart(*last, *place) >= step) {
                kept.push(*place);
            }
        }
        kept.extend(places.last());
        Self::through(&kept)
    }

    pub(super) fn places(&self) -> &[Place] {
        &self.places
    }

    /// Its length \[m\].
    pub(super) fn length(&self) -> f64 {
        self.at.last().copied().unwrap_or(0.0)
    }

    pub(super) fn reversed(&self) -> Self {
        let length = self.length();
        Self {
            places: self.places.iter().rev().copied().collect(),
            at: self.at.iter().rev().map(|at| length - at).collect(),
        }
    }

    /// The place at a distance along it, its ends beyond them.
    pub(super) fn place(&self, along: f64) -> Place {
        let above = self.at.partition_point(|at| *at < along);
        let above = above.clamp(1, self.at.len() - 1);
        let (a, b) = (self.places[above - 1], self.places[above]);
        let (from, to) = (self.at[above - 1], self.at[above]);
        let share = ((along - from) / (to - from)).clamp(0.0, 1.0);
        (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))
    }

    /// The nearest point between two distances.
    pub(super) fn nearest(&self, place: Place, from: f64, to: f64) -> Beside {
        let first = self.at.partition_point(|at| *at <= from);
        let first = first.clamp(1, self.at.len() - 1) - 1;
        let mut best = Beside { along: from, off: f64::INFINITY };
        for i in first..self.at.len() - 1 {
            if i > first && self.at[i] > to {
                break;
            }
            let (a, b) = (self.places[i], self.places[i + 1]);
            let along = (b.0 - a.0, b.1 - a.1);
            let to_place = (place.0 - a.0, place.1 - a.1);
            let length = self.at[i + 1] - self.at[i];
            let dot = along.0 * to_place.0 + along.1 * to_place.1;
            let share = (dot / (length * length)).clamp(0.0, 1.0);
            let foot = (a.0 + share * along.0, a.1 + share * along.1);
            let off = apart(foot, place);
            if off < best.off {
                best = Beside { along: self.at[i] + share * length, off };
            }
        }
        best
    }

    /// Where places one after another lie beside it. Each is looked for near
    /// the one before, so that a line that comes by itself again is followed.
    pub(super) fn follow(&self, places: &[Place]) -> Vec<Beside> {
        let mut out: Vec<Beside> = Vec::with_capacity(places.len());
        for place in places {
            let next = match out.last() {
                None => self.nearest(*place, 0.0, self.length()),
                Some(last) => {
                    let from = (last.along - BACK).max(0.0);
                    self.nearest(*place, from, last.along + AHEAD)
                }
            };
            out.push(next);
        }
        out
    }
}

/// How far back, and ahead, the next place is looked for \[m\].
const BACK: f64 = 50.0;
const AHEAD: f64 = 200.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_found_beside_a_line() {
        let corner = [(0.0, 0.0), (10.0, 0.0), (10.0, 0.0), (10.0, 10.0)];
        let line = Line::through(&corner).unwrap();
        assert_eq!(line.length(), 20.0);
        assert_eq!(line.place(15.0), (10.0, 5.0));
        assert_eq!(line.place(-1.0), (0.0, 0.0));
        assert_eq!(line.place(99.0), (10.0, 10.0));
        let beside = line.follow(&[(5.0, 1.0), (12.0, 5.0)]);
        assert_eq!(beside[0], Beside { along: 5.0, off: 1.0 });
        assert_eq!(beside[1], Beside { along: 15.0, off: 2.0 });
        assert_eq!(line.reversed().place(5.0), (10.0, 5.0));
    }

    #[test]
    fn rest_adds_no_way() {
        let mut places = vec![(0.0, 0.0), (10.0, 0.0)];
        places.extend((0..100).map(|i| (10.0 + f64::from(i % 2), 0.0)));
        let line = Line::thinned(&places, 3.0).unwrap();
        assert_eq!(line.length(), 11.0);
        assert!(Line::through(&[(1.0, 1.0), (1.0, 1.0)]).is_none());
        assert!(Line::thinned(&[], 3.0).is_none());
    }
}
