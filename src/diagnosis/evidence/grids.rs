//! Places along a mechanism's coordinates, at which a search holds them.

use std::ops::Range;

use crate::diagnosis::evidence::fit::{on_line, spread};
use crate::infer::{HeldGrid, HeldPlace};
use crate::mechanism::{Mechanism, Role, Unknown};
use crate::prior::AnyPrior;
use crate::seed::Seed;

/// How many places along so many coordinates are kept to.
fn places(held: usize) -> usize {
    match held {
        0 => 0,
        1 => 32,
        2 => 144,
        _ => 300,
    }
}

/// At how many places along the run an edge is tried, at most.
const EDGES: f64 = 120.0;
/// How long a brief stretch is there, in units of the shortest.
const BRIEF: f64 = 1.5;
/// How near the start, or the end, of the run the other edge is, as a share of
/// what is possible.
const NEAR: f64 = 0.01;
/// From which quantiles of its prior an amplitude climbs there, if it has
/// either sign and if it has one. From zero it would stay near it: errors that
/// are correlated explain there what a large amplitude explains better, and
/// less lies between.
const LARGE: [f64; 2] = [0.07, 0.93];
const MIDDLE: [f64; 1] = [0.5];
/// How far, on the line, a coordinate may be from where it is held at the edge
/// of its prior.
const APART: f64 = 1.5;

/// The coordinates of a mechanism along which the data may tell little, with
/// even places along them, for each of its amplitudes; all other coordinates
/// begin at `before` and `after`.
pub(crate) fn even_grids(
    mechanism: &dyn Mechanism,
    before: &[f64],
    after: &[f64],
    seed: Seed,
) -> Vec<HeldGrid> {
    let unknowns = mechanism.unknowns();
    let one = |along: Range<usize>| {
        let others = Others::of(&unknowns, &along, before, after);
        even(&unknowns[along], &others, seed)
    };
    mechanism.amplitudes().into_iter().map(one).collect()
}

/// Places along the run where an edge of a confined mechanism may be, for each
/// of its amplitudes; all other coordinates begin at `before` and `after`.
pub(crate) fn edge_grids(
    mechanism: &dyn Mechanism,
    before: &[f64],
    after: &[f64],
) -> Vec<HeldGrid> {
    let unknowns = mechanism.unknowns();
    let one = |along: Range<usize>| {
        let others = Others::of(&unknowns, &along, before, after);
        narrow(&unknowns[along], &others)
    };
    mechanism.amplitudes().into_iter().filter_map(one).collect()
}

/// Where all other coordinates begin, on the line.
struct Others {
    before: Vec<f64>,
    after: Vec<f64>,
}

impl Others {
    /// Those beside a mechanism's unknowns in a range, its others at the
    /// middle of the line.
    fn of(
        unknowns: &[Unknown],
        along: &Range<usize>,
        before: &[f64],
        after: &[f64],
    ) -> Self {
        let earlier = vec![0.0; along.start];
        let later = vec![0.0; unknowns.len() - along.end];
        Self {
            before: [before, &earlier].concat(),
            after: [&later, after].concat(),
        }
    }

    fn with(&self, place: &[f64]) -> Vec<f64> {
        [&self.before, place, &self.after].concat()
    }
}

/// Even places along an amplitude and where it is.
///
/// An amplitude that may have either sign follows from where its stretch is,
/// nearly as in linear regression: there it is not among them.
fn even(along: &[Unknown], others: &Others, seed: Seed) -> HeldGrid {
    let free = usize::from(along.len() > 1 && along[0].is_signed());
    let first = others.before.len();
    let held = (first + free..first + along.len()).collect();
    let searched = &along[free..];
    let amplitude = vec![0.0; free];
    let places = spread(searched, places(searched.len()), seed)
        .into_iter()
        .map(|(place, apart)| {
            let line = others.with(&[&amplitude[..], &place].concat());
            HeldPlace { line, spacing: apart }
        })
        .collect();
    HeldGrid { held, places }
}

