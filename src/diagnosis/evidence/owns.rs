//! Where the model's own parameters begin when a mechanism is looked for.

use statrs::statistics::Statistics;

use super::edges::to_the_end;
use super::fit::Fit;
use crate::diagnosis::locate::FreeForce;
use crate::error::Result;
use crate::mechanism::{Mechanism, Role, Unknown};
use crate::model::{AnyProgram, Posterior, With};

/// Where the model's own parameters begin.
#[derive(Debug)]
pub(super) struct Owns {
    /// At their best with nothing added, where errors may explain what is
    /// missing, and at their best with a force of free form, where it does.
    pub(super) best: Vec<Vec<f64>>,
    /// In the middle of what they are with the force along each axis: between
    /// its peaks, where a mechanism that is like the force at neither has its
    /// own.
    pub(super) between: Vec<Vec<f64>>,
    /// In the tails of each, with nothing added: the memory of the errors,
    /// above all, decides which stretches they hide.
    pub(super) tails: Vec<Vec<f64>>,
    /// Where mechanisms have them.
    pub(super) met: Vec<Met>,
    /// Places near one of these, whose mechanism has an unknown that those near
    /// it lack: a step in time is likely where one along the run is.
    pub(super) alike: Vec<Met>,
    /// The standard deviation of each coordinate, with nothing added.
    widths: Vec<f64>,
}

/// Where a mechanism is likely.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Met {
    /// The model's own parameters there, on the line.
    pub(super) own: Vec<f64>,
    /// Names, units and values of the mechanism's unknowns.
    values: Vec<(String, &'static str, f64)>,
}

impl Met {
    /// Of a mechanism and a place on the line.
    pub(super) fn of(
        mechanism: &dyn Mechanism,
        added: &[f64],
        own: &[f64],
    ) -> Self {
        let values = mechanism.unknowns().into_iter().zip(added);
        let values = values.map(|(unknown, z)| {
            let value = unknown.prior.value_at(*z);
            (unknown.name, unknown.unit, value)
        });
        Self { own: own.to_vec(), values: values.collect() }
    }

    /// Whether it has an unknown that another has not.
    fn says_more_than(&self, other: &Self) -> bool {
        let has = |(name, unit, _): &(String, &str, f64)| {
            other.values.iter().any(|(n, u, _)| n == name && u == unit)
        };
        !self.values.iter().all(has)
    }

    /// Places of another mechanism with what both call alike as it is here, and
    /// one that lasts to the end where the beginning alone is shared; none
    /// where nothing is. A step is a patch that does not end, and where it
    /// begins a patch may.
    pub(super) fn shared_with(
        &self,
        mechanism: &dyn Mechanism,
        places: &[Vec<f64>],
    ) -> Vec<Vec<f64>> {
        let unknowns = mechanism.unknowns();
        let shared: Vec<Option<f64>> =
            unknowns.iter().map(|unknown| self.line_of(unknown)).collect();
        if shared.iter().all(Option::is_none) {
            return Vec::new();
        }
        let mut places = places.to_vec();
        let onwards = places.first().cloned().and_then(|mut place| {
            let (i, length) = length_alone(&unknowns, &shared)?;
            place[i] = to_the_end(&length.prior);
            Some(place)
        });
        places.extend(onwards);
        for place in &mut places {
            for (z, shared) in place.iter_mut().zip(&shared) {
                *z = shared.unwrap_or(*z);
            }
        }
        places
    }

    /// The place on the line of what is called alike here.
    fn line_of(&self, unknown: &Unknown) -> Option<f64> {
        let is_like = |(name, unit, _): &&(String, &str, f64)| {
            *name == unknown.name && *unit == unknown.unit
        };
        let (.., value) = self.values.iter().find(is_like)?;
        let z = unknown.prior.line_of(*value);
        z.is_finite().then_some(z)
    }
}

/// The length of a stretch of which the beginning alone is shared: what it
/// begins with lasts to the end.
fn length_alone<'u>(
    unknowns: &'u [Unknown],
    shared: &[Option<f64>],
) -> Option<(usize, &'u Unknown)> {
    let is_alone = |&(i, unknown): &(usize, &Unknown)| {
        let is_length = matches!(unknown.role, Role::Length { .. });
        is_length && shared[i].is_none() && shared[i - 1].is_some()
    };
    unknowns.iter().enumerate().skip(1).find(is_alone)
}

