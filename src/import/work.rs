//! From the files to an event, step by step.

use super::case::Case;
use super::crs::{Crs, Place};
use super::grid::Grid;
use super::ground::{BEYOND, ENDING, Ground, spacing, track};
use super::line::{Beside, Line};
use super::log::{Log, SpeedKind};
use super::options::Options;
use super::outline::Outline;
use super::phase::{Phase, REST, between, stretches, widened};
use super::smooth::fit;
use super::{plane, source};
use crate::draws::median;
use crate::error::{Error, Result};
use crate::io::place;

/// Positions nearer than this to the last one kept are no way \[m\].
const STEP: f64 = 3.0;

/// The fewest rows that an event is made of.
const FEWEST: usize = 6;

/// Further than this from the path, positions are of another place \[m\].
const ELSEWHERE: f64 = 500.0;

/// Positions within this time of one give its speed \[s\].
const SPEED_HALF: f64 = 0.5;

/// Reads the files, and works out what an event needs.
pub(super) fn work_out(options: &Options) -> Result<Case> {
    options.check()?;
    let log = source::log(&options.log, options.columns.as_deref())?;
    let grid = options.terrain.as_deref().map(source::terrain).transpose()?;
    let outline = options.path.as_deref().map(source::path).transpose()?;
    let crs = plane::projection(options, &log, outline.as_ref())?;
    let places = plane::places(&log, crs.as_ref())?;
    let mut said = log.said.clone();
    said.push(match &crs {
        Some(crs) if log.is_geographic => {
            format!("Longitudes and latitudes were brought to {}.", crs.name)
        }
        _ => "The log's x and y were taken as metres on the projection of \
              terrain and path."
            .to_owned(),
    });
    let level = by_positions(&log, &places);
    let speeds = speeds(&log, &level, &mut said);
    let (phase, others) = moving(options, &log, &speeds, &mut said)?;
    let taken = &places[phase.first..=phase.last];
    let given = outline.as_ref().map(|o| (o, crs.as_ref()));
    let (line, beside) = path(options, given, taken, &mut said)?;
    let ground = ground(options, grid.as_ref(), &log, phase, &line, &beside)?;
    said.push(told_ground(options, grid.as_ref(), &ground));
    let terrain = grid.map(|grid| taken.iter().map(|p| grid.at(*p)).collect());
    let mut case = Case {
        name: name(options),
        recorded: Vec::new(),
        threshold: options.threshold,
        is_given: outline.is_some(),
        log,
        places,
        speeds,
        level,
        phase,
        others,
        line,
        beside,
        terrain,
        ground,
        said,
    };
    case.recorded = along_slope(&case);
    Ok(case)
}

/// The event's name: as asked for, or that of the log's file.
fn name(options: &Options) -> String {
    let stem = options.log.file_stem().unwrap_or_default();
    let stem = stem.to_string_lossy().into_owned();
    options.name.clone().unwrap_or(stem)
}

/// Horizontal speeds by positions: the slope of a line fitted to those near
/// in time, and at least to those before and after.
fn by_positions(log: &Log, places: &[Place]) -> Vec<f64> {
    let times: Vec<f64> = log.fixes.iter().map(|fix| fix.time).collect();
    let over_time = |of: fn(&Place) -> f64| -> Vec<(f64, f64)> {
        times.iter().copied().zip(places.iter().map(of)).collect()
    };
    let (x, y) = (over_time(|p| p.0), over_time(|p| p.1));
    let speed = |i: usize| {
        let before = times[i] - times[i.saturating_sub(1)];
        let after = times[(i + 1).min(times.len() - 1)] - times[i];
        let half = SPEED_HALF.max(1.5 * before.max(after));
        let (x, y) = (fit(&x, times[i], half)?, fit(&y, times[i], half)?);
        Some(x.slope.hypot(y.slope))
    };
    (0..times.len()).map(|i| speed(i).unwrap_or(f64::NAN)).collect()
}

/// The speeds of the log's own kind.
fn speeds(log: &Log, level: &[f64], said: &mut Vec<String>) -> Vec<f64> {
    let (says, speeds) = match log.kind {
        SpeedKind::Positions => (
            "The log has no speeds: they were worked out from its positions \
             and divided by the cosine of the track's slope.",
            level.to_vec(),
        ),
        kind => {
            let own = log.fixes.iter().zip(level);
            let own = own.map(|(fix, l)| fix.speed.unwrap_or(*l)).collect();
            let says = match kind {
                SpeedKind::Whole => {
                    "Speeds are the receiver's own: the length of its \
                     velocity to the north, to the east and down."
                }
                SpeedKind::Along => {
                    "Speeds are the receiver's own, taken as those along the \
                     slope."
                }
                _ => {
                    "Speeds are the receiver's own over ground, divided by \
                     the cosine of the track's slope."
                }
            };
            (says, own)
        }
    };
    said.push(says.to_owned());
    speeds
}

