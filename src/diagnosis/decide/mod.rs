//! From evidence to a decision: probabilities, the verdict, and which
//! mechanisms are added.

pub(crate) mod added;
pub(crate) mod choose;
pub(crate) mod chosen;
pub(crate) mod decision;
pub(crate) mod judge;
pub(crate) mod noise;
pub(crate) mod odds;
pub(crate) mod stepwise;
