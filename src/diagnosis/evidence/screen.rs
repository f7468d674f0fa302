//! Where along the run a stretch, or a step, promises most: by superposition.
//!
//! To first order in its amplitude, a stretch does to the predictions what one
//! from its beginning to the end of the run does, less what one from its end
//! does. One derivative at each border along the run so tells the score of
//! every stretch between two borders, all other coordinates at their best
//! (Rao's score test, with what has to be estimated projected out).

use nalgebra::{DMatrix, DVector};

use super::edges::{Edges, on_line};
use super::others::Others;
use crate::error::Result;
use crate::infer::{HeldGrid, HeldPlace};
use crate::mechanism::{Mechanism, Unknown};
use crate::model::{Information, Posterior, unit_directions};
use crate::parallel;
use crate::prior::{AnyPrior, Distribution, Prior};
use crate::scalar::{Grad, Real};

/// The quantiles of its prior between which an amplitude starts.
const AMPLITUDES: [f64; 2] = [0.02, 0.98];
/// The quantiles from which one of either sign starts besides: errors that are
/// correlated explain what a large amplitude explains better, and less lies
/// between.
const LARGE: [f64; 2] = [0.07, 0.93];
/// The same of one that cannot be below zero.
const ONE: [f64; 1] = [0.7];
/// A quantile of an amplitude that cannot be below zero, where it is as good
/// as none.
const HARDLY: f64 = 0.02;
/// The quantile of a prior that is a standard deviation above its middle.
const DEVIATION: f64 = 0.8413;

/// How closely the run is looked at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mesh {
    /// How many borders there are at the most.
    borders: usize,
    /// How far apart, in borders, places are at the least, with how many of
    /// these there are at the most: some all over the run, most where the
    /// scores are.
    levels: &'static [(usize, usize)],
    /// How far apart, in borders, stretches begin that last to the end, and
    /// end that last from the beginning, with a large amplitude; none at 0.
    /// What makes the mass stop, or run on, is not nearly linear.
    halves: usize,
}

/// Where a mechanism is looked for without anything known of it.
pub(super) const FINE: Mesh =
    Mesh { borders: 120, levels: &[(15, 8), (5, 10), (1, 14)], halves: 4 };
/// From the tails of the model's own parameters, beside other terms, and under
/// a second noise: beside a finer look, or from where a term is known.
pub(super) const COARSE: Mesh =
    Mesh { borders: 60, levels: &[(7, 5), (1, 7)], halves: 0 };
/// From where others have the model's own parameters: what they stand for may
/// be friction from the start on.
pub(super) const MET: Mesh = Mesh { halves: 4, ..COARSE };

/// Places along the run where an edge of a confined mechanism may be, for each
/// of its amplitudes; all other coordinates begin at `before` and `after`.
///
/// # Errors
/// What no other parameter values would mend.
pub(super) fn edge_grids(
    posterior: &Posterior<'_>,
    mechanism: &dyn Mechanism,
    before: &[f64],
    after: &[f64],
    mesh: Mesh,
) -> Result<Vec<HeldGrid>> {
    let unknowns = mechanism.unknowns();
    let mut grids = Vec::new();
    for along in mechanism.amplitudes() {
        let Some(edges) = Edges::of(&unknowns[along.clone()], mesh.borders)
        else {
            continue;
        };
        let screen = Screen {
            posterior,
            amplitude: &unknowns[along.start],
            edges,
            others: Others::of(&unknowns, &along, before, after),
        };
        grids.extend(screen.grid(mesh)?);
    }
    Ok(grids)
}

/// Edges of one amplitude, all other coordinates at known places.
struct Screen<'a, 'm> {
    posterior: &'a Posterior<'m>,
    amplitude: &'a Unknown,
    edges: Edges<'a>,
    others: Others,
}

impl Screen<'_, '_> {
    fn line(&self, amplitude: f64, edges: &[f64]) -> Vec<f64> {
        self.others.with(&[&[amplitude], edges].concat())
    }

