//! The evidence of a model with mechanisms.

pub(crate) mod apart;
pub(crate) mod attribute;
pub(crate) mod fit;
mod grids;