/// How many places of the own parameters that mechanisms have are begun from,
/// and how many near these that tell of more; from how many widths on places
/// are such of their own.
pub(super) const MOST_MET: usize = 4;
const ELSEWHERE: f64 = 2.0;

impl Owns {
    /// Of a model as it is, and of forces of free form.
    ///
    /// # Errors
    /// A model that fails.
    pub(super) fn of(
        program: &dyn AnyProgram,
        none: &Fit,
        forces: &[FreeForce],
    ) -> Result<Self> {
        let with = With::new(program, &[]);
        let posterior = Posterior::new(&with)?;
        let likely = FreeForce::likeliest(forces);
        let open = likely.and_then(FreeForce::likeliest_own);
        let rows = none.draws.thinned(DRAWN).into_iter();
        let drawn: Vec<Vec<f64>> =
            rows.map(|row| posterior.line(row)).collect::<Result<_>>()?;
        let best = [none.own()].into_iter().chain(open);
        let best = best.map(<[f64]>::to_vec).collect();
        let between = forces.iter().map(FreeForce::middle_of_own).collect();
        let (widths, tails) = (widths(&drawn), tails(drawn));
        let (met, alike) = (Vec::new(), Vec::new());
        Ok(Self { best, between, tails, met, alike, widths })
    }

    /// Takes in where mechanisms have them, each with ln of what it holds: the
    /// likeliest first, as far as these are places of their own, or tell of an
    /// unknown that those near them lack.
    pub(super) fn meet(&mut self, places: impl Iterator<Item = (f64, Met)>) {
        let mut places: Vec<(f64, Met)> = places.collect();
        places.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, one) in places {
            let is_near = |known: &[f64]| self.are_near(known, &one.own);
            if self.best.iter().any(|best| is_near(best)) {
                continue;
            }
            let known = self.met.iter().chain(&self.alike);
            let near: Vec<&Met> =
                known.filter(|known| is_near(&known.own)).collect();
            let says_more = near.iter().all(|known| one.says_more_than(known));
            let list = match near.is_empty() {
                true => &mut self.met,
                false => &mut self.alike,
            };
            if says_more && list.len() < MOST_MET {
                list.push(one);
            }
        }
    }

    /// Whether no coordinate of a place is far from that of another.
    fn are_near(&self, one: &[f64], other: &[f64]) -> bool {
        let mut off = one.iter().zip(other).zip(&self.widths);
        off.all(|((a, b), width)| (a - b).abs() <= ELSEWHERE * width)
    }
}

/// Of how many draws of the model as it is those in the tails are taken.
const DRAWN: usize = 400;

/// The standard deviation of each coordinate.
fn widths(drawn: &[Vec<f64>]) -> Vec<f64> {
    let count = drawn.first().map_or(0, Vec::len);
    let of = |i: usize| drawn.iter().map(|line| line[i]).collect::<Vec<_>>();
    (0..count).map(|i| of(i).std_dev()).collect()
}

