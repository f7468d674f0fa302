//! No function is longer than a page of a screen.

use std::path::PathBuf;

use super::{root, sources};

/// From the line with `fn` to the closing brace.
const LONGEST: usize = 45;

/// The name behind `fn` in a line that begins a function.
fn name(line: &str) -> Option<&str> {
    let (before, rest) = line.split_once("fn ")?;
    let is_word = |w: &str| {
        let word = w.trim_start_matches("pub");
        ["", "const", "async"].contains(&word) || word.starts_with('(')
    };
    // `pub(in a::b)` has a word more; none is written here.
    let begins = before.trim().split(' ').all(is_word);
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
    begins.then(|| &rest[..end.unwrap_or(rest.len())])
}

/// How many lines the function takes that begins at the first of them, as
/// rustfmt sets them: the brace that closes it stands under its beginning.
fn length(lines: &[&str]) -> usize {
    let indent = lines[0].len() - lines[0].trim_start().len();
    let ends = |line: &&str| {
        let own = line.len() - line.trim_start().len() == indent;
        own && line.trim_start().starts_with('}')
    };
    let header = lines.iter().position(|l| l.ends_with(['{', '}', ';']));
    let header = header.unwrap_or(0);
    if !lines[header].ends_with('{') {
        return header + 1;
    }
    let body = lines[header + 1..].iter().position(ends);
    body.map_or(1, |at| header + at + 2)
}

#[test]
fn no_function_is_too_long() {
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in ["src", "macros/src", "examples", "benches", "tests"] {
        sources(&root().join(folder), &mut files);
    }
    let mut long = Vec::new();
    for path in &files {
        let text = std::fs::read_to_string(path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let file = path.strip_prefix(root()).unwrap().display();
        for (i, line) in lines.iter().enumerate() {
            let Some(name) = name(line) else { continue };
            if length(&lines[i..]) > LONGEST {
                long.push(format!("{file} {name}"));
            }
        }
    }
    assert!(long.is_empty(), "over {LONGEST} lines: {long:#?}");
}
