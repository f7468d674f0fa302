//! The `model!` macro of couloir.
//!
//! Tokens become a tree (`split`, `parse`, `body`), the tree is checked
//! (`check`, `label`), and only a tree without errors is written out as a
//! program (`expand`). Whatever is wrong is collected on the way and reported
//! at once, each mistake on the user's own token.
#![warn(clippy::print_stdout, clippy::print_stderr, clippy::unwrap_used)]

mod body;
mod check;
mod distribution;
mod errors;
mod expand;
mod keep;
mod label;
mod parse;
mod split;
mod tokens;
mod tree;

use errors::Errors;

/// What couloir's `model!` accepts; couloir shows an example.
///
/// # The struct
///
/// It holds the data and comes first: any fields with any visibility and
/// attributes, no generics. The macro adds `new`, which takes the fields in
/// the order written and is as visible as the struct, and `impl Program`, from
/// which `Model` follows. Below, every field is in scope under its name: a
/// number, `bool` or reference by value, anything else by reference.
///
/// # Declarations
///
/// Each ends with `;` and may use the fields and what stands above it; a
/// comment `///` may precede it.
///
/// | written | declares |
/// |---|---|
/// | `centre ~ Normal(0.3, 0.1);` | an unknown |
/// | `z[n] ~ Normal(0.0, 1.0);` | a vector of `n` of them, any expression of type `usize` |
/// | `y[i in 0..n] ~ Normal(z[i], 1.0);` | one for each index, each with its own prior, which may depend on those before it (`y[i - 1]`) |
/// | `mu[k] ~ Ordered(Normal(0.0, 2.0));` | `k` of them in ascending order |
/// | `share[k] ~ Dirichlet([1.0; 3]);` | `k` shares that sum to 1; the last follows from the others and is kept beside them |
/// | `x[i in 0..n] ~ Normal(m, s) given x_seen[i];` | a datum where there is one, an unknown where it is missing: an `Option` that is `None`, an `f64` that is NaN |
/// | `friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi = drag };` | a block: `:` gives an unknown its prior, `=` a known or shared value |
/// | `errors ~ Ar { phi: [Uniform(-1.0, 1.0); 2], sigma2: .. };` | a list: `[prior, prior]` or `[prior; count]`, known values `= [a, b]` |
/// | `friction ~ Coulomb { .. } + Turbulent { .. };` | blocks that add up |
/// | `friction[i in 0..n] ~ Coulomb { mu = centre + spread * z[i] };` | a block for each index, in a list |
/// | `let scale = 2.0 * centre;` | nothing: an ordinary `let` |
/// | `keep scale = 2.0 * centre;` | nothing: a `let` that becomes a column of the draws |
///
/// An unknown of a block is called as its field is (`mu`) while that is
/// unique in the model, else by its block (`friction.mu`), and where terms of
/// one sum share a field by the type of the block (`coulomb.mu`). Those of
/// vectors, lists and indexed blocks carry an index; a list of one does not.
///
/// A block is any struct with one type parameter, its number, that implements
/// `Block`; a law or noise of one's own is used exactly as the built-in ones.
///
/// # Distributions
///
/// `Normal(mean, sd)`, `LogNormal(mean, sd)` of ln x, `Gamma(shape, scale)`,
/// `InverseGamma(shape, scale)`, `Exponential(mean)`, `Uniform(low, high)`,
/// `Beta(a, b)`, `HalfNormal(scale)`, `HalfCauchy(scale)`,
/// `Cauchy(location, scale)`, `StudentT(freedom, location, scale)`, `Flat()`.
/// `Truncated(D, low, high)` is one of these cut off, and `Mixture([w, ..],
/// [D, ..])` several of them with weights that sum to 1. Data may also be
/// whole numbers from `Poisson(mean)`, `Binomial(trials, p)` and
/// `Bernoulli(p)`, which no unknown has, or a mixture of such.
///
/// They need no import. A path is a `Prior` of one's own: `my::Prior(a)`, or
/// `self::Prior(a)`, calls its `new(a)`.
///
/// # The likelihood
///
/// Ordinary Rust, with `~` lines anywhere among its statements (also in
/// `for`, `if`, `while`, `match`) that add up:
///
/// - `data ~ prediction + noise;` scores a series; the noise is the last
///   summand and was declared above.
/// - `data ~ Distribution(..);` scores a number, or each of several, real or
///   whole.
/// - `log_density += value;` adds what no distribution says, as one datum.
///   The word is the language's own.
/// - `keep name = value;` is a `let` whose number, list or list of lists
///   becomes a column of the draws (`name`, `name[2]`, `name[2,1]`), once an
///   inference has made these; `keep name[i] = value;` does so one by one and
///   binds nothing.
/// - `keep name ~ Distribution(..);` keeps a new draw for each draw of the
///   parameters, and binds nothing; `keep name[i] ~ ..` likewise.
///
/// A system of differential equations is solved with `couloir::ode`.
///
/// `?` ends the run where there is no flow. Numbers are `Real`s that carry
/// derivatives: literals and comparisons work as usual. What the macro makes
/// is hygienic, so `run` and `K` may be names of one's own.
///
/// # Mistakes
///
/// | mistake | mend |
/// |---|---|
/// | `x = Normal(..);`, `x: Normal(..);` | `x ~ Normal(..);` |
/// | `mu: 0.3` | `mu = 0.3`: a value takes `=` |
/// | `mu = Gamma(9.0, 0.03)` | `mu: Gamma(9.0, 0.03)`: an unknown takes `:` |
/// | `mu` alone in a block | `mu = mu` or `mu: prior` |
/// | `Normal(0, 1)` | `Normal(0.0, 1.0)` |
/// | `Gama(9.0, 0.03)`, `Gamma(9.0)`, `Gamma(-1.0, 2.0)` | as `Gamma(shape, scale)` says |
/// | a name never used, declared twice, used above its line, or a field's | use it, rename it, move it |
/// | `friction[n] ~ Coulomb { .. }` | `friction[i in 0..n] ~ Coulomb { .. }` |
/// | `x ~ Poisson(3.0)`, `x ~ Ordered(..)`, `y ~ Dirichlet(..)` | an unknown is real; several are declared together, `x[n] ~ ..` |
/// | `x[n] ~ .. given y` | `x[i in 0..n] ~ .. given y[i]` |
/// | `Mixture(0.5, ..)`, `Truncated(x, ..)` | lists of weights, distributions of distributions |
/// | `Coulomb { .. } + Normal(..)`, `Coulomb {}` | `+` adds blocks with fields |
/// | a missing `;` or `,` | put it where the message points |
/// | `data ~ flow.velocity();` | `.. + errors`, or a distribution |
/// | `data ~ errors + flow.velocity();` | the noise comes last |
/// | `friction ~ Own { .. }` with `struct Own { mu: f64 }` | `struct Own<S> { mu: S }`: a block is generic |
/// | no struct, two, generic, without names | `pub struct Name { event: Event }` |
/// | no likelihood, two, or one without `~` | `likelihood { data ~ prediction + noise; }` |
///
/// All of them are reported at once. What depends on types (a field that a
/// block does not have, or lacks; a struct that is no block; data that are
/// none) rustc reports, on the same tokens.
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
