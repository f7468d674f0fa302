//! The corrected model as Rust to paste.

use std::fmt::Write as _;

use crate::diagnosis::findings::Corrected;
use crate::diagnosis::options::Options;
use crate::mechanism::Mechanism;
use crate::mechanism::catalogue::is_built_in;

/// The corrected model, written out: the mechanisms that the model had, and
/// those added to it, and another noise where there is one.
pub(crate) fn corrected(
    added: &[&dyn Mechanism],
    noise: Option<String>,
    options: &Options,
    quantities: &[&str],
) -> Corrected {
    let had = options.mechanisms.iter().map(|m| m.as_ref() as &dyn Mechanism);
    let all: Vec<&dyn Mechanism> = had.chain(added.iter().copied()).collect();
    let law = format!("du/dt = g sin(theta) - r, r of {}", options.friction);
    let terms = all.iter().map(|m| format!("{}: {}", m.name(), m.formula()));
    let equation = [law].into_iter().chain(terms).collect();
    if added.is_empty() && noise.is_none() {
        return Corrected { equation, ..Corrected::default() };
    }
    // The declarations are those of the errors as they were.
    let is_known =
        noise.is_none() && all.iter().all(|m| is_built_in(m.name()));
    let model = options
        .declarations
        .as_ref()
        .filter(|_| is_known)
        .map_or_else(String::new, |own| model_text(&all, own, quantities));
    let labels = all.iter().map(|m| m.label()).collect();
    Corrected { equation, model, labels, noise }
}

/// A program with the model, which scores such quantities, and the mechanisms
/// added to it.
fn model_text(
    mechanisms: &[&dyn Mechanism],
    blocks: &[String; 2],
    quantities: &[&str],
) -> String {
    let [friction, errors] = blocks;
    let scored = |quantity: &&str| {
        format!("event.{quantity} ~ flow.{quantity}() + errors;\n")
    };
    let scored = quantities.iter().map(scored).collect::<Vec<_>>();
    let scored = scored.join("        ");
    let mut text = format!(
        "use couloir::mechanism::catalogue::find;\n\
         use couloir::infer::Evidence;\n\
         use couloir::model::With;\n\
         use couloir::prelude::*;\n\n\
         model! {{\n    struct Before {{ event: Event }}\n    \
         friction ~ {friction};\n    errors ~ {errors};\n    \
         likelihood {{\n        let flow = event.slide(&friction)?;\n        \
         {scored}    }}\n}}\n\n\
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recording_is_scored() {
        let blocks = ["Coulomb { mu: 0.3 }", "Iid { sigma2: 1.0 }"];
        let blocks = blocks.map(str::to_owned);
        let text = model_text(&[], &blocks, &["velocity", "position"]);
        let expected = "        let flow = event.slide(&friction)?;\n        \
            event.velocity ~ flow.velocity() + errors;\n        \
            event.position ~ flow.position() + errors;\n    }\n}\n";
        assert!(text.contains(expected), "{text}");
    }
}
