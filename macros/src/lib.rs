//! The `model!` macro of couloir.

mod body;
mod check;
mod distribution;
mod errors;
mod expand;
mod label;
mod parse;
mod split;
mod tokens;
mod tree;

use errors::Errors;

/// TODO
#[proc_macro]
pub fn model(input: proc_macro::TokenStream) -> proc_macro::TokenStream {
    expand(input.into()).into()
}

/// Tokens to tree, all errors, tree to tokens.
fn expand(input: proc_macro2::TokenStream) -> proc_macro2::TokenStream {
    let fresh = expand::Fresh::new(input.clone());
    let (source, errors) = understand(input);
    let mut tokens = expand::source(&source, &fresh, !errors.is_empty());
    tokens.extend(errors.into_tokens());
    tokens
}

/// The model as a tree, and everything that is wrong with it.
fn understand(input: proc_macro2::TokenStream) -> (tree::Source, Errors) {
    let mut errors = Errors::default();
    let mut source = parse::source(input, &mut errors);
    check::source(&source, &mut errors);
    label::assign(&mut source, &mut errors);
    (source, errors)
}

#[cfg(test)]
mod tests;
