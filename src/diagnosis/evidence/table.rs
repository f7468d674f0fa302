//! The two-way table: every mechanism under every noise that is kept.

use std::f64::consts::LN_10;

use super::attribute::{Attribution, Care, Known, attribute_beside};
use super::carried::Move;
use super::noises::{NEAR, Noises, Noisy};
use crate::error::{Error, Result};
use crate::infer::Progress;
use crate::mechanism::{Extent, Mechanism};
use crate::model::{AnyProgram, Program};
use crate::parallel;
use crate::seed::Seed;

/// How far below the best, in ln, what another noise promises of a mechanism is
/// estimated: as far as names are told of together, a tenth, and by as much as
/// what is promised may be off, 2.
const CLOSE: f64 = 4.3;

/// What the evidence says under one noise.
#[derive(Debug)]
pub(crate) struct Row<'a> {
    pub(crate) noisy: Noisy<'a>,
    /// ln of the evidence with each mechanism of the catalogue.
    pub(crate) candidates: Vec<f64>,
    /// The same with a force of free form.
    pub(crate) open: f64,
    /// All fits, where they were made under this noise.
    pub(crate) found: Option<Attribution>,
}

/// What the evidence says under every noise that is kept.
#[derive(Debug)]
pub(crate) struct Table<'a> {
    /// The noises that are kept; the first has all fits.
    pub(crate) rows: Vec<Row<'a>>,
    /// The named noise, where it is not kept.
    dropped: Option<Noisy<'a>>,
}

impl<'a> Table<'a> {
    /// Weighs every mechanism and the free-form force under the likeliest
    /// noise, and what they promise from there under the others, with those
    /// that do now that mechanisms are known.
    ///
    /// # Errors
    /// An improper prior, or a model that fails.
    pub(crate) fn of(
        noises: Noises<'a>,
        extent: &Extent,
        catalogue: &[Box<dyn Mechanism>],
        care: Care,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let Noises { kept, dropped, simpler } = noises;
        let mut kept = kept.into_iter();
        let first = Row::bare(kept.next().ok_or_else(no_noise)?);
        let mut table = Self { rows: vec![first], dropped: None };
        table.fill(0, extent, catalogue, care, seed, progress)?;
        progress.begin("weighing them under other noises", None);
        let mut others: Vec<Noisy<'a>> = kept.collect();
        let first = &table.rows[0];
        let does = |program: &dyn AnyProgram, own: [&[f64]; 2]| {
            first.does_under(program, own, catalogue, seed.child(99))
        };
        let again =
            parallel::try_map(&simpler, |one| does(&*one.program, one.own()))?;
        for (one, does) in simpler.into_iter().zip(again) {
            if does {
                others.push(one.fitted(seed)?);
            }
        }
        match dropped {
            Some(one) if does(one.program(), one.own())? => others.push(one),
            dropped => table.dropped = dropped,
        }
        for (i, noisy) in others.into_iter().enumerate() {
            let seed = seed.child(100 + i as u64);
            let first = &table.rows[0];
            let row = Row::beside(noisy, first, catalogue, seed)?;
            table.rows.push(row);
        }
        Ok(table)
    }

    /// The model as it was, under the noise that it names.
    pub(crate) fn as_it_was(&self) -> Result<&Noisy<'a>> {
        let kept = self.rows.iter().map(|row| &row.noisy);
        let mut all = kept.chain(&self.dropped);
        all.find(|noisy| noisy.is_named()).ok_or_else(no_noise)
    }

    /// Which row is the named noise's, where it is kept.
    pub(crate) fn named(&self) -> Option<usize> {
        self.rows.iter().position(|row| row.noisy.is_named())
    }

    /// The model under the noises of all other rows.
    pub(crate) fn beside(&self, row: usize) -> Vec<&Noisy<'a>> {
        let rows = self.rows.iter().enumerate();
        let others = rows.filter(|(i, _)| *i != row);
        others.map(|(_, other)| &other.noisy).collect()
    }

    /// Makes all fits under the noise of a row, where there are none yet. A
    /// search begins where other rows found each mechanism too: one noise may
    /// swallow what another leaves to be explained.
    ///
    /// # Errors
    /// An improper prior, or a model that fails.
    pub(crate) fn fill(
        &mut self,
        row: usize,
        extent: &Extent,
        catalogue: &[Box<dyn Mechanism>],
        care: Care,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<()> {
        let Some(known) = self.known(row, catalogue)? else { return Ok(()) };
        let known = Known { places: &known, care };
        self.rows[row].fill(extent, catalogue, known, seed, progress)
    }

    /// Where other rows found each mechanism, as places of a row without fits.
    fn known(
        &self,
        row: usize,
        catalogue: &[Box<dyn Mechanism>],
    ) -> Result<Option<Vec<Vec<Vec<f64>>>>> {
        let to = &self.rows[row];
        if to.found.is_some() {
            return Ok(None);
        }
        let mut known = vec![Vec::new(); catalogue.len()];
        for from in &self.rows {
            let Some(found) = &from.found else { continue };
            let each = catalogue.iter().zip(&found.candidates);
            for (known, (mechanism, fit)) in known.iter_mut().zip(each) {
                let moved = Move {
                    from: (from.noisy.program(), fit),
                    to: (to.noisy.program(), to.noisy.own()),
                    mechanisms: &[mechanism.as_ref()],
                };
                known.extend(moved.likeliest()?);
            }
        }
        Ok(Some(known))
    }

    /// Whether the named noise is kept.
    pub(crate) fn keeps_named(&self) -> bool {
        self.dropped.is_none()
    }
}

