//! Posteriors, evidences and predictions, against exact answers and by
//! simulation.

mod bands;
mod evidence;
mod population;
mod reference;
#[cfg(feature = "cli")]
mod repeat;
#[cfg(feature = "cli")]
mod reproduce;
mod sbc;
mod sbc_of_models;
