//! A noise that is what another one says.

/// Makes a type the noise that an expression of `self` is, in all that a noise
/// says.
macro_rules! noise_like {
    (impl[$($bounds:tt)*] $of:ty, $self:ident => $inner:expr) => {
        impl<K: $crate::scalar::Kind, $($bounds)*> $crate::noise::Noise<K>
            for $of
        {
            fn check(
                &$self,
                at: &$crate::noise::Grid,
            ) -> $crate::error::Result<()> {
                $inner.check(at)
            }

            #[inline]
            fn walk(
                &$self,
                at: &$crate::noise::Grid,
                residuals: &[$crate::Real<K>],
                visit: &mut dyn FnMut($crate::noise::Conditional<K>),
            ) -> $crate::Outcome {
                $inner.walk(at, residuals, visit)
            }

            fn draw(
                &$self,
                at: &$crate::noise::Grid,
                rng: &mut $crate::seed::Rng,
            ) -> ::core::result::Result<Vec<f64>, $crate::Stop> {
                $inner.draw(at, rng)
            }

            #[inline]
            fn log_likelihood(
                &$self,
                at: &$crate::noise::Grid,
                residuals: &[$crate::Real<K>],
            ) -> ::core::result::Result<$crate::Real<K>, $crate::Stop> {
                $inner.log_likelihood(at, residuals)
            }

            fn inform(
                &$self,
                at: &$crate::noise::Grid,
                residuals: &[$crate::Real<K>],
                hear: &mut dyn FnMut(&$crate::Real<K>),
            ) -> ::core::result::Result<$crate::Real<K>, $crate::Stop> {
                $inner.inform(at, residuals, hear)
            }

            #[inline]
            fn width(
                &$self,
                predicted: $crate::Real<K>,
            ) -> Option<$crate::Real<K>> {
                $inner.width(predicted)
            }

            fn standardise(&$self, deviate: f64) -> f64 {
                $inner.standardise(deviate)
            }

            fn stationary(&$self) -> Option<$crate::noise::Stationary> {
                $inner.stationary()
            }
        }
    };
}

pub(crate) use noise_like;
