//! The macro on token streams: what is understood, and every mistake with
//! the token it is reported on.

use proc_macro2::TokenStream;

use crate::distribution::{Argument, BUILT_IN, BuiltIn, Need, Of};
use crate::tree::Line;
use crate::{expand, understand};

/// The struct that most cases start with.
const DATA: &str = "struct C { event: Event, events: Vec<Event>, runout: f64, \
                    n: usize }";

/// Declarations and a likelihood that are right.
const FRICTION: &str = "friction ~ Coulomb { mu: Gamma(9.0, 0.03) };";
const ERRORS: &str = "errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };";
const BODY: &str = "likelihood { let flow = event.slide(&friction)?; \
                    event.velocity ~ flow.velocity() + errors; }";

fn tokens(model: &str) -> TokenStream {
    model.parse().expect("tokens")
}

/// The errors of a model: the token underlined, and the words.
fn errors(model: &str) -> Vec<(String, String)> {
    let (_, errors) = understand(tokens(model));
    let told = |error: &syn::Error| {
        let at = error.span().source_text().unwrap_or_default();
        (at, error.to_string())
    };
    errors.sorted().iter().map(told).collect()
}

/// Expects exactly these errors: the token, and a part of the words.
#[track_caller]
fn expect(model: &str, expected: &[(&str, &str)]) {
    let found = errors(model);
    let fit =
        |((at, words), (token, part)): (&(String, String), &(&str, &str))| {
            at == token && words.contains(part)
        };
    let same =
        found.len() == expected.len() && found.iter().zip(expected).all(fit);
    assert!(same, "{model}\nfound {found:#?}\nexpected {expected:#?}");
}

/// With a right friction, errors and likelihood around one line.
#[track_caller]
fn expect_line(line: &str, expected: &[(&str, &str)]) {
    let body = "likelihood { let _ = (x, &friction); event.velocity ~ \
                event.slide(&friction)?.velocity() + errors; }";
    expect(&format!("{DATA} {line} {FRICTION} {ERRORS} {body}"), expected);
}

/// With `x = 1.0` and one block before the errors.
#[track_caller]
fn expect_block(block: &str, expected: &[(&str, &str)]) {
    expect(&format!("{DATA} friction ~ {block}; {ERRORS} {BODY}"), expected);
}

/// With one likelihood behind right declarations.
#[track_caller]
fn expect_body(body: &str, expected: &[(&str, &str)]) {
    let uses = "let _ = (&friction, &errors, centre);";
    expect(
        &format!(
            "{DATA} centre ~ Normal(0.0, 1.0); {FRICTION} {ERRORS} \
             likelihood {{ {uses} {body} }}"
        ),
        expected,
    );
}

/// The names of the blocks' unknowns.
fn labels(model: &str) -> Vec<String> {
    let (source, errors) = understand(tokens(model));
    assert!(errors.is_empty(), "{:?}", errors.sorted());
    let mut labels = Vec::new();
    for line in &source.lines {
        let Line::Declaration(declaration) = line else { continue };
        let fields = declaration.terms().iter().flat_map(|term| &term.fields);
        let unknown = fields.filter(|field| field.value.is_unknown());
        labels.extend(unknown.map(|field| field.label.clone()));
    }
    labels
}

#[test]
fn the_design_is_understood_word_for_word() {
    let model = "
        /// Voellmy friction with errors correlated along the flow.
        pub struct Calibration { event: Event }
        friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
        errors ~ Ar { phi: [Uniform(-1.0, 1.0)],
                      sigma2: InverseGamma(3.0, 20.0) };
        likelihood {
            let flow = event.slide(&friction)?;
            event.velocity ~ flow.velocity() + errors;
        }";
    expect(model, &[]);
    assert_eq!(labels(model), ["mu", "xi", "phi", "sigma2"]);
    let file = syn::parse2::<syn::File>(expand(tokens(model))).expect("items");
    assert_eq!(file.items.len(), 3);
}

