//! The language: what `model!` accepts, and the words with which it refuses
//! the rest.

#[test]
fn mistakes_are_refused_in_plain_words() {
    let cases = trybuild::TestCases::new();
    cases.compile_fail("tests/ui/*.rs");
    cases.pass("tests/ui/pass/*.rs");
}
