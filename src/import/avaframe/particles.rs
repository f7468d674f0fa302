//! The particles of a simulation by time, as com1DFA writes them: a table for
//! each time, with the columns X, Y, Z \[m\], velocityMagnitude \[m/s\], m
//! \[kg\], ID and time \[s\].

use std::path::Path;

use super::super::clock::Moment;
use super::super::line::Line;
use super::super::log::{Fix, Frame, Log, SpeedKind};
use super::super::outline::Outline;
use super::super::particle::Particle;
use super::project::Project;
use crate::error::{Error, Result};
use crate::io::{place, quoted, read_any_text};

/// Where the columns of a table are.
struct Header {
    x: usize,
    y: usize,
    z: usize,
    speed: usize,
    time: usize,
    mass: Option<usize>,
    number: Option<usize>,
}

/// A particle at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Row {
    place: (f64, f64),
    height: f64,
    speed: f64,
    mass: f64,
    number: Option<u64>,
}

/// All particles at a time.
#[derive(Debug, Clone, PartialEq)]
struct Step {
    time: f64,
    rows: Vec<Row>,
}

/// The logs of the particles that are taken.
pub(in super::super) fn logs(
    project: &Project,
    particles: &[Particle],
    outline: Option<&Outline>,
) -> Result<Vec<Log>> {
    let path = particles
        .contains(&Particle::Front)
        .then(|| path(project, outline))
        .transpose()?;
    let mut fixes: Vec<Vec<Fix>> = vec![Vec::new(); particles.len()];
    let (mut least, mut most) = (usize::MAX, 0);
    for file in &project.steps {
        let step = read(file)?;
        least = least.min(step.rows.len());
        most = most.max(step.rows.len());
        let last = fixes.iter().flatten().map(|fix: &Fix| fix.time);
        let last = last.fold(f64::NEG_INFINITY, f64::max);
        if step.time <= last {
            return Err(Error::input(format!(
                "{}: is of {} s, after a table of {last} s; expected later \
                 times in later files: delete what another run left there",
                place(file),
                step.time
            )));
        }
        for (particle, fixes) in particles.iter().zip(&mut fixes) {
            fixes.extend(fix(*particle, &step, path.as_ref(), file)?);
        }
    }
    let both = particles.iter().zip(fixes);
    both.map(|(one, fixes)| log(project, *one, fixes, (least, most))).collect()
}

/// The path that a front is furthest along.
fn path(project: &Project, outline: Option<&Outline>) -> Result<Line> {
    let wrong = |what: &str| {
        Error::input(format!(
            "--particle front: {what}; expected a path on the projection of \
             the simulation {}, which the front is furthest along: give one \
             with --path",
            quoted(&project.simulation)
        ))
    };
    let outline = outline.ok_or_else(|| wrong("there is no path"))?;
    if outline.is_geographic {
        return Err(wrong("the path is in degrees"));
    }
    Line::through(&outline.places)
        .ok_or_else(|| wrong("the path's places are one"))
}

/// What is taken of a step; nothing where the particle has left.
fn fix(
    particle: Particle,
    step: &Step,
    path: Option<&Line>,
    file: &Path,
) -> Result<Option<Fix>> {
    let found = match particle {
        Particle::Mean => {
            // The centre of a bent flow lies above the ground.
            let (place, speed) = mean(&step.rows);
            Some((place, None, Some(speed)))
        }
        Particle::Front => {
            path.map(|path| (foremost(&step.rows, path), None, None))
        }
        Particle::Number(wanted) => {
            if step.rows.iter().any(|row| row.number.is_none()) {
                return Err(Error::input(format!(
                    "{}: has no column ID; expected one, by which particle \
                     {wanted} is found: run com1DFA with \
                     visuParticleProperties = velocityMagnitude|m|ID, or \
                     take --particle mean",
                    place(file)
                )));
            }
            let mut rows = step.rows.iter();
            let row = rows.find(|row| row.number == Some(wanted));
            row.map(|row| (row.place, Some(row.height), Some(row.speed)))
        }
    };
    Ok(found.map(|(place, height, speed)| Fix {
        row: 0,
        time: step.time,
        place,
        height,
        speed,
        satellites: None,
    }))
}

/// Place and speed, averaged by mass.
fn mean(rows: &[Row]) -> ((f64, f64), f64) {
    let total: f64 = rows.iter().map(|row| row.mass).sum();
    let of = |value: fn(&Row) -> f64| {
        rows.iter().map(|row| row.mass / total * value(row)).sum::<f64>()
    };
    ((of(|r| r.place.0), of(|r| r.place.1)), of(|r| r.speed))
}

/// The distance of the foremost particle along the path \[m\].
fn foremost(rows: &[Row], path: &Line) -> (f64, f64) {
    let along = |row: &Row| path.nearest(row.place, 0.0, path.length()).along;
    (rows.iter().map(along).fold(0.0, f64::max), 0.0)
}

