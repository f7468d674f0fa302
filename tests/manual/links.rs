//! The links of the manual: every file and every heading that they name is
//! there. No network is asked, so addresses elsewhere are passed over.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::root;

/// Every page below a folder.
pub(crate) fn pages(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(pages(&path));
        } else if path.extension().is_some_and(|e| e == "md") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The lines of a page that are no code.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut in_code = false;
    text.lines().filter(move |line| {
        let fence = line.trim_start().starts_with("```");
        in_code ^= fence;
        !in_code && !fence && !line.starts_with("    ")
    })
}

/// What a page links to: all between `](` and `)`.
pub(crate) fn targets(text: &str) -> Vec<String> {
    let whole = prose(text).collect::<Vec<_>>().join(" ");
    let parts = whole.split("](").skip(1);
    let ends = parts.filter_map(|part| part.split_once(')'));
    ends.map(|(target, _)| target.to_owned()).collect()
}

/// The anchors of a page: its headings as GitHub and mdBook write them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text).filter(|line| line.starts_with('#'));
    headings.map(|line| anchor(line.trim_start_matches('#'))).collect()
}

fn anchor(heading: &str) -> String {
    let kept = heading.trim().to_lowercase();
    let kept = kept
        .chars()
        .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// What is wrong with a link that stands in a page.
pub(crate) fn fault(page: &Path, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (file, heading) = target.split_once('#').unwrap_or((target, ""));
    let to = match file {
        "" => page.to_owned(),
        file => page.parent().unwrap().join(file),
    };
    let from = page.strip_prefix(root()).unwrap().display();
    let Ok(text) = fs::read_to_string(&to) else {
        return Some(format!("{from}: no file {target}"));
    };
    let is_there = heading.is_empty() || anchors(&text).contains(heading);
    (!is_there).then(|| format!("{from}: no heading {target}"))
}

#[test]
fn a_broken_link_is_seen() {
    let page = root().join("manual/src/README.md");
    assert!(fault(&page, "nowhere.md").is_some());
    assert!(fault(&page, "formats.md#nowhere").is_some());
    assert_eq!(fault(&page, "formats.md#event-folder"), None);
    assert_eq!(
        anchor(" The file `event.toml`, line 3"),
        "the-file-eventtoml-line-3"
    );
    assert_eq!(targets("a [b](c.md#d)\n```\n[e](f.md)\n```"), ["c.md#d"]);
}
