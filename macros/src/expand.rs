//! Tree to tokens: the struct, its constructor and one `impl Program`.
//!
//! Names that the macro makes are hygienic and stand at the user's tokens, so
//! that rustc's errors underline those and not the whole macro.

use std::collections::HashSet;

use proc_macro2::{Group, Ident, Span, TokenStream, TokenTree};
use quote::{ToTokens, quote, quote_spanned};
use syn::spanned::Spanned;
use syn::{Expr, ExprReference, Generics, ItemStruct, Path, Type};

use crate::distribution::{BuiltIn, Need, Of};
use crate::tree::{Body, Count, Declaration, Distribution, Field, Keep};
use crate::tree::{
    Kept, Line, Observation, Piece, Right, Sampling, Source, Term, Value,
};

/// The whole expansion; with `broken`, a program that does nothing stands in,
/// so that no errors follow from those already reported.
pub(crate) fn source(
    source: &Source,
    fresh: &Fresh,
    broken: bool,
) -> TokenStream {
    let Some(item) = &source.structure else { return TokenStream::new() };
    let kind = fresh.name("K");
    let writer = Writer { kind: &kind, fresh };
    let (run, body) = match broken {
        true => (quote!(_), writer.mentions(source)),
        false => {
            let run = at(item.ident.span(), "run");
            (run.to_token_stream(), writer.program(source))
        }
    };
    let bindings = item.fields.iter().filter_map(binding);
    let (name, constructor) = (&item.ident, constructor(item));
    let generics = shared(item);
    let (generics, arguments, conditions) = generics.split_for_impl();
    let at = Span::mixed_site().located_at(name.span());
    quote_spanned! {at=>
        #item
        #constructor
        impl #generics ::couloir::Program for #name #arguments #conditions {
            fn run<#kind: ::couloir::Number>(
                &self,
                #run: &mut ::couloir::Run<'_, #kind>,
            ) -> ::couloir::Outcome {
                #(#bindings)*
                #body
                ::core::result::Result::Ok(())
            }
        }
    }
}

/// The struct's generics; where there are any, which is an error already,
/// without a second one for being no program.
fn shared(item: &ItemStruct) -> Generics {
    let mut generics = item.generics.clone();
    if !generics.params.is_empty() {
        let sync = syn::parse_quote!(Self: ::core::marker::Sync);
        generics.make_where_clause().predicates.push(sync);
    }
    generics
}

/// `fn new(field, ..) -> Self`, as visible as the struct.
fn constructor(item: &ItemStruct) -> TokenStream {
    let syn::Fields::Named(fields) = &item.fields else {
        return TokenStream::new();
    };
    let (name, visibility) = (&item.ident, &item.vis);
    let (generics, arguments, conditions) = item.generics.split_for_impl();
    let names: Vec<_> =
        fields.named.iter().filter_map(|f| f.ident.as_ref()).collect();
    let types = fields.named.iter().map(|f| &f.ty);
    let doc = format!("A [`{name}`] of its data, field by field.");
    let at = Span::mixed_site().located_at(name.span());
    quote_spanned! {at=>
        impl #generics #name #arguments #conditions {
            #[doc = #doc]
            #[allow(clippy::too_many_arguments, clippy::new_without_default)]
            #visibility fn new(#(#names: #types),*) -> Self {
                Self { #(#names),* }
            }
        }
    }
}

/// `let field = &self.field;`, without the `&` for numbers and references.
fn binding(field: &syn::Field) -> Option<TokenStream> {
    let name = field.ident.as_ref()?;
    let at = Span::mixed_site().located_at(name.span());
    let borrow = (!is_copied(&field.ty)).then(|| quote_spanned!(at=> &));
    Some(quote_spanned! {at=>
        #[allow(unused_variables)]
        let #name = #borrow self.#name;
    })
}

const NUMBERS: [&str; 16] = [
    "f64", "f32", "usize", "isize", "u8", "u16", "u32", "u64", "u128", "i8",
    "i16", "i32", "i64", "i128", "bool", "char",
];

fn is_copied(given: &Type) -> bool {
    match given {
        Type::Reference(reference) => reference.mutability.is_none(),
        Type::Path(path) => path
            .path
            .get_ident()
            .is_some_and(|name| NUMBERS.iter().any(|number| name == number)),
        _ => false,
    }
}

/// Type names that the user does not use.
///
/// rustc's hygiene covers local variables only; a type named `K` beside the
/// model would be hidden by the method's own parameter.
pub(crate) struct Fresh(HashSet<String>);

