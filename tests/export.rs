//! What a run writes for other programs, read back.
