//! What is added to the model: one mechanism, a pair, or three.

use std::f64::consts::LN_10;
use std::ops::Range;

use rayon::prelude::*;

use crate::diagnosis::compare::checks::rows_of;
use crate::diagnosis::decide::added::Added;
use crate::diagnosis::decide::judge::Beforehand;
use crate::diagnosis::evidence::attribute::{
    Attribution, Known, extend, pair,
};
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::findings::{Judged, Rival, Verdict};
use crate::diagnosis::hypothesis::{Hypothesis, UNKNOWN};
use crate::draws::median;
use crate::error::Result;
use crate::mechanism::{Family, Mechanism};
use crate::model::Program;
use crate::seed::Seed;

/// In log10: by how much a pair must beat the best single mechanism, and a
/// third one the pair, besides what a further term costs beforehand; and how
/// near a rival comes.
const RISE: f64 = 1.0;
/// Of how many mechanisms all pairs are weighed.
const BEST: usize = 5;

/// What was chosen to be added to the model.
pub(crate) struct Chosen {
    /// Which of the catalogue.
    which: Vec<usize>,
    pub(crate) fit: Fit,
    /// What would do nearly as well in its place, with ln of its evidence.
    rivals: Vec<(Vec<usize>, f64)>,
    /// Which others reach further, in words.
    pub(crate) beaten: Option<String>,
}

/// The best pair with the best single mechanism in it, and the best without.
struct Pairs {
    nested: Option<Chosen>,
    other: Option<Chosen>,
}

/// What there is to choose from.
pub(crate) struct Choice<'a, P> {
    pub(crate) program: &'a P,
    pub(crate) all: &'a [Box<dyn Mechanism>],
    /// The fit of each of them, under one noise.
    pub(crate) found: &'a Attribution,
    /// ln of the evidence with a force of free form, under the same noise.
    pub(crate) open: f64,
    /// Their names, most probable first.
    pub(crate) judged: &'a [Judged],
    pub(crate) beforehand: Beforehand<'a>,
    pub(crate) seed: Seed,
}

