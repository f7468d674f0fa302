//! The two-way table: every mechanism under every noise that is kept.

use super::attribute::{Attribution, attribute_beside, follow};
use super::noises::{Noises, Noisy};
use crate::diagnosis::locate::locate_all;
use crate::error::{Error, Result};
use crate::infer::Progress;
use crate::mechanism::{Extent, Mechanism};
use crate::model::Program;
use crate::seed::Seed;

/// What was found under one noise.
#[derive(Debug)]
pub(crate) struct Row<'a, P> {
    pub(crate) noisy: Noisy<'a, P>,
    pub(crate) found: Attribution,
    /// ln of the evidence with a force of free form.
    pub(crate) open: f64,
}

/// What was found under every noise that is kept.
#[derive(Debug)]
pub(crate) struct Table<'a, P> {
    /// The noises that are kept.
    pub(crate) rows: Vec<Row<'a, P>>,
    /// The named noise, where it is not kept.
    dropped: Option<Noisy<'a, P>>,
}

impl<'a, P: Program> Table<'a, P> {
    /// Weighs every mechanism and the free-form force under the likeliest
    /// noise, and from where they are likely there under the others.
    ///
    /// # Errors
    /// An improper prior, or a model that fails.
    pub(crate) fn of(
        noises: Noises<'a, P>,
        extent: &Extent,
        catalogue: &[Box<dyn Mechanism>],
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let Noises { kept, dropped } = noises;
        let mut kept = kept.into_iter();
        let lead = kept.next().ok_or_else(no_noise)?;
        let lead = Row::lead(lead, extent, catalogue, seed, progress)?;
        let mut rows = vec![lead];
        for (i, noisy) in kept.enumerate() {
            progress.begin("weighing them under other noises", None);
            let seed = seed.child(100 + i as u64);
            rows.push(Row::following(noisy, &rows[0], catalogue, seed)?);
        }
        Ok(Self { rows, dropped })
    }

    /// The model as it was, under the noise that it names.
    pub(crate) fn as_it_was(&self) -> Result<&Noisy<'a, P>> {
        let kept = self.rows.iter().map(|row| &row.noisy);
        let mut all = kept.chain(&self.dropped);
        all.find(|noisy| noisy.is_named()).ok_or_else(no_noise)
    }

    /// Whether the named noise is kept.
    pub(crate) fn keeps_named(&self) -> bool {
        self.dropped.is_none()
    }
}

fn no_noise() -> Error {
    Error::inference("no noise is kept")
}

impl<'a, P: Program> Row<'a, P> {
    fn lead(
        noisy: Noisy<'a, P>,
        extent: &Extent,
        catalogue: &[Box<dyn Mechanism>],
        seed: Seed,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let none = noisy.none.clone();
        let found = attribute_beside(
            noisy.program(),
            none,
            Some(extent),
            catalogue,
            seed,
            progress,
        )?;
        let open = found.open_log();
        Ok(Self { noisy, found, open })
    }

    /// What the force brings is that of the first row, less what it brings
    /// more there by the outlooks.
    fn following(
        noisy: Noisy<'a, P>,
        lead: &Self,
        catalogue: &[Box<dyn Mechanism>],
        seed: Seed,
    ) -> Result<Self> {
        let known = lead.found.candidates.iter().map(|fit| fit.log_evidence);
        let candidates = follow(
            (lead.noisy.program(), &lead.found),
            (noisy.program(), noisy.own()),
            catalogue,
            known.fold(noisy.none.log_evidence, f64::max),
            seed,
        )?;
        let open = lead.open + noisy.open.log - lead.noisy.open.log;
        let none = noisy.none.clone();
        let found = Attribution { none, forces: Vec::new(), candidates };
        Ok(Self { noisy, found, open })
    }

    /// Infers the free-form force, where it is not known yet.
    ///
    /// # Errors
    /// A model that fails.
    pub(crate) fn opened(&mut self, extent: &Extent, seed: Seed) -> Result<()> {
        if self.found.forces.is_empty() {
            let program = self.noisy.program();
            self.found.forces =
                locate_all(program, extent, &self.found.none, seed)?;
        }
        Ok(())
    }
}
