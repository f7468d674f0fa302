//! The path that the recordings share, and where their rows lie beside it.

use super::crs::Place;
use super::line::{Beside, Line};
use super::moving::Moving;
use super::options::Options;
use super::outline::Outline;
use crate::draws::median;
use crate::error::{Error, Result};
use crate::io::place;

/// Positions nearer than this to the last one kept are left out \[m\].
const STEP: f64 = 3.0;

/// Further than this from the path, positions are of another place \[m\].
const ELSEWHERE: f64 = 500.0;

/// Where the rows of each recording lie beside the path.
#[derive(Debug)]
pub(super) struct Along {
    /// The path, in the direction of the motion.
    pub(super) line: Line,
    /// For each recording, its rows that are taken.
    pub(super) beside: Vec<Vec<Beside>>,
    /// For each recording, what was done, in a sentence.
    pub(super) said: Vec<String>,
}

impl Along {
    /// Where along the path the first recording begins, and the last ends
    /// \[m\].
    pub(super) fn span(&self) -> (f64, f64) {
        let first = self.beside.iter().filter_map(|rows| rows.first());
        let begin = first.map(|b| b.along).fold(f64::INFINITY, f64::min);
        let all = self.beside.iter().flatten().map(|b| b.along);
        (begin, all.fold(0.0, f64::max))
    }
}

/// The path that a file gives, as it goes there.
pub(super) fn given(options: &Options, places: &[Place]) -> Result<Line> {
    Line::through(places).ok_or_else(|| {
        Error::input(format!(
            "{}: all its places are one; expected a line along the path",
            file(options)
        ))
    })
}

fn file(options: &Options) -> String {
    options.path.as_deref().map(place).unwrap_or_default()
}

/// How far along the line rows go \[m\].
fn way(beside: &[Beside]) -> f64 {
    let ends = beside.first().zip(beside.last());
    ends.map_or(0.0, |(a, b)| b.along - a.along)
}

fn off(beside: &[Beside]) -> f64 {
    let off: Vec<f64> = beside.iter().map(|b| b.off).collect();
    median(&off)
}

/// The recordings along the path of a file, which is turned round where the
/// motion goes against it.
pub(super) fn on_given(
    options: &Options,
    outline: &Outline,
    line: Line,
    all: &[Moving],
) -> Result<Along> {
    let file = file(options);
    let follow = |line: &Line| -> (Vec<Vec<Beside>>, f64) {
        let beside = all.iter().map(|one| line.follow(one.taken()));
        let beside: Vec<_> = beside.collect();
        let ways = beside.iter().map(|rows| way(rows)).sum();
        (beside, ways)
    };
    let (mut line, mut turned) = (line, "");
    let (mut beside, ways) = follow(&line);
    if ways < 0.0 {
        (line, turned) = (line.reversed(), ", turned round");
        (beside, _) = follow(&line);
    }
    let which = match outline.count {
        1 => "the line".to_owned(),
        count => format!("the longest of {count} lines"),
    };
    let mut said = Vec::new();
    for (one, rows) in all.iter().zip(&beside) {
        check(&file, one, rows, outline.count)?;
        said.push(format!(
            "The path is {which} of {file}{turned}; positions were put on its \
             nearest place, at the median {:.1} m away.",
            off(rows)
        ));
    }
    Ok(Along { line, beside, said })
}

/// Refuses a path that a recording has nothing to do with.
fn check(
    file: &str,
    one: &Moving,
    rows: &[Beside],
    count: usize,
) -> Result<()> {
    let (word, off, way) = (one.log.word(), off(rows), way(rows));
    if off > ELSEWHERE {
        return Err(Error::input(format!(
            "{file}: the {word}'s positions are {off:.0} m from it (median); \
             expected a path that they follow: check --crs, and that the \
             longest of its {count} lines is the one meant"
        )));
    }
    if way < STEP {
        return Err(Error::input(format!(
            "{file}: the {word} goes {way:.1} m along it; expected a path \
             that the motion follows: leave --path out, and the {word}'s own \
             positions are taken"
        )));
    }
    Ok(())
}

/// The recordings along the positions of the first of them.
pub(super) fn on_own(all: &[Moving]) -> Result<Along> {
    let first = all.first().map_or(&[][..], Moving::taken);
    let name = all.first().map(|one| place(&one.log.path));
    let name = name.unwrap_or_default();
    let line = Line::thinned(first, STEP).ok_or_else(|| {
        Error::input(format!(
            "{name}: the positions never change; expected a sensor that \
             moves: take another part with --from and --to"
        ))
    })?;
    let word = all.first().map_or("log", |one| one.log.word());
    let mut said = vec![format!(
        "The path is the {word}'s own positions, {:.1} m long seen from \
         above; those less than {STEP} m from the last one kept are left out \
         of it.",
        line.length()
    )];
    let beside = all.iter().map(|one| line.follow(one.taken()));
    let beside: Vec<_> = beside.collect();
    for (one, rows) in all.iter().zip(&beside).skip(1) {
        if off(rows) > ELSEWHERE || way(rows) < STEP {
            return Err(Error::input(format!(
                "{}: goes {:.1} m along the positions of {name}, {:.0} m \
                 beside them (median); expected recordings of one avalanche: \
                 give its path with --path, or import each by itself",
                place(&one.log.path),
                way(rows),
                off(rows)
            )));
        }
        said.push(format!(
            "The path is the positions of {name}; those of this recording \
             were put on its nearest place, at the median {:.1} m away.",
            off(rows)
        ));
    }
    Ok(Along { line, beside, said })
}
