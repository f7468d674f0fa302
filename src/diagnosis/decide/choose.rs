//! What is added to the model: one mechanism, a pair, or three.

use std::f64::consts::LN_10;

use crate::diagnosis::decide::chosen::Chosen;
use crate::diagnosis::decide::judge::verdict_of_family;
use crate::diagnosis::decide::odds::Beforehand;
use crate::diagnosis::decide::stepwise::{RISE, Stepwise};
use crate::diagnosis::evidence::attribute::Attribution;
use crate::diagnosis::evidence::noises::Noisy;
use crate::diagnosis::findings::{Judged, Verdict};
use crate::diagnosis::hypothesis::UNKNOWN;
use crate::error::Result;
use crate::mechanism::Mechanism;
use crate::seed::Seed;

/// What there is to choose from.
pub(crate) struct Choice<'a> {
    /// The model under the noise that it goes on with.
    pub(crate) noisy: &'a Noisy<'a>,
    pub(crate) all: &'a [Box<dyn Mechanism>],
    /// The fit of each of them, under one noise.
    pub(crate) found: &'a Attribution,
    /// ln of the evidence with a force of free form, under the same noise.
    pub(crate) open: f64,
    /// Their names, most probable first: under that noise, and whatever the
    /// noise.
    pub(crate) own: &'a [Judged],
    pub(crate) judged: &'a [Judged],
    pub(crate) beforehand: Beforehand<'a>,
    /// The model under the other noises that are kept.
    pub(crate) elsewhere: Vec<&'a Noisy<'a>>,
    /// Whether one mechanism has to do.
    pub(crate) singly: bool,
    pub(crate) seed: Seed,
}

/// The verdict, once combinations are weighed too.
pub(crate) struct Explained {
    pub(crate) verdict: Verdict,
    /// What is added to the model.
    pub(crate) chosen: Option<Chosen>,
    /// Several terms that do nearly as well as a force of free form that is
    /// more probable.
    pub(crate) equal: Option<Chosen>,
}

impl Choice<'_> {
    /// The model to go on with: the best mechanism where there is one, or a
    /// pair or three where the evidence rises.
    pub(crate) fn choose(&self, verdict: Verdict) -> Result<Option<Chosen>> {
        if verdict == Verdict::Adequate {
            return Ok(None);
        }
        let candidates = self.best_variants();
        let Some(first) = self.first(&candidates, verdict) else {
            return Ok(None);
        };
        if self.singly {
            let fit = self.found.candidates[first].clone();
            return Ok(Some(Chosen::new(vec![first], fit)));
        }
        let stepwise = Stepwise {
            noisy: self.noisy,
            all: self.all,
            found: self.found,
            beforehand: &self.beforehand,
            candidates,
            elsewhere: &self.elsewhere,
            seed: self.seed,
        };
        stepwise.from(first).map(Some)
    }

    /// The verdict once combinations are weighed too.
    ///
    /// What was chosen goes: physics where one of two or three mechanisms is of
    /// the physics, though the best single one may be of the sensor.
    /// Where the free-form force is more probable than any single mechanism,
    /// it must bring more than several together by what any further term has
    /// to bring.
    pub(crate) fn explained(
        &self,
        verdict: Verdict,
        chosen: Option<Chosen>,
    ) -> Explained {
        let open = verdict == Verdict::Unexplained;
        let Some(chosen) = chosen else {
            return Explained { verdict, chosen: None, equal: None };
        };
        let single = chosen.which.len() == 1;
        let log = chosen.fit.log_evidence;
        let further = RISE * LN_10 + self.beforehand.price(UNKNOWN);
        let short = if single { 0.0 } else { further };
        if open && log + short <= self.open {
            // Worth a name where only its terms' price is in the way.
            let near = !single && log + RISE * LN_10 > self.open - further;
            let equal = near.then_some(chosen);
            return Explained { verdict, chosen: None, equal };
        }
        let family = chosen.family(self.all);
        let verdict = family.map_or(verdict, verdict_of_family);
        Explained { verdict, chosen: Some(chosen), equal: None }
    }

    /// The best variant of each name, most probable first.
    fn best_variants(&self) -> Vec<usize> {
        let all = self.all;
        let evidence = |i: &usize| self.found.candidates[*i].log_evidence;
        let variants = |m: &Judged| {
            (0..all.len())
                .filter(|&i| all[i].name() == m.name)
                .max_by(|a, b| evidence(a).total_cmp(&evidence(b)))
        };
        self.own.iter().filter_map(variants).collect()
    }

    /// Of those that do nearly as well as the best under this noise the most
    /// probable whatever the noise, so that what is selected is what is told;
    /// those of the verdict's kind come before all others.
    fn first(&self, candidates: &[usize], verdict: Verdict) -> Option<usize> {
        let log = |i: usize| self.found.candidates[i].log_evidence;
        let best = *candidates.first()?;
        let near = |i: &usize| log(best) - log(*i) < RISE * LN_10;
        let rank = |i: &usize| {
            let mechanism = self.all[*i].as_ref();
            let agrees = verdict_of_family(mechanism.family()) == verdict;
            let name = mechanism.name();
            (!agrees, self.judged.iter().position(|m| m.name == name))
        };
        candidates.iter().copied().filter(near).min_by_key(rank)
    }
}
