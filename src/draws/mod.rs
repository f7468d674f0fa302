//! Draws from a posterior, and what can be said of them without the model.
//!
//! [`Draws`] holds the chains of a sampler. Beside it stand the diagnostics
//! that read nothing but numbers: convergence ([`rhat()`], [`ess_bulk`],
//! [`between_chains`]), Monte Carlo error ([`mcse_mean`]), marginal summaries
//! and densities ([`summarise`], [`density`]), tests of residuals
//! ([`ljung_box`], [`shapiro_wilk`]) and predictive comparison ([`loo()`],
//! [`leave_future_out`]).
//!
//! A figure that does not exist (of an empty, constant or non-finite sample)
//! is NaN or `None`, never a panic.
//!
//! ```
//! use couloir::draws::{Draws, summarise};
//! let mut draws = Draws::new(
//!     vec!["mu".into(), "xi".into()],
//!     vec!["1".into(), "m s^-2".into()],
//! )?;
//! draws.push_chain(vec![0.2, 1500.0, 0.3, 1600.0], Some(0.4))?;
//! assert_eq!(draws.row(0, 1), [0.3, 1600.0]);
//! assert_eq!(summarise(&draws)[1].mean, 1550.0);
//! # Ok::<(), couloir::Error>(())
//! ```

use std::fmt::Write;

use nalgebra::DMatrix;

use crate::error::{Error, Result};

mod array;
mod ess;
mod kde;
mod kolmogorov;
mod lfo;
mod loo;
mod quantile;
mod residual;
mod rhat;
mod spectrum;
mod summary;

pub use array::Array;
pub use ess::{
    ess_bulk, ess_mean, ess_quantile, ess_tail, mcse_mean, mcse_quantile,
    relative_efficiency,
};
pub use kde::{Density, Support, bandwidth, density};
pub use kolmogorov::{
    ChainComparison, KolmogorovSmirnov, between_chains, two_sample,
};
pub use lfo::{Lfo, leave_future_out};
pub use loo::{
    Loo, k_threshold, loo, loo_of_chains, psis, psis_of_chains, sum_and_error,
};
pub(crate) use loo::{log_sum_exp, shares};
pub(crate) use quantile::median;
pub use quantile::quantile;
pub use residual::{
    LjungBox, ShapiroWilk, autocorrelation, ljung_box, normal_p, shapiro_wilk,
    uncorrelated_p,
};
pub use rhat::rhat;
pub use summary::{Summary, summarise};

/// The chains of a sampler, all of one length and one dimension.
///
/// Chains, iterations and parameters are counted from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Draws {
    names: Vec<String>,
    units: Vec<String>,
    chains: Vec<Vec<f64>>,
    acceptance: Vec<f64>,
}

impl Draws {
    /// No draws yet of the parameters `names`, measured in `units`.
    ///
    /// # Errors
    ///
    /// Without a parameter, or with another number of units than of names.
    pub fn new(names: Vec<String>, units: Vec<String>) -> Result<Self> {
        if names.is_empty() {
            return Err(Error::inference("draws of no parameter"));
        }
        if names.len() != units.len() {
            return Err(Error::inference(format!(
                "{} parameters have {} units; each takes one",
                names.len(),
                units.len()
            )));
        }
        Ok(Self { names, units, chains: vec![], acceptance: vec![] })
    }

    /// Adds a chain: `rows` is row-major, iterations x dimension.
    ///
    /// An `acceptance` rate that the sampler does not have is kept as NaN.
    ///
    /// # Errors
    ///
    /// When the chain is empty, holds a broken row, or is not as long as
    /// those before it.
    pub fn push_chain(
        &mut self,
        rows: Vec<f64>,
        acceptance: Option<f64>,
    ) -> Result<()> {
        let dimension = self.dimension();
        if rows.is_empty() || !rows.len().is_multiple_of(dimension) {
            return Err(Error::inference(format!(
                "a chain of {} numbers is not made of rows of {dimension}",
                rows.len()
            )));
        }
        let found = rows.len() / dimension;
        let expected = self.iterations();
        if !self.chains.is_empty() && found != expected {
            return Err(Error::inference(format!(
                "chain {} has {found} iterations, those before it {expected}",
                self.chains.len()
            )));
        }
        self.chains.push(rows);
        self.acceptance.push(acceptance.unwrap_or(f64::NAN));
        Ok(())
    }

