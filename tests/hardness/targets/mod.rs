//! What is done with an input, parser by parser.

pub(crate) mod data;
pub(crate) mod imports;
pub(crate) mod results;
pub(crate) mod words;
