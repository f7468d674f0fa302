//! What a source file says of the thing in it: its doc comments, as Markdown.

use std::fs;

use super::root;

/// The comments of one source file.
pub(crate) struct Told {
    /// What the file is for, as its head says.
    pub(crate) head: String,
    text: String,
}

impl Told {
    /// Those of the file `name` in a folder of `src`; dashes in the name are
    /// underscores in the file's.
    pub(crate) fn of(folder: &str, name: &str) -> Self {
        let file = format!("src/{folder}/{}.rs", name.replace('-', "_"));
        let text = fs::read_to_string(root().join(&file))
            .unwrap_or_else(|e| panic!("{file}: {e}"));
        let head = text.lines().map_while(|l| l.strip_prefix("//!"));
        Self { head: markdown(head), text }
    }

    /// What stands over the line that begins so; examples are left out.
    pub(crate) fn above(&self, begins: &str) -> Option<String> {
        let lines: Vec<&str> = self.text.lines().map(str::trim).collect();
        let at = lines.iter().position(|l| l.starts_with(begins))?;
        let above = lines[..at].iter().rev().filter(|l| !l.starts_with("#["));
        let said = above.map_while(|l| l.strip_prefix("///"));
        let mut said: Vec<&str> = said.collect();
        said.reverse();
        (!said.is_empty()).then(|| markdown(said.into_iter()))
    }
}

/// A doc comment as Markdown that needs no compiler: no examples, no links
/// into the code, formulas that are set in as blocks.
fn markdown<'a>(lines: impl Iterator<Item = &'a str>) -> String {
    let mut told: Vec<String> = Vec::new();
    let mut in_example = false;
    for line in lines {
        let line = line.strip_prefix(' ').unwrap_or(line);
        if line.starts_with("```") {
            in_example = !in_example;
        } else if !in_example {
            told.push(without_links(line));
        }
    }
    told.join("\n").trim().replace("\n\n  ", "\n\n      ")
}

/// A line without the links that only rustdoc follows.
fn without_links(line: &str) -> String {
    let mut plain = line.replace("\\[", "[").replace("\\]", "]");
    while let Some((before, rest)) = plain.split_once("[`") {
        let Some((word, after)) = rest.split_once("`]") else { break };
        let target = after.strip_prefix('(').and_then(|t| t.split_once(')'));
        let after = target.map_or(after, |(_, after)| after);
        plain = format!("{before}`{word}`{after}");
    }
    plain
}
