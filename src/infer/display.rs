//! An inference in a few lines of text.

use std::fmt::{Display, Formatter, Result};

use super::inference::{Inference, Marginal};
use crate::draws::{Draws, Summary, summarise};

impl Display for Inference {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        if let Some(draws) = &self.draws {
            head(f)?;
            tell_draws(draws, f)?;
        }
        if let Some(kept) = &self.kept {
            tell_draws(kept, f)?;
        }
        for m in &self.marginals {
            let Marginal { name, mean, sd, .. } = m;
            let (low, high) = (m.quantiles[1], m.quantiles[5]);
            writeln!(
                f,
                "{name:18} {mean:.4} +- {sd:.4} ({low:.4} .. {high:.4})"
            )?;
        }
        if let Some(mode) = &self.mode {
            let values: Vec<_> =
                mode.natural.iter().map(|x| format!("{x:.4}")).collect();
            writeln!(f, "mode at {}", values.join(", "))?;
        }
        if let Some(evidence) = &self.evidence {
            let (log, se) = (evidence.log, evidence.se);
            writeln!(f, "ln evidence {log:.2} +- {se:.2}")?;
        }
        let mut told = self.warnings.iter().chain(&self.hints);
        told.try_for_each(|warning| writeln!(f, "Warning: {warning}"))
    }
}

fn head(f: &mut Formatter<'_>) -> Result {
    writeln!(
        f,
        "{:18} {:>9} {:>9} {:>9} {:>9} {:>6} {:>6}",
        "parameter", "mean", "sd", "5 %", "95 %", "R-hat", "ESS"
    )
}

fn tell_draws(draws: &Draws, f: &mut Formatter<'_>) -> Result {
    summarise(draws).iter().try_for_each(|s| {
        let name = match s.unit.as_str() {
            "1" | "value" | "value2" => s.name.clone(),
            unit => format!("{} [{unit}]", s.name),
        };
        let places = decimals(s);
        write!(f, "{name:18}")?;
        for x in [s.mean, s.sd, s.q05, s.q95] {
            write!(f, " {x:9.places$}")?;
        }
        writeln!(f, " {:6.3} {:6.0}", s.rhat, s.ess_bulk)
    })
}

/// As many decimals as show the standard deviation to two digits.
fn decimals(s: &Summary) -> usize {
    let digits = 1.0 - s.sd.log10().floor();
    if digits.is_finite() { digits.clamp(0.0, 6.0) as usize } else { 3 }
}
