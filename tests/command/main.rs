//! The command as people run it.

mod bad_input;
mod cases;
mod export;
mod habits;
#[cfg(feature = "import")]
mod import;
mod resume;
mod sweep;
mod words;
