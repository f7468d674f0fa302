//! One-step predictors of rising order (Durbin and Levinson).

use crate::block::List;
use crate::scalar::Arithmetic;

/// The best linear predictor of a stationary process from its last j values,
///
///   E(r_t | r_(t-1) .. r_(t-j)) = sum_i c_(j,i) r_(t-i),
///
/// and the variance v_j of its error; j rises with every partial
/// autocorrelation p (Brockwell and Davis 1991, section 5.2):
///
///   c_(j,i) = c_(j-1,i) - p c_(j-1,j-i), c_(j,j) = p,
///   v_j = v_(j-1) (1 - p^2).
#[derive(Debug, Clone)]
pub(super) struct Predictor<S> {
    /// c_(j,1) .. c_(j,j).
    pub(super) coefficients: List<S>,
    /// v_j, in the squared unit of the process.
    pub(super) variance: S,
}

impl<S: Arithmetic> Predictor<S> {
    /// Order 0: predicts 0, with the variance of the process as error.
    pub(super) fn new(variance: S) -> Self {
        Self { coefficients: List::new(), variance }
    }

    /// The next order, from its partial autocorrelation.
    pub(super) fn raise(&mut self, partial: S) {
        let c = &mut self.coefficients;
        let order = c.len();
        for i in 0..order.div_ceil(2) {
            let (near, far) = (c[i], c[order - 1 - i]);
            c[order - 1 - i] = far - partial * near;
            c[i] = near - partial * far;
        }
        c.push(partial);
        self.variance *= one_minus_square(partial);
    }

    /// The prediction from the values before, latest last.
    pub(super) fn predict(&self, past: &[S]) -> S {
        self.coefficients
            .iter()
            .zip(past.iter().rev())
            .fold(S::zero(), |sum, (&c, &r)| sum + c * r)
    }
}

/// 1 - x^2 without cancellation near 1.
pub(super) fn one_minus_square<S: Arithmetic>(x: S) -> S {
    (S::one() - x) * (S::one() + x)
}
