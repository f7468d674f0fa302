//! Which terms together: they are added, exchanged and dropped until none of
//! these raises the evidence by more than terms cost.
//!
//! A second term is beforehand as unlikely as the first was, and a recording
//! is told by one cause rather than by two: a set of terms is worth ln of its
//! evidence, less what its names cost beforehand and a fixed price for each
//! term after the first. To add the best to the best single term alone would
//! keep a first term that others make idle, and never meet a pair of which
//! neither part does well alone.

use std::collections::BTreeSet;
use std::f64::consts::LN_10;

use crate::diagnosis::decide::chosen::Chosen;
use crate::diagnosis::decide::odds::Beforehand;
use crate::diagnosis::evidence::attribute::Attribution;
use crate::diagnosis::evidence::carried::Move;
use crate::diagnosis::evidence::combination::{
    Combination, Known, Pursued, Sought,
};
use crate::diagnosis::evidence::noises::{NEAR, Noisy};
use crate::draws::log_sum_exp;
use crate::error::Result;
use crate::infer::Precision;
use crate::mechanism::Mechanism;
use crate::parallel;
use crate::seed::Seed;

/// In log10: by how much a further term must raise the evidence, besides what
/// it costs beforehand; and how near a rival comes.
pub(crate) const RISE: f64 = 1.0;
/// The most terms.
const MOST: usize = 3;
/// How many that promise most are fitted before the rest is held against them.
const AT_ONCE: usize = 4;

/// A search for the terms that are worth most together.
pub(crate) struct Stepwise<'a> {
    /// The model under the noise that it goes on with, without mechanisms.
    pub(crate) noisy: &'a Noisy<'a>,
    pub(crate) all: &'a [Box<dyn Mechanism>],
    /// The fit of each of them.
    pub(crate) found: &'a Attribution,
    pub(crate) beforehand: &'a Beforehand<'a>,
    /// Which of them may be terms, most probable first.
    pub(crate) candidates: Vec<usize>,
    /// The model under the other noises that are kept.
    pub(crate) elsewhere: &'a [&'a Noisy<'a>],
    pub(crate) seed: Seed,
}

/// Terms that differ from others by one.
struct Step {
    /// Which of the others are kept.
    kept: Vec<usize>,
    added: Option<usize>,
}

impl Step {
    /// The terms that it leads to, in the order that they came in.
    fn terms(&self, before: &[usize]) -> Vec<usize> {
        let kept = self.kept.iter().map(|&k| before[k]);
        kept.chain(self.added).collect()
    }
}

/// Terms with their fit, and what a thorough search found of them, for a
/// sharper one.
struct Tried<'a> {
    chosen: Chosen,
    found: Option<Pursued<'a>>,
}

/// Terms on the way to their fit.
struct Priced<T> {
    which: Vec<usize>,
    /// What they cost, in ln.
    price: f64,
    terms: T,
}

/// Before any look at them, and after a quick one.
type Untried<'a> = Priced<Sought<'a>>;
type Look<'a> = Priced<Combination<'a>>;

impl Look<'_> {
    /// About what they are worth.
    fn promise(&self) -> f64 {
        self.terms.log() - self.price
    }

    /// The most that they may be worth.
    fn most(&self) -> f64 {
        self.terms.most() - self.price
    }
}

