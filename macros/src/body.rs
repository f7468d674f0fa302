//! The likelihood's body: ordinary Rust in which `~` lines are found.
//!
//! `~` is no operator of Rust, so the tokens are walked statement by
//! statement, into every pair of braces; whatever is no `~` line is passed on
//! with its own spans.

use proc_macro2::{Delimiter, Spacing, Span, TokenStream, TokenTree};
use syn::parse::{ParseStream, Parser};
use syn::{BinOp, Expr};

use crate::distribution;
use crate::errors::Errors;
use crate::keep;
use crate::tokens::{braces, contains, find, is_mark, is_word, split, stream};
use crate::tree::{Distribution, Observation, Piece, Sampling};

/// The pieces of what stands between two braces.
pub(crate) fn pieces(tokens: TokenStream, errors: &mut Errors) -> Vec<Piece> {
    let trees: Vec<_> = tokens.into_iter().collect();
    let mut walk = Walk { pieces: Vec::new(), errors };
    let mut rest = &trees[..];
    while let Some(end) = find(rest, ';') {
        walk.statement(&rest[..end], true);
        walk.pieces.push(Piece::Token(rest[end].clone()));
        rest = &rest[end + 1..];
    }
    walk.statement(rest, false);
    walk.pieces
}

struct Walk<'a> {
    pieces: Vec<Piece>,
    errors: &'a mut Errors,
}

impl Walk<'_> {
    /// A statement, behind blocks that need no `;` of their own.
    fn statement(&mut self, trees: &[TokenTree], ended: bool) {
        if let Some(start) = keep::start(trees) {
            return self.own(trees, start, ended, Self::keep);
        }
        if let Some(start) = increment(trees) {
            return self.own(trees, start, ended, Self::increment);
        }
        let Some(tilde) = find(trees, '~') else {
            return self.ordinary(trees);
        };
        let start = start(trees, tilde);
        let arm = start > 0 && is_mark(&trees[start - 1], '>');
        let comma = find(&trees[tilde..], ',').filter(|_| arm);
        let end = comma.map_or(trees.len(), |comma| tilde + comma);
        self.ordinary(&trees[..start]);
        self.line(&trees[start..end], tilde - start);
        if !(ended || arm) {
            let last = &trees[end - 1];
            let words = "a `;` is missing behind this";
            self.errors.at_span(last_span(last), words);
        }
        if let Some(comma) = trees.get(end) {
            self.pieces.push(Piece::Token(comma.clone()));
            self.statement(&trees[end + 1..], ended);
        }
    }

    /// A statement of the language's own, from `start` on.
    fn own(
        &mut self,
        trees: &[TokenTree],
        start: usize,
        ended: bool,
        read: fn(&mut Self, &[TokenTree]),
    ) {
        self.ordinary(&trees[..start]);
        read(self, &trees[start..]);
        if let (false, Some(last)) = (ended, trees.last()) {
            let words = "a `;` is missing behind this";
            self.errors.at_span(last_span(last), words);
        }
    }

    fn keep(&mut self, trees: &[TokenTree]) {
        let read = keep::read(trees, self.errors);
        self.pieces.extend(read.map(|keep| Piece::Keep(Box::new(keep))));
    }

    /// `log_density += value`
    fn increment(&mut self, trees: &[TokenTree]) {
        let read = whole("a `;` is missing before this");
        let value = self.errors.keep(read.parse2(stream(&trees[3..])));
        if let (TokenTree::Ident(word), Some(value)) = (&trees[0], value) {
            let value = Box::new(value);
            self.pieces.push(Piece::Increment(word.clone(), value));
        }
    }

    /// Tokens outside `~` lines; braces among them are walked.
    fn ordinary(&mut self, trees: &[TokenTree]) {
        for tree in trees {
            if let Some(inside) = braces(tree) {
                let pieces = pieces(inside.stream(), self.errors);
                self.pieces.push(Piece::Braces(inside.span(), pieces));
                continue;
            }
            if let TokenTree::Group(inside) = tree
                && let Some(tilde) = contains(inside.stream(), '~')
            {
                let words = "a `~` line is a statement of its own: take it \
                             out of the brackets, into a `for` loop, say";
                self.errors.at(tilde, words);
            }
            self.pieces.push(Piece::Token(tree.clone()));
        }
    }

    /// `data ~ prediction + noise` or `data ~ Distribution(..)`.
    fn line(&mut self, trees: &[TokenTree], tilde: usize) {
        let (data, law) = (&trees[..tilde], &trees[tilde + 1..]);
        let mark = trees[tilde].span();
        let data = self.data(data, mark);
        let law = self.law(law, mark);
        self.pieces.push(match (data, law) {
            (Some(data), Some(law)) => {
                Piece::Observation(Box::new(Observation {
                    data,
                    tilde: mark,
                    law,
                }))
            }
            (_, law) => Piece::Broken(law.map(Box::new)),
        });
    }

    fn data(&mut self, trees: &[TokenTree], tilde: Span) -> Option<Expr> {
        let Some(first) = trees.first() else {
            let words = "what was recorded stands left of `~`, as in \
                         `event.velocity ~ ..`";
            self.errors.at_span(tilde, words);
            return None;
        };
        if is_word(first, "let") {
            let words = "a `;` is missing between this `let` and the `~` \
                         behind it";
            self.errors.at(first, words);
            return None;
        }
        let read = whole("a `;` is missing before this");
        self.errors.keep(read.parse2(stream(trees)))
    }

    fn law(&mut self, trees: &[TokenTree], tilde: Span) -> Option<Sampling> {
        if trees.is_empty() {
            self.errors.at_span(tilde, NEITHER);
            return None;
        }
        if let Some(second) = find(trees, '~') {
            let words = "a second `~` in one statement: a `;` is missing at \
                         the end of the line before it";
            self.errors.at(&trees[second], words);
            return None;
        }
        let read = whole("a `;` is missing before this");
        let law = self.errors.keep(read.parse2(stream(trees)))?;
        self.sampling(law)
    }

    fn sampling(&mut self, law: Expr) -> Option<Sampling> {
        match law {
            Expr::Call(call) if distribution::is_meant(&call) => {
                Distribution::from_call(&call).map(Sampling::Distribution)
            }
            Expr::Binary(sum) if matches!(sum.op, BinOp::Add(_)) => {
                Some(Sampling::Noise {
                    prediction: sum.left,
                    noise: sum.right,
                })
            }
            Expr::Binary(sum) if matches!(sum.op, BinOp::Sub(_)) => {
                let words = "the noise is added: write `.. + errors`";
                self.errors.at(sum.op, words);
                None
            }
            other => {
                self.errors.at(other, NEITHER);
                None
            }
        }
    }
}

