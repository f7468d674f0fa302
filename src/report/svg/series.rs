//! What series that several pictures draw are called: in their legends, and
//! where a page reads their values out.

pub(crate) const RECORDED: &str = "recording";
pub(crate) const MEDIAN_FLOW: &str = "median flow";
pub(crate) const FLOWS: &str = "90 % of flows";
pub(crate) const WITH_ERRORS: &str = "90 % with errors";
pub(crate) const LOCATED: &str = "located stretch";
