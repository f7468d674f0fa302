//! How does the cost grow with values, pieces, parameters and events?
//!
//! `cargo bench --bench growth` prints tables in Markdown, each with the
//! exponents fitted to it; with `-- parameters` those of parameters alone,
//! and so for the others.

#![allow(missing_docs, clippy::print_stdout)]

#[path = "../reference/mod.rs"]
mod reference;

mod models;
mod table;

use std::time::Instant;

use couloir::model::Model;
use couloir::prelude::*;

use models::{Gappy, Hierarchy, Sections, avalanches, long_slope};
use table::{Row, print};

fn main() -> Result<()> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let wants = |name: &str| {
        let named = wanted.iter().filter(|word| !word.starts_with('-'));
        named.clone().count() == 0 || named.clone().any(|word| word == name)
    };
    if wanted.iter().any(|w| w == "profile") {
        let z: Vec<f64> = (0..256).map(|i| 0.1 * (i as f64).sin()).collect();
        let mut g = vec![0.0; 256];
        let (h, e) = (Hierarchy::new(256), Sections::new(256));
        let m: &dyn Model =
            if wanted.iter().any(|w| w == "flow") { &e } else { &h };
        for _ in 0..40_000 {
            let _ = std::hint::black_box(m.gradient(
                &z,
                couloir::model::Weights::LINE,
                &mut g,
            ));
        }
        return Ok(());
    }
    if wants("parameters") {
        parameters()?;
    }
    if wants("values") {
        let sizes = [10, 100, 1_000, 10_000, 100_000];
        print("values", rows(&sizes, |n| long_slope(300, n))?);
        print("values, AR(2), some missing", rows(&sizes, Gappy::new)?);
    }
    if wants("pieces") {
        let sizes = [10, 100, 1_000, 10_000, 100_000];
        print("pieces of the track", rows(&sizes, |n| long_slope(n, 20))?);
    }
    if wants("events") {
        print("events", rows(&[1, 2, 5, 10, 20, 50, 100], avalanches)?);
    }
    Ok(())
}

fn parameters() -> Result<()> {
    let sizes = [2, 8, 16, 24, 32, 64, 128, 256];
    let hierarchy = rows(&sizes, |n| Ok(Hierarchy::new(n)))?;
    print("parameters of a hierarchy", hierarchy);
    let sections = rows(&sizes, |n| Ok(Sections::new(n)))?;
    print("parameters of one flow, by section", sections);
    Ok(())
}

fn rows<M: Model + 'static>(
    sizes: &[usize],
    model: impl Fn(usize) -> Result<M>,
) -> Result<Vec<Row>> {
    let row = |&size: &usize| {
        let mut shortest = f64::INFINITY;
        for _ in 0..5 {
            let begun = Instant::now();
            drop(model(size)?);
            shortest = shortest.min(begun.elapsed().as_secs_f64());
        }
        Row::new(size, Box::new(model(size)?), shortest)
    };
    sizes.iter().map(row).collect()
}
