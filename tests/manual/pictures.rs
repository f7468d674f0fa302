//! The pictures are those that the code draws.

use std::fs;

use super::{MEND, book, drawn, fresh};

/// By how much a coordinate may differ: a tenth of a pixel, to which pictures
/// are rounded, since the last digit of a function differs between machines.
const ROUNDED: f64 = 0.1001;

#[test]
fn the_pictures_are_those_that_the_code_draws() {
    fresh();
    let mut old = Vec::new();
    for (path, svg) in drawn::all() {
        let found = fs::read_to_string(book().join(&path));
        if !found.is_ok_and(|found| alike(&found, &svg)) {
            old.push(path);
        }
    }
    assert!(old.is_empty(), "{MEND}: {old:#?}");
}

/// Whether two pictures are the same but for rounding.
fn alike(a: &str, b: &str) -> bool {
    let is_end = |c: char| !(c.is_ascii_digit() || c == '.' || c == '-');
    let (mut a, mut b) = (a.split(is_end), b.split(is_end));
    loop {
        let near = match (a.next(), b.next()) {
            (None, None) => return true,
            (Some(a), Some(b)) if a == b => true,
            (Some(a), Some(b)) => match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(a), Ok(b)) => (a - b).abs() <= ROUNDED,
                _ => false,
            },
            _ => false,
        };
        if !near {
            return false;
        }
    }
}

#[test]
fn another_picture_is_not_alike() {
    assert!(alike("<p d=\"M1.2 3\"/>", "<p d=\"M1.3 3\"/>"));
    assert!(!alike("<p d=\"M1.2 3\"/>", "<p d=\"M1.4 3\"/>"));
    assert!(!alike("<p d=\"M1.2 3\"/>", "<p d=\"M1.2 3 4\"/>"));
}
