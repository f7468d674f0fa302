//! Cuts the tokens of a model into its struct, its lines and its likelihood.

use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream, TokenTree};

use crate::distribution::distance;
use crate::errors::Errors;
use crate::keep;
use crate::tokens::{attributes, braces, group, is_mark, is_word, stream};

/// One part of a model, not yet understood.
pub(crate) enum Part {
    /// `pub struct Name { .. }` with its attributes.
    Struct(TokenStream),
    /// What stands before a `;`, attributes included.
    Line(Vec<TokenTree>),
    /// `likelihood { .. }`
    Likelihood(Ident, Group),
}

/// The parts in order; every missing `;` is reported and mended.
pub(crate) fn parts(input: TokenStream, errors: &mut Errors) -> Vec<Part> {
    let mut cutter = Cutter { parts: Vec::new(), line: Vec::new(), errors };
    let trees: Vec<_> = input.into_iter().collect();
    let mut next = 0;
    while let Some(tree) = trees.get(next) {
        next += 1;
        if let (TokenTree::Ident(word), Some(body)) =
            (tree, trees.get(next).and_then(braces))
            && cutter.starts_likelihood(word)
        {
            next += 1;
            cutter.likelihood(word, body);
        } else {
            cutter.take(tree);
        }
    }
    cutter.end_unfinished();
    cutter.parts
}

struct Cutter<'a> {
    parts: Vec<Part>,
    line: Vec<TokenTree>,
    errors: &'a mut Errors,
}

impl Cutter<'_> {
    fn take(&mut self, tree: &TokenTree) {
        if is_mark(tree, ';') {
            return self.end();
        }
        if is_word(tree, "let") && self.line.last().is_some_and(may_end) {
            self.end_unfinished();
        }
        self.line.push(tree.clone());
        if braces(tree).is_some() && self.is_struct() {
            self.parts.push(Part::Struct(stream(&self.line)));
            self.line.clear();
        }
    }

    fn is_struct(&self) -> bool {
        let (_, rest) = attributes(&self.line);
        let colon = |tree: &TokenTree| is_mark(tree, '~');
        rest.iter().take_while(|t| !colon(t)).any(|t| is_word(t, "struct"))
    }

    /// Whether `word`, with braces behind it, opens the likelihood; a slip of
    /// the pen counts where a line could not start like that.
    fn starts_likelihood(&self, word: &Ident) -> bool {
        let (_, rest) = attributes(&self.line);
        let alone = rest.is_empty();
        word == "likelihood"
            || (alone && distance(&word.to_string(), "likelihood") <= 3)
    }

    fn likelihood(&mut self, word: &Ident, body: &Group) {
        let (_, rest) = attributes(&self.line);
        if rest.is_empty() {
            self.line.clear();
        }
        self.end_unfinished();
        if word != "likelihood" {
            let words = format!("write `likelihood` instead of `{word}`");
            self.errors.at(word, words);
        }
        self.parts.push(Part::Likelihood(word.clone(), body.clone()));
    }

    /// A line has ended; where it holds two declarations, a `;` is missing.
    fn end(&mut self) {
        let mut line = std::mem::take(&mut self.line);
        while let Some(start) = second_declaration(&line) {
            let rest = line.split_off(start);
            self.missing(line.last());
            self.parts.push(line_or_struct(line));
            line = rest;
        }
        if !line.is_empty() {
            self.parts.push(line_or_struct(line));
        }
    }

    /// A line has ended without its `;`.
    fn end_unfinished(&mut self) {
        let (_, rest) = attributes(&self.line);
        if is_declaration(rest) {
            let last = rest.last().cloned();
            self.missing(last.as_ref());
        }
        self.end();
    }

    fn missing(&mut self, last: Option<&TokenTree>) {
        let Some(last) = last else { return };
        let span = match last {
            TokenTree::Group(group) => group.span_close(),
            tree => tree.span(),
        };
        self.errors.at_span(span, "a `;` is missing behind this");
    }
}

/// A struct without braces ends at a `;` as lines do.
fn line_or_struct(line: Vec<TokenTree>) -> Part {
    let (_, rest) = attributes(&line);
    let head = rest.iter().take(3);
    if head.into_iter().any(|tree| is_word(tree, "struct")) {
        let mut item = stream(&line);
        let end = line.last().map_or_else(Span::call_site, TokenTree::span);
        item.extend(quote::quote_spanned!(end=> ;));
        return Part::Struct(item);
    }
    Part::Line(line)
}

/// Whether the tokens are a line at all, as far as one can tell.
fn is_declaration(line: &[TokenTree]) -> bool {
    keep::start(line) == Some(0)
        || line.first().is_some_and(|first| is_word(first, "let"))
        || line.iter().any(|tree| is_mark(tree, '~'))
}

/// Whether an expression may end with `tree`.
fn may_end(tree: &TokenTree) -> bool {
    match tree {
        TokenTree::Group(_) | TokenTree::Literal(_) => true,
        TokenTree::Ident(word) => {
            !["if", "while", "else"].iter().any(|w| word == w)
        }
        TokenTree::Punct(_) => false,
    }
}

/// Where the second declaration of a line starts: at the name before its
/// second `~`, or before its first in a `let`.
fn second_declaration(line: &[TokenTree]) -> Option<usize> {
    let (_, rest) = attributes(line);
    let is_let = rest.first().is_some_and(|first| is_word(first, "let"));
    let mut tildes = line.iter().enumerate().filter(|(_, t)| is_mark(t, '~'));
    let (tilde, _) = tildes.nth(usize::from(!is_let))?;
    let indexed = group(line.get(tilde.checked_sub(1)?)?, Delimiter::Bracket);
    let name = tilde.checked_sub(1 + usize::from(indexed.is_some()))?;
    let is_name = matches!(line.get(name), Some(TokenTree::Ident(_)));
    (is_name && name > 0 && may_end(&line[name - 1])).then_some(name)
}
