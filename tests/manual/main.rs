//! The manual: its reference says what the code says, its links lead
//! somewhere, its contents list every page.
//!
//! `COULOIR_WRITE_MANUAL=1 cargo test --release --test manual` writes the
//! reference anew.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

mod backends;
mod drawn;
mod formats;
mod laws;
mod links;
mod mechanisms;
mod noises;
mod page;
mod pages;
mod pictures;
mod priors;
mod sources;
mod table;
mod told;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Once;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn book() -> PathBuf {
    root().join("manual/src")
}

/// Writes what is made from the code, once, where that was asked for.
fn fresh() {
    static WRITTEN: Once = Once::new();
    WRITTEN.call_once(|| {
        if std::env::var_os("COULOIR_WRITE_MANUAL").is_none() {
            return;
        }
        for (path, text) in pages::all().into_iter().chain(drawn::all()) {
            write(&path, &text);
        }
        let contents = contents();
        let (chapters, _) = contents.split_once(REFERENCE).unwrap();
        write("SUMMARY.md", &format!("{chapters}{}", pages::contents()));
    });
}

/// Where the part of the contents begins that is made from the code.
const REFERENCE: &str = "# Reference\n";

fn contents() -> String {
    fs::read_to_string(book().join("SUMMARY.md")).unwrap()
}

fn write(path: &str, text: &str) {
    let file = book().join(path);
    fs::create_dir_all(file.parent().unwrap()).unwrap();
    fs::write(file, text).unwrap();
}

const MEND: &str = "write them anew with COULOIR_WRITE_MANUAL=1";

#[test]
fn the_reference_says_what_the_code_says() {
    fresh();
    let mut old = Vec::new();
    let mut named = BTreeSet::new();
    for (path, text) in pages::all() {
        let found = fs::read_to_string(book().join(&path));
        if found.ok().as_ref() != Some(&text) {
            old.push(path.clone());
        }
        named.insert(book().join(path));
    }
    assert!(old.is_empty(), "{MEND}: {old:#?}");
    let there = links::pages(&book().join("reference"));
    let left: Vec<_> = there.iter().filter(|p| !named.contains(*p)).collect();
    assert!(left.is_empty(), "of nothing in the code: {left:#?}");
}

#[test]
fn the_contents_list_every_page() {
    fresh();
    let text = contents();
    let at = text.find(REFERENCE).unwrap();
    assert!(text[at..] == pages::contents(), "{MEND}");
    let listed: BTreeSet<_> =
        links::targets(&text).iter().map(|t| book().join(t)).collect();
    let mut there: BTreeSet<_> = links::pages(&book()).into_iter().collect();
    there.remove(&book().join("SUMMARY.md"));
    assert_eq!(listed, there);
}

#[test]
fn every_link_leads_somewhere() {
    fresh();
    let mut files = links::pages(&book());
    files.push(root().join("README.md"));
    let mut faults = Vec::new();
    for page in files {
        let text = fs::read_to_string(&page).unwrap();
        let targets = links::targets(&text);
        faults.extend(targets.iter().filter_map(|t| links::fault(&page, t)));
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
