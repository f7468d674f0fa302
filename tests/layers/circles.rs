//! Files that use each other in a circle.
//!
//! A file depends on the file that defines what its `use` lines and its paths
//! name, whichever door it comes through: `mod x;` and `pub use` are doors,
//! and no dependency.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::{code, is_of_tests, root, sources};

/// A path of modules, from the root of the crate.
type Names = Vec<String>;

struct File {
    module: Names,
    code: String,
    /// What its `use` lines name, and under which name; `*` for all.
    used: Vec<(Names, String, bool)>,
}

fn names(path: &str) -> Names {
    path.split("::").map(|s| s.trim().to_owned()).collect()
}

/// `a::{b, c::{d, e}}` as single paths.
fn spread(tree: &str) -> Vec<String> {
    let Some((head, rest)) = tree.split_once('{') else {
        return vec![tree.trim().to_owned()];
    };
    let body = rest.trim_end().strip_suffix('}').unwrap_or(rest);
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for c in body.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if c == ',' && depth == 0 {
            parts.push(String::new());
        } else {
            parts.last_mut().unwrap().push(c);
        }
    }
    let parts = parts.iter().filter(|p| !p.trim().is_empty());
    let whole = |part: &String| spread(&format!("{}{part}", head.trim()));
    parts.flat_map(whole).collect()
}

/// From the crate's root; `None` for other crates.
fn absolute(module: &[String], path: &[String]) -> Option<Names> {
    let supers = path.iter().take_while(|s| *s == "super").count();
    let own = module.get(..module.len().checked_sub(supers)?)?;
    match path[0].as_str() {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some([module, &path[1..]].concat()),
        "super" => Some([own, &path[supers..]].concat()),
        _ => None,
    }
}

impl File {
    fn of(path: &Path) -> Self {
        let inside = path.strip_prefix(root().join("src")).unwrap();
        let inside = inside.with_extension("");
        let mut module: Names =
            inside.iter().map(|s| s.to_str().unwrap().to_owned()).collect();
        if ["mod", "lib"].contains(&module.last().unwrap().as_str()) {
            module.pop();
        }
        let (mut used, mut rest) = (Vec::new(), String::new());
        for statement in code(path).split_inclusive(';') {
            let line = statement.lines().position(|l| {
                let l = l.trim_start();
                let behind = l.strip_prefix("pub").unwrap_or(l).trim_start();
                let shut = behind.starts_with('(').then(|| behind.find(')'));
                let open = shut.flatten().map_or(0, |at| at + 1);
                behind[open..].trim_start().starts_with("use ")
            });
            let Some(line) = line else {
                rest.push_str(statement);
                continue;
            };
            let lines: Vec<&str> = statement.lines().collect();
            rest.push_str(&lines[..line].join("\n"));
            rest.push('\n');
            let whole = lines[line..].join(" ");
            let is_door = whole.trim_start().starts_with("pub");
            let tree = whole.split_once("use ").unwrap().1;
            for one in spread(tree.trim_end_matches(';')) {
                let (path, alias) = match one.split_once(" as ") {
                    Some((path, alias)) => (names(path), Some(alias)),
                    None => (names(&one), None),
                };
                let path = Self::path(&module, path, &inside);
                let Some(path) = path else { continue };
                let last = path.last().cloned().unwrap_or_default();
                let name = alias.map_or(last, |a| a.trim().to_owned());
                used.push((path, name, is_door));
            }
        }
        Self { module, code: rest, used }
    }

    /// A path of a `use` line: from the root, or of a module beside it.
    fn path(module: &Names, path: Names, file: &Path) -> Option<Names> {
        let path = match path.last() {
            Some(last) if last == "self" => path[..path.len() - 1].to_vec(),
            _ => path,
        };
        let absolute = absolute(module, &path);
        let folder = root().join("src").join(module.join("/"));
        let below = folder.join(format!("{}.rs", path[0])).exists()
            || folder.join(&path[0]).is_dir();
        let child = || (below && file.iter().count() > 0).then_some(());
        absolute.or_else(|| child().map(|()| [&module[..], &path].concat()))
    }

