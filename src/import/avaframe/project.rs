//! Where a project of AvaFrame has what an event is made of.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::super::options::Options;
use crate::error::{Error, Result};
use crate::io::{place, quoted};

/// The most files that a folder of a project is looked through for.
const MOST: usize = 100_000;

/// A project of AvaFrame.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) struct Project {
    /// The simulation's name.
    pub(super) simulation: String,
    /// A table of all particles for each time, in the order of the times.
    pub(super) steps: Vec<PathBuf>,
    terrain: Option<PathBuf>,
    path: Option<PathBuf>,
}

impl Project {
    /// The project that the options name, if they do.
    pub(in super::super) fn of(options: &Options) -> Result<Option<Self>> {
        let Some(folder) = &options.avaframe else { return Ok(None) };
        let (simulation, steps) =
            simulation(folder, options.simulation.as_deref())?;
        let terrain = match options.terrain {
            Some(_) => None,
            None => Some(terrain(folder)?),
        };
        let path = match options.path {
            Some(_) => None,
            None => path(folder, &simulation)?,
        };
        Ok(Some(Self { simulation, steps, terrain, path }))
    }

    /// The options with the files of the project for those that they lack.
    pub(in super::super) fn complete(&self, options: &Options) -> Options {
        let mut options = options.clone();
        options.terrain = options.terrain.or_else(|| self.terrain.clone());
        options.path = options.path.or_else(|| self.path.clone());
        if let [one] = options.particles()
            && options.folders().is_empty()
            && options.name.is_none()
        {
            options.name = Some(format!("{}-{one}", self.simulation));
        }
        options
    }
}

/// The files of a folder, by name; none where there is no such folder.
fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let unread = |error: std::io::Error| {
        Error::system(format!("{}: cannot be read: {error}", place(folder)))
    };
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut files = Vec::new();
    for entry in folder.read_dir().map_err(unread)? {
        files.push(entry.map_err(unread)?.path());
        if files.len() > MOST {
            return Err(Error::input(format!(
                "{}: holds more than {MOST} files; expected the output of \
                 one simulation: delete the others",
                place(folder)
            )));
        }
    }
    files.sort();
    Ok(files)
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The tables of particles by simulation and number of the step:
/// `Outputs/MODULE/particlesCSV/particlesNAME.csv.0003`.
fn tables(folder: &Path) -> Result<BTreeMap<String, Vec<(u64, PathBuf)>>> {
    let mut all: BTreeMap<String, Vec<(u64, PathBuf)>> = BTreeMap::new();
    for module in files(&folder.join("Outputs"))? {
        for file in files(&module.join("particlesCSV"))? {
            let name = name(&file);
            let parts = name
                .strip_prefix("particles")
                .and_then(|name| name.rsplit_once(".csv."));
            if let Some((simulation, step)) = parts
                && let Ok(step) = step.parse()
            {
                let steps = all.entry(simulation.to_owned()).or_default();
                steps.push((step, file));
            }
        }
    }
    Ok(all)
}

/// The simulation and its tables, in the order of the steps.
fn simulation(
    folder: &Path,
    wanted: Option<&str>,
) -> Result<(String, Vec<PathBuf>)> {
    let mut all = tables(folder)?;
    let names: Vec<String> = all.keys().map(|name| quoted(name)).collect();
    let wrong = |what: String| Err(Error::input(what).within(place(folder)));
    let found = match (wanted, all.len()) {
        (_, 0) => None,
        (Some(wanted), _) => match all.remove_entry(wanted) {
            Some(found) => Some(found),
            None => {
                return wrong(format!(
                    "--simulation: found {}; expected one of {}",
                    quoted(wanted),
                    names.join(", ")
                ));
            }
        },
        (None, 1) => all.pop_first(),
        (None, count) => {
            return wrong(format!(
                "there are {count} simulations, {}; expected one: name it \
                 with --simulation",
                names.join(", ")
            ));
        }
    };
    let Some((simulation, mut steps)) = found else {
        return wrong(
            "has no Outputs/com1DFA/particlesCSV with tables of particles; \
             expected a project of AvaFrame: run com1DFA with \
             writePartToCSV = True, visuParticleProperties = \
             velocityMagnitude|m|ID, and particles in resType"
                .to_owned(),
        );
    };
    steps.sort();
    Ok((simulation, steps.into_iter().map(|(_, file)| file).collect()))
}

fn ends(path: &Path, endings: &[&str]) -> bool {
    let name = name(path).to_ascii_lowercase();
    endings.iter().any(|ending| name.ends_with(ending))
}

/// The terrain model, of which a project has one.
fn terrain(folder: &Path) -> Result<PathBuf> {
    let inputs = folder.join("Inputs");
    let mut grids = files(&inputs)?;
    grids.retain(|file| ends(file, &[".asc", ".tif", ".tiff"]));
    match <[PathBuf; 1]>::try_from(grids) {
        Ok([one]) => Ok(one),
        Err(all) => Err(Error::input(format!(
            "{}: holds {} terrain models (.asc, .tif); expected one: give it \
             with --terrain",
            place(&inputs),
            all.len()
        ))),
    }
}

/// The path: that for AIMEC, for com2AB, any that is called so, or the one
/// that AvaFrame made of the simulation; none where there is none.
fn path(folder: &Path, simulation: &str) -> Result<Option<PathBuf>> {
    let mut lines = files(&folder.join("Inputs/LINES"))?;
    let made = files(&folder.join("Outputs/ana5Utils/DFAPath"))?;
    lines.extend(made.into_iter().filter(|f| name(f).contains(simulation)));
    lines.retain(|file| ends(file, &[".shp"]));
    let is_of = |kind: &str, file: &&PathBuf| match kind {
        "aimec" | "path" => name(file).to_lowercase().contains(kind),
        _ => ends(file, &["ab.shp"]),
    };
    for kind in ["aimec", "ab", "path"] {
        let mut found = lines.iter().filter(|file| is_of(kind, file));
        let first = found.next();
        if let (Some(one), Some(other)) = (first, found.next()) {
            return Err(Error::input(format!(
                "{}: there is {} beside it; expected one path: name it with \
                 --path",
                place(one),
                place(other)
            )));
        }
        if first.is_some() {
            return Ok(first.cloned());
        }
    }
    Ok(None)
}
