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
}

/// One of its arguments.
pub(crate) struct Argument {
    pub(crate) name: &'static str,
    /// Whether it has to be above 0.
    pub(crate) positive: bool,
}

const fn real(name: &'static str) -> Argument {
    Argument { name, positive: false }
}

const fn positive(name: &'static str) -> Argument {
    Argument { name, positive: true }
}

const fn built_in(
    name: &'static str,
    arguments: &'static [Argument],
) -> BuiltIn {
    BuiltIn { name, arguments }
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
];

impl BuiltIn {
    /// The one of that name.
    pub(crate) fn named(name: &Ident) -> Option<&'static Self> {
        BUILT_IN.iter().find(|known| name == known.name)
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
    pub(crate) fn check(&self, errors: &mut Errors) {
        let Some(name) = self.path.get_ident() else { return };
        let Some(known) = BuiltIn::named(name) else {
            return errors.at(name, unknown(name));
        };
        if self.arguments.len() == known.arguments.len() {
            self.check_values(known, errors);
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

    fn check_values(&self, known: &BuiltIn, errors: &mut Errors) {
        for (given, argument) in self.arguments.iter().zip(known.arguments) {
            if argument.positive && value(given).is_some_and(|x| x <= 0.0) {
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
        if let ("Uniform", [Some(low), Some(high)]) = (known.name, &*values)
            && low >= high
        {
            let words = format!(
                "an empty range: in `Uniform(low, high)` low has to be below \
                 high, but {low:?} is not below {high:?}"
            );
            errors.at(&self.arguments, words);
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
