//! The built-in distributions, as far as the macro has to know them.
//!
//! rustc holds back its own unresolved names beside a macro's errors, so the
//! names and arguments are known here; a test keeps them equal to those of
//! `couloir::prior`.

use proc_macro2::Ident;
use syn::{Expr, ExprCall, Lit, Path, UnOp};

use crate::errors::Errors;
use crate::tree::Distribution;

/// A built-in distribution.
pub(crate) struct BuiltIn {
    pub(crate) name: &'static str,
    pub(crate) arguments: &'static [Argument],
    pub(crate) of: Of,
}

/// What a distribution is of.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Of {
    /// A real number: an unknown, or a datum.
    Real,
    /// A whole number, which no unknown is.
    Whole,
    /// Several numbers that depend on each other.
    Several,
}

/// Where a distribution stands.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// Right of one unknown.
    One,
    /// Right of `name[n]`.
    Several,
    /// Right of data.
    Data,
    /// Within the distribution of an unknown.
    Part,
}

/// One of its arguments.
pub(crate) struct Argument {
    pub(crate) name: &'static str,
    pub(crate) need: Need,
}

/// What an argument has to be.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Need {
    Real,
    /// A number above 0.
    Positive,
    /// A list of numbers.
    Numbers,
    Distribution,
    /// A list of distributions.
    Distributions,
}

const fn real(name: &'static str) -> Argument {
    Argument { name, need: Need::Real }
}

const fn positive(name: &'static str) -> Argument {
    Argument { name, need: Need::Positive }
}

const fn numbers(name: &'static str) -> Argument {
    Argument { name, need: Need::Numbers }
}

const fn distribution(name: &'static str) -> Argument {
    Argument { name, need: Need::Distribution }
}

const fn distributions(name: &'static str) -> Argument {
    Argument { name, need: Need::Distributions }
}

const fn built_in(
    name: &'static str,
    arguments: &'static [Argument],
) -> BuiltIn {
    BuiltIn { name, arguments, of: Of::Real }
}

const fn of_whole(
    name: &'static str,
    arguments: &'static [Argument],
) -> BuiltIn {
    BuiltIn { name, arguments, of: Of::Whole }
}

const fn of_several(
    name: &'static str,
    arguments: &'static [Argument],
) -> BuiltIn {
    BuiltIn { name, arguments, of: Of::Several }
}

/// All of them.
pub(crate) const BUILT_IN: &[BuiltIn] = &[
    built_in("Normal", &[real("mean"), positive("sd")]),
    built_in("LogNormal", &[real("mean"), positive("sd")]),
    built_in("Gamma", &[positive("shape"), positive("scale")]),
    built_in("InverseGamma", &[positive("shape"), positive("scale")]),
    built_in("Exponential", &[positive("mean")]),
    built_in("Uniform", &[real("low"), real("high")]),
    built_in("Beta", &[positive("a"), positive("b")]),
    built_in("HalfNormal", &[positive("scale")]),
    built_in("HalfCauchy", &[positive("scale")]),
    built_in("Cauchy", &[real("location"), positive("scale")]),
    built_in(
        "StudentT",
        &[positive("freedom"), real("location"), positive("scale")],
    ),
    built_in("Flat", &[]),
    built_in("Truncated", &[distribution("D"), real("low"), real("high")]),
    built_in("Mixture", &[numbers("weights"), distributions("[D, ..]")]),
    of_whole("Poisson", &[positive("mean")]),
    of_whole("Binomial", &[real("trials"), real("p")]),
    of_whole("Bernoulli", &[real("p")]),
    of_several("Ordered", &[distribution("D")]),
    of_several("Dirichlet", &[numbers("weights")]),
];

