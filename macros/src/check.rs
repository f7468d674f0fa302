//! All that can be wrong with a model that was understood.

use std::collections::HashSet;

use proc_macro2::{Ident, TokenTree};
use syn::{Expr, Fields, ItemStruct};

use crate::body::assignments;
use crate::distribution::{BuiltIn, Place, check_number, is_built_in};
use crate::errors::Errors;
use crate::tokens::{shown, split, stream, uses};
use crate::tree::{Body, Count, Declaration, Keep, Kept, Line};
use crate::tree::{Right, Sampling, Source, Term, Value};

/// Reports everything that is wrong with `source`.
pub(crate) fn source(source: &Source, errors: &mut Errors) {
    match &source.structure {
        Some(item) => structure(item, errors),
        None => missing_struct(source, errors),
    }
    names(source, errors);
    order(source, errors);
    for line in &source.lines {
        match line {
            Line::Declaration(declaration) => {
                length(declaration, errors);
                given(declaration, errors);
                let several = matches!(declaration.count, Count::Vector(_));
                right(&declaration.right, several, errors);
            }
            Line::Broken(broken) => {
                let each = broken.parts.iter();
                each.for_each(|part| right(part, true, errors));
            }
            Line::Keep(keep) => drawn(keep, errors),
            Line::Let(_) => {}
        }
    }
    used(source, errors);
    for body in &source.bodies {
        for (data, law) in body.lines() {
            if let Some(data) = data {
                recorded(source, data, errors);
            }
            sampled(source, law, errors);
        }
        for one in body.drawn() {
            one.check(Place::Data, errors);
        }
        assigned(source, body, errors);
    }
    bodies(source, errors);
}

fn structure(item: &ItemStruct, errors: &mut Errors) {
    let name = &item.ident;
    if !item.generics.params.is_empty() {
        let words = format!(
            "`{name}` cannot be generic: remove this, and give its fields \
             types without parameters"
        );
        errors.at(&item.generics, words);
    }
    if !matches!(item.fields, Fields::Named(_)) {
        let words = format!(
            "the data of a model have names: write `struct {name} {{ event: \
             Event }}`"
        );
        errors.at(name, words);
    }
}

fn missing_struct(source: &Source, errors: &mut Errors) {
    if source.broken_structure {
        return;
    }
    let words = "the struct is missing: a model starts with its data, as in \
                 `pub struct Calibration { event: Event }`";
    let first = source.lines.iter().find_map(Line::declared);
    match first.or_else(|| source.bodies.first().map(|body| &body.keyword)) {
        Some(place) => errors.at(place, words),
        None => errors.at_span(proc_macro2::Span::call_site(), words),
    }
}

/// The names of the struct's fields.
fn fields(source: &Source) -> Vec<&Ident> {
    let item = source.structure.iter();
    item.flat_map(|item| &item.fields)
        .filter_map(|f| f.ident.as_ref())
        .collect()
}

/// The names that a line binds.
fn bound(line: &Line) -> Vec<&Ident> {
    match line {
        Line::Let(local) => local.names.iter().collect(),
        Line::Keep(keep) => keep.bound().into_iter().collect(),
        line => line.declared().into_iter().collect(),
    }
}

/// Names declared twice, or taken from a field.
fn names(source: &Source, errors: &mut Errors) {
    let fields = fields(source);
    let mut seen: Vec<(&Ident, bool)> = Vec::new();
    for line in &source.lines {
        let declares = line.declared().is_some();
        for name in bound(line) {
            let twice =
                seen.iter().any(|&(n, d)| n == name && (d || declares));
            if twice {
                let words =
                    format!("`{name}` is declared twice: choose another name");
                errors.at(name, words);
            } else if declares && fields.contains(&name) {
                let words = format!(
                    "`{name}` is a field of the struct already: choose \
                     another name"
                );
                errors.at(name, words);
            }
            seen.push((name, declares));
        }
    }
}

