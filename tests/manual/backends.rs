//! A page for each backend.

use couloir::infer::{BACKENDS, Entry};

use super::page::Page;
use super::told::Told;

/// All of them; `nuts` has one whether it is built in or not.
pub(crate) fn pages() -> Vec<Page> {
    let mut pages: Vec<Page> = BACKENDS.iter().map(page).collect();
    if pages.iter().all(|page| page.name != "nuts") {
        pages.insert(2, nuts());
    }
    pages
}

fn page(entry: &Entry) -> Page {
    if entry.name == "nuts" {
        return nuts();
    }
    let gives = match (entry.gives.draws, entry.gives.evidence) {
        (true, true) => "draws and the evidence with its standard error",
        (true, false) => "draws",
        (false, true) => "the evidence and marginals, without draws",
        (false, false) => "the mode",
    };
    of(entry.name, entry.about, gives, "")
}

/// The one that is a feature: its page is the same without it.
fn nuts() -> Page {
    let built = " It needs couloir built with `--features nuts`.";
    of(
        "nuts",
        "no-U-turn sampler on the real line, exact gradient",
        "draws",
        built,
    )
}

fn of(name: &str, about: &str, gives: &str, built: &str) -> Page {
    let file = if name == "random-walk" { "mh" } else { name };
    let told = Told::of("infer/backends", file);
    let text = format!(
        "{}\n\nIt gives {gives}.{built} On the command line: `--backend \
         {name}`. [Which backend when](../../../../docs/backends.md) compares them.\n",
        told.head
    );
    let about = format!("{}.", capital(about));
    Page::of("backends", [name, name], &about, &text)
}

fn capital(text: &str) -> String {
    let (first, rest) = text.split_at(1);
    first.to_uppercase() + rest
}
