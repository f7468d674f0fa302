//! Small questions about token streams that no parser answers.

use proc_macro2::{Delimiter, Group, Ident, TokenStream, TokenTree};
use quote::ToTokens;

/// Whether `tree` is the punctuation mark `mark`.
pub(crate) fn is_mark(tree: &TokenTree, mark: char) -> bool {
    matches!(tree, TokenTree::Punct(punct) if punct.as_char() == mark)
}

/// Whether `tree` is the word `word`.
pub(crate) fn is_word(tree: &TokenTree, word: &str) -> bool {
    matches!(tree, TokenTree::Ident(ident) if ident == word)
}

/// `tree` as a group in braces.
pub(crate) fn braces(tree: &TokenTree) -> Option<&Group> {
    group(tree, Delimiter::Brace)
}

/// `tree` as a group with the given delimiter.
pub(crate) fn group(tree: &TokenTree, with: Delimiter) -> Option<&Group> {
    match tree {
        TokenTree::Group(group) if group.delimiter() == with => Some(group),
        _ => None,
    }
}

/// The place of the first `mark` outside all brackets.
pub(crate) fn find(trees: &[TokenTree], mark: char) -> Option<usize> {
    trees.iter().position(|tree| is_mark(tree, mark))
}

/// The tokens as a stream.
pub(crate) fn stream(trees: &[TokenTree]) -> TokenStream {
    trees.iter().cloned().collect()
}

/// The pieces between the `mark`s outside all brackets, turbofish included.
pub(crate) fn split(trees: &[TokenTree], mark: char) -> Vec<&[TokenTree]> {
    let mut pieces = Vec::new();
    let (mut start, mut depth) = (0, 0_usize);
    for (i, tree) in trees.iter().enumerate() {
        let before = |n: usize, mark| i >= n && is_mark(&trees[i - n], mark);
        if is_mark(tree, '<') && (depth > 0 || before(1, ':')) {
            depth += 1;
        } else if is_mark(tree, '>') && !before(1, '-') {
            depth = depth.saturating_sub(1);
        } else if depth == 0 && is_mark(tree, mark) {
            pieces.push(&trees[start..i]);
            start = i + 1;
        }
    }
    pieces.push(&trees[start..]);
    pieces
}

/// The attributes at the start, and the rest.
pub(crate) fn attributes(
    trees: &[TokenTree],
) -> (Vec<&[TokenTree]>, &[TokenTree]) {
    let (mut found, mut rest) = (Vec::new(), trees);
    while let [mark, brackets, ..] = rest
        && is_mark(mark, '#')
        && group(brackets, Delimiter::Bracket).is_some()
    {
        found.push(&rest[..2]);
        rest = &rest[2..];
    }
    (found, rest)
}

/// Whether `mark` stands anywhere inside, at any depth.
pub(crate) fn contains(tokens: TokenStream, mark: char) -> Option<TokenTree> {
    tokens.into_iter().find_map(|tree| match tree {
        TokenTree::Group(group) => contains(group.stream(), mark),
        tree => is_mark(&tree, mark).then_some(tree),
    })
}

/// The names that stand for values in `tokens`: no fields, methods, paths or
/// names just being bound; those inside a format string count.
pub(crate) fn uses(tokens: impl ToTokens) -> Vec<Ident> {
    let mut found = Vec::new();
    collect_uses(tokens.into_token_stream(), &mut found);
    found
}

fn collect_uses(tokens: TokenStream, found: &mut Vec<Ident>) {
    let trees: Vec<_> = tokens.into_iter().collect();
    for (i, tree) in trees.iter().enumerate() {
        match tree {
            TokenTree::Group(group) => collect_uses(group.stream(), found),
            TokenTree::Ident(name) if is_use(&trees, i) => {
                found.push(name.clone());
            }
            TokenTree::Literal(text) => {
                let text = text.to_string();
                let named = text.split('{').skip(1).filter_map(first_word);
                found.extend(named.map(|name| Ident::new(name, tree.span())));
            }
            TokenTree::Ident(_) | TokenTree::Punct(_) => {}
        }
    }
}

fn is_use(trees: &[TokenTree], i: usize) -> bool {
    let before = |n: usize, mark| i >= n && is_mark(&trees[i - n], mark);
    let after =
        |n: usize, mark| trees.get(i + n).is_some_and(|t| is_mark(t, mark));
    let word = |n: usize, word| i >= n && is_word(&trees[i - n], word);
    let member = before(1, '.') && !before(2, '.');
    let field = after(1, ':') && !after(2, ':');
    let path = before(1, ':') && before(2, ':');
    let bound = word(1, "let") || (word(1, "mut") && word(2, "let"));
    !(member || field || path || bound)
}

/// The identifier at the start of what stands behind a `{` in a string.
fn first_word(text: &str) -> Option<&str> {
    let end = text
        .find(|c: char| !(c.is_alphanumeric() || c == '_'))
        .unwrap_or(text.len());
    let word = &text[..end];
    syn::parse_str::<Ident>(word).is_ok().then_some(word)
}

/// The user's tokens for a message; `..` where they would be too long.
pub(crate) fn shown(tokens: impl ToTokens) -> String {
    let text = tokens.into_token_stream().to_string();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if text.len() > 48 { "..".to_owned() } else { text }
}