/// Names used above the line that declares them.
fn order(source: &Source, errors: &mut Errors) {
    let fields = fields(source);
    for (i, line) in source.lines.iter().enumerate() {
        let (above, below) = source.lines.split_at(i);
        for name in mentioned(line) {
            let is = |line: &Line| bound(line).contains(&&name);
            if fields.contains(&&name) || above.iter().any(is) {
                continue;
            }
            if line.declared() == Some(&name) {
                if is_one_after_another(line) {
                    continue;
                }
                let words = format!("`{name}` is used in its own line");
                errors.at(&name, words);
            } else if below.iter().skip(1).any(is) {
                let words = format!(
                    "`{name}` is declared further down: move its line above \
                     this one"
                );
                errors.at(&name, words);
            }
        }
    }
}

/// Whether each of a line's unknowns may depend on those before it.
fn is_one_after_another(line: &Line) -> bool {
    matches!(line, Line::Declaration(declaration)
        if matches!(declaration.count, Count::Each { .. })
            && declaration.terms().is_empty())
}

/// The names that a line uses.
fn mentioned(line: &Line) -> Vec<Ident> {
    match line {
        Line::Let(local) => uses(&local.value),
        Line::Keep(keep) => mentioned_kept(keep),
        Line::Broken(broken) => uses(&broken.tokens),
        Line::Declaration(declaration) => mentioned_by(declaration),
    }
}

fn mentioned_kept(keep: &Keep) -> Vec<Ident> {
    let mut found = match &keep.right {
        Kept::Value(value) => uses(value),
        Kept::Drawn(distribution) => uses(&distribution.arguments),
    };
    found.extend(keep.index.iter().flat_map(uses));
    found
}

fn mentioned_by(declaration: &Declaration) -> Vec<Ident> {
    let mut found = match &declaration.right {
        Right::Distribution(distribution) => uses(&distribution.arguments),
        Right::Blocks(terms) => {
            let fields = terms.iter().flat_map(|term| &term.fields);
            fields.flat_map(|field| mentioned_in(&field.value)).collect()
        }
    };
    found.extend(declaration.given.iter().flat_map(uses));
    match &declaration.count {
        Count::One => {}
        Count::Vector(length) => found.extend(uses(length)),
        Count::Each { index, range } => {
            found.retain(|name| name != index);
            found.extend(uses(range));
        }
    }
    found
}

fn mentioned_in(value: &Value) -> Vec<Ident> {
    let priors =
        value.priors().iter().flat_map(|prior| uses(&prior.arguments));
    let mut found: Vec<_> = priors.collect();
    match value {
        Value::Known(value) | Value::Repeated(_, value) => {
            found.extend(uses(value));
        }
        Value::Broken(tokens) => found.extend(uses(tokens)),
        Value::Prior(_) | Value::Priors(_) => {}
    }
    found
}

/// Declarations that nothing uses.
fn used(source: &Source, errors: &mut Errors) {
    if source.bodies.is_empty() {
        return;
    }
    let bodies = source.bodies.iter().flat_map(|body| uses(&body.tokens));
    let lines = source.lines.iter().flat_map(mentioned);
    let names: HashSet<_> = lines.chain(bodies).collect();
    for name in source.lines.iter().filter_map(Line::declared) {
        if !names.contains(name) {
            let words = format!(
                "`{name}` is never used: use it further down, or remove \
                 this line"
            );
            errors.at(name, words);
        }
    }
}

/// Blocks are indexed by name.
fn length(declaration: &Declaration, errors: &mut Errors) {
    if let (Count::Vector(length), Right::Blocks(_)) =
        (&declaration.count, &declaration.right)
    {
        let words = format!(
            "a block for each needs a name for the index: write `{}[i in \
             0..{}]`",
            declaration.name,
            shown(length)
        );
        errors.at(length, words);
    }
}

