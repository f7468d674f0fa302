//! Any of the distributions, as event files write it: "Gamma(9, 0.03)".

use std::fmt;

use super::{
    Beta, Cauchy, Distribution, Exponential, Flat, Gamma, HalfCauchy,
    HalfNormal, InverseGamma, LogNormal, Normal, Prior, StudentT, Support,
    Uniform,
};
use crate::error::{Error, Result};
use crate::scalar::{Kind, Plain, Real};
use crate::seed::Rng;
use crate::spelling::{nearest, quoted};

/// What an argument has to be.
#[derive(Debug, Clone, Copy)]
enum Need {
    Finite,
    Positive,
    /// Above the first argument, by a finite number.
    AboveFirst,
}

/// The largest size of an argument, and one by the smallest: far beyond what
/// anybody knows of a slope, and small enough for densities to be numbers.
const LARGEST: f64 = 1e15;

/// A distribution as texts know it.
struct Family {
    name: &'static str,
    arguments: &'static [(&'static str, Need)],
    build: fn(&[f64]) -> Option<AnyPrior>,
}

/// The list of distributions, with what their arguments have to be, and all
/// that follows from the list.
macro_rules! families {
    (@number $argument:ident) => { f64 };
    ($($name:ident($($argument:ident: $need:ident),*);)*) => {
        /// One of the distributions, with numbers as arguments.
        ///
        /// ```
        /// use couloir::prior::{AnyPrior, Distribution};
        /// use couloir::scalar::{Plain, Real};
        /// # fn main() -> couloir::Result<()> {
        /// let prior = AnyPrior::parse("Exponential( 2 )")?;
        /// assert_eq!(prior, AnyPrior::Exponential(2.0));
        /// assert_eq!(prior.to_string(), "Exponential(2)");
        /// assert_eq!((prior.name(), prior.arguments()), ("Exponential", vec![2.0]));
        /// assert_eq!(prior.quantile(0.5), Some(2.0 * 2.0_f64.ln()));
        /// let x = Real::<Plain>::new(3.0);
        /// assert_eq!(prior.log_density(x).value(), -1.5 - 2.0_f64.ln());
        /// # Ok(())
        /// # }
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[non_exhaustive]
        pub enum AnyPrior {
            $(
                #[doc = concat!(
                    "[`", stringify!($name), "`]: ",
                    stringify!($name($($argument),*)), "."
                )]
                $name($(families!(@number $argument)),*),
            )*
        }

        /// The distributions: their names and numbers of arguments.
        ///
        /// ```
        /// use couloir::prior::NAMES;
        /// assert!(NAMES.contains(&("Normal", 2)));
        /// ```
        pub const NAMES: &[(&str, usize)] = &[
            $((
                stringify!($name),
                <[&str]>::len(&[$(stringify!($argument)),*]),
            ),)*
        ];

        const FAMILIES: &[Family] = &[$(Family {
            name: stringify!($name),
            arguments: &[$((stringify!($argument), Need::$need)),*],
            build: |values| match *values {
                [$($argument),*] => Some(AnyPrior::$name($($argument),*)),
                _ => None,
            },
        },)*];

        impl AnyPrior {
            /// Its name, such as "Gamma".
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$name(..) => stringify!($name),)*
                }
            }

            /// Its arguments, in order.
            pub fn arguments(&self) -> Vec<f64> {
                match *self {
                    $(Self::$name($($argument),*) => vec![$($argument),*],)*
                }
            }

            /// [`Prior::quantile`], without a kind of number to name.
            pub fn quantile(&self, p: f64) -> Option<f64> {
                match *self {
                    $(Self::$name($($argument),*) =>
                        $name::<Plain>::new($($argument),*).quantile(p),)*
                }
            }

            /// [`Distribution::draw`], without a kind of number to name.
            pub fn draw(&self, rng: &mut Rng) -> Option<f64> {
                match *self {
                    $(Self::$name($($argument),*) =>
                        $name::<Plain>::new($($argument),*).draw(rng),)*
                }
            }
        }

        impl<K: Kind> Distribution<K> for AnyPrior {
            #[inline]
            fn log_density(&self, x: Real<K>) -> Real<K> {
                match *self {
                    $(Self::$name($($argument),*) =>
                        $name::<K>::new($($argument),*).log_density(x),)*
                }
            }

            fn draw(&self, rng: &mut Rng) -> Option<f64> {
                self.draw(rng)
            }
        }

        impl<K: Kind> Prior<K> for AnyPrior {
            fn support(&self) -> Support<K> {
                match *self {
                    $(Self::$name($($argument),*) =>
                        $name::<K>::new($($argument),*).support(),)*
                }
            }

            fn is_proper(&self) -> bool {
                self.is_proper()
            }

            fn quantile(&self, p: f64) -> Option<f64> {
                self.quantile(p)
            }
        }
    };
}

families! {
    Normal(mean: Finite, sd: Positive);
    LogNormal(mean: Finite, sd: Positive);
    Gamma(shape: Positive, scale: Positive);
    InverseGamma(shape: Positive, scale: Positive);
    Exponential(mean: Positive);
    Uniform(low: Finite, high: AboveFirst);
    Beta(a: Positive, b: Positive);
    HalfNormal(scale: Positive);
    HalfCauchy(scale: Positive);
    Cauchy(location: Finite, scale: Positive);
    StudentT(freedom: Positive, location: Finite, scale: Positive);
    Flat();
}

impl AnyPrior {
    /// Reads a text such as "Gamma(9, 0.03)"; spaces are free, case is not.
    ///
    /// ```
    /// use couloir::prior::AnyPrior;
    /// let error = AnyPrior::parse("Gama(9, 0.03)").unwrap_err();
    /// assert!(error.is_input());
    /// assert!(error.to_string().contains("did you mean \"Gamma\"?"));
    /// ```
    pub fn parse(text: &str) -> Result<Self> {
        read(text).map_err(|e| {
            e.within(format_args!("prior {}", quoted(text)))
                .on_page("reference/priors")
        })
    }

