//! From evidence to a decision: probabilities, the verdict, and which
//! mechanisms are added.

pub(crate) mod added;
pub(crate) mod choose;
pub(crate) mod chosen;
pub(crate) mod judge;
pub(crate) mod noise;
pub(crate) mod stepwise;
