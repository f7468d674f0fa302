//! Several mechanisms together, looked at quickly before they are fitted.

use super::attribute::{PRIOR_STARTS, anywhere, around};
use super::fit::{Fit, Prospect, prospect, unseen};
use super::screen::COARSE;
use crate::error::Result;
use crate::infer::{LaplaceMixture, Precision, SearchSpace};
use crate::mechanism::Mechanism;
use crate::model::{AnyProgram, ByEvent, Posterior, With};
use crate::seed::Seed;

/// A model whose mechanisms are known, with where it is best on the line.
pub(crate) struct Known<'k, 'a> {
    pub(crate) mechanisms: &'k [&'a dyn Mechanism],
    /// Their parameters.
    pub(crate) added: &'k [f64],
    /// The model's own parameters.
    pub(crate) own: &'k [f64],
    /// The same beside a force of free form.
    pub(crate) open: &'k [f64],
}

/// Mechanisms together, with where they are to be looked for.
pub(crate) struct Sought<'a> {
    program: &'a dyn AnyProgram,
    mechanisms: Vec<&'a dyn Mechanism>,
    /// The best known places first.
    space: SearchSpace,
    seed: Seed,
}

/// From how many of these climbs say what they promise.
const BEST_KNOWN: usize = 3;

/// Mechanisms together after a quick look at them.
pub(crate) struct Combination<'a> {
    sought: Sought<'a>,
    /// What a quick search found.
    look: Prospect<'a>,
}

/// How far, in ln, what a search promises may fall short of an evidence.
const SHORT: f64 = 1.0;

impl<'a> Sought<'a> {
    /// A pair: from the best of either, with the other anywhere, both with the
    /// model's own parameters beside that one mechanism and with those that a
    /// force of free form leaves. Beside one mechanism the noise may have
    /// swallowed what the other explains, and a climb from there may end where
    /// it still does.
    ///
    /// # Errors
    /// An improper prior, or a model that fails.
    pub(crate) fn pair(
        program: &'a dyn AnyProgram,
        mechanisms: [&'a dyn Mechanism; 2],
        fits: [&Fit; 2],
        open: Option<&[f64]>,
        seed: Seed,
    ) -> Result<Self> {
        let ([a, b], [of_a, of_b]) = (mechanisms, fits);
        let with = With::new(program, &mechanisms);
        let posterior = Posterior::new(&with)?;
        let (mut space, mut more) = (
            around(
                &posterior,
                b,
                Some(of_b.mechanism()),
                (of_a.mechanism(), of_a.own()),
                COARSE,
                seed.child(0),
            )?,
            around(
                &posterior,
                a,
                Some(of_a.mechanism()),
                (&[], &[of_b.mechanism(), of_b.own()].concat()),
                COARSE,
                seed.child(1),
            )?,
        );
        // The best known places first.
        space.starts.insert(1, more.starts.remove(0));
        if let Some(open) = open {
            let [of_a, of_b] = [of_a.mechanism(), of_b.mechanism()];
            let beside_b = [of_b, open].concat();
            let a_anywhere = anywhere(a, &[], &beside_b, seed.child(2));
            let b_anywhere = anywhere(b, of_a, open, seed.child(3));
            let both = [of_a, of_b, open].concat();
            let at_open = [both].into_iter();
            let at_open = at_open.chain(in_turn(&a_anywhere, &b_anywhere));
            space.starts.splice(2..2, at_open);
        }
        space.extend(more);
        Ok(Self::within(program, mechanisms.to_vec(), space, seed))
    }

    /// One mechanism more, from the best of those that are known.
    ///
    /// # Errors
    /// As [`Sought::pair`].
    pub(crate) fn extended(
        program: &'a dyn AnyProgram,
        known: &Known<'_, 'a>,
        (added, fit): (&'a dyn Mechanism, &Fit),
        seed: Seed,
    ) -> Result<Self> {
        let best = Some(fit.mechanism());
        let mut mechanisms = known.mechanisms.to_vec();
        mechanisms.push(added);
        let with = With::new(program, &mechanisms);
        let posterior = Posterior::new(&with)?;
        let Known { added: before, own, open, .. } = *known;
        let seed_of = seed.child(0);
        let beside = (before, own);
        let mut space =
            around(&posterior, added, best, beside, COARSE, seed_of)?;
        let mut at_open = vec![[before, fit.mechanism(), open].concat()];
        at_open.extend(anywhere(added, before, open, seed.child(1)));
        space.starts.splice(1..1, at_open);
        Ok(Self::within(program, mechanisms, space, seed))
    }

    fn within(
        program: &'a dyn AnyProgram,
        mechanisms: Vec<&'a dyn Mechanism>,
        space: SearchSpace,
        seed: Seed,
    ) -> Self {
        let prior_starts = PRIOR_STARTS * mechanisms.len();
        let space = SearchSpace { prior_starts, ..space };
        Self { program, mechanisms, space, seed: seed.child(9) }
    }

    /// The most, in ln, that their evidence may be by the peaks near the best
    /// known places alone: that costs a thirtieth of a look.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn most(&self) -> Result<f64> {
        let with = ByEvent::new(self.program, &self.mechanisms)?;
        let posterior = Posterior::new(&with)?;
        let starts = self.space.starts.iter().take(BEST_KNOWN).cloned();
        let starts = starts.collect();
        let space = SearchSpace { starts, ..SearchSpace::default() };
        let backend = LaplaceMixture::within(space).quick();
        let found = backend.outlook(&posterior, self.seed.child(0))?;
        Ok(found.log + unseen(self.program))
    }

    /// After a quick look.
    ///
    /// # Errors
    /// An improper prior, or a model that fails.
    pub(crate) fn looked(self) -> Result<Combination<'a>> {
        let quick = LaplaceMixture::within(self.space.clone()).quick();
        let look = self.searched(quick, self.seed.child(0))?;
        Ok(Combination { sought: self, look })
    }

