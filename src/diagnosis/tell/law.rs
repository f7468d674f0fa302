//! The friction law's parameters in words: as they were, corrected, and with
//! the rest of the physics left open.

use crate::diagnosis::hypothesis::UNKNOWN;
use crate::diagnosis::tell::phrases::{
    interval, is_corrected, is_unsure, joined, with_unit,
};
use crate::diagnosis::{Diagnosis, ParameterSummary, Verdict};
use crate::report::digits::beside;
use crate::report::text::plain;

/// How many parameters are told.
const TOLD: usize = 2;

/// How many sd a value may lie off the median of what is likely of it when the
/// rest is left open: one in a hundred right values lies further off. The 90 %
/// interval would doubt one in ten right ones.
const APART: f64 = 2.576;

/// How many sd the 5 % and the 95 % quantile of a normal distribution lie off.
const TAIL: f64 = 1.645;

/// What to use for the law's parameters; `None` where nothing is known of
/// them, or several events have each their own: the page has these.
pub(super) fn law(d: &Diagnosis) -> Option<String> {
    let law = &d.law;
    let open = &law.with_free_form_force;
    let several = d.pictured.len() > 1;
    if open.is_empty() || law.as_it_was.is_empty() || several {
        return None;
    }
    let [was, left_open] =
        [&law.as_it_was, open].map(|all| values(all, false));
    let many = open.len() > 1;
    let (they_are, value) =
        if many { ("they are", "values") } else { ("it is", "value") };
    if d.verdict == Verdict::Unexplained {
        let named = values(open, true);
        return Some(format!(
            "With a force of free form in the model {named}, instead of {was} \
             without it: use the {value} with the force."
        ));
    }
    let (told, begin, instead, which) = match is_corrected(d) {
        true => {
            let instead = format!(", instead of {was}");
            (&law.corrected, "In the corrected model ", instead, "corrected")
        }
        false => {
            let nothing = String::new();
            (&law.as_it_was, "As calibrated, ", nothing, "calibrated")
        }
    };
    let end = match (agree(told, open), doubt(d)) {
        (true, None) => format!("that agrees, so use the {which} {value}"),
        (true, Some(doubt)) => format!(
            "that agrees, but {doubt}, so use the {value} with the force"
        ),
        (false, _) => {
            format!("that does not agree, so use the {value} with the force")
        }
    };
    Some(format!(
        "{begin}{}{instead}. With a force of free form, which leaves the rest \
         of the physics open, {they_are} {left_open}: {end}.",
        values(told, true)
    ))
}

/// "mu is 0.31 (0.29 to 0.33) and xi is ..", or the values alone.
fn values(all: &[ParameterSummary], named: bool) -> String {
    let value = |p: &ParameterSummary| {
        let middle = with_unit(&beside(p.q50, p.sd), &p.unit);
        let value = format!("{middle} ({})", interval(p));
        match named {
            true => format!("{} is {value}", plain(&p.name)),
            false => value,
        }
    };
    let all: Vec<String> = all.iter().take(TOLD).map(value).collect();
    joined(&all, "and")
}

/// What speaks against what was selected, or calibrated, although its values
/// agree.
fn doubt(d: &Diagnosis) -> Option<&'static str> {
    // Several terms then imitate a force that none of them is.
    let imitates = d.group.first().is_some_and(|name| name == UNKNOWN);
    if d.weak {
        Some("the verdict is weak")
    } else if imitates && is_corrected(d) {
        Some("no mechanism alone explains as much as that force")
    } else if is_unsure(d) {
        Some("more likely than not something is missing")
    } else {
        None
    }
}

/// Whether each is within what is possible of it when the rest is left open.
fn agree(told: &[ParameterSummary], open: &[ParameterSummary]) -> bool {
    told.iter().zip(open).all(|(p, open)| {
        let off = p.q50 - open.q50;
        let tail = if off < 0.0 { open.q05 } else { open.q95 };
        off.abs() <= APART / TAIL * (tail - open.q50).abs()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::{Hypothesis, Judged, LawParameters};

    fn mu(q05: f64, q50: f64, q95: f64) -> Vec<ParameterSummary> {
        let (name, unit) = ("mu".to_owned(), "1".to_owned());
        let sd = (q95 - q05) / 3.29;
        vec![ParameterSummary { name, unit, mean: q50, sd, q05, q50, q95 }]
    }

    fn diagnosis(verdict: Verdict, corrected: Option<f64>) -> Diagnosis {
        let selected = corrected.map(|_| "surge".to_owned());
        Diagnosis {
            verdict,
            selected: selected.into_iter().collect(),
            law: LawParameters {
                as_it_was: mu(0.19, 0.2, 0.21),
                corrected: corrected
                    .map_or(Vec::new(), |x| mu(x - 0.01, x, x + 0.01)),
                with_free_form_force: mu(0.25, 0.3, 0.36),
            },
            ..Diagnosis::default()
        }
    }

    #[test]
    fn the_words_say_which_to_use() {
        let told = |verdict, corrected| {
            law(&diagnosis(verdict, corrected)).unwrap_or_default()
        };
        let fits = told(Verdict::MissingPhysics, Some(0.31));
        assert!(fits.starts_with("In the corrected model mu is 0.31"));
        let was = "instead of 0.2000 (0.1900 to 0.2100)";
        assert!(fits.contains(was), "{fits}");
        assert!(fits.contains("it is 0.300 (0.250 to 0.360): that agrees"));
        assert!(fits.ends_with("use the corrected value."), "{fits}");
        let apart = told(Verdict::MissingPhysics, Some(0.24));
        assert!(apart.ends_with("use the corrected value."), "{apart}");
        let off = told(Verdict::MissingPhysics, Some(0.22));
        assert!(off.ends_with("use the value with the force."), "{off}");
        let weak = diagnosis(Verdict::MissingPhysics, Some(0.31));
        let weak = law(&Diagnosis { weak: true, ..weak }).unwrap();
        assert!(weak.contains("weak, so use the value with"), "{weak}");
        let imitated = diagnosis(Verdict::MissingPhysics, Some(0.31));
        let group = vec![UNKNOWN.to_owned()];
        let imitated = Diagnosis { group, ..imitated };
        let imitated = law(&imitated).unwrap();
        assert!(imitated.contains("that force, so use the value with"));
        let alone = told(Verdict::Adequate, None);
        assert!(alone.starts_with("As calibrated, mu is 0.2"), "{alone}");
        assert!(alone.ends_with("use the value with the force."), "{alone}");
        let open = told(Verdict::Unexplained, Some(0.3));
        assert!(open.starts_with("With a force of free form"), "{open}");
        let baseline = |probability| Judged {
            kind: Hypothesis::Baseline,
            probability,
            ..Judged::default()
        };
        let sure = "that agrees, so use the calibrated value.";
        let unsure = "missing, so use the value with the force.";
        for (probability, end) in [(0.6, sure), (0.4, unsure)] {
            let mut near = diagnosis(Verdict::Adequate, None);
            near.law.as_it_was = mu(0.29, 0.31, 0.33);
            near.mechanisms = vec![baseline(probability)];
            let near = law(&near).unwrap();
            assert!(near.ends_with(end), "{near}");
        }
        let nothing = Diagnosis::default();
        assert!(law(&nothing).is_none());
    }
}