/// The rows that are taken, and other stretches above the threshold.
fn moving(
    options: &Options,
    log: &Log,
    speeds: &[f64],
    said: &mut Vec<String>,
) -> Result<(Phase, Vec<Phase>)> {
    let times: Vec<f64> = log.fixes.iter().map(|fix| fix.time).collect();
    let at = |name: &str, text: &Option<String>| {
        text.as_deref().map(|text| log.moment(name, text)).transpose()
    };
    let (from, to) = (at("--from", &options.from)?, at("--to", &options.to)?);
    let found = stretches(&times, speeds, options.threshold);
    let (phase, others) = if from.is_some() || to.is_some() {
        (between(&times, from, to), Vec::new())
    } else {
        let others = found.as_ref().map(|f| f.others.clone());
        let wide = |f| widened(&times, f, options.margin);
        (found.map(|f| wide(f.longest)), others.unwrap_or_default())
    };
    let rows = phase.map_or(0, |phase| phase.last - phase.first + 1);
    let Some(phase) = phase.filter(|_| rows >= FEWEST) else {
        return Err(too_few(options, log, speeds, rows));
    };
    said.push(told_phase(options, &times, phase, from.or(to).is_some()));
    Ok((phase, others))
}

fn too_few(
    options: &Options,
    log: &Log,
    speeds: &[f64],
    rows: usize,
) -> Error {
    let top = speeds.iter().copied().fold(0.0, f64::max);
    let end = log.fixes.last().map_or(0.0, |fix| fix.time);
    Error::input(format!(
        "{}: {rows} rows are in the part that would be taken; expected at \
         least {FEWEST}: the log lasts {end:.1} s and its top speed is \
         {top:.2} m/s; change --threshold ({} m/s), or --from and --to",
        place(&options.log),
        options.threshold
    ))
}

fn told_phase(
    options: &Options,
    times: &[f64],
    phase: Phase,
    is_asked: bool,
) -> String {
    let (from, to) = (times[phase.first], times[phase.last]);
    let rows = phase.last - phase.first;
    let cut = format!(
        "Taken is the log from {from:.2} to {to:.2} s after its first row: \
         {rows} values over {:.2} s, and the speed at t = 0",
        to - from
    );
    match (is_asked, options.margin) {
        (true, _) => format!("{cut}, as --from and --to say."),
        (false, margin) => {
            let more = match margin {
                0.0 => String::new(),
                margin => format!(", and {margin} s before and after"),
            };
            format!(
                "{cut}. This is the longest stretch above {} m/s, with the \
                 row before it{more}; rests of less than {REST} s within it \
                 are kept.",
                options.threshold
            )
        }
    }
}

/// The path, in the direction of the motion, and where the rows lie beside it.
fn path(
    options: &Options,
    given: Option<(&Outline, Option<&Crs>)>,
    taken: &[Place],
    said: &mut Vec<String>,
) -> Result<(Line, Vec<Beside>)> {
    match given {
        None => own_path(options, taken, said),
        Some((outline, crs)) => given_path(options, outline, crs, taken, said),
    }
}

/// The path through the positions themselves.
fn own_path(
    options: &Options,
    taken: &[Place],
    said: &mut Vec<String>,
) -> Result<(Line, Vec<Beside>)> {
    let line = Line::thinned(taken, STEP).ok_or_else(|| {
        Error::input(format!(
            "{}: the positions never change; expected a sensor that moves: \
             take another part with --from and --to",
            place(&options.log)
        ))
    })?;
    said.push(format!(
        "The path is the log's own positions, {:.1} m long seen from above; \
         those less than {STEP} m from the last one kept are no way.",
        line.length()
    ));
    let beside = line.follow(taken);
    Ok((line, beside))
}

/// The path of a file, turned round where the motion goes against it.
fn given_path(
    options: &Options,
    outline: &Outline,
    crs: Option<&Crs>,
    taken: &[Place],
    said: &mut Vec<String>,
) -> Result<(Line, Vec<Beside>)> {
    let file = options.path.as_deref().map(place).unwrap_or_default();
    let line = Line::through(&plane::path(outline, crs)?).ok_or_else(|| {
        Error::input(format!(
            "{file}: all its places are one; expected a line along the path"
        ))
    })?;
    let along = |line: &Line| {
        let beside = line.follow(taken);
        let ends = beside.first().zip(beside.last());
        let way = ends.map_or(0.0, |(a, b)| b.along - a.along);
        (beside, way)
    };
    let (mut line, mut turned) = (line, "");
    let (mut beside, mut way) = along(&line);
    if way < 0.0 {
        (line, turned) = (line.reversed(), ", turned round");
        (beside, way) = along(&line);
    }
    let off: Vec<f64> = beside.iter().map(|b| b.off).collect();
    check_path(&file, median(&off), way, outline.count)?;
    let which = match outline.count {
        1 => "the line".to_owned(),
        count => format!("the longest of {count} lines"),
    };
    said.push(format!(
        "The path is {which} of {file}{turned}; positions were put on its \
         nearest place, at the median {:.1} m away.",
        median(&off)
    ));
    Ok((line, beside))
}