impl BuiltIn {
    /// The one of that name.
    pub(crate) fn named(name: &Ident) -> Option<&'static Self> {
        BUILT_IN.iter().find(|known| name == known.name)
    }

    /// Why it cannot stand there.
    fn misplaced(&self, place: Place) -> Option<String> {
        let name = self.name;
        match (self.of, place) {
            (Of::Whole, Place::One | Place::Several | Place::Part) => {
                Some(format!(
                    "`{name}` is of whole numbers, and an unknown is a real \
                     number: in the likelihood, data may come from it"
                ))
            }
            (Of::Several, Place::One) => Some(format!(
                "`{name}` is of several numbers: write `name[n] ~ {}`",
                self.written()
            )),
            (Of::Several, Place::Data | Place::Part) => Some(format!(
                "`{name}` is of several unknowns: it stands alone, right of \
                 `name[n] ~`"
            )),
            _ => None,
        }
    }

    /// Whether an argument is made of other distributions.
    pub(crate) fn has_parts(&self) -> bool {
        let is_part = |one: &Argument| {
            matches!(one.need, Need::Distribution | Need::Distributions)
        };
        self.arguments.iter().any(is_part)
    }

    /// How it is written: `Normal(mean, sd)`.
    pub(crate) fn written(&self) -> String {
        let names: Vec<_> = self.arguments.iter().map(|a| a.name).collect();
        format!("{}({})", self.name, names.join(", "))
    }
}

impl Distribution {
    /// A call read as a distribution, whatever its name.
    pub(crate) fn from_call(call: &ExprCall) -> Option<Self> {
        let path = called(call)?.clone();
        Some(Self { path, arguments: call.args.clone() })
    }

    /// Reports a name that is none and arguments that cannot be.
    ///
    /// Only a single name is looked up: `path::to::Own(..)` is the user's.
    pub(crate) fn check(&self, place: Place, errors: &mut Errors) {
        let Some(name) = self.path.get_ident() else { return };
        let Some(known) = BuiltIn::named(name) else {
            return errors.at(name, unknown(name));
        };
        if let Some(words) = known.misplaced(place) {
            errors.at(name, words);
        }
        if self.arguments.len() == known.arguments.len() {
            self.check_values(known, place, errors);
        } else {
            let (given, wanted) =
                (self.arguments.len(), known.arguments.len());
            let words = format!(
                "`{name}` takes {wanted} argument{}, not {given}: write \
                 `{}`",
                if wanted == 1 { "" } else { "s" },
                known.written(),
            );
            errors.at(name, words);
        }
    }

    fn check_values(
        &self,
        known: &BuiltIn,
        place: Place,
        errors: &mut Errors,
    ) {
        for (given, argument) in self.arguments.iter().zip(known.arguments) {
            let above = argument.need == Need::Positive;
            if check_parts(given, argument.need, place, errors) {
                continue;
            }
            if above && value(given).is_some_and(|x| x <= 0.0) {
                let words = format!(
                    "the {} of `{}` has to be above 0",
                    argument.name,
                    known.written(),
                );
                errors.at(given, words);
            } else {
                check_number(given, errors);
            }
        }
        let values: Vec<_> = self.arguments.iter().map(value).collect();
        if let ("Uniform", [Some(low), Some(high)])
        | ("Truncated", [_, Some(low), Some(high)]) = (known.name, &*values)
            && low >= high
        {
            let words = format!(
                "an empty range: in `{}` low has to be below high, but \
                 {low:?} is not below {high:?}",
                known.written()
            );
            errors.at(&self.arguments, words);
        }
    }
}

/// Checks an argument that is made of others; whether it is one.
fn check_parts(
    given: &Expr,
    need: Need,
    place: Place,
    errors: &mut Errors,
) -> bool {
    match (need, given) {
        (Need::Real | Need::Positive, _) => return false,
        (Need::Distribution, one) => check_part(one, place, errors),
        (Need::Distributions, Expr::Array(list)) => {
            list.elems.iter().for_each(|one| check_part(one, place, errors));
        }
        (Need::Numbers, Expr::Array(list)) => {
            list.elems.iter().for_each(|one| check_number(one, errors));
        }
        (Need::Numbers, Expr::Repeat(list)) => {
            check_number(&list.expr, errors);
        }
        (Need::Numbers, given) if value(given).is_some() => {
            let words = "a list of numbers is needed here, such as `[0.9, \
                         0.1]`";
            errors.at(given, words);
        }
        // A list that the user made in Rust.
        (Need::Distributions | Need::Numbers, _) => {}
    }
    true
}