    fn defines(&self, name: &str) -> bool {
        let kinds = [
            "fn",
            "struct",
            "enum",
            "trait",
            "type",
            "const",
            "static",
            "macro_rules!",
        ];
        kinds.iter().any(|kind| {
            let start = format!("{kind} {name}");
            self.code.match_indices(&start).any(|(at, _)| {
                let next = self.code[at + start.len()..].chars().next();
                !next.is_some_and(|c| c.is_alphanumeric() || c == '_')
            })
        })
    }
}

/// The file that defines what a path names, through the doors.
fn definer(
    files: &BTreeMap<Names, File>,
    path: &[String],
    deep: usize,
) -> Option<Names> {
    let known =
        (0..=path.len()).rev().find(|k| files.contains_key(&path[..*k]))?;
    let (module, rest) = path.split_at(known);
    let file = &files[module];
    let Some(name) = rest.first() else { return Some(module.to_vec()) };
    if file.defines(name) || deep > 8 {
        return Some(module.to_vec());
    }
    for (path, as_name, _) in &file.used {
        let further = match as_name.as_str() {
            "*" => [&path[..path.len() - 1], rest].concat(),
            own if own == name => [&path[..], &rest[1..]].concat(),
            _ => continue,
        };
        let found = definer(files, &further, deep + 1);
        let there = |f: &Names| as_name != "*" || files[f].defines(name);
        if let Some(found) = found.filter(there) {
            return Some(found);
        }
    }
    Some(module.to_vec())
}

/// Every path in the code behind `crate::` and `super::`, and behind the name
/// of a module that is used whole.
fn paths(file: &File) -> Vec<Names> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let words = file.code.split(|c: char| !is_word(c) && c != '$');
    let mut found = Vec::new();
    for word in words.filter(|w| w.contains("::") && !w.starts_with("::")) {
        let path = names(word.trim_end_matches(':'));
        if let Some(path) = absolute(&file.module, &path) {
            found.push(path);
            continue;
        }
        let whole = file.used.iter().find(|(_, name, _)| *name == path[0]);
        if let Some((module, ..)) = whole {
            found.push([&module[..], &path[1..]].concat());
        }
    }
    found
}

fn graph() -> BTreeMap<String, BTreeSet<String>> {
    let mut all = Vec::new();
    sources(&root().join("src"), &mut all);
    all.retain(|p| !is_of_tests(p) && !p.ends_with("main.rs"));
    let files = all.iter().map(|p| File::of(p));
    let files: BTreeMap<Names, File> =
        files.map(|f| (f.module.clone(), f)).collect();
    let depends = |file: &File| -> BTreeSet<String> {
        let lines = file.used.iter().filter(|(_, _, is_door)| !is_door);
        // A module used whole is what is used of it.
        let items = lines
            .map(|(path, ..)| path.clone())
            .filter(|path| !files.contains_key(path));
        items
            .chain(paths(file))
            .filter_map(|path| definer(&files, &path, 0))
            .filter(|module| *module != file.module)
            .map(|module| module.join("/"))
            .collect()
    };
    files.iter().map(|(m, f)| (m.join("/"), depends(f))).collect()
}

/// All that can be reached from a file.
fn reach<'g>(
    graph: &'g BTreeMap<String, BTreeSet<String>>,
    from: &str,
) -> BTreeSet<&'g str> {
    let mut found = BTreeSet::new();
    let mut next: Vec<&str> = graph[from].iter().map(String::as_str).collect();
    while let Some(one) = next.pop() {
        if found.insert(one) {
            next.extend(graph[one].iter().map(String::as_str));
        }
    }
    found
}

#[test]
fn no_files_use_each_other_in_a_circle() {
    let graph = graph();
    let mut circles: BTreeSet<Vec<&str>> = BTreeSet::new();
    for file in graph.keys() {
        let there = reach(&graph, file);
        if there.contains(file.as_str()) {
            let mutual = there.into_iter();
            let back = |f: &&str| reach(&graph, f).contains(file.as_str());
            circles.insert(mutual.filter(back).collect());
        }
    }
    assert!(circles.is_empty(), "files in a circle: {circles:#?}");
}
