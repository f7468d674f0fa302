//! Whether a verdict is weak: evidence and fit disagree, or the recording
//! does not rule out that nothing is missing.

use crate::diagnosis::hypothesis::NONE;
use crate::diagnosis::tell::phrases::{
    all_called, is_corrected, joined, recorded_in, with_unit,
};
use crate::diagnosis::{BeforeAfter, Diagnosis};
use crate::report::digits::significant;
use crate::report::text::{capital, plain};

/// The errors that grow although the evidence does, with what they are called.
fn worse(d: &Diagnosis) -> Vec<(&'static str, BeforeAfter)> {
    let i = &d.improvement;
    let all = [
        ("the root mean square error", i.rmse),
        ("the least one of its motion", i.least_squares),
        ("that of the last 30 %, predicted from the rest,", i.heldout_rmse),
    ];
    let gains = is_corrected(d) && i.log10_bayes_factor > 0.0;
    let told = all.into_iter().filter(|(_, pair)| gains && pair.grows());
    told.collect()
}

/// Whether the verdict is weak.
pub(crate) fn is_weak(d: &Diagnosis) -> bool {
    let added = !d.selected.is_empty();
    let open = added && d.group.iter().any(|name| name == NONE);
    open || d.withheld.is_some() || !worse(d).is_empty()
}

/// What is not added although the evidence asks for it, and why.
pub(crate) fn withheld(d: &Diagnosis) -> Option<String> {
    let withheld = d.withheld.as_ref()?;
    let BeforeAfter { before, after } = withheld.rmse;
    let what = match withheld.names[..] {
        [] => format!("Errors of another kind ({})", plain(&withheld.noise)),
        _ => all_called(d, &withheld.names, "together with"),
    };
    Some(format!(
        "{} would have the most evidence, but the root mean square error \
         would grow from {} to {}: what makes the fit worse is not added, and \
         this verdict is weak.",
        capital(&what),
        significant(before, 2),
        with_unit(&significant(after, 2), recorded_in(d)),
    ))
}

/// Why the verdict is weak, where evidence and fit disagree.
pub(crate) fn disagreement(d: &Diagnosis) -> Option<String> {
    let worse = worse(d);
    if worse.is_empty() {
        return None;
    }
    let unit = recorded_in(d);
    let told = |(what, pair): &(&str, BeforeAfter)| {
        let before = significant(pair.before, 2);
        let after = with_unit(&significant(pair.after, 2), unit);
        format!("{what} grows from {before} to {after}")
    };
    let told: Vec<String> = worse.iter().map(told).collect();
    Some(format!(
        "The evidence rises but the fit does not: {}; this verdict is weak.",
        joined(&told, "and")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::fixture::diagnosis;
    use crate::diagnosis::{Verdict, Withheld, in_words};

    #[test]
    fn a_fit_that_grows_worse_is_weak_and_told() {
        let mut d = diagnosis();
        assert!(!is_weak(&d) && disagreement(&d).is_none());
        d.improvement.rmse = BeforeAfter { before: 0.9, after: 1.7 };
        assert!(is_weak(&d));
        let said = disagreement(&d).unwrap();
        let told = "the root mean square error grows from 0.90 to 1.7 m/s;";
        assert!(said.contains(told), "{said}");
    }

    #[test]
    fn what_makes_the_fit_worse_is_told_and_weak() {
        let mut d = diagnosis();
        let names = std::mem::take(&mut d.selected);
        let rmse = BeforeAfter { before: 0.68, after: 0.85 };
        let noise = "ou + tails".to_owned();
        d.withheld = Some(Withheld { names, noise, rmse });
        assert!(is_weak(&d));
        let said = withheld(&d).unwrap();
        let told = "would grow from 0.68 to 0.85 m/s: what makes the fit";
        assert!(said.contains(told), "{said}");
        let words = in_words(&d);
        assert!(words.contains(&said));
        assert!(words[0].contains("may"), "{}", words[0]);
        // Other errors alone.
        d.verdict = Verdict::Errors;
        d.withheld.iter_mut().for_each(|withheld| withheld.names.clear());
        let words = in_words(&d).join(" ");
        let told = "Errors of another kind (ou + tails) would have the most";
        assert!(words.contains(told), "{words}");
        assert!(words.contains("may not be iid ones"), "{words}");
        assert!(words.contains("Nothing is added"), "{words}");
    }

    #[test]
    fn a_group_with_nothing_missing_is_weak() {
        let mut d = diagnosis();
        d.group.push(NONE.to_owned());
        assert!(is_weak(&d));
    }
}
