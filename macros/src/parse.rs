//! Tokens to tree: the struct, the declarations and their right sides.
//!
//! Every line is read on its own, so that an error in one leaves the others
//! understood.

use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream, TokenTree};
use quote::ToTokens;
use syn::ext::IdentExt;
use syn::parse::{ParseStream, Parser};
use syn::visit::Visit;
use syn::{Expr, ExprArray, ItemStruct, Path, Stmt, Token, token};

use crate::body;
use crate::distribution;
use crate::errors::Errors;
use crate::keep;
use crate::split::{self, Part};
use crate::tokens::{attributes, braces, find, group, is_mark, is_word};
use crate::tokens::{shown, split, stream};
use crate::tree::{Body, Broken, Count, Declaration, Distribution, Field};
use crate::tree::{Let, Line, Right, Source, Term, Value};

/// Reads a whole model; what cannot be understood is reported.
pub(crate) fn source(input: TokenStream, errors: &mut Errors) -> Source {
    let mut source = Source {
        structure: None,
        broken_structure: false,
        lines: Vec::new(),
        bodies: Vec::new(),
    };
    for part in split::parts(input, errors) {
        match part {
            Part::Struct(tokens) => structure(tokens, &mut source, errors),
            Part::Line(trees) => {
                let line = match source.bodies.last() {
                    Some(body) => late(&trees, body, errors),
                    None => line(&trees, errors),
                };
                source.lines.extend(line);
            }
            Part::Likelihood(keyword, group) => {
                let body = likelihood(keyword, &group, errors);
                source.bodies.push(body);
            }
        }
    }
    source
}

fn structure(tokens: TokenStream, source: &mut Source, errors: &mut Errors) {
    let read = errors.keep(syn::parse2::<ItemStruct>(tokens));
    let Some(item) = read else {
        source.broken_structure = true;
        return;
    };
    if source.structure.is_some() {
        let words = "a second struct: a model has one, write this one \
                     outside `model!`";
        return errors.at(item.ident, words);
    }
    source.structure = Some(item);
}

/// A line below the likelihood.
fn late(
    trees: &[TokenTree],
    body: &Body,
    errors: &mut Errors,
) -> Option<Line> {
    let (_, rest) = attributes(trees);
    let words = format!(
        "this stands below `{}`: move the line above it",
        body.keyword
    );
    errors.at(rest.first()?, words);
    let tokens = stream(rest);
    Some(Line::Broken(Broken { name: None, tokens, parts: Vec::new() }))
}

fn likelihood(keyword: Ident, group: &Group, errors: &mut Errors) -> Body {
    let tokens = group.stream();
    let pieces = body::pieces(tokens.clone(), errors);
    Body { keyword, braces: group.span(), tokens, pieces }
}

/// One line without its `;`; `None` where there is nothing.
fn line(trees: &[TokenTree], errors: &mut Errors) -> Option<Line> {
    let (attributes, rest) = attributes(trees);
    let first = rest.first()?;
    if is_word(first, "let") {
        return Some(local(trees, errors));
    }
    for attribute in attributes {
        check_attribute(attribute, errors);
    }
    if keep::start(rest) == Some(0) {
        let keep = keep::read(rest, errors);
        return keep.map(|keep| Line::Keep(Box::new(keep)));
    }
    let Some(tilde) = find(rest, '~') else {
        no_tilde(rest, errors);
        return Some(broken(rest, behind_another_mark(rest, errors)));
    };
    let head = errors.keep(head.parse2(stream(&rest[..tilde])));
    let (law, given) = given(&rest[tilde + 1..], errors);
    let right = right(&rest[tilde], law, errors);
    Some(match (head, right) {
        (Some((name, count)), Ok(right)) => {
            Line::Declaration(Box::new(Declaration {
                name,
                count,
                right,
                given,
            }))
        }
        (None, Ok(right)) => broken(rest, vec![right]),
        (_, Err(parts)) => broken(rest, parts),
    })
}

/// What stands before `given`, and the expression behind it.
fn given<'t>(
    trees: &'t [TokenTree],
    errors: &mut Errors,
) -> (&'t [TokenTree], Option<Expr>) {
    let word = (1..trees.len()).find(|&i| {
        let behind = group(&trees[i - 1], Delimiter::Parenthesis).is_some();
        behind && is_word(&trees[i], "given")
    });
    let Some(word) = word else { return (trees, None) };
    let value = expression(&trees[word], &trees[word + 1..], errors);
    (&trees[..word], value)
}

