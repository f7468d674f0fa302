//! The corrected model as Rust to paste.

use std::fmt::Write as _;

use crate::block::Field;
use crate::diagnosis::findings::Corrected;
use crate::diagnosis::options::Options;
use crate::mechanism::Mechanism;
use crate::mechanism::catalogue::is_built_in;
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

/// The noise with its priors: `Ar { phi: [Uniform(..)], sigma2: .. }`.
fn errors(
    model: &Assembled,
    priors: &mut impl Iterator<Item = AnyPrior>,
) -> Option<String> {
    let noise = model.noise();
    let mut fields: Vec<(Field, Vec<String>)> = Vec::new();
    for field in model.noise_fields() {
        let prior = rust(priors.next()?);
        match fields.last_mut() {
            Some((last, list)) if last.name == field.name => list.push(prior),
            _ => fields.push((field, vec![prior])),
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
    let name = camel(noise.split('(').next()?);
    Some(format!("{name} {{ {} }}", fields.join(", ")))
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

/// The corrected model, written out: the mechanisms that the model had, and
/// those added to it.
pub(crate) fn corrected(
    added: &[&dyn Mechanism],
    options: &Options,
    quantity: &str,
) -> Corrected {
    let had = options.mechanisms.iter().map(|m| m.as_ref() as &dyn Mechanism);
    let all: Vec<&dyn Mechanism> = had.chain(added.iter().copied()).collect();
    let law = format!("du/dt = g sin(theta) - r, r of {}", options.friction);
    let terms = all.iter().map(|m| format!("{}: {}", m.name(), m.formula()));
    let equation = [law].into_iter().chain(terms).collect();
    if added.is_empty() {
        return Corrected { equation, ..Corrected::default() };
    }
    let is_found = all.iter().all(|m| is_built_in(m.name()));
    let model = options
        .declarations
        .as_ref()
        .filter(|_| is_found)
        .map_or_else(String::new, |own| model_text(&all, own, quantity));
    let labels = all.iter().map(|m| m.label()).collect();
    Corrected { equation, model, labels }
}

/// A program with the model and the mechanisms added to it.
fn model_text(
    mechanisms: &[&dyn Mechanism],
    blocks: &[String; 2],
    quantity: &str,
) -> String {
    let [friction, errors] = blocks;
    let mut text = format!(
        "use couloir::mechanism::catalogue::find;\n\
         use couloir::infer::Evidence;\n\
         use couloir::model::With;\n\
         use couloir::prelude::*;\n\n\
         model! {{\n    struct Before {{ event: Event }}\n    \
         friction ~ {friction};\n    errors ~ {errors};\n    \
         likelihood {{\n        let flow = event.slide(&friction)?;\n        \
         event.{quantity} ~ flow.{quantity}() + errors;\n    }}\n}}\n\n\
         fn evidence(event: Event) -> Result<Option<Evidence>> {{\n    \
         let extent = event.extent();\n    \
         let before = Before::new(event);\n"
    );
    let mut names = Vec::new();
    for (i, mechanism) in mechanisms.iter().enumerate() {
        let label = mechanism.label();
        // Writing to a text cannot fail.
        let _ = writeln!(
            text,
            "    let added_{i} = find({label:?}, &extent, &[])?;"
        );
        names.push(format!("added_{i}.as_ref()"));
    }
    let names = names.join(", ");
    let _ = write!(
        text,
        "    let corrected = With::new(&before, &[{names}]);\n    \
         let posterior = Posterior::new(&corrected)?;\n    \
         let found = infer(&Smc::default(), &posterior, Seed::new(1), \
         &Quiet)?;\n    \
         Ok(found.evidence)\n}}\n"
    );
    text
}
