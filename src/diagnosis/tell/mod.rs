//! A diagnosis as words, tables, pictures, a page, and a model to paste.

mod gain;
mod json;
mod law;
mod moment;
pub(crate) mod next;
pub(crate) mod noise;
#[cfg(feature = "pages")]
pub(crate) mod page;
pub(crate) mod paste;
pub(crate) mod phrases;
pub(crate) mod pictures;
pub(crate) mod place;
mod signs;
pub(crate) mod summary;
pub(crate) mod weak;
pub(crate) mod words;
