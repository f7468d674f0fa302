//! The plain structure that every format is written from.

use crate::draws::Loo;
use crate::error::{Error, Result};

/// The numbers or words of a variable, its last dimension fastest.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Values {
    /// Real numbers.
    Real(Vec<f64>),
    /// Counts and indices.
    Whole(Vec<i64>),
    /// Names.
    Words(Vec<String>),
}

impl Values {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Whole(values) => values.len(),
            Self::Words(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The real numbers; none where they are something else.
    pub fn reals(&self) -> &[f64] {
        match self {
            Self::Real(values) => values,
            _ => &[],
        }
    }
}

/// A named array. One that is called as its only dimension is a coordinate:
/// it says what the places along that dimension are.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// The unit of its values; "1" for pure numbers, empty for names.
    pub unit: String,
    /// What it is, in a few words.
    pub about: String,
    /// The names of its dimensions.
    pub dimensions: Vec<String>,
    /// How long each is.
    pub shape: Vec<usize>,
    /// Its values.
    pub values: Values,
}

impl Variable {
    /// A variable with dimensions of these names and lengths.
    ///
    /// ```
    /// use couloir::export::{Values, Variable};
    /// let values = || Values::Real(vec![0.3, 0.2, 0.4]);
    /// let mu = Variable::new("mu", "1", &[("draw", 3)], values())?;
    /// assert_eq!((mu.shape, mu.values.len()), (vec![3], 3));
    /// assert!(Variable::new("mu", "1", &[("draw", 4)], values()).is_err());
    /// # Ok::<(), couloir::Error>(())
    /// ```
    ///
    /// # Errors
    /// Another number of values than the dimensions have places.
    pub fn new(
        name: impl Into<String>,
        unit: impl Into<String>,
        dimensions: &[(&str, usize)],
        values: Values,
    ) -> Result<Self> {
        let (name, unit) = (name.into(), unit.into());
        let shape: Vec<usize> = dimensions.iter().map(|d| d.1).collect();
        let places: usize = shape.iter().product();
        if places != values.len() {
            return Err(Error::inference(format!(
                "{name}: {} values do not fill an array of {shape:?}",
                values.len()
            )));
        }
        let dimensions = dimensions.iter().map(|d| d.0.to_owned()).collect();
        let about = String::new();
        Ok(Self { name, unit, about, dimensions, shape, values })
    }

    /// The same with what it is, in a few words.
    #[must_use]
    pub fn about(self, about: impl Into<String>) -> Self {
        Self { about: about.into(), ..self }
    }

    /// The places along a dimension, counted from 0.
    pub(super) fn counted(name: &str, length: usize) -> Result<Self> {
        let places = (0..length as i64).collect();
        Self::new(name, "1", &[(name, length)], Values::Whole(places))
    }

    /// Whether it says what the places along a dimension are.
    pub fn is_coordinate(&self) -> bool {
        self.dimensions == [self.name.as_str()]
    }
}

/// Variables that belong together; those of one dimension name have one
/// length along it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Group {
    /// Its name, one of those that ArviZ knows.
    pub name: &'static str,
    /// What is to be known of it, by key.
    pub attributes: Vec<(String, String)>,
    /// Its variables, coordinates among them.
    pub variables: Vec<Variable>,
}

impl Group {
    /// A group of these variables; of coordinates that several bring along,
    /// the first is kept.
    pub(super) fn new(name: &'static str, all: Vec<Variable>) -> Self {
        let mut variables: Vec<Variable> = Vec::new();
        for variable in all {
            if !variables.iter().any(|one| one.name == variable.name) {
                variables.push(variable);
            }
        }
        Self { name, attributes: Vec::new(), variables }
    }
}

/// How well the model predicts values left out one by one, from the draws
/// that `log_likelihood` is of.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LeftOut {
    /// The prediction.
    pub loo: Loo,
    /// How many draws it is made of.
    pub draws: usize,
    /// How many independent draws each of them is worth.
    pub efficiency: f64,
}

impl LeftOut {
    /// A prediction from so many draws, each worth `efficiency` independent
    /// ones.
    pub fn new(loo: Loo, draws: usize, efficiency: f64) -> Self {
        Self { loo, draws, efficiency }
    }
}

/// A posterior with what it says of the data: ArviZ's InferenceData.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct InferenceData {
    /// What is to be known of all: version, command, seed, by key.
    pub attributes: Vec<(String, String)>,
    /// Its groups.
    pub groups: Vec<Group>,
    /// Leave-one-out prediction, where there is a `log_likelihood`.
    pub left_out: Option<LeftOut>,
}

impl InferenceData {
    /// The group of this name.
    pub fn group(&self, name: &str) -> Option<&Group> {
        self.groups.iter().find(|group| group.name == name)
    }

    /// A variable of a group.
    pub fn variable(&self, group: &str, name: &str) -> Option<&Variable> {
        let mut variables = self.group(group)?.variables.iter();
        variables.find(|variable| variable.name == name)
    }

    /// The same with one more attribute.
    #[must_use]
    pub fn with(mut self, key: &str, value: impl Into<String>) -> Self {
        self.attributes.push((key.to_owned(), value.into()));
        self
    }
}
