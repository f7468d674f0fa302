//! What is looked for in a model: the mechanisms that come along, and those
//! of a user.

use std::fmt;
use std::sync::Arc;

use super::built_in;
use crate::error::{Error, Result};
use crate::mechanism::{Candidate, Extent, Mechanism, Role};
use crate::spelling::quoted;

/// Makes a mechanism whose priors suit an event.
type Maker = Arc<dyn Fn(&Extent) -> Box<dyn Mechanism> + Send + Sync>;

/// The mechanisms that a diagnosis weighs: those that come along, and a
/// user's own.
///
/// `Catalogue::default().with(|e| Box::new(Mine { extent: *e }))` has one more,
/// a type that is [`Candidate`] and [`Missing`](crate::mechanism::Missing),
/// under a name of its own.
#[derive(Clone, Default)]
pub struct Catalogue {
    further: Vec<Maker>,
}

impl fmt::Debug for Catalogue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Catalogue")
            .field("further", &self.further.len())
            .finish()
    }
}

impl Catalogue {
    /// With one mechanism more, made for the extent of each event that it is
    /// weighed for.
    #[must_use]
    pub fn with(
        mut self,
        make: impl Fn(&Extent) -> Box<dyn Mechanism> + Send + Sync + 'static,
    ) -> Self {
        self.further.push(Arc::new(make));
        self
    }

    /// Every mechanism that applies to an event of this extent and that a
    /// model with laws, noises and mechanisms of these names has not, variants
    /// one after the other; the user's own last.
    pub fn of(
        &self,
        extent: &Extent,
        blocks: &[String],
    ) -> Vec<Box<dyn Mechanism>> {
        let mut all = built_in(extent);
        all.extend(self.further.iter().map(|make| make(extent)));
        all.retain(|m| applies(m.as_ref(), blocks));
        all
    }

    /// Refuses mechanisms of a user that could not be told from others, or
    /// whose amount is not known.
    ///
    /// # Errors
    /// A name that is taken, or no amplitude as the first unknown.
    pub(crate) fn check(&self, extent: &Extent, taken: &[&str]) -> Result<()> {
        for make in &self.further {
            let own = make(extent);
            let name = own.name();
            if is_built_in(name) || taken.contains(&name) {
                return Err(Error::input(format!(
                    "a mechanism of one's own is called {name:?}, as \
                     something else in the catalogue; expected a name of its \
                     own: give it another"
                )));
            }
            let unknowns = own.unknowns();
            if unknowns.first().map(|u| u.role) != Some(Role::Amplitude) {
                return Err(Error::input(format!(
                    "the mechanism {name:?} has no amplitude as its first \
                     unknown; expected `Unknown::amplitude(..)` there, whose \
                     zero gives the model back"
                )));
            }
        }
        Ok(())
    }

    /// The mechanism that a label means; a name that has several variants
    /// means the first of them.
    ///
    /// # Errors
    /// A label of none, or of one that does not apply here; the message lists
    /// those that do.
    pub fn find(
        &self,
        label: &str,
        extent: &Extent,
        blocks: &[String],
    ) -> Result<Box<dyn Mechanism>> {
        let wanted = without_spaces(label);
        let is_it = |m: &dyn Mechanism| {
            wanted == m.name() || wanted == without_spaces(&m.label())
        };
        let mut here = self.of(extent, blocks);
        if let Some(i) = here.iter().position(|m| is_it(m.as_ref())) {
            return Ok(here.swap_remove(i));
        }
        let labels: Vec<String> = here.iter().map(|m| m.label()).collect();
        let elsewhere = self.of(&extent.of_everything(), &[]);
        let known = elsewhere.into_iter().find(|m| is_it(m.as_ref()));
        let why = match known {
            None => "is no mechanism",
            Some(m) if is_held(m.as_ref(), blocks) => {
                "is a term that the model's laws already have"
            }
            Some(m) if !applies(m.as_ref(), blocks) => {
                "changes what none of the model's laws has"
            }
            Some(_) => "has nothing to act on in this event",
        };
        Err(Error::input(format!(
            "{} {why}; expected one of {}: take one of them, or drop it",
            quoted(label),
            labels.join(", ")
        )))
    }
}

/// [`Catalogue::of`] the mechanisms that come along.
pub fn catalogue(
    extent: &Extent,
    blocks: &[String],
) -> Vec<Box<dyn Mechanism>> {
    Catalogue::default().of(extent, blocks)
}

/// [`Catalogue::find`] among the mechanisms that come along.
///
/// # Errors
/// As [`Catalogue::find`].
pub fn find(
    label: &str,
    extent: &Extent,
    blocks: &[String],
) -> Result<Box<dyn Mechanism>> {
    Catalogue::default().find(label, extent, blocks)
}

fn without_spaces(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).collect()
}

/// Whether a mechanism that comes along has this name.
pub(crate) fn is_built_in(name: &str) -> bool {
    built_in(&Extent::EVERYTHING).iter().any(|m| m.name() == name)
}

/// Whether a mechanism can be missing from a model with blocks of these names;
/// of no names any can.
pub(crate) fn applies(mechanism: &dyn Candidate, blocks: &[String]) -> bool {
    let needs = mechanism.needs();
    let has = |own: &String| needs.contains(&own.as_str());
    let can = needs.is_empty() || blocks.is_empty() || blocks.iter().any(has);
    can && !is_held(mechanism, blocks)
}

/// Whether a model with blocks of these names has the mechanism already, in
/// this variant or another.
pub(crate) fn is_held(mechanism: &dyn Candidate, blocks: &[String]) -> bool {
    let also = mechanism.contained_in();
    blocks
        .iter()
        .any(|own| own == mechanism.name() || also.contains(&own.as_str()))
}
