//! What a model keeps beside its parameters, at every draw.

use crate::draws::Draws;
use crate::error::{Error, Result};
use crate::model::{Label, Listener, Point, Posterior};
use crate::parallel;
use crate::scalar::Plain;
use crate::seed::{Rng, Seed};

/// The quantities that the model keeps (`keep` in `model!`), at each of the
/// draws of its parameters and in the same order; `None` where it keeps none.
///
/// # Errors
/// A model that fails, or that keeps other quantities at other draws; two
/// quantities of one name.
pub fn kept(
    posterior: &Posterior<'_>,
    draws: &Draws,
    seed: Seed,
) -> Result<Option<Draws>> {
    let names = names(posterior, draws, seed)?;
    if names.is_empty() {
        return Ok(None);
    }
    check(posterior, &names)?;
    let units = vec!["1".to_owned(); names.len()];
    let mut found = Draws::new(names, units)?;
    for chain in 0..draws.chains() {
        let seed = seed.child(chain as u64);
        let rows = parallel::try_map(0..draws.iterations(), |i| {
            let row = draws.row(chain, i);
            let one = heard(posterior, row, seed.child(i as u64))?;
            one.values_of(found.names())
        })?;
        let acceptance = draws.acceptance().get(chain).copied();
        found.push_chain(rows.concat(), acceptance)?;
    }
    Ok(Some(found))
}

/// At how many draws a model is asked what it keeps.
const ASKED: usize = 32;

/// What the model keeps, by the first of some draws that it does not reject and
/// where it keeps anything.
fn names(
    posterior: &Posterior<'_>,
    draws: &Draws,
    seed: Seed,
) -> Result<Vec<String>> {
    for row in draws.thinned(ASKED) {
        let one = heard(posterior, row, seed)?;
        if !one.names.is_empty() && !one.rejected {
            return Ok(one.names);
        }
    }
    Ok(Vec::new())
}

fn check(posterior: &Posterior<'_>, names: &[String]) -> Result<()> {
    let mut seen: std::collections::HashSet<&str> =
        posterior.parameters().iter().map(|p| &p.name[..]).collect();
    match names.iter().find(|name| !seen.insert(name)) {
        None => Ok(()),
        Some(name) => Err(Error::input(format!(
            "two quantities are called {name}; give what is kept a name that \
             no parameter and nothing else that is kept has"
        ))),
    }
}

fn heard(posterior: &Posterior<'_>, row: &[f64], seed: Seed) -> Result<Kept> {
    let mut kept = Kept::new(seed);
    let density = posterior.hear(Point::Natural(row), &mut kept)?;
    kept.rejected = density.rejected.is_some();
    Ok(kept)
}

/// Collects what is kept.
struct Kept {
    names: Vec<String>,
    values: Vec<f64>,
    /// Whether the model rejects the draw.
    rejected: bool,
    rng: Rng,
}

impl Kept {
    fn new(seed: Seed) -> Self {
        let (names, values) = (Vec::new(), Vec::new());
        Self { names, values, rejected: false, rng: seed.rng() }
    }

    /// Its values, which have to be those of the same names; NaN for a draw
    /// that the model rejects, as round-off at a border may let it.
    fn values_of(self, names: &[String]) -> Result<Vec<f64>> {
        if self.rejected {
            return Ok(vec![f64::NAN; names.len()]);
        }
        match self.names == names {
            true => Ok(self.values),
            false => Err(Error::input(
                "the model keeps other quantities at one draw than at \
                 another; expected the same at all of them: let their number \
                 and names depend on the data alone",
            )),
        }
    }
}

impl Listener<Plain> for Kept {
    fn kept(&mut self, label: &Label<'_>, value: f64) {
        self.names.push(label.name());
        self.values.push(value);
    }

    fn chance(&mut self) -> Option<&mut Rng> {
        Some(&mut self.rng)
    }
}
