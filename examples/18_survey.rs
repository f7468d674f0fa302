//! A survey to try `couloir sweep` on: synthetic events of the challenge, each
//! with several seeds.
//!
//! ```sh
//! cargo run --release --example 18_survey -- survey 100 100
//! couloir sweep survey/list.csv --verb calibrate --out results -- --quick
//! ```

use std::fs;
use std::path::{Path, PathBuf};

use couloir::challenge::{Errors, Mix, cases};
use couloir::{Error, Result, io};

/// The seed of the events.
const SEED: u64 = 20;

/// Of so many cases with an effect, more than half as many again have none or
/// another.
fn effects(events: usize) -> usize {
    (events * 10).div_ceil(17).max(1)
}

fn write(folder: &Path, events: usize, seeds: usize) -> Result<()> {
    let all = cases(effects(events), SEED, Mix::One, Errors::Simple)?;
    let mut list = String::from("event,seed\n");
    for (number, case) in all.iter().take(events).enumerate() {
        let name = format!("event-{number:05}");
        io::write_all(&folder.join(&name), &case.recordings[0].files)?;
        for seed in 1..=seeds {
            list.push_str(&format!("{name},{seed}\n"));
        }
    }
    io::write_all(folder, &[("list.csv", list)])
}

fn main() -> Result<()> {
    let mut words = std::env::args().skip(1);
    let folder = words.next().map_or_else(
        || std::env::temp_dir().join("couloir-survey"),
        PathBuf::from,
    );
    let mut number = || words.next().and_then(|word| word.parse().ok());
    let (events, seeds) = (number().unwrap_or(20), number().unwrap_or(2));
    write(&folder, events, seeds)?;
    let written = fs::read_dir(&folder)
        .map_err(|error| Error::system(error.to_string()))?
        .count();
    println!("{}: {} synthetic events", folder.display(), written - 1);
    Ok(())
}
