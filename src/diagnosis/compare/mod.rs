//! The model as it was and the corrected one, side by side: errors, held-out
//! values, coverage, least squares.

pub(crate) mod baseline;
pub(crate) mod checks;
pub(crate) mod least_squares;
