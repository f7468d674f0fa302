//! What the corrected model brings, in words: the fit, the evidence,
//! predictions, and what is left.

use crate::diagnosis::tell::noise::is_other;
use crate::diagnosis::tell::phrases::{judged, recorded_in, with_unit};
use crate::diagnosis::{BeforeAfter, Diagnosis};
use crate::report::digits::{p_value, per_cent, short, significant};
use crate::report::text::{capital, plain};

/// What adding it brings to the fit.
pub(crate) fn better(d: &Diagnosis) -> String {
    let i = &d.improvement;
    let before = with_unit(&significant(i.rmse.before, 2), recorded_in(d));
    let after = with_unit(&significant(i.rmse.after, 2), recorded_in(d));
    let mut said = match i.rmse {
        BeforeAfter { before: b, after: a }
            if b.is_finite() && a.is_finite() =>
        {
            let way = if a < b { "falls" } else { "goes" };
            format!(
                "With it the root mean square error {way} from {before} \
                     to {after}"
            )
        }
        _ => format!("Without it the root mean square error is {before}"),
    };
    if i.log10_bayes_factor.is_finite() {
        let way = if i.log10_bayes_factor < 0.0 { "against" } else { "for" };
        let size = format!("{:.1}", i.log10_bayes_factor.abs());
        let what = match is_other(d) && !d.selected.is_empty() {
            true => "it and for these errors",
            false => "it",
        };
        let size = over_noises(d).map_or(size.clone(), |all| {
            let errors = plain(&d.selected_noise);
            format!("{all:.1} over all noises ({size} with {errors} errors)")
        });
        said += &format!(
            "; the evidence {way} {what} is a log10 Bayes factor of {size}"
        );
    }
    said + "."
}

/// The log10 Bayes factor of a term alone, all noises that are kept counted,
/// where it is less by more than 1 than under the noise that was selected:
/// another noise takes much of the mismatch for itself.
fn over_noises(d: &Diagnosis) -> Option<f64> {
    let [name] = &d.selected[..] else { return None };
    let all = judged(d, name)?.log10_bayes_factor;
    let alone = d.improvement.log10_bayes_factor;
    (all > 0.0 && all < alone - 1.0 && !is_other(d)).then_some(all)
}

/// A p-value below which the corrected model's residuals are told to be
/// correlated.
const CORRELATED: f64 = 0.01;

/// What is left in the residuals of the corrected model.
pub(crate) fn correlated(d: &Diagnosis) -> Option<String> {
    let p = d.improvement.ljung_box_p.after;
    (p < CORRELATED).then(|| {
        format!(
            "The residuals of the corrected model are still correlated \
             (Ljung-Box p {}): its intervals may be too narrow.",
            p_value(p)
        )
    })
}

/// Predictions: of the stretch that was held out, and the bands.
pub(crate) fn ahead(d: &Diagnosis) -> Option<String> {
    let i = &d.improvement;
    let known = |p: BeforeAfter| p.before.is_finite() && p.after.is_finite();
    let mut clauses = Vec::new();
    if known(i.heldout_rmse) {
        let after = significant(i.heldout_rmse.after, 2);
        clauses.push(format!(
            "predicted from its first 70 %, the rest of the recording is \
             missed by {} instead of {}",
            with_unit(&after, recorded_in(d)),
            significant(i.heldout_rmse.before, 2)
        ));
    }
    if known(i.coverage90) {
        clauses.push(format!(
            "the 90 % band holds {} of the values ({} before)",
            per_cent(i.coverage90.after),
            per_cent(i.coverage90.before)
        ));
    }
    (!clauses.is_empty()).then(|| capital(&clauses.join("; ")) + ".")
}

/// The force that is left beside what was selected.
pub(crate) fn rest(d: &Diagnosis) -> Option<String> {
    let rest = d.rest.filter(|r| r.specific_force_q95.is_finite())?;
    Some(format!(
        "Any force that is left beside that is below {} m/s² on 95 % of the \
         run.",
        short(rest.specific_force_q95, 2)
    ))
}