    /// The names of the parameters.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The units of the parameters.
    pub fn units(&self) -> &[String] {
        &self.units
    }

    /// How many parameters there are.
    pub fn dimension(&self) -> usize {
        self.names.len()
    }

    /// How many chains there are.
    pub fn chains(&self) -> usize {
        self.chains.len()
    }

    /// How many iterations each chain has; 0 without chains.
    pub fn iterations(&self) -> usize {
        self.chains.first().map_or(0, |rows| rows.len() / self.dimension())
    }

    /// How many draws there are, over all chains.
    pub fn total(&self) -> usize {
        self.chains() * self.iterations()
    }

    /// One draw, a value per parameter; empty where there is none.
    pub fn row(&self, chain: usize, iteration: usize) -> &[f64] {
        self.chains
            .get(chain)
            .and_then(|rows| {
                rows.chunks_exact(self.dimension()).nth(iteration)
            })
            .unwrap_or(&[])
    }

    /// All draws, chain after chain.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.chains.iter().flat_map(|rows| rows.chunks_exact(self.dimension()))
    }

    /// The draws of one parameter, chain by chain; chains are empty where
    /// there is no such parameter.
    pub fn column(&self, parameter: usize) -> Vec<Vec<f64>> {
        let of = |rows: &Vec<f64>| {
            rows.chunks_exact(self.dimension())
                .filter_map(|row| row.get(parameter).copied())
                .collect()
        };
        self.chains.iter().map(of).collect()
    }

    /// The draws of one parameter, all chains in one.
    pub fn pooled(&self, parameter: usize) -> Vec<f64> {
        self.rows().filter_map(|row| row.get(parameter).copied()).collect()
    }

    /// The acceptance rate of each chain, NaN where it has none.
    pub fn acceptance(&self) -> &[f64] {
        &self.acceptance
    }

    /// `n` draws spread evenly over all chains; all of them where there are
    /// no more than `n`.
    pub fn thinned(&self, n: usize) -> Vec<&[f64]> {
        let total = self.total();
        let n = n.min(total);
        let iterations = self.iterations();
        (0..n)
            .map(|i| (2 * i + 1) * total / (2 * n))
            .map(|at| self.row(at / iterations, at % iterations))
            .collect()
    }

    /// The same as draws of their own, in one chain.
    ///
    /// # Errors
    /// Where there is no draw.
    pub fn few(&self, n: usize) -> Result<Self> {
        let mut few = Self::new(self.names.clone(), self.units.clone())?;
        few.push_chain(self.thinned(n).concat(), None)?;
        Ok(few)
    }

    /// Every `step`-th draw of each chain, from the first on.
    ///
    /// # Errors
    /// Where there is no draw.
    pub fn every(&self, step: usize) -> Result<Self> {
        let mut some = Self::new(self.names.clone(), self.units.clone())?;
        for (rows, acceptance) in self.chains.iter().zip(&self.acceptance) {
            let rows = rows.chunks_exact(self.dimension());
            let rows: Vec<_> = rows.step_by(step.max(1)).collect();
            some.push_chain(rows.concat(), Some(*acceptance))?;
        }
        Ok(some)
    }

    /// The mean of each parameter over all draws.
    pub fn mean(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.dimension()];
        for row in self.rows() {
            sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += x);
        }
        let total = self.total() as f64;
        sums.into_iter().map(|sum| sum / total).collect()
    }

    /// The covariance of the parameters over all draws, dimension x
    /// dimension, with divisor draws - 1; NaN below two draws.
    pub fn covariance(&self) -> DMatrix<f64> {
        let d = self.dimension();
        let mean = self.mean();
        let mut sums = DMatrix::<f64>::zeros(d, d);
        for row in self.rows() {
            for i in 0..d {
                for j in 0..=i {
                    sums[(i, j)] += (row[i] - mean[i]) * (row[j] - mean[j]);
                }
            }
        }
        let freedom = match self.total() {
            0 | 1 => f64::NAN,
            total => (total - 1) as f64,
        };
        DMatrix::from_fn(d, d, |i, j| sums[(i.max(j), i.min(j))] / freedom)
    }

    /// The draws as CSV: a header `chain,iteration,<names>`, then a line per
    /// draw. Numbers read back to the same bits.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("chain,iteration");
        for name in &self.names {
            text.push(',');
            text.push_str(&csv_field(name));
        }
        text.push('\n');
        for (chain, rows) in self.chains.iter().enumerate() {
            // A chain often stands still: its row is then copied as text.
            let (mut last, mut written): (&[f64], _) = (&[], 0..0);
            let rows = rows.chunks_exact(self.dimension());
            for (iteration, row) in rows.enumerate() {
                // Writing to a string cannot fail.
                let _ = write!(text, "{chain},{iteration}");
                let begin = text.len();
                if same_bits(row, last) {
                    text.extend_from_within(written);
                } else {
                    for x in row {
                        let _ = write!(text, ",{x:?}");
                    }
                }
                (last, written) = (row, begin..text.len());
                text.push('\n');
            }
        }
        text
    }
}

