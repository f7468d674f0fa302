//! What series that several pictures draw are called: in their legends, and
//! where a page reads their values out; and how far down they go.

pub(crate) const RECORDED: &str = "recording";
pub(crate) const MEDIAN_FLOW: &str = "median flow";
pub(crate) const FLOWS: &str = "90 % of flows";
pub(crate) const WITH_ERRORS: &str = "90 % with errors";
pub(crate) const LOCATED: &str = "located stretch";

/// What chains are called.
pub(crate) const CHAIN_NAMES: [&str; 6] =
    ["chain 1", "chain 2", "chain 3", "chain 4", "chain 5", "chain 6"];

/// The least that a band of a quantity is drawn to: errors are normal and may
/// make a speed negative, but no mass slides uphill.
pub(crate) fn least(quantity: &str) -> f64 {
    if quantity == "velocity" { 0.0 } else { f64::NEG_INFINITY }
}