impl Fresh {
    /// For a model of those tokens.
    pub(crate) fn new(tokens: TokenStream) -> Self {
        let mut taken = HashSet::new();
        collect(tokens, &mut taken);
        Self(taken)
    }

    /// `wanted`, with as many `1` behind it as it takes to be new.
    fn name(&self, wanted: &str) -> Ident {
        let mut name = wanted.to_owned();
        while self.0.contains(&name) {
            name.push('1');
        }
        Ident::new(&name, Span::mixed_site())
    }
}

fn collect(tokens: TokenStream, taken: &mut HashSet<String>) {
    for tree in tokens {
        match tree {
            TokenTree::Group(group) => collect(group.stream(), taken),
            TokenTree::Ident(name) => {
                taken.insert(name.to_string());
            }
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
        }
    }
}

/// The macro's own name `name`, at the user's `span`.
fn at(span: Span, name: &str) -> Ident {
    Ident::new(name, Span::mixed_site().located_at(span))
}

/// Writes the lines of `run`.
struct Writer<'a> {
    /// The method's type parameter.
    kind: &'a Ident,
    fresh: &'a Fresh,
}

impl Writer<'_> {
    fn program(&self, source: &Source) -> TokenStream {
        let lines = source.lines.iter().map(|line| self.line(line));
        let body = source.bodies.first().map(|body| self.body(body));
        quote!(#(#lines)* #body)
    }

    /// The blocks of a broken model, so that their imports count as used.
    fn mentions(&self, source: &Source) -> TokenStream {
        let rights = source.lines.iter().flat_map(|line| match line {
            Line::Declaration(declaration) => {
                std::slice::from_ref(&declaration.right)
            }
            Line::Broken(broken) => &broken.parts,
            Line::Let(_) | Line::Keep(_) => &[],
        });
        let terms = rights.flat_map(Right::terms).enumerate();
        terms
            .map(|(i, term)| {
                let (_, alias) = self.alias(i, &term.path);
                quote!(#[allow(dead_code)] #alias)
            })
            .collect()
    }

    /// `type Name<S> = Path<S>;`, and its name.
    ///
    /// It names the user's type once, so that a misspelt one is one error.
    fn alias(&self, i: usize, path: &Path) -> (Ident, TokenStream) {
        let site = Span::mixed_site().located_at(path.span());
        let mut name = self.fresh.name(&format!("Block{i}"));
        name.set_span(site);
        let number = self.fresh.name("S");
        let item = quote_spanned! {site=>
            type #name<#number> = #path<#number>;
        };
        (name, item)
    }

    fn line(&self, line: &Line) -> TokenStream {
        match line {
            Line::Let(local) => local.statement.clone(),
            Line::Keep(keep) => {
                let keep = self.keep(keep);
                quote!(#keep;)
            }
            Line::Declaration(declaration) => self.declaration(declaration),
            Line::Broken(_) => TokenStream::new(),
        }
    }

    fn declaration(&self, declaration: &Declaration) -> TokenStream {
        let name = &declaration.name;
        let value = match (&declaration.right, &declaration.count) {
            (Right::Distribution(prior), Count::Vector(length)) => {
                self.vector(name, length, prior)
            }
            (Right::Distribution(prior), _) => {
                let label = label(name, &name.to_string(), &quote!("1"));
                let label = indexed(label, &declaration.count);
                match &declaration.given {
                    None => self.scalar(&label, prior),
                    Some(given) => self.given(&label, given, prior),
                }
            }
            (Right::Blocks(terms), count) => self.blocks(name, terms, count),
        };
        let value = match &declaration.count {
            Count::Each { index, range } => {
                let list = self.list_of(&declaration.right);
                each(name, &list, index, range, &value)
            }
            Count::One | Count::Vector(_) => value,
        };
        let at = Span::mixed_site().located_at(name.span());
        quote_spanned!(at=> let #name = #value;)
    }

    /// `run.scalar(label, prior)?`
    fn scalar(
        &self,
        label: &TokenStream,
        prior: &Distribution,
    ) -> TokenStream {
        let span = prior.path.span();
        let (run, prior) = (at(span, "run"), self.distribution(prior));
        let at = Span::mixed_site().located_at(span);
        quote_spanned!(at=> #run.scalar(#label, #prior)?)
    }

    /// `run.given(label, &datum, prior)?`
    fn given(
        &self,
        label: &TokenStream,
        given: &Expr,
        prior: &Distribution,
    ) -> TokenStream {
        let span = prior.path.span();
        let (run, prior) = (at(span, "run"), self.distribution(prior));
        let given = reference(given);
        let at = Span::mixed_site().located_at(span);
        quote_spanned!(at=> #run.given(#label, #given, #prior)?)
    }

    /// The type of a list of what is declared for each index; numbers say
    /// theirs, so that each may depend on those before it.
    fn list_of(&self, right: &Right) -> TokenStream {
        let kind = self.kind;
        match right {
            Right::Distribution(_) => quote! {
                ::couloir::block::List::<::couloir::Real<#kind>>
            },
            Right::Blocks(_) => quote!(::couloir::block::List),
        }
    }

    /// `let name = value; run.keep(label, &name)`, `run.keep_draw(..)`
    fn keep(&self, keep: &Keep) -> TokenStream {
        let name = &keep.name;
        let run = at(name.span(), "run");
        let mut label = label(name, &name.to_string(), &quote!("1"));
        if let Some(index) = &keep.index {
            let at = Span::mixed_site().located_at(index.span());
            label = quote_spanned!(at=> #label.at(#index));
        }
        let at = Span::mixed_site().located_at(name.span());
        match (&keep.right, keep.bound()) {
            (Kept::Drawn(law), _) => {
                let law = self.distribution(law);
                quote_spanned!(at=> #run.keep_draw(#label, #law))
            }
            (Kept::Value(value), Some(name)) => quote_spanned! {at=>
                let #name = #value;
                #run.keep(#label, &#name)
            },
            (Kept::Value(value), None) => {
                let value = reference(value);
                quote_spanned!(at=> #run.keep(#label, #value))
            }
        }
    }

    /// `run.vector(label, length, prior)?`, or `run.joint(..)?`
    fn vector(
        &self,
        name: &Ident,
        length: &Expr,
        prior: &Distribution,
    ) -> TokenStream {
        let label = label(name, &name.to_string(), &quote!("1"));
        let known = prior.path.get_ident().and_then(BuiltIn::named);
        let several = known.is_some_and(|known| known.of == Of::Several);
        let span = prior.path.span();
        let (run, prior) = (at(span, "run"), self.distribution(prior));
        let at = Span::mixed_site().located_at(span);
        match several {
            true => quote_spanned!(at=> #run.joint(#label, #length, &#prior)?),
            false => {
                quote_spanned!(at=> #run.vector(#label, #length, #prior)?)
            }
        }
    }

    /// `::couloir::prior::Name::<K>::new(..)`, or `path::Own::new(..)`.
    fn distribution(&self, given: &Distribution) -> TokenStream {
        let Distribution { path, arguments } = given;
        let kind = self.kind;
        let at = Span::mixed_site().located_at(path.span());
        let Some(name) = path.get_ident() else {
            return quote_spanned!(at=> #path::new(#arguments));
        };
        match BuiltIn::named(name).filter(|known| known.has_parts()) {
            None => quote_spanned! {at=>
                ::couloir::prior::#name::<#kind>::new(#arguments)
            },
            Some(known) => {
                let needs = known.arguments.iter().map(|one| one.need);
                let arguments = arguments.iter().zip(needs);
                let arguments =
                    arguments.map(|(given, need)| self.part(given, need));
                quote_spanned! {at=>
                    ::couloir::prior::#name::<#kind, _>::new(#(#arguments),*)
                }
            }
        }
    }

    /// An argument of a distribution that is made of others; a list of them
    /// is a tuple.
    fn part(&self, given: &Expr, need: Need) -> TokenStream {
        match (need, given) {
            (Need::Distribution | Need::Distributions, Expr::Call(call)) => {
                let part = Distribution::from_call(call);
                part.map_or_else(
                    || given.to_token_stream(),
                    |part| self.distribution(&part),
                )
            }
            (Need::Distributions, Expr::Array(list)) => {
                let parts = list.elems.iter();
                let parts = parts.map(|one| self.part(one, need));
                let at = Span::mixed_site().located_at(given.span());
                quote_spanned!(at=> (#(#parts,)*))
            }
            _ => given.to_token_stream(),
        }
    }

    /// `{ fields, one by one; run.declare(Block { .. }) }`
    fn blocks(
        &self,
        name: &Ident,
        terms: &[Term],
        count: &Count,
    ) -> TokenStream {
        let mut lines = TokenStream::new();
        let mut sum: Option<TokenStream> = None;
        for (i, term) in terms.iter().enumerate() {
            let block = self.term(i, term, count, &mut lines);
            let at = Span::mixed_site().located_at(term.path.span());
            sum = Some(match sum {
                None => block,
                Some(sum) => quote_spanned! {at=>
                    ::couloir::block::Sum::new(#sum, #block)
                },
            });
        }
        let run = at(name.span(), "run");
        let at = Span::mixed_site().located_at(name.span());
        quote_spanned!(at=> { #lines #run.declare(#sum) })
    }

    /// One block's struct expression; its fields go to `lines` before.
    fn term(
        &self,
        i: usize,
        term: &Term,
        count: &Count,
        lines: &mut TokenStream,
    ) -> TokenStream {
        let kind = self.kind;
        let site = Span::mixed_site().located_at(term.path.span());
        let (alias, item) = self.alias(i, &term.path);
        lines.extend(item);
        let mut fields = Vec::new();
        for (j, field) in term.fields.iter().enumerate() {
            let local = at(value_span(field), &format!("value_{i}_{j}"));
            let value = self.field(&alias, field, count);
            let at = Span::mixed_site().located_at(field.name.span());
            lines.extend(quote_spanned!(at=> let #local = #value;));
            let name = &field.name;
            fields.push(quote_spanned!(at=> #name: #local));
        }
        quote_spanned! {site=>
            #alias::<::couloir::Real<#kind>> { #(#fields),* }
        }
    }

    fn field(
        &self,
        alias: &Ident,
        field: &Field,
        count: &Count,
    ) -> TokenStream {
        let label = || {
            let unit = self.unit(alias, &field.name);
            indexed(label(&field.name, &field.label, &unit), count)
        };
        match &field.value {
            Value::Prior(prior) => {
                let (kind, value) = (self.kind, self.scalar(&label(), prior));
                let at = Span::mixed_site().located_at(prior.path.span());
                quote_spanned! {at=>
                    ::couloir::block::OneNumber::<::couloir::Real<#kind>>::of(
                        #value
                    )
                }
            }
            Value::Priors(priors) => self.list(&label(), priors),
            Value::Repeated(prior, length) => {
                let span = prior.path.span();
                let (run, prior) = (at(span, "run"), self.distribution(prior));
                let label = label();
                let at = Span::mixed_site().located_at(span);
                quote_spanned!(at=> #run.vector(#label, #length, #prior)?)
            }
            Value::Known(value) => self.known(value),
            Value::Broken(_) => TokenStream::new(),
        }
    }

    /// `<Block<Real<K>> as block::Block<Real<K>>>::unit("field")`
    fn unit(&self, alias: &Ident, field: &Ident) -> TokenStream {
        let (kind, name) = (self.kind, field.to_string());
        let at = alias.span();
        quote_spanned! {at=>
            <#alias<::couloir::Real<#kind>> as
                ::couloir::block::Block<::couloir::Real<#kind>>>::unit(#name)
        }
    }

    /// `[prior, prior]`; a list of one keeps the plain name.
    fn list(
        &self,
        label: &TokenStream,
        priors: &[Distribution],
    ) -> TokenStream {
        let alone = priors.len() == 1;
        let values = priors.iter().enumerate().map(|(i, prior)| {
            let label = match alone {
                true => label.clone(),
                false => {
                    let at = Span::mixed_site().located_at(prior.path.span());
                    quote_spanned!(at=> #label.at(#i))
                }
            };
            self.scalar(&label, prior)
        });
        let at =
            priors.first().map_or_else(Span::call_site, |p| p.path.span());
        self.collected(at, &quote!([#(#values),*].into_iter()))
    }

    /// A known value: a number, or a list of numbers.
    fn known(&self, value: &Expr) -> TokenStream {
        let kind = self.kind;
        let number = |one: &Expr| {
            let at = Span::mixed_site().located_at(one.span());
            quote_spanned! {at=>
                ::core::convert::Into::<::couloir::Real<#kind>>::into(#one)
            }
        };
        match value {
            Expr::Array(list) => {
                let values = list.elems.iter().map(number);
                self.collected(
                    list.span(),
                    &quote!([#(#values),*].into_iter()),
                )
            }
            Expr::Repeat(list) => {
                let (one, length) = (number(&list.expr), &list.len);
                self.collected(
                    list.span(),
                    &quote!(::core::iter::repeat_n(#one, #length)),
                )
            }
            one => {
                let at = Span::mixed_site().located_at(one.span());
                quote_spanned!(at=> ::couloir::block::Fills::fill(#one))
            }
        }
    }

    /// A list field of some values, for which the compiler is to point to
    /// `span`.
    fn collected(&self, span: Span, values: &TokenStream) -> TokenStream {
        let kind = self.kind;
        let at = Span::mixed_site().located_at(span);
        quote_spanned! {at=>
            ::couloir::block::ManyNumbers::<::couloir::Real<#kind>>::of(
                #values
            )
        }
    }

    fn body(&self, body: &Body) -> TokenStream {
        let inside = self.pieces(&body.pieces);
        let block = braced(inside, body.braces);
        // Of a single `for` on one line rustc thinks the braces are too many.
        quote!(#[allow(unused_braces)] #block)
    }

    fn pieces(&self, pieces: &[Piece]) -> TokenStream {
        pieces
            .iter()
            .map(|piece| match piece {
                Piece::Token(tree) => tree.to_token_stream(),
                Piece::Braces(span, inside) => {
                    braced(self.pieces(inside), *span)
                }
                Piece::Keep(keep) => self.keep(keep),
                Piece::Increment(word, value) => {
                    let run = at(word.span(), "run");
                    let at = Span::mixed_site().located_at(word.span());
                    quote_spanned!(at=> #run.increment(#value)?)
                }
                Piece::Observation(line) => self.observation(line),
                Piece::Broken(_) => TokenStream::new(),
            })
            .collect()
    }

    /// `run.observe(&data, prediction, &noise)?`
    fn observation(&self, line: &Observation) -> TokenStream {
        let run = at(line.tilde, "run");
        let data = reference(&line.data);
        let at = Span::mixed_site().located_at(line.tilde);
        match &line.law {
            Sampling::Noise { prediction, noise } => {
                let noise = reference(noise);
                quote_spanned! {at=>
                    #run.observe(#data, #prediction, #noise)?
                }
            }
            Sampling::Distribution(distribution) => {
                let law = self.distribution(distribution);
                let place = written(&line.data);
                quote_spanned! {at=>
                    #run.observe_each(#data, #law)
                        .map_err(|stop| stop.within(#place))?
                }
            }
        }
    }
}

/// `Label::new(name, unit)`
fn label(name: &Ident, text: &str, unit: &TokenStream) -> TokenStream {
    let at = Span::mixed_site().located_at(name.span());
    quote_spanned!(at=> ::couloir::Label::new(#text, #unit))
}

/// The label at the index of a block for each.
fn indexed(label: TokenStream, count: &Count) -> TokenStream {
    match count {
        Count::Each { index, .. } => {
            let at = Span::mixed_site().located_at(index.span());
            quote_spanned!(at=> #label.at(#index))
        }
        Count::One | Count::Vector(_) => label,
    }
}

/// `{ for index in range { name.push(value) } name }`
///
/// The list has the user's name, so that a value may depend on those before.
fn each(
    name: &Ident,
    list: &TokenStream,
    index: &Ident,
    range: &Expr,
    value: &TokenStream,
) -> TokenStream {
    let at = Span::mixed_site().located_at(index.span());
    quote_spanned! {at=> {
        let mut #name = #list::new();
        for #index in #range {
            let one = #value;
            #name.push(one);
        }
        #name
    }}
}

/// `{ inside }` at the user's braces.
fn braced(inside: TokenStream, span: Span) -> TokenStream {
    let mut group = Group::new(proc_macro2::Delimiter::Brace, inside);
    group.set_span(span);
    TokenTree::Group(group).into()
}

/// An expression as the user wrote it.
fn written(given: &Expr) -> String {
    let plain = || given.to_token_stream().to_string().replace(' ', "");
    given.span().source_text().unwrap_or_else(plain)
}

/// `&given`, with parentheses where it takes them.
fn reference(given: &Expr) -> Expr {
    Expr::Reference(ExprReference {
        attrs: Vec::new(),
        and_token: syn::Token![&](given.span()),
        mutability: None,
        expr: Box::new(given.clone()),
    })
}

/// Where the user wrote a field's value.
fn value_span(field: &Field) -> Span {
    match &field.value {
        Value::Prior(prior) | Value::Repeated(prior, _) => prior.path.span(),
        Value::Known(value) => value.span(),
        Value::Priors(_) | Value::Broken(_) => field.name.span(),
    }
}