/// A datum is given to one unknown, of a distribution.
fn given(declaration: &Declaration, errors: &mut Errors) {
    let Some(given) = &declaration.given else { return };
    let name = &declaration.name;
    match (&declaration.right, &declaration.count) {
        (Right::Distribution(_), Count::One | Count::Each { .. }) => {}
        (Right::Distribution(_), Count::Vector(length)) => {
            let words = format!(
                "data are given one by one: write `{name}[i in 0..{}] ~ .. \
                 given {}[i]`",
                shown(length),
                shown(given)
            );
            errors.at(given, words);
        }
        (Right::Blocks(_), _) => {
            let words = "a block is not observed: `given` stands behind a \
                         distribution";
            errors.at(given, words);
        }
    }
}

fn drawn(keep: &Keep, errors: &mut Errors) {
    if let Kept::Drawn(distribution) = &keep.right {
        distribution.check(Place::Data, errors);
    }
}

fn right(right: &Right, several: bool, errors: &mut Errors) {
    let place = if several { Place::Several } else { Place::One };
    match right {
        Right::Distribution(distribution) => distribution.check(place, errors),
        Right::Blocks(terms) => {
            terms.iter().for_each(|block| term(block, errors));
        }
    }
}

fn term(term: &Term, errors: &mut Errors) {
    if let Some(known) = term.path.get_ident().and_then(BuiltIn::named) {
        let words = format!(
            "a distribution takes parentheses: write `{}`",
            known.written()
        );
        return errors.at(&term.path, words);
    }
    for (i, field) in term.fields.iter().enumerate() {
        let name = &field.name;
        if term.fields[..i].iter().any(|other| other.name == *name) {
            let words = format!("`{name}` is given twice: remove one");
            errors.at(name, words);
        }
        value(name, &field.value, errors);
    }
}

fn value(name: &Ident, value: &Value, errors: &mut Errors) {
    let priors = value.priors().iter();
    priors.for_each(|prior| prior.check(Place::One, errors));
    let empty = match value {
        Value::Priors(priors) => priors.is_empty(),
        Value::Known(Expr::Array(list)) => {
            list.elems.iter().for_each(|one| check_number(one, errors));
            list.elems.is_empty()
        }
        Value::Known(one) => {
            check_number(one, errors);
            false
        }
        Value::Prior(_) | Value::Repeated(..) | Value::Broken(_) => false,
    };
    if empty {
        let words = format!(
            "the list of `{name}` is empty: give it a prior for each value, \
             or `[prior; count]`"
        );
        errors.at(name, words);
    }
}

/// A model has one likelihood, with a `~` line at least.
fn bodies(source: &Source, errors: &mut Errors) {
    let Some((first, others)) = source.bodies.split_first() else {
        let mut names = source.lines.iter().filter_map(Line::declared);
        if names.any(|name| name == "likelihood") {
            return;
        }
        let words = "the likelihood is missing: end the model with \
                     `likelihood { data ~ prediction + noise; }`";
        let last = source.lines.iter().rev().find_map(Line::declared);
        let name = source.structure.as_ref().map(|item| &item.ident);
        if let Some(place) = last.or(name) {
            errors.at(place, words);
        }
        return;
    };
    for other in others {
        let words = "a second likelihood: a model has one, and the lines in \
                     it add up";
        errors.at(&other.keyword, words);
    }
    if !first.has_lines() && meant(source, first).is_empty() {
        let words = "this likelihood compares nothing with a recording: \
                     write a line `data ~ prediction + noise;`";
        errors.at(&first.keyword, words);
    }
}

/// A `=` where a `~` was meant.
fn assigned(source: &Source, body: &Body, errors: &mut Errors) {
    for mark in meant(source, body) {
        errors.at(mark, "data are compared with `~`: write `~` for this `=`");
    }
}

/// The `=` behind which a noise is added or a distribution stands.
fn meant(source: &Source, body: &Body) -> Vec<TokenTree> {
    let is_law = |right: &[TokenTree]| {
        let last = split(right, '+').last().map(|last| stream(last));
        match last.map(syn::parse2::<Expr>) {
            Some(Ok(Expr::Call(call))) => is_built_in(&call),
            Some(Ok(one)) => declared(source, &one)
                .is_some_and(|name| has_blocks(source, name)),
            _ => false,
        }
    };
    let all = assignments(body.tokens.clone()).into_iter();
    all.filter(|(_, right)| is_law(right)).map(|(mark, _)| mark).collect()
}

