//! Noises by their names in event files.

use std::marker::PhantomData;

use super::entry::{NoiseEntry, NoiseFor};
use super::inferred::INFER;
use super::summed::SumEntry;
use super::{
    Ar, Growth, Iid, Matern32, Noise, Ou, Part, Student, Tails, White, Whole,
};
use crate::block::{Block, Field};
use crate::error::{Error, Stop};
use crate::scalar::{Kind, Real};
use crate::spelling::{nearest, quoted};

/// The longest list a noise may have: an order above says that the residuals
/// are not noise, and costs in the order cubed where values are missing.
const LONGEST: usize = 20;

/// What a block of the catalogue is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    /// A noise by itself only.
    Alone,
    /// A noise by itself, and a summand.
    Either,
    /// A summand only.
    Summand,
}

/// Lists the blocks: each is one entry here and one file.
macro_rules! catalogue {
    ($($role:ident: $($noise:ident),*;)*) => {
        const NOISES: &[Listed] = &[$($(Listed {
            name: <$noise<f64> as Block<f64>>::NAME,
            fields: <$noise<f64> as Block<f64>>::FIELDS,
            role: Role::$role,
            open: |length| Box::new(Entry {
                length,
                block: PhantomData::<fn() -> $noise<f64>>,
            }),
        }),*),*];

        $($(catalogue!(@ $role $noise);)*)*
    };
    (@ $role:ident $noise:ident) => {
        impl<K: Kind> NoiseFor<K> for Entry<$noise<f64>> {
            fn with(
                &self,
                values: &[Real<K>],
                then: &mut dyn FnMut(&dyn Noise<K>),
            ) -> Result<(), Stop> {
                self.admit(values.len())?;
                let block = $noise::<Real<K>>::from_values(values);
                catalogue!(@noise $role block then);
                Ok(())
            }

            fn part(
                &self,
                values: &[Real<K>],
                then: &mut dyn FnMut(&dyn Part<K>),
            ) -> Result<(), Stop> {
                self.admit(values.len())?;
                let block = $noise::<Real<K>>::from_values(values);
                catalogue!(@part $role block then)
            }
        }

        impl NoiseEntry for Entry<$noise<f64>> {
            fn name(&self) -> String {
                self.full_name()
            }

            fn parameters(&self) -> Vec<(String, Field)> {
                self.all_parameters()
            }

            fn dimension(&self) -> usize {
                self.expected()
            }

            fn blocks(&self, say: &mut dyn FnMut(&'static str)) {
                say(<$noise<f64> as Block<f64>>::NAME);
            }

            fn terms(&self) -> Vec<(&'static str, Vec<Field>)> {
                let fields = self.all_parameters().into_iter();
                let fields = fields.map(|(_, field)| field).collect();
                vec![(<$noise<f64> as Block<f64>>::NAME, fields)]
            }
        }
    };
    (@noise Summand $block:ident $then:ident) => {
        $then(&Whole::of(&$block))
    };
    (@noise $role:ident $block:ident $then:ident) => { $then(&$block) };
    (@part Alone $block:ident $then:ident) => {{
        let (_, _) = ($block, $then);
        Err(Stop::Fail(Error::inference("not a summand of a noise")))
    }};
    (@part $role:ident $block:ident $then:ident) => {{
        $then(&$block);
        Ok(())
    }};
}

catalogue! {
    Alone: Iid, Student;
    Either: Ar, Ou, Matern32, White;
    Summand: Tails, Growth;
}

/// Whether a noise of the catalogue has this name.
pub(crate) fn is_noise(name: &str) -> bool {
    NOISES.iter().any(|noise| noise.name == name)
}

/// A noise of the catalogue.
struct Listed {
    name: &'static str,
    fields: &'static [Field],
    role: Role,
    open: fn(usize) -> Box<dyn NoiseEntry>,
}

impl Listed {
    fn has_list(&self) -> bool {
        self.fields.iter().any(|f| f.list)
    }

    /// What to write instead of it in a sum.
    fn no_summand(&self) -> Option<&'static str> {
        match (self.role, self.name) {
            (Role::Alone, "student") => {
                Some("in a sum write \"tails\" for tails as heavy")
            }
            (Role::Alone, _) => Some("in a sum write \"white\" for it"),
            _ => None,
        }
    }

    /// How an event file writes it.
    fn pattern(&self) -> String {
        let argument = if self.has_list() { "(k)" } else { "" };
        format!("{}{argument}", self.name)
    }
}

/// The block `B` with lists of that length.
#[derive(Debug)]
struct Entry<B> {
    length: usize,
    block: PhantomData<fn() -> B>,
}

