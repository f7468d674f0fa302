//! What the compiler says of models that are written wrongly.

/// After a change of words, write them anew with
/// `TRYBUILD=overwrite cargo test -p couloir-mistakes` and read the difference.
#[test]
fn mistakes_are_refused_in_plain_words() {
    let cases = trybuild::TestCases::new();
    cases.compile_fail("ui/*.rs");
}
