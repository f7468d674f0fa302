//! One clock for several recordings of one avalanche.

use super::log::Log;
use super::moving::Moving;

/// When each recording's t = 0 is on the clock that they share, from the
/// first of them on \[s\]. They share one where all move at some moment of
/// it, as sensors in one flow do; nothing otherwise.
pub(super) fn starts(all: &[Moving]) -> Option<Vec<f64>> {
    let clock = |log: &Log| log.begin.is_clock;
    let is_one_kind =
        all.windows(2).all(|w| clock(&w[0].log) == clock(&w[1].log));
    let moment = |one: &Moving, time: f64| one.log.begin.seconds + time;
    let begins: Vec<f64> =
        all.iter().map(|one| moment(one, one.begin())).collect();
    let ends = all.iter().map(|one| moment(one, one.end()));
    let last = begins.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let overlap = last < ends.fold(f64::INFINITY, f64::min);
    let first = begins.iter().copied().fold(f64::INFINITY, f64::min);
    (is_one_kind && overlap)
        .then(|| begins.iter().map(|begin| begin - first).collect())
}