#[test]
fn every_form_is_understood() {
    let lines = "
        /// A comment.
        x ~ Normal(0.3, 0.1);
        z[n] ~ Normal(0.0, 1.0);
        w[events.len()] ~ Flat();
        y[j in 0..n] ~ Normal(z[j], 1.0);
        #[allow(unused)] let (a, b) = (2.0 * x, if let Some(c) = n { c } else { w });
        own ~ my::Prior(a, b::<A, B>(3.0));
        sum ~ Coulomb { mu: Gamma(9.0, 0.03), } + laws::Turbulent { xi = own };
        each[i in 0..n] ~ Coulomb { mu = x + y[i] };
        more ~ Ar { phi: [Normal(0.0, 1.0); n], psi = [0.1, x], chi = [a; 2] };
        let last = (&sum, &each, &more);";
    let body = "likelihood {
        for (e, f) in events.iter().zip(&each) {
            let _ = (last, f);
            if n > 3 { e.velocity ~ e.slide(f)?.velocity() + errors; }
            while false { runout ~ my::Prior(y[0]) ; }
            match n { 0 => runout ~ Normal(x, 1.0), _ => { } }
        }
        let mut state = State { x }; state.x = a + b;
        e.velocity ~ if n { x } else { x } + &friction;
    }";
    expect(&format!("{DATA} {lines} {FRICTION} {ERRORS} {body}"), &[]);
}

#[test]
fn a_name_stays_plain_while_it_is_unique() {
    let model = |lines: &str| {
        let body =
            "likelihood { let _ = (&a, &b); runout ~ Normal(1.0, 1.0); }";
        format!("{DATA} {lines} {body}")
    };
    let mu = "mu: Gamma(9.0, 0.03)";
    let two = model(&format!("a ~ Coulomb {{ {mu} }}; b ~ Pcm {{ {mu} }};"));
    assert_eq!(labels(&two), ["a.mu", "b.mu"]);
    let sum = model(&format!(
        "a ~ Coulomb {{ {mu} }} + Pcm {{ {mu} }}; b ~ Iid {{ s: Flat() }};"
    ));
    assert_eq!(labels(&sum), ["coulomb.mu", "pcm.mu", "s"]);
    let known = model(&format!(
        "a ~ Coulomb {{ {mu} }} + Pcm {{ mu = 0.3 }}; b ~ Flat();"
    ));
    assert_eq!(labels(&known), ["mu"]);
    let scalar = model(&format!("b ~ Flat(); a ~ Law {{ b: Flat(), {mu} }};"));
    assert_eq!(labels(&scalar), ["a.b", "mu"]);
}

#[test]
fn unknowns_that_cannot_be_told_apart() {
    expect_block(
        "Coulomb { mu: Flat() } + Coulomb { mu: Flat() }",
        &[("mu", "two unknowns would both be called `coulomb.mu`")],
    );
}

#[test]
fn names() {
    expect_line(
        "x ~ Flat(); unused ~ Flat();",
        &[("unused", "`unused` is never used")],
    );
    expect_line("x ~ Flat(); x ~ Flat();", &[("x", "declared twice")]);
    expect_line("let x = 1.0; x ~ Flat();", &[("x", "declared twice")]);
    expect_line("let x = 1.0; let x = 2.0 * x;", &[]);
    expect_line("x ~ Flat(); let runout = runout + x;", &[]);
    expect_line(
        "x ~ Normal(runout, 1.0); event ~ Flat();",
        &[("event", "`event` is a field of the struct already")],
    );
    expect_line(
        "x ~ Normal(y, 1.0); y ~ Flat();",
        &[("y", "`y` is declared further down: move its line above this one")],
    );
    expect_line("let x = y; y ~ Flat();", &[("y", "further down")]);
    expect_line("x ~ Normal(x, 1.0);", &[("x", "used in its own line")]);
    expect_line("x[x in 0..n] ~ Normal(x, 1.0);", &[]);
    expect_block("Coulomb { mu = errors }", &[("errors", "further down")]);
}

#[test]
fn a_name_counts_as_used_where_it_stands_for_a_value() {
    let used = |text: &str| {
        let line = format!("x ~ Flat(); y ~ Flat(); let z = {text};");
        expect_line(&line, &[]);
    };
    ["S { y: y }", "0..y", "f(a, y)", "format!(\"{y:.1}\")", "y.ln()"]
        .into_iter()
        .for_each(used);
    let unused = |text: &str| {
        let line = format!("x ~ Flat(); y ~ Flat(); let z = {text};");
        expect_line(&line, &[("y", "never used")]);
    };
    ["x.y", "S { y: x }", "m::y(x)", "{ let y = 3.0; x }", "\"y\""]
        .into_iter()
        .for_each(unused);
}