/// The draws near the ends of each coordinate's middle 95 %.
fn tails(mut drawn: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let coordinates = drawn.first().map_or(0, Vec::len);
    let low = drawn.len() / 40;
    let high = drawn.len().saturating_sub(1 + low);
    (0..coordinates)
        .flat_map(|i| {
            drawn.sort_by(|a, b| a[i].total_cmp(&b[i]));
            [drawn[low].clone(), drawn[high].clone()]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::Extent;
    use crate::mechanism::catalogue::catalogue;

    #[test]
    fn places_of_their_own_are_taken_in_the_likeliest_first() {
        let mut owns = Owns {
            best: vec![vec![0.0, 0.0]],
            between: Vec::new(),
            tails: Vec::new(),
            met: Vec::new(),
            alike: Vec::new(),
            widths: vec![1.0, 0.1],
        };
        // Near the best, far in the narrow coordinate, next to that, and five
        // more apart from all.
        let places = [[1.9, 0.1], [0.0, 0.5], [0.5, 0.6]];
        let far = (1..=5).map(|i| [10.0 * f64::from(i), 0.0]);
        let places: Vec<[f64; 2]> = places.into_iter().chain(far).collect();
        let logs = [9.0, 5.0, 6.0, 1.0, 2.0, 3.0, 4.0, 0.0];
        let met = places
            .iter()
            .map(|place| Met { own: place.to_vec(), values: Vec::new() });
        owns.meet(logs.into_iter().zip(met));
        let likeliest = [[0.5, 0.6], [40.0, 0.0], [30.0, 0.0], [20.0, 0.0]];
        let found: Vec<&[f64]> =
            owns.met.iter().map(|one| &one.own[..]).collect();
        assert_eq!(found, likeliest);
    }

    #[test]
    fn what_is_near_is_taken_in_where_it_says_more() {
        let mut owns = Owns {
            best: vec![vec![0.0]],
            between: Vec::new(),
            tails: Vec::new(),
            met: Vec::new(),
            alike: Vec::new(),
            widths: vec![1.0],
        };
        let of = |own: f64, unit: &'static str| Met {
            own: vec![own],
            values: vec![("from".to_owned(), unit, own)],
        };
        let (time, again, place) = (of(9.0, "s"), of(9.5, "s"), of(8.5, "m"));
        let near_the_best = of(1.0, "m");
        let all = [&time, &again, &near_the_best, &place].map(Clone::clone);
        owns.meet([4.0, 3.0, 2.0, 1.0].into_iter().zip(all));
        assert_eq!((owns.met, owns.alike), (vec![time], vec![place]));
    }

    #[test]
    fn a_patch_begins_where_a_step_does() {
        let extent = Extent::EVERYTHING;
        let blocks = ["voellmy".to_owned()];
        let all = catalogue(&extent, &blocks);
        let find = |name: &str| {
            all.iter().map(AsRef::as_ref).find(|m| m.name() == name).unwrap()
        };
        let (step, patch) = (find("friction-step"), find("friction-patch"));
        let met = Met::of(step, &[0.2, -1.5], &[7.0]);
        let places = vec![vec![0.0, 0.0, 0.4, 1.0], vec![0.1, 0.2, 0.3, 2.0]];
        let found = met.shared_with(patch, &places);
        // Each, and one that lasts to the end as the step does.
        assert_eq!(found.len(), places.len() + 1);
        let natural = |m: &dyn Mechanism, i: usize, z: f64| {
            m.unknowns()[i].prior.value_at(z)
        };
        let longest = patch.unknowns()[2].prior.quantile(1.0).unwrap();
        let onwards = natural(patch, 2, found[2][2]);
        assert!(onwards > 0.99 * longest, "{onwards} of {longest}");
        for (place, before) in found.iter().zip(&places) {
            for (i, z) in [0.2, -1.5].into_iter().enumerate() {
                let (of_step, of_patch) =
                    (natural(step, i, z), natural(patch, i, place[i]));
                // Round-off of a logistic function and back.
                let off = (of_step - of_patch).abs();
                assert!(off < 1e-9 * of_step.abs(), "{i}: {off}");
            }
            assert_eq!(place[2..], before[2..]);
        }
        // A shift of the release is called like nothing of a patch.
        let release = Met::of(find("release-position"), &[0.1], &[7.0]);
        assert!(release.shared_with(patch, &places).is_empty());
    }

    #[test]
    fn tails_are_draws_and_widths_standard_deviations() {
        let drawn: Vec<Vec<f64>> = (0..=400)
            .map(|i| vec![f64::from(i), -2.0 * f64::from(i)])
            .collect();
        // Of 0 to n the standard deviation is sqrt((n + 1)(n + 2)/12).
        let sd = (401.0 * 402.0 / 12.0_f64).sqrt();
        let found = widths(&drawn);
        assert!((found[0] - sd).abs() < 1e-9 * sd);
        assert!((found[1] - 2.0 * sd).abs() < 1e-9 * sd);
        let [low, high] = [vec![10.0, -20.0], vec![390.0, -780.0]];
        assert_eq!(tails(drawn), [low.clone(), high.clone(), high, low]);
    }
}