/// A line that was not understood; its name is kept if it has one.
fn broken(trees: &[TokenTree], parts: Vec<Right>) -> Line {
    let named = matches!(trees, [TokenTree::Ident(_), mark, ..]
        if braces(mark).is_none() && group(mark, Delimiter::Parenthesis).is_none());
    let name = trees
        .first()
        .filter(|_| named)
        .and_then(|name| syn::parse2(stream(std::slice::from_ref(name))).ok());
    let from = usize::from(name.is_some());
    Line::Broken(Broken { name, tokens: stream(&trees[from..]), parts })
}

/// Declarations may carry comments for the reader, nothing else.
fn check_attribute(attribute: &[TokenTree], errors: &mut Errors) {
    let TokenTree::Group(brackets) = &attribute[1] else { return };
    let first = brackets.stream().into_iter().next();
    if !first.is_some_and(|word| is_word(&word, "doc")) {
        let words = "a declaration takes no attributes: remove this";
        errors.at(stream(attribute), words);
    }
}

/// `let pattern = value;`
fn local(trees: &[TokenTree], errors: &mut Errors) -> Line {
    let mut statement = stream(trees);
    let end = trees.last().map_or_else(Span::call_site, TokenTree::span);
    statement.extend(quote::quote_spanned!(end=> ;));
    let local = match errors.keep(syn::parse2(statement.clone())) {
        Some(Stmt::Local(local)) => local,
        _ => return broken(trees, Vec::new()),
    };
    let mut names = Names(Vec::new());
    names.visit_pat(&local.pat);
    let value = match &local.init {
        Some(init) => init.expr.to_token_stream(),
        None => TokenStream::new(),
    };
    Line::Let(Let { names: names.0, value, statement })
}

/// The names that a pattern binds.
struct Names(Vec<Ident>);

impl<'a> Visit<'a> for Names {
    fn visit_pat_ident(&mut self, pattern: &'a syn::PatIdent) {
        self.0.push(pattern.ident.clone());
        syn::visit::visit_pat_ident(self, pattern);
    }
}

/// A line without `~`: what was meant, by its second token.
fn no_tilde(trees: &[TokenTree], errors: &mut Errors) {
    let name = shown(&trees[0]);
    match trees {
        [word, ..] if is_word(word, "likelihood") => {
            errors.at(word, "write `likelihood { .. }`");
        }
        [TokenTree::Ident(_), mark, ..]
            if is_mark(mark, '=') || is_mark(mark, ':') =>
        {
            let words = format!(
                "a declaration takes `~`: write `{name} ~ ..`; a known \
                 value takes `let {name} = ..;`"
            );
            errors.at(mark, words);
        }
        [first, fields] if braces(fields).is_some() => {
            let words = format!(
                "a block needs a name: write `name ~ {name} {{ .. }};`"
            );
            errors.at(first, words);
        }
        [first, ..] => {
            let words = "expected a declaration `name ~ ..;`, a `let ..;` \
                         or `likelihood { .. }`";
            errors.at(first, words);
        }
        [] => {}
    }
}

/// What stands behind a `=` or `:` written for a `~`; it may hold more
/// mistakes. Where it is no right side either, one error is enough.
fn behind_another_mark(
    trees: &[TokenTree],
    errors: &mut Errors,
) -> Vec<Right> {
    let [TokenTree::Ident(_), mark, given @ ..] = trees else {
        return Vec::new();
    };
    let mut more = Errors::default();
    match right(mark, given, &mut more) {
        Ok(right) if is_mark(mark, '=') || is_mark(mark, ':') => {
            errors.append(more);
            vec![right]
        }
        _ => Vec::new(),
    }
}

