//! What is new in a value.

use crate::scalar::{Kind, Real};

/// The prediction error of a value over its size.
pub(super) struct Innovation<'f, K: Kind> {
    pub(super) error: Real<K>,
    pub(super) variance: &'f Real<K>,
    /// Whether that is the variance of the value before.
    pub(super) is_same: bool,
    /// The logarithm of the value's size.
    pub(super) log_size: Option<Real<K>>,
}