    /// The best places; `None` where nothing can be told.
    fn grid(&self, mesh: Mesh) -> Result<Option<HeldGrid>> {
        let Some(scores) = self.scores()? else { return Ok(None) };
        let ranked = scores.ranked();
        let far = mesh.levels[0].0;
        let places = mesh
            .levels
            .iter()
            .flat_map(|&(apart, most)| {
                let chosen = best(&ranked, apart, most).into_iter();
                chosen.flat_map(move |one| {
                    self.places(&one, apart, apart == far)
                })
            })
            .chain(self.halves(mesh.halves))
            .collect();
        let first = self.others.before.len() + 1;
        let held = (first..first + self.edges.count()).collect();
        Ok(Some(HeldGrid { held, places }))
    }

    /// Stretches to the end, and from the beginning, with large amplitudes.
    fn halves(&self, apart: usize) -> Vec<HeldPlace> {
        let borders = self.edges.borders();
        let each = (1..borders).step_by(apart.max(1));
        let each = each.take(if apart == 0 { 0 } else { borders });
        let ends = each.flat_map(|i| [(i, borders), (0, i)]);
        let whole = self.edges.count() == 1;
        ends.filter(|(_, to)| !whole || *to == borders)
            .flat_map(|(from, to)| {
                let (edges, spacing) = self.edges.place(from, to, apart);
                self.large().into_iter().map(move |amplitude| HeldPlace {
                    line: self.line(amplitude, &edges),
                    spacing: spacing.clone(),
                })
            })
            .collect()
    }

    /// Large amplitudes, of either sign where there are two.
    fn large(&self) -> Vec<f64> {
        let all = if self.amplitude.is_signed() { &LARGE[..] } else { &ONE };
        all.iter().map(|p| on_line(&self.amplitude.prior, *p)).collect()
    }

    /// A place with the amplitude that its score tells; a far one with large
    /// amplitudes of either sign too.
    fn places(&self, one: &Scored, apart: usize, far: bool) -> Vec<HeldPlace> {
        let prior = &self.amplitude.prior;
        let [low, high] = AMPLITUDES.map(|p| on_line(prior, p));
        let told = prior.line_of(one.amplitude);
        let told = if told.is_nan() { low } else { told.clamp(low, high) };
        let further = if far { self.large() } else { Vec::new() };
        let (edges, spacing) = self.edges.place(one.from, one.to, apart);
        let place = |amplitude: &f64| HeldPlace {
            line: self.line(*amplitude, &edges),
            spacing: spacing.clone(),
        };
        std::iter::once(&told).chain(&further).map(place).collect()
    }

    /// The score of every stretch.
    fn scores(&self) -> Result<Option<Scores>> {
        let prior = &self.amplitude.prior;
        let signed = self.amplitude.is_signed();
        let small = if signed { 0.0 } else { on_line(prior, HARDLY) };
        let along = self.along(small)?;
        let Some(last) = along.iter().rposition(Option::is_some) else {
            return Ok(None);
        };
        let whole = self.line(small, &self.edges.onwards(last));
        let whole = self.posterior.information(&whole)?;
        let Some(effects) = self.effects(&along, &whole, small) else {
            return Ok(None);
        };
        let Effects { columns, follows, score } = effects;
        let sd = prior.quantile(DEVIATION).unwrap_or(1.0);
        Ok(Some(Scores {
            products: columns.tr_mul(&columns) - follows.tr_mul(&follows),
            score,
            prior: 1.0 / (sd * sd).max(f64::MIN_POSITIVE),
            signed,
            until_end: self.edges.count() == 1,
        }))
    }

    /// The density with a small amplitude from each border on, along it.
    fn along(&self, small: f64) -> Result<Vec<Option<Information>>> {
        let index = self.others.before.len();
        let along = unit_directions(&[index], self.posterior.dimension());
        parallel::try_map(0..self.edges.borders(), |i| {
            let line = self.line(small, &self.edges.onwards(i));
            let about = self.posterior.information_along(&line, &along)?;
            Ok(about.density.on_line().is_finite().then_some(about))
        })
    }