impl<B: Block<f64>> Entry<B> {
    fn full_name(&self) -> String {
        let list = B::FIELDS.iter().any(|f| f.list);
        let argument =
            if list { format!("({})", self.length) } else { String::new() };
        format!("{}{argument}", B::NAME)
    }

    fn all_parameters(&self) -> Vec<(String, Field)> {
        let of = |field: &Field| -> Vec<(String, Field)> {
            match (field.list, self.length) {
                (false, _) | (true, 1) => {
                    vec![(field.name.to_owned(), *field)]
                }
                (true, length) => (1..=length)
                    .map(|i| (format!("{}[{i}]", field.name), *field))
                    .collect(),
            }
        };
        B::FIELDS.iter().flat_map(of).collect()
    }

    /// How many values it takes.
    fn expected(&self) -> usize {
        let lists = B::FIELDS.iter().filter(|f| f.list).count();
        B::FIELDS.len() - lists + lists * self.length
    }

    fn admit(&self, found: usize) -> Result<(), Stop> {
        let expected = self.expected();
        if found == expected {
            return Ok(());
        }
        Err(Stop::Fail(Error::inference(format!(
            "{} takes {expected} values, and was given {found}",
            self.full_name()
        ))))
    }
}

/// How event files write the blocks of noises there are: "iid", "ar(k)" and
/// so on.
pub fn names() -> Vec<String> {
    NOISES.iter().map(Listed::pattern).collect()
}

/// The noise that an event file names: "iid", "ar(2)", "student", or a sum
/// such as "matern32 + white".
///
/// ```
/// let noise = couloir::noise::parse("ar(2) + white")?;
/// let names: Vec<String> =
///     noise.parameters().into_iter().map(|(name, _)| name).collect();
/// assert_eq!(names, ["phi[1]", "phi[2]", "ar.sigma2", "white.sigma2"]);
/// let error = couloir::noise::parse("studnet").unwrap_err();
/// assert!(error.to_string().contains("did you mean \"student\"?"));
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// A name that is not known, a sum of what does not add up.
pub fn parse(text: &str) -> crate::Result<Box<dyn NoiseEntry>> {
    summed(text).map_err(|error| error.on_page("reference/noises"))
}

fn summed(text: &str) -> crate::Result<Box<dyn NoiseEntry>> {
    let terms: Vec<&str> = text.split('+').map(str::trim).collect();
    if let [term] = terms[..] {
        let (noise, entry) = block(term)?;
        return match noise.role {
            Role::Summand => Err(Error::input(format!(
                "{} shapes errors that another block makes; write it beside \
                 one, as in \"white + {}\"",
                quoted(term),
                noise.name
            ))),
            _ => Ok(entry),
        };
    }
    let mut parts = Vec::with_capacity(terms.len());
    let mut known: Vec<&Listed> = Vec::new();
    for term in terms {
        let (noise, entry) = block(term)?;
        if let Some(mend) = noise.no_summand() {
            return Err(Error::input(format!(
                "\"{}\" stands by itself: {mend}",
                noise.name
            )));
        }
        if known.iter().any(|other| other.name == noise.name) {
            return Err(Error::input(format!(
                "\"{}\" is in the noise twice; expected each block once: \
                 drop one of them",
                noise.name
            )));
        }
        known.push(noise);
        parts.push(entry);
    }
    if known.iter().all(|noise| noise.role == Role::Summand) {
        return Err(Error::input(format!(
            "{} shapes errors that no block makes; add one, such as white",
            quoted(text)
        )));
    }
    Ok(Box::new(SumEntry(parts)))
}

/// A block by its name and its order.
fn block(text: &str) -> crate::Result<(&'static Listed, Box<dyn NoiseEntry>)> {
    if text == INFER {
        return Err(Error::input(
            "\"infer\" is whichever noise is likely, by itself and for \
             `calibrate` and `diagnose` only; expected one noise: name it, \
             as in \"ar(1)\"",
        ));
    }
    let (name, argument) = match text.split_once('(') {
        None => (text, None),
        Some((name, rest)) => match rest.strip_suffix(')') {
            Some(argument) => (name.trim_end(), Some(argument.trim())),
            None => {
                return Err(Error::input(format!(
                    "{} opens a bracket and does not close it; write it as \
                     in \"ar(2)\"",
                    quoted(text)
                )));
            }
        },
    };
    let Some(noise) = NOISES.iter().find(|n| n.name == name) else {
        return Err(unknown(name));
    };
    Ok((noise, (noise.open)(length(noise, argument)?)))
}

