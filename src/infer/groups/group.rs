//! Groups of a posterior's coordinates.

use crate::model::Posterior;

/// Some coordinates of a posterior, as a posterior of their own.
#[derive(Debug)]
pub struct Group<'a> {
    /// Prior and data of these coordinates alone.
    pub posterior: &'a Posterior<'a>,
    /// Which coordinate of the whole each of them is.
    pub places: Vec<usize>,
}

/// A posterior with its groups.
#[derive(Debug)]
pub struct Grouped<'a> {
    /// All coordinates.
    pub whole: &'a Posterior<'a>,
    /// Those that all groups have in common, under their prior alone; `None`
    /// where there are none.
    pub common: Option<Group<'a>>,
    /// Each group, what is in common among its coordinates.
    pub groups: Vec<Group<'a>>,
}
