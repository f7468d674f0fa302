//! What the compiler says of models that are written wrongly.
//!
//! These tests stand with the macro, whose messages they are: the compiler
//! checks each model beside the library without its features, which takes far
//! fewer crates than the library with all of them.

/// After a change of words, write them anew with
/// `TRYBUILD=overwrite cargo test -p couloir-macros --test mistakes` and read
/// the difference.
#[test]
fn mistakes_are_refused_in_plain_words() {
    let cases = trybuild::TestCases::new();
    cases.compile_fail("tests/ui/*.rs");
}
