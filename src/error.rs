//! What can go wrong, as one opaque type with predicates.
//!
//! The reasons are few and a caller acts on two of them only: input that a
//! person has to mend ([`Error::is_input`]) and anything else. Messages name
//! the place, what was found, what was expected, and the mend.

use std::fmt;

/// An error of couloir.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    kind: Kind,
    message: String,
    page: Option<&'static str>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Input,
    Inference,
    System,
}

/// A result with couloir's error.
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    fn new(kind: Kind, message: String) -> Self {
        Self { kind, message, page: None }
    }

    /// Input that somebody has to mend: a file, a key, an argument.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(Kind::Input, message.into())
    }

    /// An inference that could not be carried out as asked.
    pub fn inference(message: impl Into<String>) -> Self {
        Self::new(Kind::Inference, message.into())
    }

    /// The machine refused: a file could not be written, say.
    pub fn system(message: impl Into<String>) -> Self {
        Self::new(Kind::System, message.into())
    }

    /// The same error with the place put before its message.
    #[must_use]
    pub fn within(mut self, place: impl fmt::Display) -> Self {
        self.message = format!("{place}: {}", self.message);
        self
    }

    /// The same error with the page of the manual that helps, where none is
    /// named yet.
    #[must_use]
    pub(crate) fn on_page(mut self, page: &'static str) -> Self {
        self.page = self.page.or(Some(page));
        self
    }

    /// The page of the manual that helps, where there is one: `formats` is
    /// `manual/src/formats.md`.
    ///
    /// ```
    /// use couloir::prior::AnyPrior;
    /// let error = AnyPrior::parse("Gama(9, 0.03)").unwrap_err();
    /// assert_eq!(error.page(), Some("reference/priors"));
    /// ```
    pub fn page(&self) -> Option<&'static str> {
        self.page
    }

    /// Whether the input has to be mended.
    pub fn is_input(&self) -> bool {
        self.kind == Kind::Input
    }

    /// Whether an inference failed.
    pub fn is_inference(&self) -> bool {
        self.kind == Kind::Inference
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

/// Why the evaluation of a model stopped short of a density.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    /// For these parameter values there is no such flow or noise: the
    /// density is zero, and the case is counted.
    Reject(&'static str),
    /// Something is wrong that other values would not mend: the run ends.
    Fail(Error),
}

impl Stop {
    /// The same with the place put before a failure's message.
    #[must_use]
    pub fn within(self, place: impl fmt::Display) -> Self {
        match self {
            Self::Reject(reason) => Self::Reject(reason),
            Self::Fail(error) => Self::Fail(error.within(place)),
        }
    }
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        Self::Fail(error)
    }
}

/// What the body of a model returns.
pub type Outcome = std::result::Result<(), Stop>;
