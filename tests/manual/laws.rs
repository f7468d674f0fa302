//! A page for each friction law.

use couloir::physics::Varies;
use couloir::physics::friction::{LAWS, Law};

use super::page::{Page, struct_name};
use super::sources::{self, source};
use super::table::{Row, parameters};
use super::told::Told;

/// All of them.
pub(crate) fn pages() -> Vec<Page> {
    LAWS.iter().map(|law| page(*law)).collect()
}

fn page(law: &dyn Law) -> Page {
    let name = law.name();
    let told = Told::of("physics/friction", name);
    let about = told.above(&format!("pub struct {}<", struct_name(name)));
    let meaning = |field| told.above(&format!("pub {field}:"));
    let row = |field: &couloir::block::Field| Row {
        name: field.name.to_owned(),
        meaning: meaning(field.name).unwrap_or_default(),
        unit: field.unit.to_owned(),
        prior: field.prior.to_owned(),
    };
    let rows: Vec<Row> = law.fields().iter().map(row).collect();
    let text = format!(
        "{}\n\nIn an event file: `friction = \"{name}\"`, or in a sum. In \
         Rust: `couloir::physics::friction::{}`.\n\n{}\n{}\n\n\
         Source: {}\n",
        about.unwrap(),
        struct_name(name),
        parameters(&rows),
        solved(law.varies()),
        source(sources::LAWS, name),
    );
    Page::of("laws", [name, name], &told.head, &text)
}

fn solved(varies: Varies) -> &'static str {
    match varies {
        Varies::Nowhere => {
            "It is the same along the whole track; the motion is solved \
             exactly."
        }
        Varies::WithPlace => {
            "It depends on the place; the motion is solved exactly on each \
             piece of the track."
        }
        Varies::WithSpeed => {
            "It depends on the speed in its own way; the motion is solved \
             leg by leg, which takes longer."
        }
    }
}