fn no_noise() -> Error {
    Error::inference("no noise is kept")
}

impl<'a> Row<'a> {
    /// Without mechanisms yet.
    fn bare(noisy: Noisy<'a>) -> Self {
        let open = noisy.open.log;
        Self { noisy, candidates: Vec::new(), open, found: None }
    }

    /// Makes all fits.
    fn fill(
        &mut self,
        extent: &Extent,
        catalogue: &[Box<dyn Mechanism>],
        known: Known<'_>,
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<()> {
        let found = attribute_beside(
            self.noisy.program(),
            self.noisy.none.clone(),
            Some(extent),
            catalogue,
            known,
            seed,
            progress,
        )?;
        let logs = found.candidates.iter().map(|fit| fit.log_evidence);
        self.candidates = logs.collect();
        self.open = found.open_log();
        self.found = Some(found);
        Ok(())
    }

    /// With the evidences of another row, each more by as much as the normal
    /// approximations about the likeliest draws there promise more; those that
    /// may matter beside the best are estimated from there. Not of several
    /// events, where an estimate costs as much as a fit.
    fn beside(
        noisy: Noisy<'a>,
        first: &Self,
        catalogue: &[Box<dyn Mechanism>],
        seed: Seed,
    ) -> Result<Self> {
        let found = first.found()?;
        let alone: Vec<[&dyn Mechanism; 1]> =
            catalogue.iter().map(|mechanism| [mechanism.as_ref()]).collect();
        let of = |at: usize| Move {
            from: (first.noisy.program(), &found.candidates[at]),
            to: (noisy.program(), noisy.own()),
            mechanisms: &alone[at],
        };
        let promised = parallel::try_map(0..catalogue.len(), |at| {
            Ok(first.candidates[at] + of(at).gain(seed)?)
        })?;
        let known = [first.highest(), noisy.none.log_evidence];
        let best = promised.iter().copied().chain(known);
        let least = match noisy.program().events() {
            1 => best.fold(f64::NEG_INFINITY, f64::max) - CLOSE,
            _ => f64::INFINITY,
        };
        let each = promised.into_iter().enumerate();
        let candidates = parallel::try_map(each, |(at, promised)| {
            match promised > least {
                true => of(at).estimated(seed.child(1 + at as u64)),
                false => Ok(promised),
            }
        })?;
        let open = first.open + noisy.open.log - first.noisy.open.log;
        Ok(Self { noisy, candidates, open, found: None })
    }

    /// Whether the likeliest mechanism is about as likely under another noise
    /// as anything is here.
    fn does_under(
        &self,
        program: &dyn AnyProgram,
        own: [&[f64]; 2],
        catalogue: &[Box<dyn Mechanism>],
        seed: Seed,
    ) -> Result<bool> {
        let found = self.found()?;
        let logs = self.candidates.iter().enumerate();
        let best = logs.max_by(|(_, a), (_, b)| a.total_cmp(b));
        let Some((at, log)) = best else { return Ok(false) };
        let from = (self.noisy.program(), &found.candidates[at]);
        let mechanisms = &[catalogue[at].as_ref()][..];
        let there = Move { from, to: (program, own), mechanisms };
        let gain = there.gain(seed)?;
        Ok(log + gain > self.highest() - NEAR * LN_10)
    }

    /// The most evidence of any, in ln, and of the model alone.
    fn highest(&self) -> f64 {
        let none = self.noisy.none.log_evidence;
        self.candidates.iter().copied().fold(none, f64::max)
    }

    /// All fits.
    ///
    /// # Errors
    /// None were made under this noise.
    pub(crate) fn found(&self) -> Result<&Attribution> {
        let missing = || Error::inference("a noise without fits");
        self.found.as_ref().ok_or_else(missing)
    }
}
