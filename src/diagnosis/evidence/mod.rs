//! The evidence of a model with mechanisms.

pub(crate) mod apart;
pub(crate) mod attribute;
pub(crate) mod carried;
pub(crate) mod combination;
mod edges;
pub(crate) mod fit;
mod grids;
pub(crate) mod noises;
mod others;
mod owns;
mod screen;
mod survey;
pub(crate) mod table;