#[test]
fn distributions() {
    expect_line(
        "x ~ Gama(9.0, 0.03);",
        &[(
            "Gama",
            "no distribution `Gama`: did you mean `Gamma(shape, scale)`?",
        )],
    );
    expect_line(
        "x ~ normal(9.0, 0.03);",
        &[("normal", "did you mean `Normal(mean, sd)`?")],
    );
    expect_line(
        "x ~ Coulomb(0.3);",
        &[("Coulomb", "a block takes braces, `Coulomb { .. }`")],
    );
    expect_line(
        "x ~ Normal { mean = 3.0 };",
        &[(
            "Normal",
            "a distribution takes parentheses: write `Normal(mean, sd)`",
        )],
    );
    expect_line("x ~ Exponential();", &[("Exponential", "1 argument, not 0")]);
    expect_line(
        "x ~ Normal(1.0);",
        &[(
            "Normal",
            "`Normal` takes 2 arguments, not 1: write `Normal(mean, sd)`",
        )],
    );
    expect_line(
        "x ~ Gamma(-1.0, 2.0);",
        &[("-1.0", "the shape of `Gamma(shape, scale)` has to be above 0")],
    );
    expect_line("x ~ Normal(0.0, 0.0);", &[("0.0", "the sd of")]);
    expect_line(
        "x ~ Uniform(1.0, -1.0);",
        &[("1.0, -1.0", "1.0 is not below -1.0")],
    );
    expect_line(
        "x ~ Normal(0, -2);",
        &[("0", "write `0.0`"), ("-2", "has to be above 0")],
    );
}

#[test]
fn lines_that_are_no_declarations() {
    expect_line("x = Flat();", &[("=", "write `x ~ ..`")]);
    expect_line("x: Flat();", &[(":", "write `x ~ ..`")]);
    expect_line("x ~ 3.0;", &[("3.0", "`let name = ..;`")]);
    expect_line("x ~ Flat;", &[("Flat", "`Flat` alone is not enough")]);
    expect_line("x ~ ;", &[("~", "a block or a distribution is missing")]);
    expect_line(
        "let x = 1.0; Voellmy { mu: Flat() };",
        &[("Voellmy", "write `name ~ Voellmy { .. };`")],
    );
    expect_line("let x = 1.0; f(3.0);", &[("f", "expected a declaration")]);
    expect_line("let x = ;", &[("=", "expected an expression")]);
    expect_line("let x = 1.0; 3 ~ Flat();", &[("3", "left of `~` stands")]);
    expect_line("x[i of n] ~ Flat();", &[("of", "left of `~` stands")]);
    expect_line("x[(i, j) in n] ~ Flat();", &[("(", "write one name")]);
    expect_line("x.y ~ Flat();", &[(".", "left of `~` stands")]);
    expect_line("let x = 1.0; fn ~ Flat();", &[("fn", "found keyword")]);
    expect_line("#[inline] x ~ Flat();", &[("#[inline]", "no attributes")]);
}

#[test]
fn missing_semicolons() {
    let missing = |at| [(at, "a `;` is missing behind this")];
    expect_line("x ~ Flat()", &missing(")"));
    expect_line("let x = 3.0", &missing("3.0"));
    expect_line("x ~ Flat() let y = x;", &missing(")"));
    expect_line("let y = 1.0 x[n] ~ Normal(y, 1.0);", &missing("1.0"));
    let model = |friction: &str, errors: &str| {
        format!("{DATA} {friction} {errors} {BODY}")
    };
    let friction = FRICTION.trim_end_matches(';');
    let errors = ERRORS.trim_end_matches(';');
    expect(&model(friction, ERRORS), &missing("}"));
    expect(&model(FRICTION, errors), &missing("}"));
}