/// Refuses a path that the log has nothing to do with.
fn check_path(file: &str, off: f64, way: f64, count: usize) -> Result<()> {
    if off > ELSEWHERE {
        return Err(Error::input(format!(
            "{file}: the log's positions are {off:.0} m from it (median); \
             expected a path that they follow: check --crs, and that the \
             longest of its {count} lines is the one meant"
        )));
    }
    if way < STEP {
        return Err(Error::input(format!(
            "{file}: the log goes {way:.1} m along it; expected a path that \
             the motion follows: leave --path out, and the log's own \
             positions are taken"
        )));
    }
    Ok(())
}

/// The track: elevations along the path, smoothed.
fn ground(
    options: &Options,
    grid: Option<&Grid>,
    log: &Log,
    phase: Phase,
    line: &Line,
    beside: &[Beside],
) -> Result<Ground> {
    let samples = match grid {
        Some(grid) => of_terrain(options, grid, line)?,
        None => of_log(options, log, phase, beside)?,
    };
    let ends = beside.iter().map(|b| b.along);
    let end = ends.clone().fold(0.0, f64::max);
    let begin = beside.first().map_or(0.0, |b| b.along);
    track(&samples, begin, end, options.smooth).ok_or_else(|| {
        Error::input(format!(
            "{}: elevations are known from {:.0} to {:.0} m along the path, \
             and the recording goes from {begin:.0} to {end:.0} m; expected \
             elevations from its start on, over at least {} m: take a larger \
             terrain model, or a smaller --smooth",
            place(options.terrain.as_ref().unwrap_or(&options.log)),
            samples.first().map_or(0.0, |s| s.0),
            samples.last().map_or(0.0, |s| s.0),
            spacing(options.smooth)
        ))
    })
}

/// Elevations of the terrain model under the path.
fn of_terrain(
    options: &Options,
    grid: &Grid,
    line: &Line,
) -> Result<Vec<(f64, f64)>> {
    // Four places a cell, and no more than half a million.
    let step = (0.25 * grid.cell).max(line.length() / 5e5);
    let count = (line.length() / step) as usize;
    let all = (0..=count).map(|i| step * i as f64);
    let all = all.chain([line.length()]).map(|along| {
        let z = grid.at(line.place(along))?;
        Some((along, z))
    });
    let samples: Vec<_> = all.flatten().collect();
    if samples.len() > 1 {
        return Ok(samples);
    }
    let (x, y) = line.place(0.0);
    Err(Error::input(format!(
        "{}: has no elevation under the path, which begins at x = {x:.0}, y \
         = {y:.0}; expected a place in it ({}): check --crs, or take another \
         terrain model",
        options.terrain.as_deref().map(place).unwrap_or_default(),
        grid.extent()
    )))
}

/// Heights of the log along the path.
fn of_log(
    options: &Options,
    log: &Log,
    phase: Phase,
    beside: &[Beside],
) -> Result<Vec<(f64, f64)>> {
    let rows = &log.fixes[phase.first..=phase.last];
    let both = rows.iter().zip(beside);
    let both = both.filter_map(|(fix, b)| Some((b.along, fix.height?)));
    let mut samples: Vec<(f64, f64)> = both.collect();
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    match samples.len() {
        0 | 1 => Err(Error::input(format!(
            "{}: has no heights, and there is no terrain model; expected one \
             of both: give --terrain, or name the column of heights, as in \
             --columns height=h",
            place(&options.log)
        ))),
        _ => Ok(samples),
    }
}

fn told_ground(
    options: &Options,
    grid: Option<&Grid>,
    ground: &Ground,
) -> String {
    let source = match grid {
        Some(grid) => format!(
            "the terrain model {} with cells of {} m, between them linear",
            options.terrain.as_deref().map(place).unwrap_or_default(),
            grid.cell
        ),
        None => "the log's own heights".to_owned(),
    };
    let smoothed = match options.smooth {
        0.0 => "not smoothed".to_owned(),
        smooth => format!("smoothed over {smooth} m"),
    };
    let further = match ground.known_to {
        None => String::new(),
        Some(at) => format!(
            " Beyond {at:.0} m it goes on to {BEYOND} m behind the last \
             position at the mean slope of the last {ENDING} m, for draws \
             that run further."
        ),
    };
    format!(
        "Elevations are of {source}, {smoothed}, on points {} m apart.\
         {further}",
        spacing(options.smooth)
    )
}

/// The speeds of the rows that are taken, along the slope.
fn along_slope(case: &Case) -> Vec<f64> {
    let taken = &case.speeds[case.phase.first..=case.phase.last];
    match case.log.kind {
        SpeedKind::Whole | SpeedKind::Along => taken.to_vec(),
        _ => taken
            .iter()
            .zip(case.distances())
            .map(|(speed, x)| speed / case.ground.cosine(x))
            .collect(),
    }
}
