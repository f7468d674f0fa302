//! From the files to events, step by step.

use super::along::{self, Along};
use super::avaframe::{self, Project};
use super::case::Case;
use super::crs::Crs;
use super::elevations::{ground, told};
use super::grid::Grid;
use super::ground::Ground;
use super::log::Log;
use super::moving::Moving;
use super::options::Options;
use super::outline::Outline;
use super::{plane, source, together};
use crate::error::Result;

/// Reads the files, and works out what the event of each recording needs.
pub(super) fn work_out(options: &Options) -> Result<Vec<Case>> {
    options.check()?;
    let project = Project::of(options)?;
    let completed = project.as_ref().map(|own| own.complete(options));
    let options = completed.as_ref().unwrap_or(options);
    let grid = options.terrain.as_deref().map(source::terrain).transpose()?;
    let outline = options.path.as_deref().map(source::path).transpose()?;
    let logs = recordings(options, project.as_ref(), outline.as_ref())?;
    let crs =
        plane::projection(options, &logs, outline.as_ref(), grid.as_ref())?;
    let line = outline.as_ref().map(|outline| {
        along::given(options, &plane::path(outline, crs.as_ref())?)
    });
    let line = line.transpose()?;
    let all = logs.into_iter().map(|log| {
        let mut one = Moving::of(options, log, crs.as_ref(), line.as_ref())?;
        note(options, &mut one, grid.as_ref(), crs.as_ref())?;
        Ok(one)
    });
    let all = all.collect::<Result<Vec<_>>>()?;
    let along = match (&outline, line) {
        (Some(outline), Some(line)) => {
            along::on_given(options, outline, line, &all)?
        }
        _ => along::on_own(&all)?,
    };
    let ground = ground(options, grid.as_ref(), &all, &along)?;
    Ok(cases(options, all, along, &ground, grid.as_ref()))
}

/// The logs, the front behind them, and what is taken of a simulation.
fn recordings(
    options: &Options,
    project: Option<&Project>,
    outline: Option<&Outline>,
) -> Result<Vec<Log>> {
    let columns = options.columns.as_deref();
    let logs = options.logs.iter().map(|path| source::log(path, columns));
    let front = options.front.iter().map(|path| source::front(path, columns));
    let mut all = logs.chain(front).collect::<Result<Vec<_>>>()?;
    if let Some(project) = project {
        all.extend(avaframe::logs(project, options.particles(), outline)?);
    }
    Ok(all)
}

/// Notes which projection was taken, and what is to doubt about it.
fn note(
    options: &Options,
    one: &mut Moving,
    grid: Option<&Grid>,
    crs: Option<&Crs>,
) -> Result<()> {
    if options.crs.is_none() && grid.is_some_and(|grid| grid.epsg.is_some()) {
        let is_used = one.log.is_geographic();
        let said = "The projection is the one that the terrain model names.";
        one.said.extend(is_used.then(|| said.to_owned()));
    }
    let doubt = plane::doubt(options, &one.log, grid, crs)?;
    one.log.doubts.extend(doubt);
    Ok(())
}

/// What is known of each recording, with the path and the track of all.
fn cases(
    options: &Options,
    all: Vec<Moving>,
    along: Along,
    ground: &Ground,
    grid: Option<&Grid>,
) -> Vec<Case> {
    let (origin, _) = along.span();
    let several = all.len() > 1;
    let starts = several.then(|| together::starts(&all)).flatten();
    let names = names(options, &all);
    let Along { line, beside, said } = along;
    let each = all.into_iter().zip(beside).zip(said).enumerate();
    let each = each.map(|(i, ((mut moving, beside), path))| {
        let word = moving.log.word();
        moving.said.push(path);
        moving.said.push(told(options, grid, ground, word));
        let taken = moving.taken();
        let terrain =
            |grid: &Grid| taken.iter().map(|p| grid.at(*p)).collect();
        Case {
            name: names.get(i).cloned().unwrap_or_default(),
            threshold: options.threshold,
            line: line.clone(),
            is_given: options.path.is_some(),
            beside,
            terrain: grid.map(terrain),
            ground: ground.clone(),
            origin,
            several,
            start: starts.as_ref().and_then(|all| all.get(i)).copied(),
            recorded: Vec::new(),
            moving,
        }
    });
    let mut cases: Vec<Case> = each.collect();
    cases.iter_mut().for_each(|case| case.recorded = case.along_slope());
    cases
}

/// The events' names: as asked for, or those of the files.
fn names(options: &Options, all: &[Moving]) -> Vec<String> {
    let folders = options.folders();
    if !folders.is_empty() {
        return folders;
    }
    let own = all.iter().map(|one| {
        let stem = one.log.path.file_stem().unwrap_or_default();
        let stem = stem.to_string_lossy().into_owned();
        options.name.clone().unwrap_or(stem)
    });
    own.collect()
}
