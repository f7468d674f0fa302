//! The model as it was and the corrected one, side by side: errors, held-out
//! values, coverage, least squares; and whether a model scores what there is.

pub(crate) mod baseline;
pub(crate) mod checks;
pub(crate) mod least_squares;
pub(crate) mod scored;