/// How long the lists of the noise are, from what stands in its brackets.
fn length(noise: &Listed, argument: Option<&str>) -> crate::Result<usize> {
    let name = noise.name;
    match (noise.has_list(), argument) {
        (false, None) => Ok(0),
        (false, Some(found)) => Err(Error::input(format!(
            "\"{name}\" takes no argument, and has {}; write \"{name}\"",
            quoted(found)
        ))),
        (true, None) => Err(Error::input(format!(
            "\"{name}\" needs its order; write \"{name}(1)\" for the first"
        ))),
        (true, Some(found)) => match found.parse() {
            Ok(k @ 1..=LONGEST) => Ok(k),
            _ => Err(Error::input(format!(
                "the order of \"{name}\" is a whole number from 1 to \
                 {LONGEST}, and {} is none; write \"{name}(1)\" for the first",
                quoted(found)
            ))),
        },
    }
}

fn unknown(found: &str) -> Error {
    let known: Vec<_> = NOISES.iter().map(|n| n.name).collect();
    let meant = nearest(found, &known)
        .and_then(|name| NOISES.iter().find(|n| n.name == name));
    let mend = meant.map_or(String::new(), |n| {
        format!("; did you mean \"{}\"?", n.pattern())
    });
    Error::input(format!(
        "there is no noise {}, there are {}{mend}",
        quoted(found),
        names().join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Grid;
    use crate::scalar::{Grad, Plain};

    #[test]
    fn names_and_parameters_are_those_of_the_blocks() {
        let listed = |text: &str| -> Vec<String> {
            let entry = parse(text).unwrap();
            assert_eq!(entry.name(), text);
            entry.parameters().into_iter().map(|(name, _)| name).collect()
        };
        let all = "iid, student, ar(k), ou, matern32, white, tails, growth";
        assert_eq!(names().join(", "), all);
        assert_eq!(listed("iid"), ["sigma2"]);
        assert_eq!(listed("ar(1)"), ["phi", "sigma2"]);
        assert_eq!(listed("ar(3)"), ["phi[1]", "phi[2]", "phi[3]", "sigma2"]);
        assert_eq!(listed("student"), ["dof", "scale"]);
        assert_eq!(parse(" ar( 20 ) ").unwrap().name(), "ar(20)");
        let sum = "matern32 + white + tails + growth";
        let own = ["sd_matern", "time_matern", "sigma2", "nu", "growth"];
        assert_eq!(listed(sum), own);
        assert_eq!(parse("ou+white").unwrap().name(), "ou + white");
        assert_eq!(parse(sum).unwrap().dimension(), 5);
    }

    #[test]
    fn wrong_names_are_answered_with_a_mend() {
        for (text, answer) in [
            ("idd", "no noise \"idd\", there are iid, student, ar(k), ou"),
            ("idd", "; did you mean \"iid\"?"),
            ("ar", "write \"ar(1)\""),
            ("ra(2)", "there is no noise \"ra\""),
            ("ar(0)", "from 1 to 20, and \"0\" is none"),
            ("ar(21)", "from 1 to 20, and \"21\" is none"),
            ("ar(-1)", "\"-1\" is none"),
            ("ar(2", "does not close it"),
            ("iid(3)", "takes no argument, and has \"3\""),
            ("", "there is no noise \"\""),
            ("something", "there are iid, student, ar(k)"),
            ("tails", "as in \"white + tails\""),
            ("tails + growth", "add one, such as white"),
            ("iid + ou", "in a sum write \"white\""),
            ("ou + student", "in a sum write \"tails\""),
            ("ou + white + ou", "\"ou\" is in the noise twice"),
            ("ou + ", "there is no noise \"\""),
            ("ou + matern", "did you mean \"matern32\"?"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.is_input());
            assert!(error.to_string().contains(answer), "{error}");
        }
        assert!(!parse("something").unwrap_err().to_string().contains("mean"));
    }

    #[test]
    fn an_entry_is_the_block() {
        let at = Grid::new(vec![0.0, 1.0, 2.0], None);
        let values = [0.5, -0.2, 2.0];
        let block = Ar::from_values(&values.map(Real::<Plain>::new));
        let expected =
            block.log_likelihood(&at, &values.map(Real::new)).unwrap();
        let entry = parse("ar(2)").unwrap();
        let mut found = f64::NAN;
        let x = values.map(Real::<Grad<4>>::new);
        entry
            .with(&x, &mut |noise| {
                found = noise.log_likelihood(&at, &x).unwrap().value();
            })
            .unwrap();
        assert!((found - expected.value()).abs() < 1e-12);
        assert!(entry.with(&x[..2], &mut |_| panic!("called")).is_err());
    }
}
