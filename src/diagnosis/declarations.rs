//! The blocks of a model put together at run time, as `model!` declares them.

use crate::block::Field;
use crate::model::Assembled;
use crate::physics::friction::LAWS;
use crate::prior::AnyPrior;

/// The blocks of a model as `model!` declares them: friction, then errors.
/// `None` where a law is not one of the crate's own, or a mechanism has
/// another prior than its own.
pub(crate) fn declarations(model: &Assembled) -> Option<[String; 2]> {
    let added: Vec<_> =
        model.mechanisms().flat_map(|m| m.unknowns()).collect();
    let given = model.priors().enumerate().take(added.len());
    let given = given.map(|(i, (_, prior))| (*prior, model.role(i)));
    if !given.eq(added.iter().map(|unknown| (unknown.prior, unknown.role))) {
        return None;
    }
    let mut priors = model.priors().skip(added.len()).map(|(_, p)| *p);
    let friction = model.friction();
    let terms = friction
        .split(" + ")
        .map(|name| {
            let law = LAWS.iter().find(|law| law.name() == name)?;
            let fields = law
                .fields()
                .iter()
                .map(|f| Some(format!("{}: {}", f.name, rust(priors.next()?))))
                .collect::<Option<Vec<_>>>()?;
            Some(format!("{} {{ {} }}", camel(name), fields.join(", ")))
        })
        .collect::<Option<Vec<_>>>()?;
    let errors = errors(model, &mut priors)?;
    Some([terms.join(" + "), errors])
}

/// The noise with its priors, `Ar { phi: [Uniform(..)], sigma2: .. }`, or the
/// sum of its blocks.
fn errors(
    model: &Assembled,
    priors: &mut impl Iterator<Item = AnyPrior>,
) -> Option<String> {
    let term =
        |(name, fields): (&str, Vec<Field>)| block(name, &fields, priors);
    let terms: Option<Vec<_>> =
        model.noise_terms().into_iter().map(term).collect();
    terms.map(|terms| terms.join(" + "))
}

/// A block with its priors; neighbours of one name are a list.
fn block(
    name: &str,
    all: &[Field],
    priors: &mut impl Iterator<Item = AnyPrior>,
) -> Option<String> {
    let mut fields: Vec<(Field, Vec<String>)> = Vec::new();
    for field in all {
        let prior = rust(priors.next()?);
        match fields.last_mut() {
            Some((last, list)) if last.name == field.name => list.push(prior),
            _ => fields.push((*field, vec![prior])),
        }
    }
    let told = |(field, priors): &(Field, Vec<String>)| {
        let priors = priors.join(", ");
        match field.list {
            true => format!("{}: [{priors}]", field.name),
            false => format!("{}: {priors}", field.name),
        }
    };
    let fields: Vec<String> = fields.iter().map(told).collect();
    Some(format!("{} {{ {} }}", camel(name), fields.join(", ")))
}

/// "velocity-weakening" as the struct is called.
fn camel(name: &str) -> String {
    let word = |word: &str| {
        let mut letters = word.chars();
        let first = letters.next().map(|c| c.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    };
    name.split('-').map(word).collect()
}

/// A prior as Rust has it: numbers with a point.
fn rust(prior: AnyPrior) -> String {
    let arguments: Vec<String> =
        prior.arguments().iter().map(|x| format!("{x:?}")).collect();
    format!("{}({})", prior.name(), arguments.join(", "))
}
