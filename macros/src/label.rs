//! What every unknown of a block is called in draws and summaries.

use proc_macro2::Ident;

use crate::errors::Errors;
use crate::tree::{Line, Right, Source, Term};

/// Names every unknown: plainly while that is unique, else by its block's
/// name, else by its block's type.
pub(crate) fn assign(source: &mut Source, errors: &mut Errors) {
    let names: Vec<Unknown> = source.lines.iter().flat_map(unknowns).collect();
    let count = |of: fn(&Unknown) -> &String, label: &String| {
        names.iter().filter(|name| of(name) == label).count()
    };
    let mut chosen: Vec<String> = Vec::new();
    for name in &names {
        chosen.push(match () {
            () if count(|n| &n.plain, &name.plain) == 1 || name.alone => {
                name.plain.clone()
            }
            () if count(|n| &n.of_block, &name.of_block) == 1 => {
                name.of_block.clone()
            }
            () => name.of_type.clone(),
        });
    }
    for (i, (name, label)) in names.iter().zip(&chosen).enumerate() {
        if !name.alone && chosen[..i].contains(label) {
            let words = format!(
                "two unknowns would both be called `{label}`: declare one \
                 of them above and share it, as in `{} = ..`",
                name.plain
            );
            errors.at(&name.token, words);
        }
    }
    write(source, names.iter().zip(chosen));
}

/// The names that an unknown may have in draws and summaries.
struct Unknown {
    token: Ident,
    plain: String,
    of_block: String,
    of_type: String,
    /// Whether it is declared by itself, in no block.
    alone: bool,
}

fn unknowns(line: &Line) -> Vec<Unknown> {
    let Line::Declaration(declaration) = line else { return Vec::new() };
    let block = &declaration.name;
    if let Right::Distribution(_) = declaration.right {
        let own = || block.to_string();
        return vec![Unknown {
            token: block.clone(),
            plain: own(),
            of_block: own(),
            of_type: own(),
            alone: true,
        }];
    }
    let of_term = |term: &Term| {
        let kind =
            term.path.segments.last().map(|last| last.ident.to_string());
        let kind = kind.unwrap_or_default().to_lowercase();
        let fields = term.fields.iter().filter(|f| f.value.is_unknown());
        let unknown = move |name: &Ident| Unknown {
            token: name.clone(),
            plain: name.to_string(),
            of_block: format!("{block}.{name}"),
            of_type: format!("{kind}.{name}"),
            alone: false,
        };
        fields.map(|field| unknown(&field.name)).collect::<Vec<_>>()
    };
    declaration.terms().iter().flat_map(of_term).collect()
}

fn write<'a>(
    source: &mut Source,
    names: impl Iterator<Item = (&'a Unknown, String)>,
) {
    let mut labels =
        names.filter(|(name, _)| !name.alone).map(|(_, label)| label);
    for line in &mut source.lines {
        let Line::Declaration(declaration) = line else { continue };
        let Right::Blocks(terms) = &mut declaration.right else { continue };
        let fields = terms.iter_mut().flat_map(|term| &mut term.fields);
        for field in fields.filter(|field| field.value.is_unknown()) {
            field.label = labels.next().unwrap_or_default();
        }
    }
}
