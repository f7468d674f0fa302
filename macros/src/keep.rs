//! `keep name = value;` and `keep name ~ Distribution(..);`: what becomes a
//! column of the draws beside the parameters.

use proc_macro2::{Delimiter, TokenTree};
use syn::Expr;

use crate::distribution;
use crate::errors::Errors;
use crate::tokens::{braces, group, is_mark, is_word, stream};
use crate::tree::{Distribution, Keep, Kept};

/// Where a `keep` starts in a statement, behind blocks that need no `;`.
pub(crate) fn start(trees: &[TokenTree]) -> Option<usize> {
    (0..trees.len()).find(|&i| {
        let first = i == 0 || braces(&trees[i - 1]).is_some();
        let named = matches!(trees.get(i + 1), Some(TokenTree::Ident(_)));
        first && named && is_word(&trees[i], "keep")
    })
}

/// The statement, from `keep` to before its `;`.
pub(crate) fn read(trees: &[TokenTree], errors: &mut Errors) -> Option<Keep> {
    let (name, rest) = match trees {
        [_, TokenTree::Ident(name), rest @ ..] => (name.clone(), rest),
        _ => return None,
    };
    let indexed = rest.first().and_then(|t| group(t, Delimiter::Bracket));
    let index = match indexed {
        Some(inside) => Some(errors.keep(syn::parse2(inside.stream()))?),
        None => None,
    };
    let rest = &rest[usize::from(indexed.is_some())..];
    let right = match rest.split_first() {
        Some((mark, value)) if is_mark(mark, '=') && !value.is_empty() => {
            Kept::Value(errors.keep(syn::parse2(stream(value)))?)
        }
        Some((mark, law)) if is_mark(mark, '~') && !law.is_empty() => {
            Kept::Drawn(drawn(law, errors)?)
        }
        _ => {
            let words = format!(
                "write `keep {name} = value;` for what follows from the \
                 parameters, or `keep {name} ~ Normal(..);` for a draw"
            );
            errors.at(&name, words);
            return None;
        }
    };
    Some(Keep { name, index, right })
}

fn drawn(law: &[TokenTree], errors: &mut Errors) -> Option<Distribution> {
    match errors.keep(syn::parse2(stream(law)))? {
        Expr::Call(call) if distribution::is_meant(&call) => {
            Distribution::from_call(&call)
        }
        other => {
            let words = "behind `~` stands a distribution to draw from, such \
                         as `Normal(0.0, 1.0)`; a value takes `=`";
            errors.at(other, words);
            None
        }
    }
}
