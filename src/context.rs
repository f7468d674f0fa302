//! What one evaluation of a model shares: buffers and counts.
//!
//! A log density is evaluated millions of times; its buffers are taken from
//! a pool and go back to it, so that no evaluation but the first allocates.

use std::cell::{Cell, RefCell};
use std::ops::{Deref, DerefMut};

use crate::scalar::{Kind, Real};

/// Buffers and counts shared by the blocks of a model, one per thread and
/// kind of number.
#[derive(Debug, Default)]
pub struct Context<K: Kind> {
    pool: RefCell<Vec<Vec<Real<K>>>>,
    slides: Cell<u64>,
}

impl<K: Kind> Context<K> {
    /// A context with an empty pool.
    pub const fn new() -> Self {
        Self { pool: RefCell::new(Vec::new()), slides: Cell::new(0) }
    }

    /// An empty buffer from the pool.
    #[inline]
    pub fn buffer(&self) -> Buffer<'_, K> {
        let data = self.pool.borrow_mut().pop().unwrap_or_default();
        Buffer { data, pool: &self.pool }
    }

    /// Counts one solved motion.
    #[inline]
    pub(crate) fn count_slide(&self) {
        self.slides.set(self.slides.get() + 1);
    }

    /// How many motions were solved in this context.
    pub fn slides(&self) -> u64 {
        self.slides.get()
    }
}

/// Numbers in a buffer that goes back to its pool when dropped.
#[derive(Debug)]
pub struct Buffer<'r, K: Kind> {
    data: Vec<Real<K>>,
    pool: &'r RefCell<Vec<Vec<Real<K>>>>,
}

impl<K: Kind> Deref for Buffer<'_, K> {
    type Target = Vec<Real<K>>;
    #[inline]
    fn deref(&self) -> &Vec<Real<K>> {
        &self.data
    }
}

impl<K: Kind> DerefMut for Buffer<'_, K> {
    #[inline]
    fn deref_mut(&mut self) -> &mut Vec<Real<K>> {
        &mut self.data
    }
}

impl<K: Kind> Drop for Buffer<'_, K> {
    #[inline]
    fn drop(&mut self) {
        let mut data = std::mem::take(&mut self.data);
        data.clear();
        self.pool.borrow_mut().push(data);
    }
}
