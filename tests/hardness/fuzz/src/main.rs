//! The targets of the hardness tests, with inputs by libFuzzer: it keeps what
//! takes a branch that none before has taken, and changes that.
//!
//! `COULOIR_TARGET` names the target; all else are libFuzzer's own options.
//! `run.sh` gives each target some time.

#![no_main]

#[path = "../../targets/mod.rs"]
#[allow(dead_code, reason = "its modules are for the tests, too")]
mod targets;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use couloir::Error;
use libfuzzer_sys::{Corpus, fuzz_target};

use targets::{data, imports, results, words};

type Take = fn(&Path, &[u8]) -> Result<(), Error>;

macro_rules! targets {
    ($($module:ident::$name:ident $(as $called:literal)?),* $(,)?) => {
        /// What a target's name stands for.
        fn target(name: &str) -> Option<Take> {
            let all = [$((
                [$($called,)? stringify!($name)][0],
                $module::$name as Take,
            )),*];
            let found = all.into_iter().find(|(own, _)| *own == name);
            found.map(|(_, take)| take)
        }
    };
}

targets! {
    data::event, data::track, data::recording, data::depth,
    words::prior, words::friction, words::noise, words::shard, words::set,
    imports::log, imports::front, imports::gpx, imports::columns,
    imports::moment, imports::crs, imports::grid, imports::geotiff,
    imports::shapefile, imports::geojson, imports::particles,
    results::list, results::journal, results::earlier as "results",
}

/// The target, and a folder for its inputs.
fn chosen() -> &'static (Take, PathBuf) {
    static CHOSEN: OnceLock<(Take, PathBuf)> = OnceLock::new();
    CHOSEN.get_or_init(|| {
        let name = std::env::var("COULOIR_TARGET").unwrap_or_default();
        let Some(take) = target(&name) else {
            eprintln!("COULOIR_TARGET={name}: no target has that name");
            std::process::exit(2);
        };
        let folder = tempfile::tempdir().expect("a folder for inputs");
        (take, folder.keep())
    })
}

fuzz_target!(|input: &[u8]| -> Corpus {
    let (take, folder) = chosen();
    match take(folder, input) {
        Ok(()) => Corpus::Keep,
        // A refusal that blames anything but the input is a fault.
        Err(error) => {
            assert!(error.is_input(), "{error}");
            Corpus::Keep
        }
    }
});
