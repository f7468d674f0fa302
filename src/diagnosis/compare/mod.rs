//! The model as it was and the corrected one, side by side: errors, held-out
//! values, coverage, least squares.

pub(crate) mod before_and_after;
pub(crate) mod check;
pub(crate) mod least_squares;
