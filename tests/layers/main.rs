//! The layers: each module uses lower ones only. ARCHITECTURE.md says which
//! is which; this reads the table there and the code in `src/`. Beside them,
//! what holds for files and functions.

mod circles;
mod functions;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Each module's layer, from the rows `| 3 | `declared` | .. |`.
fn layers() -> BTreeMap<String, usize> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let mut layers = BTreeMap::new();
    for line in text.lines() {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        let [_, number, modules, ..] = cells[..] else { continue };
        let Ok(number) = number.parse() else { continue };
        for module in modules.split_whitespace() {
            let name = module.trim_matches('`').to_owned();
            let twice = layers.insert(name, number);
            assert_eq!(twice, None, "{module} is in two layers");
        }
    }
    layers
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The top module that a file belongs to: `noise` for src/noise/ar/root.rs.
fn module(path: &Path) -> String {
    let inside = path.strip_prefix(root().join("src")).unwrap();
    let first = inside.components().next().unwrap();
    let name = Path::new(first.as_os_str()).file_stem().unwrap();
    name.to_str().unwrap().to_owned()
}

/// The code of a file, without comments and without its unit tests.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let lines = text.lines().map(|l| l.split("//").next().unwrap_or(""));
    let own = lines.take_while(|l| !l.starts_with("mod tests {"));
    own.collect::<Vec<_>>().join("\n")
}

fn is_of_tests(path: &Path) -> bool {
    path.file_stem().is_some_and(|s| s == "tests" || s == "fixture")
        || path.parent().is_some_and(|p| p.ends_with("tests"))
}

/// The names behind every `crate::`, but not those in macros (`$crate`).
fn used(code: &str) -> BTreeSet<&str> {
    let mut found = BTreeSet::new();
    for (at, word) in code.match_indices("crate::") {
        if code[..at].ends_with('$') {
            continue;
        }
        let rest = &code[at + word.len()..];
        assert!(!rest.starts_with('{'), "write one `use` line a module");
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
        found.insert(&rest[..end.unwrap_or(rest.len())]);
    }
    found
}

#[test]
fn a_module_uses_lower_layers_only() {
    let layers = layers();
    let mut files = Vec::new();
    sources(&root().join("src"), &mut files);
    let mut wrong = Vec::new();
    let mut seen = BTreeSet::new();
    for path in files.iter().filter(|p| !is_of_tests(p)) {
        let own = module(path);
        if own == "lib" || own == "main" {
            continue;
        }
        let Some(layer) = layers.get(&own) else {
            panic!("ARCHITECTURE.md does not say in which layer {own} is");
        };
        let code = code(path);
        for name in used(&code).into_iter().filter(|n| **n != own) {
            // What the root itself holds: macros, and `error` once more.
            let lower = match name {
                "Result" | "Error" | "Stop" | "Outcome" => Some(&0),
                "law" => Some(&1),
                name => layers.get(name),
            };
            let inside = name == "law" && own == "physics";
            if !inside && lower.is_none_or(|lower| lower >= layer) {
                let place = path.strip_prefix(root()).unwrap().display();
                wrong.push(format!("{place} ({layer}) uses {name}"));
            }
        }
        seen.insert(own);
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    let gone: Vec<_> = layers.keys().filter(|m| !seen.contains(*m)).collect();
    assert!(gone.is_empty(), "no such modules: {gone:?}");
}

#[test]
fn nothing_but_the_command_reaches_the_terminal() {
    let mut files = Vec::new();
    sources(&root().join("src"), &mut files);
    for path in files.iter().filter(|p| module(p) != "cli") {
        let code = code(path);
        for word in ["print!(", "println!(", "stdout()", "process::exit"] {
            assert!(!code.contains(word), "{} has {word}", path.display());
        }
    }
}
