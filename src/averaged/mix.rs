//! Draws of several posteriors, as many of each as it is probable.

use crate::draws::Draws;
use crate::error::{Error, Result};

/// Draws of the parameters of these names, of several posteriors with
/// probabilities that add up to 1.
///
/// All are spread evenly over the whole, so that a part of it is as good as
/// any other.
///
/// # Errors
/// A posterior without one of the parameters, or without draws.
pub(super) fn mixed(
    parts: &[(f64, &Draws)],
    names: &[String],
) -> Result<Draws> {
    let enough = |(share, draws): &(f64, &Draws)| draws.total() as f64 / share;
    let total = parts.iter().map(enough).fold(f64::INFINITY, f64::min);
    let mut rows: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut units = Vec::new();
    for (share, draws) in parts {
        let columns = columns(draws, names)?;
        units = columns.iter().map(|&i| draws.units()[i].clone()).collect();
        let count = (share * total).round() as usize;
        for (j, row) in draws.thinned(count).into_iter().enumerate() {
            let place = (j as f64 + 0.5) / count as f64;
            rows.push((place, columns.iter().map(|&i| row[i]).collect()));
        }
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut mixture = Draws::new(names.to_vec(), units)?;
    let rows: Vec<f64> = rows.into_iter().flat_map(|(_, row)| row).collect();
    mixture.push_chain(rows, None)?;
    Ok(mixture)
}

fn columns(draws: &Draws, names: &[String]) -> Result<Vec<usize>> {
    let place = |name: &String| {
        let place = draws.names().iter().position(|own| own == name);
        place.ok_or_else(|| Error::inference(format!("no draws of {name}")))
    };
    names.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draws(names: &[&str], rows: &[[f64; 2]]) -> Draws {
        let names: Vec<String> = names.iter().map(|n| (*n).into()).collect();
        let mut draws = Draws::new(names, vec!["1".into(); 2]).unwrap();
        draws.push_chain(rows.concat(), None).unwrap();
        draws
    }

    #[test]
    fn each_has_its_share_in_every_part_of_the_whole() {
        let one = draws(&["mu", "phi"], &[[1.0, 9.0]; 300]);
        let other = draws(&["sigma2", "mu"], &[[9.0, 2.0]; 200]);
        let parts = [(0.75, &one), (0.25, &other)];
        let both = mixed(&parts, &["mu".to_owned()]).unwrap();
        // 300/0.75 draws are what the first has enough of.
        assert_eq!(both.total(), 400);
        let mu = both.pooled(0);
        for part in mu.chunks(40) {
            let twos = part.iter().filter(|x| **x == 2.0).count();
            assert!((9..=11).contains(&twos), "{twos}");
        }
        assert!(mixed(&parts, &["phi".to_owned()]).is_err());
    }
}