/// `name`, `name[n]` or `name[i in 0..n]`.
fn head(input: ParseStream<'_>) -> syn::Result<(Ident, Count)> {
    let words = "left of `~` stands a name, `name[n]` or `name[i in 0..n]`";
    if !input.peek(Ident::peek_any) {
        return Err(input.error(words));
    }
    let name: Ident = input.parse()?;
    if input.is_empty() {
        return Ok((name, Count::One));
    }
    if !input.peek(token::Bracket) {
        return Err(input.error(words));
    }
    let inside;
    syn::bracketed!(inside in input);
    if !input.is_empty() {
        return Err(input.error(words));
    }
    let count = if inside.peek2(Token![in]) {
        let index = inside.parse().map_err(|error| {
            syn::Error::new(error.span(), "write one name, as in `i in 0..n`")
        })?;
        inside.parse::<Token![in]>()?;
        Count::Each { index, range: inside.parse()? }
    } else {
        Count::Vector(inside.parse()?)
    };
    match inside.is_empty() {
        true => Ok((name, count)),
        false => Err(inside.error(words)),
    }
}

/// A distribution, or blocks with `+` between; `Err` has the parts that were
/// understood of something else.
fn right(
    tilde: &TokenTree,
    trees: &[TokenTree],
    errors: &mut Errors,
) -> Result<Right, Vec<Right>> {
    let terms = split(trees, '+');
    let read = terms.iter().map(|term| side(tilde, term, errors));
    let read: Vec<_> = read.collect();
    let complete = read.iter().all(Option::is_some);
    let mut parts: Vec<_> = read.into_iter().flatten().collect();
    if terms.len() == 1 {
        return parts.pop().ok_or(parts);
    }
    for part in &parts {
        if let Right::Distribution(one) = part {
            let words = "`+` adds blocks, such as `Coulomb { .. } + \
                         Turbulent { .. }`: a distribution stands alone";
            errors.at(&one.path, words);
        }
    }
    let is_blocks = |part: &Right| matches!(part, Right::Blocks(_));
    if complete && parts.iter().all(is_blocks) {
        Ok(Right::Blocks(parts.into_iter().flat_map(blocks).collect()))
    } else {
        Err(parts)
    }
}

fn blocks(right: Right) -> Vec<Term> {
    match right {
        Right::Blocks(terms) => terms,
        Right::Distribution(_) => Vec::new(),
    }
}

/// One term of a right side.
fn side(
    tilde: &TokenTree,
    trees: &[TokenTree],
    errors: &mut Errors,
) -> Option<Right> {
    let Some((last, before)) = trees.split_last() else {
        let words = "a block or a distribution is missing here, such as \
                     `Coulomb { .. }` or `Normal(0.0, 1.0)`";
        errors.at(tilde, words);
        return None;
    };
    if let Some(inside) = braces(last)
        && let Ok(path) = Path::parse_mod_style.parse2(stream(before))
    {
        return Some(Right::Blocks(vec![block(path, inside, errors)]));
    }
    match syn::parse2::<Expr>(stream(trees)) {
        Ok(Expr::Call(call)) if distribution::is_meant(&call) => {
            Distribution::from_call(&call).map(Right::Distribution)
        }
        Ok(other) => {
            errors.at(&other, neither(&other));
            None
        }
        Err(error) => {
            errors.push(error);
            None
        }
    }
}

fn neither(given: &Expr) -> String {
    let text = shown(given);
    match given {
        Expr::Path(_) => format!(
            "`{text}` alone is not enough: a block takes its fields, \
             `{text} {{ .. }}`, a distribution its arguments, `{text}(..)`"
        ),
        _ => "right of `~` stands a distribution such as `Normal(0.0, \
              1.0)` or a block such as `Coulomb { .. }`; a known value \
              takes `let name = ..;`"
            .to_owned(),
    }
}

fn block(path: Path, inside: &Group, errors: &mut Errors) -> Term {
    let trees: Vec<_> = inside.stream().into_iter().collect();
    if trees.is_empty() {
        let words = "a block needs its fields, each `name: prior` or `name = \
                     value`";
        errors.at(&path, words);
    }
    let lines = split(&trees, ',');
    let given = lines.iter().filter(|line| !line.is_empty());
    let fields = given.filter_map(|line| field(line, errors)).collect();
    Term { path, fields }
}