    /// What such a search finds.
    fn searched(
        &self,
        backend: LaplaceMixture,
        seed: Seed,
    ) -> Result<Prospect<'a>> {
        prospect(self.program, &self.mechanisms, backend, seed)
    }
}

impl<'a> Combination<'a> {
    /// About ln of their evidence.
    pub(crate) fn log(&self) -> f64 {
        self.look.log()
    }

    /// The most that it may be.
    pub(crate) fn most(&self) -> f64 {
        self.look.most()
    }

    /// What the look and a thorough search find; `None` where they do not
    /// promise an evidence of about the hurdle.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn pursued(self, hurdle: f64) -> Result<Option<Pursued<'a>>> {
        let least = hurdle - SHORT;
        if self.most() <= least {
            return Ok(None);
        }
        let Self { sought, look } = self;
        let seed = sought.seed;
        let backend = LaplaceMixture::within(sought.space.clone());
        let found = match look.searching(&backend) {
            Some(several) => several,
            None => {
                let found = sought.searched(backend, seed.child(3))?;
                found.joined(look, seed.child(4))?
            }
        };
        let prospect = found.pursued(least, seed.child(2))?;
        let reaches = prospect.may_reach(least);
        Ok(reaches.then(|| Pursued { prospect, seed: seed.child(1) }))
    }
}

/// One of the first, one of the second, and so on; then what is left.
fn in_turn(first: &[Vec<f64>], second: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let most = first.len().max(second.len());
    let of = |all: &[Vec<f64>], i: usize| all.get(i).cloned();
    let each = (0..most).flat_map(|i| [of(first, i), of(second, i)]);
    each.flatten().collect()
}

/// Mechanisms together after a thorough search.
pub(crate) struct Pursued<'a> {
    prospect: Prospect<'a>,
    seed: Seed,
}

impl Pursued<'_> {
    /// Their fit.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn fit(&self, precision: Precision) -> Result<Fit> {
        self.prospect.fit(precision, self.seed)
    }
}

/// Fits a pair: from the best of either, with the other anywhere; `None`
/// where it does not promise an evidence of about the hurdle.
///
/// # Errors
/// As [`attribute`](super::attribute::attribute).
pub fn pair(
    program: &dyn AnyProgram,
    mechanisms: [&dyn Mechanism; 2],
    fits: [&Fit; 2],
    hurdle: f64,
    seed: Seed,
) -> Result<Option<Fit>> {
    let pair = Sought::pair(program, mechanisms, fits, None, seed)?;
    let found = pair.looked()?.pursued(hurdle)?;
    found.map(|found| found.fit(Precision::Sharp)).transpose()
}