#[test]
fn fields_of_blocks() {
    expect_block("Coulomb {}", &[("Coulomb", "a block needs its fields")]);
    expect_block("Coulomb { mu: 0.3 }", &[("0.3", "write `mu = 0.3`")]);
    expect_block(
        "Coulomb { mu: runout }",
        &[("runout", "write `mu = runout`")],
    );
    expect_block(
        "Coulomb { mu = Gamma(9.0, 0.03) }",
        &[("=", "an unknown with a prior takes `:`")],
    );
    expect_block(
        "Coulomb { mu: 2.0 * Flat() }",
        &[("2.0 * Flat()", "one prior")],
    );
    expect_block("Coulomb { mu }", &[("mu", "write `mu: prior`")]);
    expect_block("Coulomb { mu: }", &[(":", "a value is missing")]);
    expect_block("Coulomb { mu = 3 }", &[("3", "write `3.0`")]);
    expect_block(
        "Coulomb { mu: Flat(), mu: Flat() }",
        &[("mu", "`mu` is given twice"), ("mu", "two unknowns")],
    );
    expect_block(
        "Voellmy { mu: Flat() xi: Flat() }",
        &[("xi", "a `,` is missing before this")],
    );
    expect_block("Ar { phi: [] }", &[("phi", "the list of `phi` is empty")]);
    expect_block("Ar { phi = [] }", &[("phi", "the list of `phi` is empty")]);
    expect_block(
        "Ar { phi: [Flat(), 0.3] }",
        &[("0.3", "every value of a list behind `:` has a prior")],
    );
    expect_block(
        "Ar { phi: [0.3, 0.3] }",
        &[("[0.3, 0.3]", "write `phi = [")],
    );
    expect_block("Coulomb { 3: Flat() }", &[("3", "a field is written")]);
}

#[test]
fn sums_of_blocks() {
    let mu = "Coulomb { mu: Flat() }";
    expect_block(
        &format!("{mu} + Normal(0.0, 1.0)"),
        &[("Normal", "`+` adds blocks")],
    );
    expect_block(&format!("{mu} +"), &[("~", "a block or a distribution")]);
    let each = format!("{DATA} friction[n] ~ {mu}; {ERRORS} {BODY}");
    expect(&each, &[("n", "write `friction[i in 0..n]`")]);
}

#[test]
fn observations() {
    let law = "expected `prediction + noise`";
    let behind = "a `;` is missing behind this";
    expect_body("runout ~ flow;", &[("flow", law)]);
    expect_body("runout ~ f(3.0);", &[("f(3.0)", law)]);
    expect_body("runout ~ ;", &[("~", law)]);
    expect_body("runout ~ flow - errors;", &[("-", "the noise is added")]);
    expect_body("runout ~ flow + errors", &[("errors", behind)]);
    expect_body(
        "for e in events { runout ~ flow + errors }",
        &[("errors", behind)],
    );
    expect_body("~ flow + errors;", &[("~", "what was recorded stands")]);
    expect_body(
        "a ~ b + errors c ~ d + errors;",
        &[("~", "a second `~` in one statement")],
    );
    expect_body(
        "let flow = 3.0 a ~ flow + errors;",
        &[("let", "a `;` is missing between this `let` and the `~`")],
    );
    expect_body("f(a ~ b + errors);", &[("~", "take it out")]);
    expect_body("runout ~ Normal(1.0);", &[("Normal", "not 1")]);
    expect_body(
        "centre ~ Normal(1.0, 1.0);",
        &[("centre", "`centre` is declared above, it was not recorded")],
    );
}

#[test]
fn noises() {
    expect_body("a ~ errors + flow;", &[("errors", "the noise comes last")]);
    expect_body("a ~ &errors + b + c;", &[("&errors", "comes last")]);
    expect_body("a ~ flow + centre;", &[("centre", "not a noise")]);
    expect_body("a ~ flow + 3.0;", &[("3.0", "is no noise")]);
    expect_body(
        "a ~ flow + Normal(0.0, 1.0);",
        &[("Normal(0.0, 1.0)", "is a distribution, not a noise")],
    );
    expect_body("a ~ centre + flow + local;", &[]);
    expect_body("event.velocity = flow + errors;", &[("=", "write `~`")]);
    expect_body("if n { runout = Normal(flow, 1.0); }", &[("=", "`~`")]);
}

#[test]
fn the_parts_of_a_model() {
    let body = "likelihood { a ~ Normal(0.0, 1.0); }";
    expect("", &[("", "the struct is missing")]);
    expect(body, &[("likelihood", "the struct is missing")]);
    expect(
        &format!("struct C<T> {{ a: T }} {body}"),
        &[("<T>", "`C` cannot be generic")],
    );
    expect(&format!("struct C(f64); {body}"), &[("C", "have names")]);
    expect(&format!("struct C; {body}"), &[("C", "have names")]);
    expect(
        &format!("struct C {{ a: f64 }} struct D {{ }} {body}"),
        &[("D", "a second struct")],
    );
    expect(&format!("struct C {{ a: f64 b: f64 }} {body}"), &[("b", ",")]);
    expect("struct C { a: f64 }", &[("C", "the likelihood is missing")]);
    expect(
        &format!("struct C {{ a: f64 }} {body} {body}"),
        &[("likelihood", "a second likelihood")],
    );
    expect(
        "struct C { a: f64 } likelihood { let x = 3.0; }",
        &[("likelihood", "compares nothing")],
    );
    expect(
        "struct C { a: f64 } likelihood: { a ~ Flat(); }",
        &[("likelihood", "write `likelihood { .. }`")],
    );
    expect(
        "struct C { a: f64 } likelyhood { a ~ Flat(); }",
        &[("likelyhood", "write `likelihood` instead of `likelyhood`")],
    );
    expect(
        &format!("struct C {{ a: f64 }} {body} b ~ Flat();"),
        &[("b", "this stands below `likelihood`")],
    );
}