    /// Whether the density has an integral: all but `Flat()`.
    ///
    /// ```
    /// use couloir::prior::AnyPrior;
    /// assert!(!AnyPrior::Flat().is_proper());
    /// ```
    pub fn is_proper(&self) -> bool {
        !matches!(self, Self::Flat())
    }

    /// The place on the real line of a value: infinite or not a number outside
    /// the support.
    pub(crate) fn line_of(&self, value: f64) -> f64 {
        <Self as Prior<Plain>>::support(self).to_line(value)
    }

    /// The value at a place on the real line.
    pub(crate) fn value_at(&self, z: f64) -> f64 {
        let support = <Self as Prior<Plain>>::support(self);
        support.from_line(Real::new(z)).0.value()
    }
}

impl fmt::Display for AnyPrior {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}(", self.name())?;
        for (i, value) in self.arguments().into_iter().enumerate() {
            let comma = if i > 0 { ", " } else { "" };
            let size = value.abs();
            if size == 0.0 || (1e-4..1e9).contains(&size) {
                write!(f, "{comma}{value}")?;
            } else {
                write!(f, "{comma}{value:e}")?;
            }
        }
        f.write_str(")")
    }
}

impl Family {
    /// How it is written: "Gamma(shape, scale)".
    fn form(&self) -> String {
        let names: Vec<_> = self.arguments.iter().map(|a| a.0).collect();
        format!("{}({})", self.name, names.join(", "))
    }

    /// The distribution whose arguments are `texts`.
    fn of_texts(&self, texts: &[&str]) -> Result<AnyPrior> {
        let values = texts
            .iter()
            .zip(self.arguments)
            .map(|(text, (argument, _))| {
                text.parse().map_err(|_| {
                    Error::input(format!(
                        "{argument} of {} is {}, expected a number",
                        self.form(),
                        quoted(text)
                    ))
                })
            })
            .collect::<Result<Vec<f64>>>()?;
        if texts.len() == self.arguments.len() {
            self.check(&values)?;
            if let Some(prior) = (self.build)(&values) {
                return Ok(prior);
            }
        }
        Err(Error::input(format!(
            "found {}, expected {}: write it as {}",
            plural(texts.len()),
            self.arguments.len(),
            self.form()
        )))
    }

    /// An error unless `values` are possible arguments.
    fn check(&self, values: &[f64]) -> Result<()> {
        let is_wild = |x: &&f64| {
            x.abs() > LARGEST || (**x != 0.0 && x.abs() < 1.0 / LARGEST)
        };
        if let Some(wild) = values.iter().find(is_wild) {
            return Err(Error::input(format!(
                "an argument of {} is {wild:e}, expected 0, or a size from \
                 {:e} to {LARGEST:e}",
                self.form(),
                1.0 / LARGEST
            )));
        }
        for (&value, &(name, need)) in values.iter().zip(self.arguments) {
            let (met, expected) = match need {
                Need::Finite => (value.is_finite(), "a finite number".into()),
                Need::Positive => (
                    super::positive(value),
                    "a finite number above 0".to_string(),
                ),
                Need::AboveFirst => (
                    super::positive(value - values[0]),
                    format!(
                        "a finite number above {} = {}",
                        self.arguments[0].0, values[0]
                    ),
                ),
            };
            if !met {
                return Err(Error::input(format!(
                    "{name} of {} is {value}, expected {expected}",
                    self.form()
                )));
            }
        }
        Ok(())
    }
}

/// The distribution that `text` names.
fn read(text: &str) -> Result<AnyPrior> {
    let (name, inner) = text
        .trim()
        .strip_suffix(')')
        .and_then(|call| call.split_once('('))
        .ok_or_else(|| {
            Error::input(
                "expected a distribution with its arguments in parentheses; \
                 write it as in \"Gamma(9, 0.03)\"",
            )
        })?;
    let name = name.trim();
    let family = FAMILIES
        .iter()
        .find(|family| family.name == name)
        .ok_or_else(|| unknown(name))?;
    let texts: Vec<_> = match inner.trim() {
        "" => Vec::new(),
        inner => inner.split(',').map(str::trim).collect(),
    };
    family.of_texts(&texts)
}

/// "1 argument", "2 arguments".
fn plural(count: usize) -> String {
    format!("{count} argument{}", if count == 1 { "" } else { "s" })
}

/// The error for a name that is no distribution's.
fn unknown(name: &str) -> Error {
    let names: Vec<_> = NAMES.iter().map(|n| n.0).collect();
    let meant = nearest(name, &names)
        .map_or(".".to_owned(), |n| format!("; did you mean \"{n}\"?"));
    Error::input(format!(
        "there is no distribution {}{meant} The distributions are {}",
        quoted(name),
        names.join(", ")
    ))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The named distribution with any arguments, possible or not.
    #[allow(clippy::unwrap_used)]
    pub(in super::super) fn build(name: &str, values: &[f64]) -> AnyPrior {
        let family = FAMILIES.iter().find(|f| f.name == name).unwrap();
        (family.build)(values).unwrap()
    }

    #[test]
    fn only_a_name_that_is_near_is_meant() {
        let said = |text| AnyPrior::parse(text).unwrap_err().to_string();
        let meant = said("gama(9, 0.03)");
        assert!(meant.contains("did you mean \"Gamma\"?"), "{meant}");
        let none = said("Truncated(Normal(0, 1), 0, 1)");
        assert!(none.contains("\"Truncated\". The distr"), "{none}");
    }
}
