//! What a model lacks, and what follows from it.

#[cfg(feature = "cli")]
mod corrected_model;
mod events;
mod own_mechanism;
mod thin;
mod together;
mod verdicts;
