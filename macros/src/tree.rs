//! A model as the user wrote it: what `parse` makes and `expand` reads.

use proc_macro2::{Ident, Span, TokenStream, TokenTree};
use syn::punctuated::Punctuated;
use syn::{Expr, ItemStruct, Path, Token};

/// Everything between the braces of `model!`.
pub(crate) struct Source {
    /// The struct; `None` where it is missing.
    pub(crate) structure: Option<ItemStruct>,
    /// Whether there was a struct that could not be read.
    pub(crate) broken_structure: bool,
    /// The lines between the struct and the likelihood.
    pub(crate) lines: Vec<Line>,
    /// The likelihoods; a model has one.
    pub(crate) bodies: Vec<Body>,
}

/// One line between the struct and the likelihood.
pub(crate) enum Line {
    /// `name ~ ..;`
    Declaration(Box<Declaration>),
    /// `let ..;`
    Let(Let),
    /// `keep ..;`
    Keep(Box<Keep>),
    /// A line with an error.
    Broken(Broken),
}

/// What is left of a line with an error.
pub(crate) struct Broken {
    /// The name that it declares, where that could be read.
    pub(crate) name: Option<Ident>,
    /// All behind the name; what it mentions still counts as used.
    pub(crate) tokens: TokenStream,
    /// The parts of the right side that were understood.
    pub(crate) parts: Vec<Right>,
}

/// An ordinary `let` among the declarations.
pub(crate) struct Let {
    /// The names it binds.
    pub(crate) names: Vec<Ident>,
    /// What stands behind its `=`.
    pub(crate) value: TokenStream,
    /// The whole statement.
    pub(crate) statement: TokenStream,
}

/// `keep name = ..;`, `keep name ~ ..;`, or the same of `name[index]`
pub(crate) struct Keep {
    pub(crate) name: Ident,
    pub(crate) index: Option<Expr>,
    pub(crate) right: Kept,
}

/// What is kept.
pub(crate) enum Kept {
    /// `= value`
    Value(Expr),
    /// `~ Distribution(..)`
    Drawn(Distribution),
}

/// `name ~ ..;`, `name[n] ~ ..;` or `name[i in 0..n] ~ ..;`
pub(crate) struct Declaration {
    pub(crate) name: Ident,
    pub(crate) count: Count,
    pub(crate) right: Right,
    /// What stands behind `given`.
    pub(crate) given: Option<Expr>,
}

/// How many are declared at once.
pub(crate) enum Count {
    One,
    /// `[n]`
    Vector(Expr),
    /// `[index in range]`
    Each {
        index: Ident,
        range: Expr,
    },
}

/// The right side of a declaration.
pub(crate) enum Right {
    Distribution(Distribution),
    /// At least one block; several are added.
    Blocks(Vec<Term>),
}

/// `Name(arguments)` or `path::to::Name(arguments)`.
pub(crate) struct Distribution {
    pub(crate) path: Path,
    pub(crate) arguments: Punctuated<Expr, Token![,]>,
}

/// `Name { fields }`
pub(crate) struct Term {
    pub(crate) path: Path,
    pub(crate) fields: Vec<Field>,
}

/// One field of a block.
pub(crate) struct Field {
    pub(crate) name: Ident,
    pub(crate) value: Value,
    /// The name of its unknown in draws and summaries.
    pub(crate) label: String,
}

/// What a field is given.
pub(crate) enum Value {
    /// `: Prior(..)`
    Prior(Distribution),
    /// `: [Prior(..), Prior(..)]`
    Priors(Vec<Distribution>),
    /// `: [Prior(..); count]`
    Repeated(Distribution, Expr),
    /// `= value`
    Known(Expr),
    /// Something with an error.
    Broken(TokenStream),
}

/// `likelihood { .. }`
pub(crate) struct Body {
    /// The word `likelihood`.
    pub(crate) keyword: Ident,
    /// Where its braces stand.
    pub(crate) braces: Span,
    /// Everything inside, as written.
    pub(crate) tokens: TokenStream,
    /// The same with the `~` lines understood.
    pub(crate) pieces: Vec<Piece>,
}