#[test]
fn all_errors_come_at_once_in_the_order_written() {
    expect(
        "struct C<T> { event: Event }
         x ~ Gama(9.0, 0.03);
         friction = Coulomb { mu: 0.3 };
         errors ~ Iid { sigma2: InverseGamma(3.0) }
         likelihood { event.velocity ~ friction - errors; }",
        &[
            ("<T>", "generic"),
            ("x", "never used"),
            ("Gama", "no distribution"),
            ("=", "takes `~`"),
            ("0.3", "write `mu = 0.3`"),
            ("InverseGamma", "2 arguments"),
            ("}", "a `;` is missing"),
            ("-", "the noise is added"),
        ],
    );
    expect_block(
        "Coulomb { mu: Gama(1.0) } + 3.0 + Normal(0.0, -1.0)",
        &[
            ("Gama", "no distribution"),
            ("3.0", "right of `~`"),
            ("Normal", "`+` adds blocks"),
            ("-1.0", "above 0"),
        ],
    );
    expect_block(
        "Ar { phi: [Gama(1.0), 0.3, x] }",
        &[
            ("Gama", "no distribution"),
            ("0.3", "every value"),
            ("x", "every value"),
        ],
    );
    expect_body(
        "~ Normal(1.0); ~ x + 3.0;",
        &[
            ("~", "what was recorded"),
            ("Normal", "not 1"),
            ("~", "what was recorded"),
            ("3.0", "no noise"),
        ],
    );
}

