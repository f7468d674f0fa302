//! What anybody may give couloir, by mistake or on purpose: damaged files,
//! hostile names, paths that lead elsewhere, a disk that is full.
//!
//! `COULOIR_INPUTS=10000000` gives that many inputs to the parsers in all,
//! instead of the few of every day; `COULOIR_SEED=2` gives others.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]
#![allow(clippy::panic, reason = "a test fails by it")]

mod changes;
mod command;
mod limits;
mod names;
mod parsers;
mod places;
mod targets;
