//! The reference: a page for each part, a list for each kind, and the
//! contents.

use super::page::{GENERATED, Page};
use super::{backends, laws, mechanisms, noises, priors};

/// A kind of parts: folder, heading, what it is, its pages.
type Room = (&'static str, &'static str, &'static str, Vec<Page>);

fn rooms() -> [Room; 5] {
    [
        ("laws", "Friction laws", LAWS, laws::pages()),
        ("noises", "Noises", NOISES, noises::pages()),
        ("priors", "Priors", PRIORS, priors::pages()),
        ("backends", "Backends", BACKENDS, backends::pages()),
        ("mechanisms", "Mechanisms", MECHANISMS, mechanisms::pages()),
    ]
}

const LAWS: &str = "A law says what resists a unit mass: r [m/s2] in du/dt = g sin(theta) - \
     r. Here u is the speed, s the distance along the slope, theta the slope \
     angle, g = 9.81 m/s2, h the flow depth, kappa = -dtheta/ds. Laws add \
     up: `friction = \"coulomb + turbulent\"`.";
const NOISES: &str = "A noise says how the recorded values scatter about the motion: r_i is \
     the i-th value less its prediction. Some add up: `noise = \"matern32 + \
     white\"`. `noise = \"infer\"` leaves the choice to the evidence.";
const PRIORS: &str =
    "A prior says what is known of a parameter before the recording.";
const BACKENDS: &str = "A backend explores the posterior.";
const MECHANISMS: &str = "A mechanism is a change that a model may lack. `diagnose` weighs them; \
     an event file may name those that its model is to have. Zero amplitude \
     gives the model back. g is 9.81 m/s2, theta the slope angle, u the \
     speed, s the distance, s0 where the run begins.";

/// Every generated page by its path below `manual/src`, lists included.
pub(crate) fn all() -> Vec<(String, String)> {
    let mut all = Vec::new();
    for (room, heading, about, pages) in rooms() {
        let mut list = format!(
            "{GENERATED}# {heading}\n\n{about}\n\n| name | what it is |\n\
             |---|---|\n"
        );
        for page in pages {
            let file = page.path.trim_start_matches("reference/");
            let (name, head) = (&page.name, &page.head);
            list.push_str(&format!("| [`{name}`]({file}) | {head} |\n"));
            all.push((page.path, page.text));
        }
        all.push((format!("reference/{room}.md"), list));
    }
    all
}

/// The part of the contents that lists the reference.
pub(crate) fn contents() -> String {
    let mut text = String::from("# Reference\n\n");
    for (room, heading, _, pages) in rooms() {
        text.push_str(&format!("- [{heading}](reference/{room}.md)\n"));
        for page in pages {
            text.push_str(&format!("  - [{}]({})\n", page.name, page.path));
        }
    }
    text
}
