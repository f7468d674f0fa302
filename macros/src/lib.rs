//! The `model!` macro of couloir.
