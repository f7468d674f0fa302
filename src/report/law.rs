//! The law's parameters as calibrated, and with a force of free form in the
//! model.

use super::ParameterReport;
use super::digits::{beside, significant};
use super::text::plain;

/// The law's parameters, whatever else may act.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct LawReport {
    /// As calibrated.
    pub as_it_was: Vec<ParameterReport>,
    /// With a force of free form in the model.
    pub with_free_form_force: Vec<ParameterReport>,
    /// Of the model with the force against the one without.
    pub log10_bayes_factor: f64,
    /// Whether the force differs from zero anywhere, by its simultaneous 90 %
    /// band.
    pub differs: bool,
}

impl LawReport {
    /// Whether a force acts that the model lacks, as far as is known: what was
    /// calibrated without it should then not be used.
    pub fn needs_force(&self) -> bool {
        self.differs || self.log10_bayes_factor > 0.0
    }

    /// Which of both to use, and why.
    pub(super) fn told(&self) -> Option<String> {
        let many = match self.with_free_form_force.len() {
            0 => return None,
            1 => "value",
            _ => "values",
        };
        let told = |p: &ParameterReport| {
            let unit = match p.unit_shown().as_str() {
                "" => String::new(),
                unit => format!(" {unit}"),
            };
            let of = |x| beside(x, p.sd);
            format!(
                "{} is {}{unit} ({} to {})",
                plain(&p.name),
                of(p.q50),
                of(p.q05),
                of(p.q95)
            )
        };
        let all: Vec<String> =
            self.with_free_form_force.iter().map(told).collect();
        Some(format!(
            "With a force of free form, which leaves the rest of the physics \
             open, {}: {}, so use the {many} {} the force.",
            all.join(" and "),
            self.why(),
            if self.needs_force() { "with" } else { "without" }
        ))
    }

    fn why(&self) -> String {
        let factor = significant(self.log10_bayes_factor, 2);
        let evidence = format!("a log10 Bayes factor of {factor}");
        match (self.differs, self.log10_bayes_factor > 0.0) {
            (true, true) => {
                format!("that force is not zero, and has {evidence}")
            }
            (true, false) => {
                format!("that force is not zero, although it has {evidence}")
            }
            (false, true) => format!("that force has {evidence}"),
            (false, false) => {
                format!("that force may be zero, and has {evidence}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(differs: bool, log10_bayes_factor: f64) -> String {
        let mu = ParameterReport {
            name: "mu".to_owned(),
            unit: "1".to_owned(),
            sd: 0.02,
            q05: 0.27,
            q50: 0.3,
            q95: 0.34,
            ..ParameterReport::default()
        };
        let law = LawReport {
            with_free_form_force: vec![mu],
            log10_bayes_factor,
            differs,
            ..LawReport::default()
        };
        law.told().unwrap()
    }

    #[test]
    fn the_words_say_which_to_use() {
        let without = said(false, -0.52);
        assert!(without.contains("mu is 0.300 (0.270 to 0.340)"), "{without}");
        assert!(without.contains("may be zero"), "{without}");
        assert!(without.ends_with("use the value without the force."));
        for (differs, factor) in [(true, -0.5), (false, 0.1), (true, 3.0)] {
            let with = said(differs, factor);
            assert!(with.ends_with("use the value with the force."), "{with}");
        }
        assert!(LawReport::default().told().is_none());
    }
}
