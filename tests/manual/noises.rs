//! A page for each noise.

use couloir::noise;

use super::page::{Page, struct_name};
use super::table::{Row, parameters};
use super::told::Told;

/// All of them.
pub(crate) fn pages() -> Vec<Page> {
    noise::names().iter().map(|pattern| page(pattern)).collect()
}

fn page(pattern: &str) -> Page {
    let name = pattern.split('(').next().unwrap();
    let told = Told::of("noise", name);
    let about = told.above(&format!("pub struct {}<", struct_name(name)));
    let (written, remark) = written(pattern, name);
    let one = noise::parse(&written).unwrap();
    let (_, fields) =
        one.terms().into_iter().find(|(of, _)| *of == name).unwrap();
    let row = |field: couloir::block::Field| Row {
        name: field.name.to_owned(),
        meaning: told.above(&format!("pub {}:", field.name)).unwrap(),
        unit: unit(field.unit),
        prior: field.prior.to_owned(),
    };
    let rows: Vec<Row> = fields.into_iter().map(row).collect();
    let text = format!(
        "{}\n\nIn an event file: `noise = \"{pattern}\"`{remark} In Rust: \
         `couloir::noise::{}`.\n\n{}\n{SCALES}",
        about.unwrap(),
        struct_name(name),
        parameters(&rows),
    );
    Page::of("noises", [name, name], &told.head, &text)
}

/// How a noise that holds it is written, and what to say of that.
fn written(pattern: &str, name: &str) -> (String, String) {
    let one = pattern.replace("(k)", "(1)");
    let sum = format!("white + {name}");
    let adds = |text: &str| noise::parse(text).is_ok();
    match (adds(&one), adds(&format!("growth + {one}"))) {
        (true, true) => (one, ", or in a sum.".to_owned()),
        (true, false) => (one, ", by itself.".to_owned()),
        (false, _) => {
            let remark = format!(" in a sum only, such as `{sum}`.");
            (sum, remark)
        }
    }
}

fn unit(unit: &str) -> String {
    match unit {
        "value" => "that of the recording".to_owned(),
        "value2" => "that of the recording, squared".to_owned(),
        unit => unit.to_owned(),
    }
}

const SCALES: &str = "In a prior, `size` is the largest value recorded, \
                      `size2` its square, `duration` the time from the first \
                      value to the last [s].\n";