/// A piece of the likelihood's body.
pub(crate) enum Piece {
    /// Ordinary Rust, passed on untouched.
    Token(TokenTree),
    /// `{ .. }`
    Braces(Span, Vec<Piece>),
    /// A `keep` line.
    Keep(Box<Keep>),
    /// `log_density += ..`, with the word.
    Increment(Ident, Box<Expr>),
    /// A `~` line.
    Observation(Box<Observation>),
    /// A `~` line with an error, and its right side where that has none.
    Broken(Option<Box<Sampling>>),
}

/// `data ~ ..;` in the likelihood.
pub(crate) struct Observation {
    pub(crate) data: Expr,
    pub(crate) tilde: Span,
    pub(crate) law: Sampling,
}

/// How recorded data come about.
pub(crate) enum Sampling {
    /// `prediction + noise`
    Noise { prediction: Box<Expr>, noise: Box<Expr> },
    /// `Distribution(..)`, value by value.
    Distribution(Distribution),
}

impl Line {
    /// The name that a declaration gives, even where the rest is broken.
    pub(crate) fn declared(&self) -> Option<&Ident> {
        match self {
            Self::Declaration(declaration) => Some(&declaration.name),
            Self::Broken(broken) => broken.name.as_ref(),
            Self::Let(_) | Self::Keep(_) => None,
        }
    }
}

impl Declaration {
    /// The blocks on its right; none if it is a distribution.
    pub(crate) fn terms(&self) -> &[Term] {
        self.right.terms()
    }
}

impl Right {
    /// The blocks in it.
    pub(crate) fn terms(&self) -> &[Term] {
        match self {
            Self::Blocks(terms) => terms,
            Self::Distribution(_) => &[],
        }
    }
}

impl Value {
    /// Whether the field is unknown, with a prior.
    pub(crate) fn is_unknown(&self) -> bool {
        matches!(self, Self::Prior(_) | Self::Priors(_) | Self::Repeated(..))
    }

    /// The priors in it.
    pub(crate) fn priors(&self) -> &[Distribution] {
        match self {
            Self::Prior(prior) | Self::Repeated(prior, _) => {
                std::slice::from_ref(prior)
            }
            Self::Priors(priors) => priors,
            Self::Known(_) | Self::Broken(_) => &[],
        }
    }
}

impl Keep {
    /// The name that it binds: an indexed one and a draw bind none.
    pub(crate) fn bound(&self) -> Option<&Ident> {
        match (&self.index, &self.right) {
            (None, Kept::Value(_)) => Some(&self.name),
            _ => None,
        }
    }
}

impl Body {
    /// All draws that are kept, at any depth.
    pub(crate) fn drawn(&self) -> Vec<&Distribution> {
        let mut found = Vec::new();
        collect_drawn(&self.pieces, &mut found);
        found
    }

    /// Whether it adds to the log density, at any depth.
    pub(crate) fn adds(&self) -> bool {
        adds(&self.pieces)
    }

    /// All `~` lines, at any depth: left and right side, if understood.
    pub(crate) fn lines(&self) -> Vec<(Option<&Expr>, &Sampling)> {
        let mut found = Vec::new();
        collect(&self.pieces, &mut found);
        found
    }
}

fn collect<'a>(
    pieces: &'a [Piece],
    found: &mut Vec<(Option<&'a Expr>, &'a Sampling)>,
) {
    for piece in pieces {
        match piece {
            Piece::Observation(line) => {
                found.push((Some(&line.data), &line.law));
            }
            Piece::Broken(Some(law)) => found.push((None, law)),
            Piece::Braces(_, inner) => collect(inner, found),
            Piece::Token(_)
            | Piece::Broken(None)
            | Piece::Keep(_)
            | Piece::Increment(..) => {}
        }
    }
}

fn collect_drawn<'a>(pieces: &'a [Piece], found: &mut Vec<&'a Distribution>) {
    for piece in pieces {
        match piece {
            Piece::Keep(keep) => {
                if let Kept::Drawn(one) = &keep.right {
                    found.push(one);
                }
            }
            Piece::Braces(_, inner) => collect_drawn(inner, found),
            _ => {}
        }
    }
}

fn adds(pieces: &[Piece]) -> bool {
    pieces.iter().any(|piece| match piece {
        Piece::Increment(..) => true,
        Piece::Braces(_, inner) => adds(inner),
        _ => false,
    })
}