fn log(
    project: &Project,
    particle: Particle,
    fixes: Vec<Fix>,
    (least, most): (usize, usize),
) -> Result<Log> {
    let path = project.steps.first().cloned().unwrap_or_default();
    let Some(begin) = fixes.first().map(|fix| fix.time) else {
        return Err(Error::input(format!(
            "{}: --particle: has no particle of this number; expected the ID \
             of one, or \"mean\"",
            place(&path)
        ))
        .within(particle));
    };
    let doubts = doubts(project.steps.len(), fixes.len(), (least, most));
    let said = said(project, particle, most);
    let is_front = particle == Particle::Front;
    let fix =
        |(row, fix): (u64, Fix)| Fix { row, time: fix.time - begin, ..fix };
    Ok(Log {
        path,
        fixes: (1..).zip(fixes).map(fix).collect(),
        frame: if is_front { Frame::Along } else { Frame::Metres },
        kind: if is_front { SpeedKind::Front } else { SpeedKind::Along },
        begin: Moment::number(begin),
        is_simulated: true,
        said,
        doubts,
    })
}

fn said(project: &Project, particle: Particle, most: usize) -> Vec<String> {
    let taken = match particle {
        Particle::Mean => {
            "the mean of all, weighted by mass: the centre of mass".to_owned()
        }
        Particle::Front => {
            "the distance of the foremost along the path".to_owned()
        }
        Particle::Number(number) => format!("particle {number}"),
    };
    let mut said = vec![format!(
        "Synthetic data: simulated by AvaFrame, {}. Read {} times of {most} \
         particles, and took {taken}.",
        quoted(&project.simulation),
        project.steps.len()
    )];
    said.extend((particle == Particle::Mean).then(|| {
        "The mean of the particles' speeds stands for the centre's.".into()
    }));
    said
}

fn doubts(
    steps: usize,
    count: usize,
    (least, most): (usize, usize),
) -> Vec<String> {
    let mut doubts = Vec::new();
    if least < most {
        doubts.push(format!(
            "The particles are {least} to {most}: com1DFA splits and merges \
             them, or some left the terrain."
        ));
    }
    if count < steps {
        doubts.push(format!(
            "The particle is in {count} of {steps} tables: it left the \
             terrain, or com1DFA merged it with another."
        ));
    }
    doubts
}

/// Reads the particles of a time.
fn read(path: &Path) -> Result<Step> {
    let text = read_any_text(path)?;
    let mut source = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let bad = |error: csv::Error| {
        Error::input(format!(
            "{}: is no table that can be read: {}; expected one as com1DFA \
             writes it",
            place(path),
            quoted(&error.to_string())
        ))
    };
    let header = Header::of(source.headers().map_err(bad)?)
        .map_err(|what| Error::input(what).within(place(path)))?;
    let mut step = Step { time: f64::NAN, rows: Vec::new() };
    for record in source.records() {
        let record = record.map_err(bad)?;
        let line = record.position().map_or(0, csv::Position::line);
        let (time, row) = header.row(&record).map_err(|what| {
            Error::input(what).within(format_args!("{}:{line}", place(path)))
        })?;
        if step.rows.is_empty() {
            step.time = time;
        } else if time != step.time {
            return Err(Error::input(format!(
                "the time is {time}, in rows before it {}; expected a table \
                 of one time",
                step.time
            ))
            .within(format_args!("{}:{line}", place(path))));
        }
        step.rows.push(row);
    }
    if step.rows.is_empty() {
        return Err(Error::input(format!(
            "{}: has no particle; expected a row for each",
            place(path)
        )));
    }
    Ok(step)
}

impl Header {
    fn of(header: &csv::StringRecord) -> Result<Self, String> {
        let find = |name: &str| header.iter().position(|cell| cell == name);
        let need = |name: &str| {
            find(name).ok_or_else(|| {
                let all: Vec<&str> = header.iter().collect();
                format!(
                    "the header is {}; expected the column {name} in it: run \
                     com1DFA with visuParticleProperties = \
                     velocityMagnitude|m|ID",
                    quoted(&all.join(","))
                )
            })
        };
        Ok(Self {
            x: need("X")?,
            y: need("Y")?,
            z: need("Z")?,
            speed: need("velocityMagnitude")?,
            time: need("time")?,
            mass: find("m"),
            number: find("ID"),
        })
    }

    fn row(&self, record: &csv::StringRecord) -> Result<(f64, Row), String> {
        let number = |at: usize| {
            let cell = record.get(at).unwrap_or_default();
            let value = cell.parse().ok().filter(|x: &f64| x.abs() < 1e12);
            value.ok_or_else(|| {
                format!(
                    "column {} is {}; expected a finite number: run the \
                     simulation again",
                    at + 1,
                    quoted(cell)
                )
            })
        };
        let mass = self.mass.map_or(Ok(1.0), number)?;
        if mass <= 0.0 {
            return Err(format!(
                "the mass is {mass} kg; expected a positive one"
            ));
        }
        let own = self.number.map(number).transpose()?;
        let row = Row {
            place: (number(self.x)?, number(self.y)?),
            height: number(self.z)?,
            speed: number(self.speed)?,
            mass,
            number: own.map(|own| own.max(0.0) as u64),
        };
        Ok((number(self.time)?, row))
    }
}