/// Whether two rows are the same numbers, to the sign of a zero.
fn same_bits(a: &[f64], b: &[f64]) -> bool {
    let same = |(x, y): (&f64, &f64)| x.to_bits() == y.to_bits();
    a.len() == b.len() && a.iter().zip(b).all(same)
}

/// A field of a CSV file, quoted where RFC 4180 asks for it. What a
/// spreadsheet would take for a formula has an apostrophe before it, as OWASP
/// advises ("CSV Injection").
fn csv_field(text: &str) -> String {
    let formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']);
    let text = &if formula { format!("'{text}") } else { text.to_owned() };
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod sample {
    //! Numbers that Python can reproduce to the bit, for reference values.

    /// Uniform numbers of MINSTD (Park & Miller 1988): `s = 16807 s mod
    /// (2^31 - 1)`, over `2^31 - 1`.
    pub(super) fn uniform(seed: u64, n: usize) -> Vec<f64> {
        let modulus = 2_147_483_647;
        let mut state = seed;
        let mut next = || {
            state = state * 16807 % modulus;
            state as f64 / modulus as f64
        };
        (0..n).map(|_| next()).collect()
    }

    /// `x = phi x + u - 1/2` from 0, with `u` seeded by 12345 (chain + 1).
    pub(super) fn ar1(chain: u64, n: usize, phi: f64) -> Vec<f64> {
        let mut x = 0.0;
        uniform(12345 * (chain + 1), n)
            .into_iter()
            .map(|u| {
                x = phi * x + (u - 0.5);
                x
            })
            .collect()
    }

    /// `count` such chains.
    pub(super) fn chains(count: u64, n: usize, phi: f64) -> Vec<Vec<f64>> {
        (0..count).map(|chain| ar1(chain, n, phi)).collect()
    }

    /// Draws of one parameter.
    pub(super) fn draws(chains: &[Vec<f64>]) -> super::Draws {
        let mut draws =
            super::Draws::new(vec!["x".into()], vec!["m".into()]).unwrap();
        for chain in chains {
            draws.push_chain(chain.clone(), None).unwrap();
        }
        draws
    }

    /// Whether two numbers agree to a relative tolerance.
    pub(super) fn close(found: f64, expected: f64, tolerance: f64) {
        assert!(
            (found - expected).abs() <= tolerance * expected.abs(),
            "found {found}, expected {expected}"
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_by_two() -> Draws {
        let names = vec!["a".into(), "b, \"c\"".into()];
        let mut draws = Draws::new(names, vec!["1".into(); 2]).unwrap();
        draws.push_chain(vec![1.0, 2.0, 3.0, 1.0], Some(0.25)).unwrap();
        draws.push_chain(vec![5.0, 6.0, 7.0, 1e-300], None).unwrap();
        draws
    }

    #[test]
    fn rows_that_repeat_are_written_again() {
        let mut draws =
            Draws::new(vec!["a".into()], vec!["1".into()]).unwrap();
        draws.push_chain(vec![0.5, 0.5, 0.0, -0.0], None).unwrap();
        draws.push_chain(vec![-0.0, 0.1, 0.1, 0.1], None).unwrap();
        let expected = "chain,iteration,a\n0,0,0.5\n0,1,0.5\n0,2,0.0\n\
                        0,3,-0.0\n1,0,-0.0\n1,1,0.1\n1,2,0.1\n1,3,0.1\n";
        assert_eq!(draws.to_csv(), expected);
    }

    #[test]
    fn layout_is_row_major() {
        let draws = two_by_two();
        assert_eq!((draws.chains(), draws.iterations()), (2, 2));
        assert_eq!(draws.row(1, 0), [5.0, 6.0]);
        assert_eq!(draws.row(2, 0), [] as [f64; 0]);
        assert_eq!(draws.row(0, 2), [] as [f64; 0]);
        assert_eq!(draws.column(0), [[1.0, 3.0], [5.0, 7.0]]);
        assert!(draws.column(2).iter().all(Vec::is_empty));
        assert_eq!(draws.pooled(1), [2.0, 1.0, 6.0, 1e-300]);
        assert_eq!(draws.rows().count(), 4);
        assert_eq!(draws.acceptance()[0], 0.25);
        assert!(draws.acceptance()[1].is_nan());
    }

    #[test]
    fn thinning_is_even() {
        let draws = two_by_two();
        assert_eq!(draws.thinned(2), [[3.0, 1.0], [7.0, 1e-300]]);
        assert_eq!(draws.thinned(9).len(), 4);
        assert_eq!(draws.few(2).unwrap().column(0), [[3.0, 7.0]]);
        assert!(draws.few(0).is_err());
        assert_eq!(draws.every(2).unwrap().column(0), [[1.0], [5.0]]);
        assert_eq!(draws.every(0).unwrap().column(0), draws.column(0));
        assert!(draws.thinned(0).is_empty());
    }

    #[test]
    fn moments_are_those_by_hand() {
        // Means 4 and 9/4; squared deviations of `a` 9, 1, 1, 9; of `b`
        // 1/16, 25/16, 225/16, 81/16; products 3/4, 5/4, 15/4, -27/4.
        let draws = two_by_two();
        assert_eq!(draws.mean(), [4.0, 2.25]);
        let found = draws.covariance();
        let expected = [20.0, -1.0, -1.0, 20.75].map(|sum| sum / 3.0);
        for (x, y) in found.iter().zip(expected) {
            // A handful of roundings.
            sample::close(*x, y, 1e-14);
        }
    }

    #[test]
    fn csv_quotes_and_round_trips() {
        let text = two_by_two().to_csv();
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[0], "chain,iteration,a,\"b, \"\"c\"\"\"");
        assert_eq!(lines[1], "0,0,1.0,2.0");
        assert_eq!(lines[4], "1,1,7.0,1e-300");
        assert_eq!(lines.len(), 5);
    }

    #[test]
    fn a_name_is_no_formula() {
        for name in ["=1+1", "+1", "-1", "@sum(a)", "\t=1"] {
            let draws = Draws::new(vec![name.into()], vec!["1".into()]);
            let text = draws.unwrap().to_csv();
            assert_eq!(text, format!("chain,iteration,'{name}\n"));
        }
        assert_eq!(csv_field("a=1"), "a=1");
    }

    #[test]
    fn misshapen_chains_are_errors() {
        let mut draws = two_by_two();
        for rows in [vec![], vec![1.0], vec![1.0, 2.0]] {
            assert!(draws.push_chain(rows, None).unwrap_err().is_inference());
        }
        assert_eq!(draws.chains(), 2);
        assert!(Draws::new(vec![], vec![]).is_err());
        assert!(Draws::new(vec!["a".into()], vec![]).is_err());
    }

    #[test]
    fn no_chains_give_no_figures() {
        let draws = Draws::new(vec!["a".into()], vec!["1".into()]).unwrap();
        assert!(draws.mean()[0].is_nan());
        assert!(draws.covariance()[(0, 0)].is_nan());
        assert!(draws.thinned(3).is_empty());
        assert_eq!(draws.to_csv(), "chain,iteration,a\n");
    }
}