impl<P: Program> Choice<'_, P> {
    /// The model to go on with: the best mechanism where there is one, or a
    /// pair or three where the evidence rises.
    pub(crate) fn choose(&self, verdict: Verdict) -> Result<Option<Chosen>> {
        if verdict == Verdict::Adequate {
            return Ok(None);
        }
        let best = self.best_variants();
        let Some(&first) = best.first() else { return Ok(None) };
        let fit = self.found.candidates[first].clone();
        let single = Chosen::new(vec![first], fit);
        let pairs = self.best_pair(&best, &single)?;
        let two = match pairs.nested {
            Some(two) if self.rises(&two, &single) => two,
            _ => return Ok(Some(self.rivalled(single, pairs.other))),
        };
        let two = self.rivalled(two, pairs.other);
        let found = match self.best_third(&best, &two)? {
            Some(three) if self.rises(&three, &two) => three,
            _ => two,
        };
        self.exchanged(found).map(Some)
    }

    /// The verdict once combinations are weighed too.
    ///
    /// Where two or three mechanisms together were chosen, a single one is out
    /// of the question, and what they say goes: physics where one of them is
    /// of the physics, though the best single mechanism may be of the sensor.
    /// Where the free-form force is more probable than any single mechanism,
    /// it must bring more than several together by what any further term has
    /// to bring.
    pub(crate) fn explained(
        &self,
        verdict: Verdict,
        chosen: Option<Chosen>,
    ) -> (Verdict, Option<Chosen>) {
        let further = RISE * LN_10 + self.beforehand.price(UNKNOWN);
        let beyond = |c: &Chosen| {
            let short = if c.which.len() > 1 { further } else { 0.0 };
            let reached = c.fit.log_evidence + short;
            verdict != Verdict::Unexplained || reached > self.open
        };
        let Some(chosen) = chosen.filter(beyond) else {
            return (verdict, None);
        };
        if chosen.which.len() == 1 && verdict != Verdict::Unexplained {
            return (verdict, Some(chosen));
        }
        let terms = chosen.mechanisms(self.all).into_iter();
        let verdict = match terms.map(|m| m.family()).min() {
            Some(Family::Physics) => Verdict::MissingPhysics,
            _ => Verdict::Measurement,
        };
        (verdict, Some(chosen))
    }

    /// The same with a term of the physics exchanged where another has more
    /// evidence in its place; those that have nearly as much are its rivals.
    fn exchanged(&self, chosen: Chosen) -> Result<Chosen> {
        let physics = self.physics();
        let swaps: Vec<(usize, usize)> = (1..chosen.which.len())
            .filter(|&k| physics.contains(&chosen.which[k]))
            .flat_map(|k| physics.iter().map(move |&i| (k, i)))
            .filter(|(_, i)| !chosen.which.contains(i))
            .collect();
        let fits = swaps
            .into_par_iter()
            .map(|(k, i)| self.exchange(&chosen, k, i))
            .collect::<Result<Vec<_>>>()?;
        let mut all: Vec<Chosen> = fits.into_iter().flatten().collect();
        all.push(chosen);
        all.sort_by(|a, b| self.worth(b).total_cmp(&self.worth(a)));
        let mut best = all.remove(0);
        let near = self.worth(&best) - RISE * LN_10;
        all.retain(|other| self.worth(other) > near);
        let rivals = all.into_iter().map(|c| (c.which, c.fit.log_evidence));
        best.rivals = rivals.collect();
        Ok(best)
    }

    /// The chosen with another mechanism in the place of its k-th.
    fn exchange(
        &self,
        chosen: &Chosen,
        k: usize,
        other: usize,
    ) -> Result<Option<Chosen>> {
        let mut kept = chosen.mechanisms(self.all);
        let given_up = chosen.columns(self.all)[k].1.clone();
        let mut parameters = chosen.fit.mechanism().to_vec();
        parameters.drain(given_up);
        let mut which = chosen.which.clone();
        kept.remove(k);
        which.remove(k);
        which.push(other);
        let known = Known {
            mechanisms: &kept,
            added: &parameters,
            own: chosen.fit.own(),
        };
        let added = (self.all[other].as_ref(), &self.found.candidates[other]);
        let hurdle = self.worth(chosen) + self.price(&which) - RISE * LN_10;
        let seed = self.seed.child(7000 + (k * self.all.len() + other) as u64);
        let fit = extend(self.program, &known, added, hurdle, seed)?;
        Ok(fit.map(|fit| Chosen::new(which, fit)))
    }

    /// ln of the evidence that these mechanisms must reach to be taken instead
    /// of the chosen. A second one is beforehand as unlikely as the first was:
    /// the evidence has to pay for it.
    fn hurdle(&self, which: &[usize], chosen: &Chosen) -> f64 {
        let further = self.price(which) - self.price(&chosen.which);
        chosen.fit.log_evidence + RISE * LN_10 + further
    }

    /// In ln, how much less likely beforehand these are than none of them.
    fn price(&self, which: &[usize]) -> f64 {
        let names = which.iter().map(|&i| self.all[i].name());
        names.map(|name| self.beforehand.price(name)).sum()
    }

    /// ln of the evidence, less what the terms cost beforehand.
    fn worth(&self, chosen: &Chosen) -> f64 {
        chosen.fit.log_evidence - self.price(&chosen.which)
    }

    /// Of those that were worth a fit the most probable.
    fn best(&self, fits: Vec<Option<Chosen>>) -> Option<Chosen> {
        let fits = fits.into_iter().flatten();
        fits.max_by(|a, b| self.worth(a).total_cmp(&self.worth(b)))
    }

    fn rises(&self, more: &Chosen, less: &Chosen) -> bool {
        more.fit.log_evidence > self.hurdle(&more.which, less)
    }

    /// The chosen, warned of where a pair of others reaches further.
    fn rivalled(&self, mut chosen: Chosen, rival: Option<Chosen>) -> Chosen {
        let reaches = |r: &Chosen| self.rises(r, &chosen);
        if let Some(rival) = rival.filter(reaches) {
            let mechanisms = rival.mechanisms(self.all);
            let names: Vec<_> = mechanisms.iter().map(|m| m.name()).collect();
            let gain = rival.fit.log_evidence - chosen.fit.log_evidence;
            chosen.beaten = Some(format!(
                "{} together reach a higher evidence still, by {:.1} in log10",
                names.join(" and "),
                gain / LN_10
            ));
        }
        chosen
    }

    /// The best variants of the physics with the most evidence.
    fn physics(&self) -> Vec<usize> {
        let physics = Hypothesis::Mechanism(Family::Physics);
        let is_physics = |m: &&Judged| m.kind == physics;
        self.best_of(self.judged.iter().filter(is_physics))
    }

    /// The best variant of each of the best names, most probable first.
    fn best_variants(&self) -> Vec<usize> {
        self.best_of(self.judged.iter())
    }

    fn best_of<'j>(
        &self,
        judged: impl Iterator<Item = &'j Judged>,
    ) -> Vec<usize> {
        let all = self.all;
        let evidence = |i: &usize| self.found.candidates[*i].log_evidence;
        judged
            .filter(|m| all.iter().any(|one| one.name() == m.name))
            .take(BEST)
            .filter_map(|m| {
                (0..all.len())
                    .filter(|&i| all[i].name() == m.name)
                    .max_by(|a, b| evidence(a).total_cmp(&evidence(b)))
            })
            .collect()
    }

    fn best_pair(&self, best: &[usize], single: &Chosen) -> Result<Pairs> {
        let all = self.all;
        let pairs: Vec<(usize, usize)> = (0..best.len())
            .flat_map(|i| (i + 1..best.len()).map(move |j| (best[i], best[j])))
            .collect();
        let fits = pairs
            .into_par_iter()
            .map(|(a, b)| {
                let seed = self.seed.child(1000 + (a * all.len() + b) as u64);
                let mechanisms = [all[a].as_ref(), all[b].as_ref()];
                let fits = [a, b].map(|i| &self.found.candidates[i]);
                let hurdle = self.hurdle(&[a, b], single);
                let fit = pair(self.program, mechanisms, fits, hurdle, seed)?;
                Ok(fit.map(|fit| Chosen::new(vec![a, b], fit)))
            })
            .collect::<Result<Vec<_>>>()?;
        // A second term is added to the best one: a pair of two others that
        // reaches as far says less plainly what is missing.
        let (nested, others): (Vec<_>, Vec<_>) =
            fits.into_iter().partition(|c| {
                c.as_ref().is_some_and(|c| c.which.contains(&best[0]))
            });
        Ok(Pairs { nested: self.best(nested), other: self.best(others) })
    }

    fn best_third(
        &self,
        best: &[usize],
        two: &Chosen,
    ) -> Result<Option<Chosen>> {
        let known = two.mechanisms(self.all);
        let fits = best
            .par_iter()
            .filter(|i| !two.which.contains(i))
            .map(|&i| {
                let seed = self.seed.child(5000 + i as u64);
                let known = Known {
                    mechanisms: &known,
                    added: two.fit.mechanism(),
                    own: two.fit.own(),
                };
                let added = (self.all[i].as_ref(), &self.found.candidates[i]);
                let which = [two.which.clone(), vec![i]].concat();
                let hurdle = self.hurdle(&which, two);
                let fit = extend(self.program, &known, added, hurdle, seed)?;
                Ok(fit.map(|fit| Chosen::new(which, fit)))
            })
            .collect::<Result<Vec<_>>>()?;
        Ok(self.best(fits))
    }
}