#[test]
fn a_broken_model_still_has_its_struct_and_program() {
    let model = format!("{DATA} x ~ Gama(1.0, 1.0); {BODY}");
    let file = syn::parse2::<syn::File>(expand(tokens(&model)));
    let text = quote::ToTokens::to_token_stream(&file.expect("items"));
    let text = text.to_string();
    for part in ["struct C", "fn new", "Program for C", "compile_error"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert!(!text.contains("slide"));
}

#[test]
fn no_prefix_of_a_model_panics() {
    let model = format!("{DATA} z[i in 0..n] ~ Flat(); {FRICTION} {BODY}");
    let all: Vec<_> = tokens(&model).into_iter().collect();
    for end in 0..all.len() {
        for skip in 0..end {
            let mut some = all[..end].to_vec();
            some.remove(skip);
            let _ = expand(some.into_iter().collect());
        }
    }
}

#[test]
fn distributions_made_of_others() {
    let of = |law: &str| format!("x ~ {law};");
    for right in [
        "Truncated(Normal(0.0, 1.0), 0.0, f64::INFINITY)",
        "Mixture([0.5, 0.5], [Normal(0.0, 1.0), Flat()])",
        "Mixture(&weights, parts)",
    ] {
        expect_line(&of(right), &[]);
    }
    let wanted = "a distribution is needed here";
    expect_line(&of("Truncated(y, 0.0, 1.0)"), &[("y", wanted)]);
    expect_line(
        &of("Truncated(Normal(0.0, 1.0), 2.0, 1.0)"),
        &[("Normal(0.0, 1.0), 2.0, 1.0", "low has to be below high")],
    );
    expect_line(
        &of("Truncated(Normal(0, 1.0), 0.0, 1)"),
        &[("0", "write `0.0`"), ("1", "write `1.0`")],
    );
    expect_line(
        &of("Mixture([1, 0.5], [Gama(1.0, 1.0), y])"),
        &[("1", "write `1.0`"), ("Gama", "no distribution"), ("y", wanted)],
    );
    expect_line(&of("Mixture(0.5, parts)"), &[("0.5", "a list of numbers")]);
}

#[test]
fn each_distribution_has_its_place() {
    expect_line("x ~ Poisson(3.0);", &[("Poisson", "of whole numbers")]);
    expect_line(
        "x ~ Mixture([1.0], [Poisson(3.0)]);",
        &[("Poisson", "of whole numbers")],
    );
    expect_line("x[3] ~ Ordered(Normal(0.0, 1.0));", &[]);
    expect_line("x[3] ~ Dirichlet([1.0; 3]);", &[]);
    expect_line(
        "x ~ Dirichlet([1.0; 3]);",
        &[("Dirichlet", "write `name[n] ~ Dirichlet(weights)`")],
    );
    expect_line(
        "x ~ Truncated(Ordered(Flat()), 0.0, 1.0);",
        &[("Ordered", "stands alone")],
    );
    expect_body("a ~ Poisson(3.0);", &[]);
    expect_body("a ~ Mixture([1.0], [Poisson(3.0)]);", &[]);
    expect_body("a ~ Ordered(Flat());", &[("Ordered", "several unknowns")]);
    let block = "Coulomb { mu: Poisson(3.0) }";
    expect_block(block, &[("Poisson", "of whole numbers")]);
}

#[test]
fn given_data() {
    let normal = "Normal(0.0, 1.0)";
    let line = |head: &str, tail: &str| format!("{head} ~ {normal} {tail};");
    expect_line(&line("x", "given event.x"), &[]);
    expect_line(&line("x[i in 0..3]", "given event.x[i]"), &[]);
    expect_line(
        &line("x[3]", "given event"),
        &[("event", "write `x[i in 0..3] ~ .. given event[i]`")],
    );
    expect_line(&line("x", "given"), &[("given", "a value is missing")]);
    let own = "x[i in 0..3] ~ Normal(if i > 0 { x[i - 1] } else { a }, 1.0);";
    expect_line(own, &[]);
    expect_line("x ~ Normal(x, 1.0);", &[("x", "in its own line")]);
}

#[test]
fn what_is_kept_and_added() {
    expect_line("keep x = 3.0;", &[]);
    expect_line("keep x[2] ~ Normal(0.0, 1.0); let x = 1.0;", &[]);
    expect_line("keep x; let x = 1.0;", &[("x", "write `keep x = value;`")]);
    expect_line(
        "keep y ~ 3.0; let x = 1.0;",
        &[("3.0", "a distribution to draw from")],
    );
    expect_line(
        "keep y ~ Gama(3.0); let x = 1.0;",
        &[("Gama", "no distribution")],
    );
    let line = "a ~ Flat();";
    let body = |more: &str| format!("{line} {more}");
    expect_body(&body("keep y = centre; f(y);"), &[]);
    expect_body(&body("for i in 0..3 { keep y[i] = centre; }"), &[]);
    expect_body(
        &body("if b { log_density += if b { 1.0 } else { a }; }"),
        &[],
    );
    expect_body(
        &body("keep y = centre"),
        &[("centre", "a `;` is missing behind this")],
    );
    expect_body(&body("log_density += ;"), &[("", "expected")]);
    expect_body(
        &body("keep y ~ Dirichlet([1.0]);"),
        &[("Dirichlet", "several unknowns")],
    );
    // What adds to the density is a likelihood by itself.
    expect_body("log_density += centre;", &[]);
}

/// The macro's list of distributions, as the library writes its own.
#[test]
fn the_distributions_are_those_of_the_library() {
    let mut own = String::new();
    let plain = |known: &&BuiltIn| {
        let made = known.arguments.iter().any(|a| a.need == Need::Numbers);
        known.of == Of::Real && !known.has_parts() && !made
    };
    for known in BUILT_IN.iter().filter(plain) {
        let need = |argument: &Argument| match argument {
            Argument { name: "high", .. } => "high: AboveFirst".to_owned(),
            Argument { name, need: Need::Positive } => {
                format!("{name}: Positive")
            }
            Argument { name, .. } => format!("{name}: Finite"),
        };
        let arguments: Vec<_> = known.arguments.iter().map(need).collect();
        let arguments = arguments.join(", ");
        own.push_str(&format!("    {}({arguments});\n", known.name));
    }
    let text = include_str!("../../src/prior/any.rs");
    let list = text.split_once("\nfamilies! {\n").expect("the list").1;
    assert_eq!(own, list.split_once("}\n").expect("its end").0);
}
