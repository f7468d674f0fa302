//! Every parser, given the files of its corpus and changed ones.

use std::cell::RefCell;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use proptest::test_runner::{
    Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner,
};

use super::changes::changed;
use super::limits::{Take, Tally, Watched};
use super::targets::{data, imports, results, words};

/// How many inputs there are in all every day.
const INPUTS: u64 = 150_000;

/// The shares of all targets together.
const SHARES: u64 = 1000;

/// Says a line that is not held back for tests that pass.
pub(crate) fn say(text: &str) {
    std::io::stderr().write_all(text.as_bytes()).unwrap();
}

fn number(variable: &str, otherwise: u64) -> u64 {
    let text = std::env::var(variable).ok();
    text.map_or(otherwise, |text| text.parse().unwrap())
}

/// The files of a target's corpus, by their names.
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/hardness/corpus")
        .join(target);
    let mut paths: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

/// A folder for a target's inputs, in memory where there is such a place.
fn scratch(target: &str) -> PathBuf {
    let memory = Path::new("/dev/shm");
    let base = match memory.is_dir() {
        true => memory.to_owned(),
        false => std::env::temp_dir(),
    };
    let name = format!("couloir-hardness-{}", std::process::id());
    let folder = base.join(name).join(target);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn runner(target: &str, cases: u64) -> TestRunner {
    let mut seed = [0; 32];
    seed[..8].copy_from_slice(&number("COULOIR_SEED", 1).to_le_bytes());
    let name = target.bytes().take(24);
    seed[8..].iter_mut().zip(name).for_each(|(at, byte)| *at = byte);
    let config = Config {
        cases: cases as u32,
        failure_persistence: None,
        max_shrink_iters: 1000,
        ..Config::default()
    };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &seed);
    TestRunner::new_with_rng(config, rng)
}

/// Gives a target its share of the inputs.
fn run(target: &str, share: u64, take: Take) {
    let (begun, folder) = (Instant::now(), scratch(target));
    let watched = Watched::new(take, folder.clone());
    let (corpus, tally) = (corpus(target), RefCell::new(Tally::default()));
    for (i, input) in corpus.iter().enumerate() {
        let given = watched.give(input, &mut tally.borrow_mut());
        given.unwrap_or_else(|why| panic!("{target}, file {i}: {why}"));
    }
    assert!(tally.borrow().taken > 0, "{target}: no file of it is good");
    let cases = number("COULOIR_INPUTS", INPUTS) * share / SHARES;
    let found = runner(target, cases).run(&changed(corpus), |input| {
        let given = watched.give(&input.0, &mut tally.borrow_mut());
        given.map_err(TestCaseError::fail)
    });
    if let Err(TestError::Fail(why, input)) = &found {
        let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(target);
        fs::write(&kept, &input.0).unwrap();
        panic!("{target}: {why}; kept in {}: {input:?}", kept.display());
    }
    found.unwrap();
    let Tally { inputs, taken, slowest, most } = tally.into_inner();
    say(&format!(
        "{target:10} {inputs:>9} inputs, {taken:>8} good, {:>6.0} s, slowest \
         {:>6.1} ms, most {:>8.3} MB\n",
        begun.elapsed().as_secs_f64(),
        1e3 * slowest.as_secs_f64(),
        most as f64 / f64::from(1 << 20)
    ));
    let _ = fs::remove_dir_all(&folder);
    // The folder of all targets goes with the last of them.
    let _ = folder.parent().map(fs::remove_dir);
}

macro_rules! targets {
    ($($name:ident: $share:literal, $take:path;)*) => {
        $(#[test]
        fn $name() {
            run(stringify!($name), $share, $take);
        })*

        #[test]
        fn the_shares_are_of_all() {
            assert_eq!(SHARES, 0 $(+ $share)*);
        }
    };
}

targets! {
    event: 110, data::event;
    track: 70, data::track;
    recording: 90, data::recording;
    depth: 60, data::depth;
    prior: 95, words::prior;
    friction: 70, words::friction;
    noise: 70, words::noise;
    shard: 40, words::shard;
    set: 4, words::set;
    log: 45, imports::log;
    front: 15, imports::front;
    gpx: 25, imports::gpx;
    columns: 30, imports::columns;
    moment: 20, imports::moment;
    crs: 30, imports::crs;
    grid: 25, imports::grid;
    geotiff: 45, imports::geotiff;
    shapefile: 45, imports::shapefile;
    geojson: 30, imports::geojson;
    particles: 25, imports::particles;
    list: 26, results::list;
    journal: 25, results::journal;
    results: 5, results::earlier;
}
