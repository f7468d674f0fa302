//! The errors of one expansion, collected so that none is lost.

use std::fmt::Display;

use proc_macro2::{Span, TokenStream};
use quote::ToTokens;

/// All errors found so far, each on the user's own token.
#[derive(Debug, Default)]
#[must_use]
pub(crate) struct Errors(Vec<syn::Error>);

impl Errors {
    /// An error underlining `tokens`.
    pub(crate) fn at(&mut self, tokens: impl ToTokens, words: impl Display) {
        self.push(syn::Error::new_spanned(tokens, words));
    }

    /// An error underlining the token at `span`.
    pub(crate) fn at_span(&mut self, span: Span, words: impl Display) {
        self.push(syn::Error::new(span, words));
    }

    /// An error that a parser found.
    pub(crate) fn push(&mut self, error: syn::Error) {
        self.0.push(error);
    }

    /// All errors of another collection.
    pub(crate) fn append(&mut self, mut others: Self) {
        self.0.append(&mut others.0);
    }

    /// What a parser understood; its error is kept.
    pub(crate) fn keep<T>(&mut self, result: syn::Result<T>) -> Option<T> {
        result.map_err(|error| self.push(error)).ok()
    }

    /// Whether nothing was wrong.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The errors in the order in which the user wrote their causes.
    pub(crate) fn sorted(mut self) -> Vec<syn::Error> {
        self.0.sort_by_key(|error| error.span().start());
        self.0
    }

    /// One `compile_error!` for each.
    pub(crate) fn into_tokens(self) -> TokenStream {
        self.sorted().iter().map(syn::Error::to_compile_error).collect()
    }
}