    /// What the amplitude does from each border on, all else being as with it
    /// from one of them on: it is small. `None` where nothing can be told.
    fn effects(
        &self,
        along: &[Option<Information>],
        whole: &Information,
        small: f64,
    ) -> Option<Effects> {
        let (stretch, pull) = along_line(&self.amplitude.prior, small);
        let index = self.others.before.len();
        let own: Vec<usize> = (0..index)
            .chain(index + 1 + self.edges.count()..whole.gradient.len())
            .collect();
        let inner = whole.precision.select_rows(&own).select_columns(&own);
        let lower = inner.cholesky()?.l();
        let rest =
            lower.solve_lower_triangular(&whole.gradient.select_rows(&own))?;
        let data = whole.jacobian.count();
        let mut effects = Effects::none(along.len(), own.len(), data);
        for (i, about) in along.iter().enumerate() {
            let Some(about) = about.as_ref() else { continue };
            if about.jacobian.count() != data {
                continue;
            }
            let column = about.jacobian.row(0) / stretch;
            let across = whole.jacobian.times(&own, &column);
            let across = lower.solve_lower_triangular(&across)?;
            effects.score[i] =
                (about.gradient[0] - pull) / stretch - across.dot(&rest);
            effects.columns.set_column(i, &column);
            effects.follows.set_column(i, &across);
        }
        Some(effects)
    }
}

/// What an amplitude does from each border on, a column for each.
struct Effects {
    /// To the innovations.
    columns: DMatrix<f64>,
    /// To what all other coordinates have to follow, in units of how sharply
    /// these are known.
    follows: DMatrix<f64>,
    /// To the log density, once these have followed.
    score: DVector<f64>,
}

impl Effects {
    fn none(borders: usize, own: usize, data: usize) -> Self {
        Self {
            columns: DMatrix::zeros(data, borders),
            follows: DMatrix::zeros(own, borders),
            score: DVector::zeros(borders),
        }
    }
}

/// How fast an amplitude grows along the line, and the slope of its prior's
/// log density there.
fn along_line(prior: &AnyPrior, z: f64) -> (f64, f64) {
    type K = Grad<4>;
    let support = <AnyPrior as Prior<K>>::support(prior);
    let (x, log_jacobian) = support.from_line(Real::variable(z, 0));
    let log: Real<K> = prior.log_density(x) + log_jacobian;
    (x.partial(0), log.partial(0))
}

/// Scores of an amplitude that begins at each border and lasts to the end,
/// with what they say of those between two.
struct Scores {
    score: DVector<f64>,
    /// Of what any two do to the innovations, once all else follows.
    products: DMatrix<f64>,
    /// The precision of the amplitude's prior.
    prior: f64,
    signed: bool,
    /// Whether all last to the end.
    until_end: bool,
}

/// A stretch between two borders with the amplitude that its score tells.
#[derive(Debug, Clone, Copy)]
struct Scored {
    from: usize,
    to: usize,
    amplitude: f64,
    /// About by how much the log density rises.
    gain: f64,
}

impl Scores {
    fn of(&self, from: usize, to: usize) -> Scored {
        let (mut score, mut bend) =
            (self.score[from], self.products[(from, from)]);
        if to < self.score.len() {
            score -= self.score[to];
            bend += self.products[(to, to)] - 2.0 * self.products[(from, to)];
        }
        let bend = bend.max(0.0) + self.prior;
        let score = if self.signed { score } else { score.max(0.0) };
        let gain = 0.5 * score * score / bend;
        Scored { from, to, amplitude: score / bend, gain }
    }

    /// That of every stretch, the best first.
    fn ranked(&self) -> Vec<Scored> {
        let count = self.score.len();
        let mut all: Vec<Scored> = (0..count)
            .flat_map(|from| {
                let first = if self.until_end { count } else { from + 1 };
                (first..=count).map(move |to| self.of(from, to))
            })
            .collect();
        all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        all
    }
}

/// The first of those so far from each other.
fn best(ranked: &[Scored], apart: usize, most: usize) -> Vec<Scored> {
    let mut chosen: Vec<Scored> = Vec::with_capacity(most);
    for one in ranked {
        let near = |other: &Scored| {
            one.from.abs_diff(other.from) <= apart
                && one.to.abs_diff(other.to) <= apart
        };
        if !chosen.iter().any(near) {
            chosen.push(*one);
        }
        if chosen.len() == most {
            break;
        }
    }
    chosen
}
