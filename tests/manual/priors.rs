//! A page for each prior.

use couloir::prior::NAMES;

use super::page::{Page, file_name};
use super::told::Told;

/// All of them.
pub(crate) fn pages() -> Vec<Page> {
    NAMES.iter().map(|(name, arguments)| page(name, *arguments)).collect()
}

fn page(name: &str, arguments: usize) -> Page {
    let file = file_name(name);
    let told = Told::of("prior", &file);
    let about = told.above(&format!("pub struct {name}<")).unwrap();
    let made = told.above("pub fn new(").unwrap();
    let many = match arguments {
        0 => "It takes no arguments.".to_owned(),
        1 => format!("It takes one argument. {made}"),
        n => format!("It takes {n} arguments. {made}"),
    };
    let written = if arguments == 0 { "" } else { ".." };
    let order = match arguments {
        0 | 1 => "",
        _ => " In both the arguments have this order.",
    };
    let head = told.head.split("\n\n").next().unwrap();
    let text = format!(
        "{about}\n\n{many}\n\nIn an event file: \
         `mu = \"{name}({written})\"` under `[priors]`. In Rust: \
         `couloir::prior::{name}`.{order} A density is that of the textbooks \
         (Johnson, Kotz and Balakrishnan, Continuous Univariate \
         Distributions, 1994 and 1995); look at the names of the arguments, \
         since a scale here is a rate elsewhere.\n"
    );
    Page::of("priors", [&file, name], head, &text)
}