impl Chosen {
    fn new(which: Vec<usize>, fit: Fit) -> Self {
        Self { which, fit, rivals: Vec::new(), beaten: None }
    }

    /// What would do nearly as well, most evidence first.
    pub(crate) fn rivals(
        &self,
        all: &[Box<dyn Mechanism>],
        none: &Fit,
    ) -> Vec<Rival> {
        let rival = |(which, log_evidence): &(Vec<usize>, f64)| Rival {
            names: which.iter().map(|&i| all[i].name().to_owned()).collect(),
            log10_bayes_factor: (log_evidence - none.log_evidence) / LN_10,
        };
        self.rivals.iter().map(rival).collect()
    }

    /// Calls the chosen mechanisms by the signs that they have together: one
    /// that pushes alone may brake beside another.
    pub(crate) fn call(
        &self,
        judged: &mut [Judged],
        all: &[Box<dyn Mechanism>],
    ) {
        let rows = rows_of(&self.fit.draws);
        for (mechanism, own) in self.columns(all) {
            let amplitudes = rows.iter().map(|row| row[own.start]);
            let amplitude = median(&amplitudes.collect::<Vec<_>>());
            let named = judged.iter_mut().find(|m| m.name == mechanism.name());
            if let Some(named) = named {
                named.noun = mechanism.noun(amplitude);
            }
        }
    }

    /// The mechanisms themselves.
    pub(crate) fn mechanisms<'a>(
        &self,
        all: &'a [Box<dyn Mechanism>],
    ) -> Vec<&'a dyn Mechanism> {
        self.which.iter().map(|&i| all[i].as_ref()).collect()
    }

    /// The mechanisms with the columns of their parameters in the draws.
    fn columns<'a>(
        &self,
        all: &'a [Box<dyn Mechanism>],
    ) -> Vec<(&'a dyn Mechanism, Range<usize>)> {
        let mut end = 0;
        let mechanisms = self.mechanisms(all).into_iter();
        mechanisms
            .map(|mechanism| {
                let begin = end;
                end += mechanism.unknowns().len();
                (mechanism, begin..end)
            })
            .collect()
    }

    /// The mechanisms with their draws.
    pub(crate) fn added<'a>(
        &self,
        all: &'a [Box<dyn Mechanism>],
    ) -> Vec<Added<'a>> {
        let rows = rows_of(&self.fit.draws);
        let is_mu = |name: &String| name == "mu" || name.ends_with(".mu");
        let mu = self.fit.draws.names().iter().position(is_mu);
        let columns = self.columns(all).into_iter();
        columns.map(|(m, own)| Added::new(m, &rows, own, mu)).collect()
    }
}