impl<'a> Stepwise<'a> {
    /// The terms that are worth most, from a first one on.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn from(&self, first: usize) -> Result<Chosen> {
        let mut best = Tried { chosen: self.single(first), found: None };
        let near = self.worth_of(&best.chosen) - RISE * LN_10;
        let mut tried = BTreeSet::new();
        let mut others: Vec<Tried<'_>> = Vec::new();
        loop {
            let chosen = &best.chosen;
            let untried = self.untried(chosen, &mut tried)?;
            others.extend(self.fits(untried, chosen)?);
            if self.better(&others, chosen).is_none() {
                others.extend(self.overlooked(near, chosen, &mut tried)?);
            }
            let Some(next) = self.better(&others, chosen) else { break };
            let next = others.swap_remove(next);
            others.push(std::mem::replace(&mut best, next));
        }
        self.count_noises(&mut best, &mut others)?;
        let Tried { mut chosen, found } = best;
        if let Some(found) = found {
            chosen.fit = found.fit(Precision::Sharp)?;
        }
        chosen.rivals = self.rivals(&chosen, others);
        Ok(chosen)
    }

    /// A term alone.
    fn single(&self, term: usize) -> Chosen {
        Chosen::new(vec![term], self.found.candidates[term].clone())
    }

    /// The fits of pairs that are not met from the first term, each with a
    /// term that alone is worth as much as `near`: which of these comes first
    /// must not decide what comes out. Only of those that may be worth more
    /// than the best, by what their best known places say.
    fn overlooked(
        &self,
        near: f64,
        best: &Chosen,
        tried: &mut BTreeSet<Vec<usize>>,
    ) -> Result<Vec<Tried<'a>>> {
        let worth = self.worth_of(best);
        let mut found = Vec::new();
        for &term in &self.candidates {
            let log = self.found.candidates[term].log_evidence;
            if log - self.price(&[term]) < near {
                continue;
            }
            let pairs = self.untried(&self.single(term), tried)?;
            let most = parallel::try_map(&pairs, |pair| {
                Ok(pair.terms.most()? - pair.price)
            })?;
            let pairs = pairs.into_iter().zip(most);
            let pairs = pairs.filter(|(_, most)| *most > worth);
            let pairs = pairs.map(|(pair, _)| pair).collect();
            found.extend(self.fits(pairs, best)?);
        }
        Ok(found)
    }

    /// All that differs from some terms by one and was not tried before.
    fn untried(
        &self,
        terms: &Chosen,
        tried: &mut BTreeSet<Vec<usize>>,
    ) -> Result<Vec<Untried<'a>>> {
        let mut steps = self.steps(terms);
        steps.retain(|step| tried.insert(sorted(step.terms(&terms.which))));
        parallel::try_map(&steps, |step| self.sought(terms, step))
    }

    /// All sets that differ from the chosen by one term.
    fn steps(&self, chosen: &Chosen) -> Vec<Step> {
        let names: Vec<&str> = self.all.iter().map(|m| m.name()).collect();
        steps(&chosen.which, &self.candidates, &names)
    }

    /// The fits of terms, where these may be worth more than the best and than
    /// each other, or nearly so: all are looked at, those that promise most are
    /// fitted first.
    fn fits(
        &self,
        untried: Vec<Untried<'a>>,
        best: &Chosen,
    ) -> Result<Vec<Tried<'a>>> {
        let mut left = parallel::try_map(untried, look)?;
        left.sort_by(|a, b| b.promise().total_cmp(&a.promise()));
        let mut least = self.worth_of(best);
        let near = RISE * LN_10;
        let mut found: Vec<Tried<'a>> = Vec::new();
        loop {
            let terms = best.which.len();
            left.retain(|look| {
                let alike = look.which.len() == terms;
                look.most() > if alike { least - near } else { least }
            });
            if left.is_empty() {
                return Ok(found);
            }
            let rest = left.split_off(left.len().min(AT_ONCE));
            let hurdle = least - near;
            let fits = parallel::try_map(left, |l| self.tried(l, hurdle))?;
            for one in fits.into_iter().flatten() {
                least = least.max(self.worth_of(&one.chosen));
                found.push(one);
            }
            left = rest;
        }
    }

    /// The fit of terms that may be worth so much; `None` as well where they
    /// leave the law no friction. Friction drives nothing, so beyond its end
    /// all amounts do the same, and what has that much room in its prior seems
    /// likely: but it puts another law in the place of the one that is asked
    /// about.
    fn tried(&self, look: Look<'a>, hurdle: f64) -> Result<Option<Tried<'a>>> {
        let Priced { which, price, terms } = look;
        let Some(found) = terms.pursued(hurdle + price)? else {
            return Ok(None);
        };
        let fit = found.fit(Precision::Fair)?;
        let chosen = Chosen::new(which, fit);
        let tried = Tried { chosen, found: Some(found) };
        Ok(Some(tried).filter(|one| one.chosen.leaves_friction(self.all)))
    }

    /// What a step leads to, with where it is to be looked for.
    fn sought(&self, chosen: &Chosen, step: &Step) -> Result<Untried<'a>> {
        let which = step.terms(&chosen.which);
        let number = which.iter().fold(0, |n, &i| n * 1000 + i as u64 + 1);
        let seed = self.seed.child(1000 + number);
        let terms = match &which[..] {
            &[a, b] => self.pair([a, b], seed)?,
            _ => self.extended(chosen, step, &which, seed)?,
        };
        Ok(Priced { price: self.price(&which), which, terms })
    }

    fn pair(&self, which: [usize; 2], seed: Seed) -> Result<Sought<'a>> {
        let mechanisms = which.map(|i| self.all[i].as_ref());
        let fits = which.map(|i| &self.found.candidates[i]);
        let open = Some(&self.noisy.open.own[..]);
        Sought::pair(self.noisy.program(), mechanisms, fits, open, seed)
    }

    /// One term more beside some of the chosen.
    fn extended(
        &self,
        chosen: &Chosen,
        step: &Step,
        which: &[usize],
        seed: Seed,
    ) -> Result<Sought<'a>> {
        let columns = chosen.columns(self.all);
        let kept: Vec<_> =
            step.kept.iter().map(|&k| columns[k].clone()).collect();
        let place = chosen.fit.mechanism();
        let parameters: Vec<f64> = kept
            .iter()
            .flat_map(|(_, own)| &place[own.clone()])
            .copied()
            .collect();
        let mechanisms: Vec<_> = kept.iter().map(|(m, _)| *m).collect();
        let known = Known {
            mechanisms: &mechanisms,
            added: &parameters,
            own: chosen.fit.own(),
            open: &self.noisy.open.own,
        };
        let added = which[which.len() - 1];
        let added = (self.all[added].as_ref(), &self.found.candidates[added]);
        Sought::extended(self.noisy.program(), &known, added, seed)
    }

    /// Exchanges the best for what is worth more where all noises that are
    /// kept count: what is far below the best under one noise is far below it
    /// under any that is kept.
    fn count_noises(
        &self,
        best: &mut Tried<'a>,
        others: &mut [Tried<'a>],
    ) -> Result<()> {
        let least = self.worth_of(&best.chosen) - NEAR * LN_10;
        let near =
            |other: &&mut Tried<'a>| self.worth_of(&other.chosen) > least;
        let near = others.iter_mut().filter(near);
        let mut near: Vec<&mut Tried<'a>> = near.collect();
        if near.is_empty() || self.elsewhere.is_empty() {
            return Ok(());
        }
        near.push(best);
        parallel::try_map(near, |one| {
            one.chosen.gain = self.gain(&one.chosen)?;
            Ok(())
        })?;
        if let Some(next) = self.better(others, &best.chosen) {
            std::mem::swap(best, &mut others[next]);
        }
        Ok(())
    }

    /// By how much more, in ln, the evidence of terms is, summed over noises.
    fn gain(&self, chosen: &Chosen) -> Result<f64> {
        let mechanisms = chosen.mechanisms(self.all);
        let from = (self.noisy.program(), &chosen.fit);
        let mut gains = vec![0.0];
        for noisy in self.elsewhere {
            let to = (noisy.program(), noisy.own());
            let there = Move { from, to, mechanisms: &mechanisms };
            let odds = noisy.beforehand() - self.noisy.beforehand();
            gains.push(there.gain(self.seed.child(1))? + odds);
        }
        Ok(log_sum_exp(gains.into_iter()))
    }

    /// Which of others is worth most, where that is more than what was chosen
    /// is worth by more than their errors.
    fn better(&self, others: &[Tried<'_>], chosen: &Chosen) -> Option<usize> {
        let worth = |i: usize| self.worth_of(&others[i].chosen);
        let most = |a: &usize, b: &usize| worth(*a).total_cmp(&worth(*b));
        let best = (0..others.len()).max_by(most)?;
        let error = others[best].chosen.fit.se.hypot(chosen.fit.se);
        (worth(best) > self.worth_of(chosen) + error).then_some(best)
    }

    /// Those of as many terms that are worth nearly as much, most first.
    fn rivals(
        &self,
        chosen: &Chosen,
        others: Vec<Tried<'_>>,
    ) -> Vec<(Vec<usize>, f64)> {
        let others = others.into_iter().map(|other| other.chosen);
        let mut others: Vec<Chosen> = others.collect();
        let worth = |c: &Chosen| self.worth_of(c);
        let near = worth(chosen) - RISE * LN_10;
        others.retain(|other| {
            other.which.len() == chosen.which.len() && worth(other) > near
        });
        others.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
        let rivals = others.into_iter().filter(|c| c.which.len() > 1);
        rivals.map(|c| (c.which, c.fit.log_evidence)).collect()
    }

    /// ln of the evidence of terms, less what these cost.
    fn worth_of(&self, chosen: &Chosen) -> f64 {
        let Chosen { which, fit, gain, .. } = chosen;
        fit.log_evidence + gain - self.price(which)
    }

    /// What terms cost, in ln: how much less likely beforehand they are than
    /// none of them, and the rise that each after the first has to bring.
    fn price(&self, which: &[usize]) -> f64 {
        let names = which.iter().map(|&i| self.all[i].name());
        let unlikely: f64 = names.map(|n| self.beforehand.price(n)).sum();
        unlikely + RISE * LN_10 * (which.len() as f64 - 1.0)
    }
}

fn look(untried: Untried<'_>) -> Result<Look<'_>> {
    let Priced { which, price, terms } = untried;
    Ok(Priced { which, price, terms: terms.looked()? })
}

/// All sets that differ from some terms by one, no name twice in any.
fn steps(which: &[usize], candidates: &[usize], names: &[&str]) -> Vec<Step> {
    let terms = which.len();
    let all: Vec<usize> = (0..terms).collect();
    let without = |k: usize| -> Vec<usize> {
        all.iter().copied().filter(|&i| i != k).collect()
    };
    let mut steps: Vec<Step> = Vec::new();
    for &added in candidates {
        let is_new = |k: &usize| names[which[*k]] != names[added];
        let mut all_kept = Vec::new();
        if terms < MOST {
            all_kept.push(all.clone());
        }
        if terms > 1 {
            all_kept.extend((0..terms).map(without));
        }
        all_kept.retain(|kept| kept.iter().all(is_new));
        let step = |kept| Step { kept, added: Some(added) };
        steps.extend(all_kept.into_iter().map(step));
    }
    if terms > 2 {
        let dropped = (0..terms).map(without);
        steps.extend(dropped.map(|kept| Step { kept, added: None }));
    }
    steps
}

fn sorted(mut terms: Vec<usize>) -> Vec<usize> {
    terms.sort_unstable();
    terms
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_added_exchanged_and_dropped() {
        let names = ["patch", "surge", "surge", "drag", "clock"];
        // The best variant of each name.
        let candidates = [0, 2, 3, 4];
        let from = |which: &[usize]| -> BTreeSet<Vec<usize>> {
            let all = steps(which, &candidates, &names).into_iter();
            all.map(|step| sorted(step.terms(which))).collect()
        };
        let sets = |all: &[&[usize]]| -> BTreeSet<Vec<usize>> {
            all.iter().map(|set| set.to_vec()).collect()
        };
        assert_eq!(from(&[0]), sets(&[&[0, 2], &[0, 3], &[0, 4]]));
        // The other variant of a name is its rival, not its company; and a
        // term exchanged for itself is what there was.
        let two = sets(&[
            &[0, 2, 3],
            &[0, 2, 4],
            &[0, 2],
            &[0, 3],
            &[0, 4],
            &[2, 3],
            &[2, 4],
        ]);
        assert_eq!(from(&[0, 2]), two);
        let three = from(&[0, 2, 3]);
        for dropped in [[0, 2], [0, 3], [2, 3]] {
            assert!(three.contains(&dropped[..]), "{dropped:?}");
        }
        assert!(three.contains(&[2, 3, 4][..]), "the first is exchanged");
        assert!(three.iter().all(|set| set.len() <= MOST));
    }
}
