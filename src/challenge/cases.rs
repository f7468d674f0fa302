//! The cases of a challenge: so many of each effect.

use super::case::{Case, Mix};
use super::effects::{CATALOGUE, Kind, NONE, OUTSIDE};
use super::scenery::{Order, draw};
use crate::error::{Error, Result};
use crate::seed::Seed;

/// Cases with `count` effects of the catalogue, the same number of each if
/// `count` is a multiple of 20; half as many with nothing hidden; and a fifth
/// as many with effects that no catalogue has.
///
/// ```
/// use couloir::challenge::{Mix, cases};
/// let some = cases(2, 1, Mix::One)?;
/// assert_eq!(some.len(), 3);
/// assert_eq!(some[2].truth.effect, "none");
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// No case asked for; or no ground was found on which an effect is possible.
pub fn cases(count: usize, seed: u64, mix: Mix) -> Result<Vec<Case>> {
    if count == 0 {
        return Err(Error::input("--cases 0: expected 1 or more cases"));
    }
    let rotate = |kinds: &'static [&'static Kind], count: usize| {
        let places = 0..count;
        places.map(move |i| (kinds[i % kinds.len()], i / kinds.len()))
    };
    const NONES: &[&Kind] = &[NONE];
    let hidden = rotate(&CATALOGUE, count)
        .chain(rotate(NONES, count.div_ceil(2)))
        .chain(rotate(&OUTSIDE, count / 5));
    hidden
        .enumerate()
        .map(|(i, (kind, k))| {
            let order = Order { kind, size: None, sd: None, mix };
            let name = format!("case-{:03}", i + 1);
            draw(&order, &name, branch(seed, kind).child(k as u64))
        })
        .collect()
}

/// A kind's own branch of the seed, so that its cases do not depend on how
/// many there are of others.
pub(super) fn branch(seed: u64, kind: &Kind) -> Seed {
    Seed::new(seed).child(0xc4a1).called(kind.name)
}

#[cfg(test)]
mod tests;
