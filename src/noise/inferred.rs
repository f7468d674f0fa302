//! The word for a noise that is to be inferred, and what stands in for it.

use super::{Grid, Spacing};

/// What an event file names where the noise is to be inferred.
pub(super) const INFER: &str = "infer";

/// Whether a noise's name asks for whichever is likely.
///
/// ```
/// use couloir::noise::is_inferred;
/// assert!(is_inferred("infer") && !is_inferred("iid"));
/// ```
pub fn is_inferred(name: &str) -> bool {
    name.trim() == INFER
}

/// The noise that stands where none is named, until one is known to be
/// likely: errors that are correlated in time.
pub(crate) fn stand_in<'g>(
    mut grids: impl Iterator<Item = &'g Grid>,
) -> &'static str {
    match grids.any(|grid| *grid.spacing() == Spacing::Uneven) {
        true => "ou",
        false => "ar(1)",
    }
}