/// A distribution within another one.
fn check_part(given: &Expr, place: Place, errors: &mut Errors) {
    let place = if place == Place::Data { place } else { Place::Part };
    match given {
        Expr::Call(call) if is_meant(call) => {
            if let Some(part) = Distribution::from_call(call) {
                part.check(place, errors);
            }
        }
        other => {
            let words = "a distribution is needed here, such as \
                         `Normal(0.0, 1.0)`";
            errors.at(other, words);
        }
    }
}

/// Reports a whole number where a real one is needed.
pub(crate) fn check_number(given: &Expr, errors: &mut Errors) {
    if let (true, Some(x)) = (is_whole(given), value(given)) {
        let words = format!("a real number is needed here: write `{x:?}`");
        errors.at(given, words);
    }
}

/// Whether a call is meant as a distribution: a built-in name or nearly one,
/// or a path whose last part is a type's name.
pub(crate) fn is_meant(call: &ExprCall) -> bool {
    let Some(path) = called(call) else { return false };
    let Some(last) = path.segments.last() else { return false };
    let name = last.ident.to_string();
    let is_type = name.chars().next().is_some_and(char::is_uppercase);
    let plain = path.segments.len() == 1;
    is_type || (plain && nearest(&name).is_some_and(|(_, far)| far <= 2))
}

/// Whether a call names a built-in distribution.
pub(crate) fn is_built_in(call: &ExprCall) -> bool {
    called(call)
        .and_then(Path::get_ident)
        .is_some_and(|name| BuiltIn::named(name).is_some())
}

fn called(call: &ExprCall) -> Option<&Path> {
    match &*call.func {
        Expr::Path(path) if path.qself.is_none() => Some(&path.path),
        _ => None,
    }
}

fn unknown(name: &Ident) -> String {
    let text = name.to_string();
    let own = format!("one of your own is written `self::{name}(..)`");
    match nearest(&text) {
        Some((known, far)) if far <= text.len() / 2 => {
            format!(
                "there is no distribution `{name}`: did you mean `{}`? {own}",
                known.written()
            )
        }
        _ => {
            let names: Vec<_> = BUILT_IN.iter().map(|b| b.name).collect();
            format!(
                "there is no distribution `{name}`: there are {}; {own}; a \
                 block takes braces, `{name} {{ .. }}`",
                names.join(", ")
            )
        }
    }
}

/// The built-in name nearest to `name`, and how many letters differ.
fn nearest(name: &str) -> Option<(&'static BuiltIn, usize)> {
    let name = name.to_lowercase();
    BUILT_IN
        .iter()
        .map(|known| (known, distance(&name, &known.name.to_lowercase())))
        .min_by_key(|&(_, far)| far)
}

/// How many letters have to be put in, left out or changed.
pub(crate) fn distance(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, a) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &b) in to.iter().enumerate() {
            let change = diagonal + usize::from(a != b);
            diagonal = row[j + 1];
            row[j + 1] = change.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[to.len()]
}

/// The value of a number written out, with or without a sign.
fn value(given: &Expr) -> Option<f64> {
    match given {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Float(x) => x.base10_parse().ok(),
            Lit::Int(x) => x.base10_parse().ok(),
            _ => None,
        },
        Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_)) => {
            value(&unary.expr).map(|x| -x)
        }
        Expr::Group(group) => value(&group.expr),
        _ => None,
    }
}

/// Whether it is a number without a decimal point.
fn is_whole(given: &Expr) -> bool {
    match given {
        Expr::Lit(literal) => {
            matches!(&literal.lit, Lit::Int(x) if x.suffix().is_empty())
        }
        Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_)) => {
            is_whole(&unary.expr)
        }
        Expr::Group(group) => is_whole(&group.expr),
        _ => false,
    }
}
