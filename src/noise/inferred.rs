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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_in_exists_at_the_times_of_the_recording() {
        let of = |times: &[f64]| {
            let grid = Grid::new(times.to_vec(), None);
            stand_in([&grid].into_iter())
        };
        assert_eq!(of(&[0.5, 1.0, 1.5, 2.0]), "ar(1)");
        // A value missing leaves the grid regular.
        assert_eq!(of(&[0.5, 1.0, 2.0, 2.5]), "ar(1)");
        assert_eq!(of(&[0.5, 1.0, 1.7, 2.9]), "ou");
    }
}