/// `name: prior` or `name = value`.
fn field(trees: &[TokenTree], errors: &mut Errors) -> Option<Field> {
    let (_, trees) = attributes(trees);
    let (first, rest) = trees.split_first()?;
    let TokenTree::Ident(name) = first else {
        let words = "a field is written `name: prior` or `name = value`";
        errors.at(first, words);
        return None;
    };
    let value = match rest.split_first() {
        Some((mark, given)) if is_mark(mark, ':') => {
            prior(name, mark, given, errors)
        }
        Some((mark, given)) if is_mark(mark, '=') => {
            known(name, mark, given, errors)
        }
        _ => {
            let words = format!(
                "write `{name}: prior` for an unknown or `{name} = value` \
                 for a known or shared value"
            );
            errors.at(name, words);
            Value::Broken(stream(trees))
        }
    };
    Some(Field { name: name.clone(), value, label: name.to_string() })
}

/// The expression behind `:` or `=`, up to the end of the field.
fn expression(
    mark: &TokenTree,
    given: &[TokenTree],
    errors: &mut Errors,
) -> Option<Expr> {
    if given.is_empty() {
        errors.at(mark, "a value is missing behind this");
        return None;
    }
    let read = |input: ParseStream<'_>| {
        let value = input.parse::<Expr>()?;
        match input.is_empty() {
            true => Ok(value),
            false => Err(input.error("a `,` is missing before this")),
        }
    };
    errors.keep(read.parse2(stream(given)))
}

fn prior(
    name: &Ident,
    mark: &TokenTree,
    given: &[TokenTree],
    errors: &mut Errors,
) -> Value {
    let Some(value) = expression(mark, given, errors) else {
        return Value::Broken(stream(given));
    };
    let read = match &value {
        Expr::Array(list) => list_of_priors(name, list, errors),
        Expr::Repeat(list) => one_prior(name, &list.expr, &value, errors)
            .map(|one| Value::Repeated(one, (*list.len).clone())),
        one => one_prior(name, one, &value, errors).map(Value::Prior),
    };
    read.unwrap_or_else(|| Value::Broken(stream(given)))
}

/// `[prior, prior]`; each value that has none is reported.
fn list_of_priors(
    name: &Ident,
    list: &ExprArray,
    errors: &mut Errors,
) -> Option<Value> {
    let mut priors = Vec::new();
    let mut others = Vec::new();
    for one in &list.elems {
        match as_prior(one) {
            Some(prior) => priors.push(prior),
            None => others.push(one),
        }
    }
    if priors.is_empty() && !others.is_empty() {
        errors.at(list, known_takes_equals(name, list));
        return None;
    }
    for one in others {
        let words = format!(
            "every value of a list behind `:` has a prior: give this one its \
             own, or write all of them as values, `{name} = [..]`"
        );
        errors.at(one, words);
    }
    Some(Value::Priors(priors))
}

fn as_prior(given: &Expr) -> Option<Distribution> {
    match given {
        Expr::Call(call) if distribution::is_meant(call) => {
            Distribution::from_call(call)
        }
        _ => None,
    }
}

fn known_takes_equals(name: &Ident, given: impl ToTokens) -> String {
    format!(
        "behind `:` stands a prior; a known or shared value takes `=`: write \
         `{name} = {}`",
        shown(given)
    )
}

/// One prior; `whole` is what stands behind the `:`.
fn one_prior(
    name: &Ident,
    given: &Expr,
    whole: &Expr,
    errors: &mut Errors,
) -> Option<Distribution> {
    let prior = as_prior(given);
    if prior.is_none() {
        let words = match given {
            Expr::Binary(_) => format!(
                "behind `:` stands one prior, such as `{name}: Gamma(9.0, \
                 0.03)`; combine declared parameters with `{name} = ..`"
            ),
            _ => known_takes_equals(name, whole),
        };
        errors.at(given, words);
    }
    prior
}

fn known(
    name: &Ident,
    mark: &TokenTree,
    given: &[TokenTree],
    errors: &mut Errors,
) -> Value {
    let Some(value) = expression(mark, given, errors) else {
        return Value::Broken(stream(given));
    };
    let prior = match &value {
        Expr::Array(list) => list.elems.first(),
        Expr::Repeat(list) => Some(&*list.expr),
        one => Some(one),
    };
    if let Some(Expr::Call(call)) = prior
        && distribution::is_built_in(call)
    {
        let words = format!(
            "an unknown with a prior takes `:`: write `{name}: {}`",
            shown(&value)
        );
        errors.at(mark, words);
        return Value::Broken(stream(given));
    }
    Value::Known(value)
}
