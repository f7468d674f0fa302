//! Tokens to tree: the struct, the declarations and their right sides.
//!
//! Every line is read on its own, so that an error in one leaves the others
//! understood.

use proc_macro2::{Group, Ident, TokenStream, TokenTree};
use syn::ext::IdentExt;
use syn::parse::{ParseStream, Parser};
use syn::visit::Visit;
use syn::{Expr, ItemStruct, Path, Stmt, Token, token};

use crate::body;
use crate::distribution;
use crate::errors::Errors;
use crate::split::{self, Part};
use crate::tokens::{attributes, braces, find, is_mark, is_word};
use crate::tokens::{shown, split, stream};
use crate::tree::{Body, Count, Declaration, Distribution, Field, Let, Line};
use crate::tree::{Right, Source, Term, Value};

/// Reads a whole model; what cannot be understood is reported.
pub(crate) fn source(input: TokenStream, errors: &mut Errors) -> Source {
    let mut source =
        Source { structure: None, lines: Vec::new(), bodies: Vec::new() };
    for part in split::parts(input, errors) {
        match part {
            Part::Struct(tokens) => structure(tokens, &mut source, errors),
            Part::Line(trees) => {
                if let Some(body) = source.bodies.last() {
                    late(&trees, body, errors);
                }
                source.lines.extend(line(&trees, errors));
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
    let Some(item) = read else { return };
    if source.structure.is_some() {
        let words = "a second struct: a model has one, write this one \
                     outside `model!`";
        return errors.at(item.ident, words);
    }
    source.structure = Some(item);
}

fn late(trees: &[TokenTree], body: &Body, errors: &mut Errors) {
    let words = format!(
        "this stands below `{}`: move the line above it",
        body.keyword
    );
    let (_, rest) = attributes(trees);
    if let Some(first) = rest.first() {
        errors.at(first, words);
    }
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
    let Some(tilde) = find(rest, '~') else {
        no_tilde(rest, errors);
        return Some(broken(rest, rest.len()));
    };
    let head = errors.keep(head.parse2(stream(&rest[..tilde])));
    let right = right(&rest[tilde], &rest[tilde + 1..], errors);
    Some(match (head, right) {
        (Some((name, count)), Some(right)) => {
            Line::Declaration(Box::new(Declaration { name, count, right }))
        }
        _ => broken(rest, tilde),
    })
}

/// A line that was not understood; its name is kept if it has one.
fn broken(trees: &[TokenTree], tilde: usize) -> Line {
    let name = match trees {
        [TokenTree::Ident(name), ..] => Some(name.clone()),
        _ => None,
    };
    let from = if name.is_some() { 1 } else { tilde.min(trees.len()) };
    Line::Broken { name, tokens: stream(&trees[from..]) }
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
    statement.extend(quote::quote!(;));
    let local = match errors.keep(syn::parse2(statement.clone())) {
        Some(Stmt::Local(local)) => local,
        _ => return broken(trees, 0),
    };
    let mut names = Names(Vec::new());
    names.visit_pat(&local.pat);
    let value = match &local.init {
        Some(init) => quote::ToTokens::to_token_stream(&init.expr),
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

/// A distribution, or blocks with `+` between.
fn right(
    tilde: &TokenTree,
    trees: &[TokenTree],
    errors: &mut Errors,
) -> Option<Right> {
    let terms = split(trees, '+');
    let mut blocks = Vec::new();
    let mut distributions = Vec::new();
    for term in &terms {
        match side(tilde, term, errors)? {
            Side::Block(block) => blocks.push(block),
            Side::Distribution(distribution) => {
                distributions.push(distribution);
            }
        }
    }
    match distributions.pop() {
        None => Some(Right::Blocks(blocks)),
        Some(only) if terms.len() == 1 => Some(Right::Distribution(only)),
        Some(one) => {
            let words = "`+` adds blocks, such as `Coulomb { .. } + \
                         Turbulent { .. }`: a distribution stands alone";
            errors.at(one.path, words);
            None
        }
    }
}

enum Side {
    Block(Term),
    Distribution(Distribution),
}

/// One term of a right side.
fn side(
    tilde: &TokenTree,
    trees: &[TokenTree],
    errors: &mut Errors,
) -> Option<Side> {
    let Some((last, before)) = trees.split_last() else {
        let words = "a block or a distribution is missing here, such as \
                     `Coulomb { .. }` or `Normal(0.0, 1.0)`";
        errors.at(tilde, words);
        return None;
    };
    if let Some(inside) = braces(last)
        && let Ok(path) = Path::parse_mod_style.parse2(stream(before))
    {
        return Some(Side::Block(block(path, inside, errors)));
    }
    match syn::parse2::<Expr>(stream(trees)) {
        Ok(Expr::Call(call)) if distribution::is_meant(&call) => {
            Distribution::from_call(&call).map(Side::Distribution)
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
        Expr::Array(list) => list
            .elems
            .iter()
            .map(|one| one_prior(name, one, &value, errors))
            .collect::<Option<_>>()
            .map(Value::Priors),
        Expr::Repeat(list) => one_prior(name, &list.expr, &value, errors)
            .map(|one| Value::Repeated(one, (*list.len).clone())),
        one => one_prior(name, one, &value, errors).map(Value::Prior),
    };
    read.unwrap_or_else(|| Value::Broken(stream(given)))
}

fn one_prior(
    name: &Ident,
    given: &Expr,
    whole: &Expr,
    errors: &mut Errors,
) -> Option<Distribution> {
    if let Expr::Call(call) = given
        && distribution::is_meant(call)
    {
        return Distribution::from_call(call);
    }
    let words = match given {
        Expr::Binary(_) => format!(
            "behind `:` stands one prior, such as `{name}: Gamma(9.0, \
             0.03)`; combine declared parameters with `{name} = ..`"
        ),
        _ => format!(
            "behind `:` stands a prior; a known or shared value takes `=`: \
             write `{name} = {}`",
            shown(whole)
        ),
    };
    errors.at(given, words);
    None
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
