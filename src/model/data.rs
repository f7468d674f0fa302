//! What stands left of `~`: numbers that were observed.

use crate::observe::Series;

/// Numbers that were observed, real or whole: one, or several.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not data",
    label = "left of `~` stands what was recorded: a series, a number, or a \
             list of numbers"
)]
pub trait Data {
    /// How many there are.
    fn count(&self) -> usize;
    /// One of them, counted from 0.
    fn value(&self, index: usize) -> f64;
}

macro_rules! numbers {
    ($($number:ty: |$x:ident| $value:expr;)*) => {$(
        impl Data for $number {
            #[inline]
            fn count(&self) -> usize {
                1
            }
            #[inline]
            fn value(&self, _: usize) -> f64 {
                let $x = *self;
                $value
            }
        }
        impl Data for [$number] {
            #[inline]
            fn count(&self) -> usize {
                self.len()
            }
            #[inline]
            fn value(&self, index: usize) -> f64 {
                Data::value(&self[index], 0)
            }
        }
    )*};
}
// Whole numbers above 2^53 would be rounded; no count is as large.
numbers! {
    f64: |x| x;
    bool: |x| f64::from(u8::from(x));
    u8: |x| f64::from(x);
    u16: |x| f64::from(x);
    u32: |x| f64::from(x);
    u64: |x| x as f64;
    usize: |x| x as f64;
    i32: |x| f64::from(x);
    i64: |x| x as f64;
}

impl<D> Data for Vec<D>
where
    [D]: Data,
{
    fn count(&self) -> usize {
        self.len()
    }
    fn value(&self, index: usize) -> f64 {
        self[..].value(index)
    }
}

impl<D, const N: usize> Data for [D; N]
where
    [D]: Data,
{
    fn count(&self) -> usize {
        N
    }
    fn value(&self, index: usize) -> f64 {
        self[..].value(index)
    }
}

impl Data for Series {
    fn count(&self) -> usize {
        self.len()
    }
    fn value(&self, index: usize) -> f64 {
        self.values()[index]
    }
}

impl<D: Data + ?Sized> Data for &D {
    fn count(&self) -> usize {
        (**self).count()
    }
    fn value(&self, index: usize) -> f64 {
        (**self).value(index)
    }
}
