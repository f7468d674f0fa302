//! Crossing whole pieces of the track, one after the other. Under a force that
//! is the same on each but for its slope, `ahead` crosses eight at a time.

use super::exact::{Force, Pace};
use super::track::Piece;
use crate::scalar::{Kind, Real};

/// A mass that enters a piece.
#[derive(Clone, Copy)]
pub(crate) struct Entry<K: Kind> {
    /// Which piece.
    pub(crate) index: usize,
    pub(crate) pace: Pace<K>,
    /// When [s].
    pub(crate) begins: Real<K>,
}

/// How it leaves the piece at the far border.
#[derive(Clone, Copy)]
pub(crate) struct Crossing<K: Kind> {
    pub(crate) force: Force<K>,
    pub(crate) arrival: Pace<K>,
    /// After what time [s].
    pub(crate) after: Real<K>,
    /// When [s].
    pub(crate) ends: f64,
}

/// The arrival at the far border and the time it takes.
pub(crate) type Crossed<K> = Option<(Pace<K>, Real<K>)>;

/// Crosses whole pieces, under a force without a part linear in the speed,
/// until one holds `time`: that one, and how it is crossed. Without a crossing
/// the piece has to be entered in the general way: it is the one numbered
/// `last`, or is not crossed so.
#[expect(clippy::neg_cmp_op_on_partial_ord, reason = "NaN ends it too")]
#[expect(clippy::needless_range_loop, reason = "the index is handed back")]
#[inline(always)]
pub(crate) fn skim<K: Kind>(
    pieces: &[Piece],
    entry: Entry<K>,
    last: usize,
    time: f64,
    mut cross: impl FnMut(&Piece, &Entry<K>) -> (Force<K>, Crossed<K>),
) -> (Entry<K>, Option<Crossing<K>>) {
    let Entry { index: first, mut pace, mut begins } = entry;
    for index in first..last {
        let piece = &pieces[index];
        let (force, crossed) = cross(piece, &Entry { index, pace, begins });
        let Some((arrival, after)) = crossed else {
            return (Entry { index, pace, begins }, None);
        };
        let ends = begins.value() + after.value();
        if !(ends <= time) {
            let crossing = Crossing { force, arrival, after, ends };
            return (Entry { index, pace, begins }, Some(crossing));
        }
        begins += after;
        pace = arrival;
    }
    (Entry { index: last.max(first), pace, begins }, None)
}
