//! A sum of blocks as an event file names it.

use super::entry::{NoiseEntry, NoiseFor, NoiseKind};
use super::{Noise, Whole};
use crate::block::Field;
use crate::error::{Error, Stop};
use crate::scalar::Real;

/// Blocks that are summands, in the order written.
#[derive(Debug)]
pub(super) struct SumEntry(pub(super) Vec<Box<dyn NoiseEntry>>);

impl NoiseEntry for SumEntry {
    fn name(&self) -> String {
        let names: Vec<_> = self.0.iter().map(|part| part.name()).collect();
        names.join(" + ")
    }

    /// A name that two blocks share gets its block's before it.
    fn parameters(&self) -> Vec<(String, Field)> {
        let of = |part: &dyn NoiseEntry| {
            let mut block = String::new();
            part.blocks(&mut |name| block.push_str(name));
            let named = part.parameters().into_iter();
            named.map(move |(name, field)| (block.clone(), name, field))
        };
        let all: Vec<_> =
            self.0.iter().flat_map(|part| of(part.as_ref())).collect();
        let shared = |name: &str| {
            all.iter().filter(|(_, other, _)| other == name).count() > 1
        };
        let full = |(block, name, field): &(String, String, Field)| {
            let alone = if shared(name) { Some(block) } else { None };
            let full = alone.map(|block| format!("{block}.{name}"));
            (full.unwrap_or_else(|| name.clone()), *field)
        };
        all.iter().map(full).collect()
    }

    fn dimension(&self) -> usize {
        self.0.iter().map(|part| part.dimension()).sum()
    }

    fn blocks(&self, say: &mut dyn FnMut(&'static str)) {
        self.0.iter().for_each(|part| part.blocks(say));
    }

    fn terms(&self) -> Vec<(&'static str, Vec<Field>)> {
        self.0.iter().flat_map(|part| part.terms()).collect()
    }
}

impl<K: NoiseKind> NoiseFor<K> for SumEntry {
    fn with(
        &self,
        values: &[Real<K>],
        then: &mut dyn FnMut(&dyn Noise<K>),
    ) -> Result<(), Stop> {
        join(&self.0, values, &Whole::new(), then)
    }

    fn part(
        &self,
        _: &[Real<K>],
        _: &mut dyn FnMut(&dyn super::Part<K>),
    ) -> Result<(), Stop> {
        Err(Stop::Fail(Error::inference("a sum in a sum of noises")))
    }
}

/// Adds the parts that are left to a whole, and calls `then` with it.
fn join<K: NoiseKind>(
    parts: &[Box<dyn NoiseEntry>],
    values: &[Real<K>],
    whole: &Whole<'_, K>,
    then: &mut dyn FnMut(&dyn Noise<K>),
) -> Result<(), Stop> {
    let Some((first, rest)) = parts.split_first() else {
        then(whole);
        return Ok(());
    };
    let (own, left) = values.split_at(first.dimension().min(values.len()));
    let mut outcome = Ok(());
    K::noise(first.as_ref()).part(own, &mut |part| {
        let mut more = whole.clone();
        part.join(&mut more);
        outcome = join(rest, left, &more, then);
    })?;
    outcome
}