const NEITHER: &str = "expected `prediction + noise`, such as \
                       `flow.velocity() + errors`, or a distribution, such \
                       as `Normal(flow.runout()?, 5.0)`";

/// One expression and nothing behind it.
fn whole(
    words: &'static str,
) -> impl FnOnce(ParseStream<'_>) -> syn::Result<Expr> {
    move |input| {
        let value = input.parse()?;
        match input.is_empty() {
            true => Ok(value),
            false => Err(input.error(words)),
        }
    }
}

/// Where a `log_density += ..` starts in a statement.
fn increment(trees: &[TokenTree]) -> Option<usize> {
    (0..trees.len()).find(|&i| {
        let first = i == 0 || braces(&trees[i - 1]).is_some();
        first
            && is_word(&trees[i], "log_density")
            && trees.get(i + 1).is_some_and(|tree| is_mark(tree, '+'))
            && trees.get(i + 2).is_some_and(|tree| is_mark(tree, '='))
    })
}

/// Where the statement with the `~` starts: behind a block or a `=>`.
fn start(trees: &[TokenTree], tilde: usize) -> usize {
    (1..=tilde)
        .rev()
        .find(|&i| {
            let arrow = i >= 2
                && is_mark(&trees[i - 2], '=')
                && is_mark(&trees[i - 1], '>');
            braces(&trees[i - 1]).is_some() || arrow
        })
        .unwrap_or(0)
}

fn last_span(tree: &TokenTree) -> Span {
    match tree {
        TokenTree::Group(group) if group.delimiter() != Delimiter::None => {
            group.span_close()
        }
        tree => tree.span(),
    }
}

/// Every `.. = right` that is a statement, with what stands on its right.
pub(crate) fn assignments(
    tokens: TokenStream,
) -> Vec<(TokenTree, Vec<TokenTree>)> {
    let trees: Vec<_> = tokens.into_iter().collect();
    let mut found = Vec::new();
    for statement in split(&trees, ';') {
        let inner = statement.iter().filter_map(braces);
        found.extend(inner.flat_map(|group| assignments(group.stream())));
        let start = start(statement, statement.len());
        let statement = &statement[start..];
        let is_let = statement.first().is_some_and(|t| is_word(t, "let"));
        if let Some(i) = (0..statement.len()).find(|&i| assigns(statement, i))
            && !is_let
        {
            found.push((statement[i].clone(), statement[i + 1..].to_vec()));
        }
    }
    found
}

/// Whether the i-th token is a `=` by itself.
fn assigns(trees: &[TokenTree], i: usize) -> bool {
    let joint = |tree: &TokenTree| matches!(tree, TokenTree::Punct(p) if p.spacing() == Spacing::Joint);
    let alone = i == 0 || !joint(&trees[i - 1]);
    is_mark(&trees[i], '=') && !joint(&trees[i]) && alone
}
