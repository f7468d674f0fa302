//! The cases of a challenge: so many of each effect.

use super::case::{Case, Mix};
use super::effects::{CATALOGUE, Class, Kind, NONE, OUTSIDE};
use super::scatter::{Errors, Scatter};
use super::scenery::{Order, draw};
use crate::error::{Error, Result};
use crate::seed::Seed;

/// Cases with `count` effects of the catalogue, the same number of each if
/// `count` is a multiple of 20; half as many with nothing hidden; and a fifth
/// as many with effects that no catalogue has. With [`Errors::Real`] the
/// effects on the errors are not drawn, since every case has its errors.
///
/// ```
/// use couloir::challenge::{Errors, Mix, cases};
/// let some = cases(2, 1, Mix::One, Errors::Simple)?;
/// assert_eq!(some.len(), 3);
/// assert_eq!(some[2].truth.effect, "none");
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// No case asked for; or no ground was found on which an effect is possible.
pub fn cases(
    count: usize,
    seed: u64,
    mix: Mix,
    errors: Errors,
) -> Result<Vec<Case>> {
    if count == 0 {
        return Err(Error::input("--cases 0: expected 1 or more cases"));
    }
    let known = CATALOGUE.into_iter();
    let known = known.filter(|kind| is_drawn(kind, errors)).collect();
    // Begun elsewhere, so that all characters are about as frequent.
    let hidden = rotate(known, count, 0)
        .chain(rotate(vec![NONE], count.div_ceil(2), 2))
        .chain(rotate(OUTSIDE.to_vec(), count / 5, 1));
    hidden
        .enumerate()
        .map(|(i, (kind, k, scatter))| {
            let scatter = (errors == Errors::Real).then_some(scatter);
            let order = Order { kind, size: None, sd: None, mix, scatter };
            let name = format!("case-{:03}", i + 1);
            draw(&order, &name, branch(seed, kind).child(k as u64))
        })
        .collect()
}

/// Whether an effect is hidden among such errors.
fn is_drawn(kind: &Kind, errors: Errors) -> bool {
    errors == Errors::Simple || kind.class != Class::Errors
}

/// So many cases of some kinds in turn: the kind, which of its cases it is,
/// and its errors if they are to be real. Five characters in turn, and one
/// further with each round, so that every kind meets all of them, and a case
/// does not depend on how many there are.
fn rotate(
    kinds: Vec<&'static Kind>,
    count: usize,
    first: usize,
) -> impl Iterator<Item = (&'static Kind, usize, Scatter)> {
    let all = Scatter::REAL;
    (0..count).map(move |i| {
        let (round, place) = (i / kinds.len(), i % kinds.len());
        (kinds[place], round, all[(first + place + round) % all.len()])
    })
}

/// A kind's own branch of the seed, so that its cases do not depend on how
/// many there are of others.
pub(super) fn branch(seed: u64, kind: &Kind) -> Seed {
    Seed::new(seed).child(0xc4a1).called(kind.name)
}

#[cfg(test)]
mod tests;
