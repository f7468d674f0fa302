//! A page for each mechanism, its variants on one.

use couloir::mechanism::catalogue::catalogue;
use couloir::mechanism::{Extent, Family, Mechanism, Role};

use super::page::{Page, struct_name};
use super::sources::{self, source};
use super::table::{Row, parameters};
use super::told::Told;

/// The event that default priors are shown for.
pub(crate) const EXTENT: Extent = Extent {
    begin: 0.0,
    run: 1000.0,
    since: 0.0,
    duration: 60.0,
    speed: 30.0,
    step: 0.5,
    behind: 100.0,
    start_speed: 0.0,
    carried: true,
    bends: true,
    averages: true,
    rate_unit: "m/s2",
};

/// All of them, variants one after the other.
pub(crate) fn all() -> Vec<Box<dyn Mechanism>> {
    catalogue(&EXTENT, &[])
}

/// A page for each name.
pub(crate) fn pages() -> Vec<Page> {
    let all = all();
    let mut groups: Vec<Vec<&dyn Mechanism>> = Vec::new();
    for mechanism in &all {
        let name = mechanism.name();
        match groups.iter_mut().find(|group| group[0].name() == name) {
            Some(group) => group.push(mechanism.as_ref()),
            None => groups.push(vec![mechanism.as_ref()]),
        }
    }
    groups.iter().map(|variants| page(variants)).collect()
}

fn page(variants: &[&dyn Mechanism]) -> Page {
    let name = variants[0].name();
    let told = Told::of("mechanism/catalogue", name);
    let begins = format!("pub struct {}", struct_name(name));
    let about = told.above(&begins).unwrap();
    let mut text = format!(
        "{about}\n\nWhat a report says of it: {}\n\n{}\n",
        variants[0].says(),
        family(variants[0].family())
    );
    for variant in variants {
        text.push_str(&of_variant(*variant));
    }
    text.push_str(&format!(
        "\n{SHOWN_FOR}\n{}\nSource: {}\n",
        laws(variants[0]),
        source(sources::MECHANISMS, name)
    ));
    Page::of("mechanisms", [name, name], &told.head, &text)
}

fn of_variant(mechanism: &dyn Mechanism) -> String {
    let row = |unknown: couloir::mechanism::Unknown| Row {
        name: unknown.name,
        meaning: String::new(),
        unit: unknown.unit.to_owned(),
        prior: unknown.prior.to_string(),
    };
    let unknowns = mechanism.unknowns();
    let reaches = unknowns.iter().find_map(|unknown| match unknown.role {
        Role::Length { .. } => Some(format!(
            "\nBeforehand `{}` reaches to what is left of the run, where that \
             is less.\n",
            unknown.name
        )),
        _ => None,
    });
    let rows: Vec<Row> = unknowns.into_iter().map(row).collect();
    format!(
        "\nIn an event file: `mechanisms = [\"{}\"]`. The change:\n\n    \
         {}\n\n{}{}",
        mechanism.label(),
        mechanism.formula(),
        parameters(&rows),
        reaches.unwrap_or_default()
    )
}

fn family(family: Family) -> &'static str {
    match family {
        Family::Physics => {
            "It is physics: a term that is added to du/dt, or changes one."
        }
        Family::Start => {
            "It is of the start: how the mass was released. Each of several \
             events has it in an amount of its own."
        }
        Family::Measurement => {
            "It is of the measurement: the motion stays, what is recorded \
             of it changes."
        }
    }
}

/// Which laws it is weighed beside.
fn laws(mechanism: &dyn Mechanism) -> String {
    let list = |names: &[&str]| -> String {
        let names: Vec<_> = names.iter().map(|n| format!("`{n}`")).collect();
        names.join(", ")
    };
    let mut text = String::new();
    if !mechanism.contained_in().is_empty() {
        text.push_str(&format!(
            "\nIt is not looked for in a model with {}, which has it \
             already.\n",
            list(mechanism.contained_in())
        ));
    }
    if !mechanism.needs().is_empty() {
        text.push_str(&format!(
            "\nIt is looked for only in a model with one of {}.\n",
            list(mechanism.needs())
        ));
    }
    text
}

const SHOWN_FOR: &str = "Default priors are scaled to the event. Those here are for a run of \
     1000 m and 60 s with values every 0.5 s, an upper quartile of the speeds \
     of 30 m/s, and a release 100 m from the track's first point.";