/// Left of `~` stand data.
fn recorded(source: &Source, data: &Expr, errors: &mut Errors) {
    if let Some(name) = declared(source, data) {
        let words = format!(
            "`{name}` is declared above, it was not recorded: left of `~` \
             in the likelihood stand data"
        );
        errors.at(data, words);
    }
}

fn sampled(source: &Source, law: &Sampling, errors: &mut Errors) {
    match law {
        Sampling::Distribution(distribution) => {
            distribution.check(Place::Data, errors);
        }
        Sampling::Noise { prediction, noise } => {
            summands(source, prediction, noise, errors);
        }
    }
}

/// The noise has to be last, and a noise.
fn summands(
    source: &Source,
    prediction: &Expr,
    noise: &Expr,
    errors: &mut Errors,
) {
    if let Some(words) = no_noise(source, prediction, noise) {
        return errors.at(noise, words);
    }
    let is_block = |one: &Expr| {
        declared(source, one).is_some_and(|name| has_blocks(source, name))
    };
    let misplaced = terms(prediction).into_iter().find(|one| is_block(one));
    if let (Some(earlier), false) = (misplaced, is_block(noise)) {
        let words =
            format!("the noise comes last: write `.. + {}`", shown(earlier));
        errors.at(earlier, words);
    }
}

/// Why the last summand cannot be a noise, as far as the macro can know.
fn no_noise(
    source: &Source,
    prediction: &Expr,
    noise: &Expr,
) -> Option<String> {
    let text = shown(noise);
    match noise {
        Expr::Call(call) if is_built_in(call) => Some(format!(
            "`{text}` is a distribution, not a noise: declare one above, as \
             in `errors ~ Iid {{ .. }};`, and write `.. + errors`"
        )),
        Expr::Lit(_) => Some(format!(
            "`{text}` is no noise: the last summand has to be one, such as \
             `{} + errors`",
            shown(prediction)
        )),
        one => {
            let name = declared(source, one)?;
            (!has_blocks(source, name)).then(|| {
                format!(
                    "`{name}` is a parameter, not a noise: the noise comes \
                     last, declared as in `errors ~ Iid {{ .. }};`"
                )
            })
        }
    }
}

/// The summands of a sum.
fn terms(sum: &Expr) -> Vec<&Expr> {
    match sum {
        Expr::Binary(sum) if matches!(sum.op, syn::BinOp::Add(_)) => {
            let mut found = terms(&sum.left);
            found.extend(terms(&sum.right));
            found
        }
        one => vec![one],
    }
}

/// The declared name that `given` stands for, indexed or not.
fn declared<'a>(source: &'a Source, given: &Expr) -> Option<&'a Ident> {
    match given {
        Expr::Path(path) => {
            let name = path.path.get_ident()?;
            let mut all = source.lines.iter().filter_map(Line::declared);
            all.find(|declared| *declared == name)
        }
        Expr::Index(index) => declared(source, &index.expr),
        Expr::Reference(reference) => declared(source, &reference.expr),
        Expr::Paren(paren) => declared(source, &paren.expr),
        _ => None,
    }
}

/// Whether `name` may stand for a block; a broken line may.
fn has_blocks(source: &Source, name: &Ident) -> bool {
    source.lines.iter().filter(|line| line.declared() == Some(name)).any(
        |line| match line {
            Line::Declaration(declaration) => !declaration.terms().is_empty(),
            _ => true,
        },
    )
}

impl Body {
    /// Whether it has a `~` line, even one that was not understood.
    fn has_lines(&self) -> bool {
        self.adds()
            || crate::tokens::contains(self.tokens.clone(), '~').is_some()
    }
}