/// Where a stretch or a step has an edge; `None` where there is neither.
///
/// A value that lies off is explained by a jolt just before it, and a change
/// at some moment by a stretch that begins, or ends, with the run: peaks as
/// narrow as values are apart, at which even places arrive by chance.
fn narrow(along: &[Unknown], others: &Others) -> Option<HeldGrid> {
    let (amplitude, places) = along.split_first()?;
    let sites = match places {
        [edge] => edges(edge)?,
        [from, length] => stretches(&Run::of(from, length)?),
        _ => return None,
    };
    let sizes = if amplitude.is_signed() { &LARGE[..] } else { &MIDDLE };
    let places = sites
        .iter()
        .flat_map(|(place, apart)| {
            sizes.iter().map(move |p| {
                let size = [on_line(&amplitude.prior, *p)];
                let line = others.with(&[&size[..], place].concat());
                HeldPlace { line, spacing: apart.clone() }
            })
        })
        .collect();
    let first = others.before.len();
    let held = (first + 1..first + along.len()).collect();
    Some(HeldGrid { held, places })
}

/// A place on the line with how far the next ones lie, in each coordinate.
type Site = (Vec<f64>, Vec<f64>);

/// Edges along the run, one after the other.
fn edges(edge: &Unknown) -> Option<Vec<Site>> {
    let Role::Edge(_) = edge.role else { return None };
    let count = EDGES as usize;
    let site = |i: usize| {
        let at = |part: f64| on_line(&edge.prior, (i as f64 + part) / EDGES);
        (vec![at(0.5)], vec![apart([at(0.1), at(0.9)])])
    };
    Some((0..count).map(site).collect())
}

/// The shortest stretches, one after the other along the run, those to its
/// end, and those from its start on.
fn stretches(run: &Run<'_>) -> Vec<Site> {
    let span = run.end - run.begin;
    let count = (span / run.shortest).clamp(1.0, EDGES).floor();
    let step = span / count;
    let first = run.begin + NEAR * span;
    (0..count as usize)
        .flat_map(|i| {
            let at = run.begin + (i as f64 + 0.5) * step;
            let around = [at - 0.4 * step, at + 0.4 * step];
            let begins = (run.from(at), apart(around.map(|x| run.from(x))));
            let until = |x: f64| run.length(first, x - first);
            [
                [begins, (run.length(at, BRIEF * run.shortest), APART)],
                [begins, (run.whole(), APART)],
                [
                    (run.from(first), APART),
                    (until(at), apart(around.map(until))),
                ],
            ]
        })
        .map(|site| site.into_iter().unzip())
        .collect()
}

/// How far the next places lie on the line, from those a little way before and
/// after.
fn apart([before, after]: [f64; 2]) -> f64 {
    1.25 * (after - before)
}

/// Where a stretch may be.
struct Run<'a> {
    begin: f64,
    end: f64,
    shortest: f64,
    places: &'a AnyPrior,
    lengths: &'a AnyPrior,
}

impl<'a> Run<'a> {
    fn of(from: &'a Unknown, length: &'a Unknown) -> Option<Self> {
        let (Role::Edge(_), Role::Length { until }) = (from.role, length.role)
        else {
            return None;
        };
        let begin = from.prior.quantile(0.0)?;
        let shortest = length.prior.quantile(0.0)?;
        let (places, lengths) = (&from.prior, &length.prior);
        Some(Self { begin, end: until, shortest, places, lengths })
    }

    /// A beginning on the line.
    fn from(&self, at: f64) -> f64 {
        let p = (at - self.begin) / (self.end - self.begin);
        on_line(self.places, p.clamp(NEAR, 1.0 - NEAR))
    }

    /// A length on the line, of a stretch that begins at a place.
    fn length(&self, from: f64, length: f64) -> f64 {
        let longest = (self.end - from).max(2.0 * self.shortest);
        let p = (length - self.shortest) / (longest - self.shortest);
        on_line(self.lengths, p.clamp(NEAR, 1.0 - NEAR))
    }

    /// That of all that is left.
    fn whole(&self) -> f64 {
        on_line(self.lengths, 1.0 - NEAR)
    }
}
