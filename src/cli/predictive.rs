//! The table by elpd of `couloir compare`: how well each model predicts.

use serde_json::{Value, json};

use super::answer::wrapped;
use crate::draws::{Lfo, Loo, sum_and_error};
use crate::elpd::difference;

/// The shape above which a prediction by weights is told as doubtful
/// (Vehtari and others 2017).
const HIGH: f64 = 0.7;

/// Below this many values a standard error is itself rough (Sivula,
/// Magnusson, Matamoros, Vehtari 2020, arXiv 2008.10296).
const FEW: usize = 100;

/// How well one model predicts, by one of the two ways.
pub(super) struct Predicted<'a> {
    name: String,
    parts: &'a [f64],
    pareto_k: &'a [f64],
    /// How many values were known first, and how often the model was fitted;
    /// nothing by leave-one-out.
    ahead: Option<(usize, usize)>,
}

impl<'a> Predicted<'a> {
    pub(super) fn left_out(name: String, loo: &'a Loo) -> Self {
        let (parts, pareto_k) = (&loo.pointwise, &loo.pareto_k);
        Self { name, parts, pareto_k, ahead: None }
    }

    pub(super) fn ahead(name: String, lfo: &'a Lfo) -> Self {
        let (parts, pareto_k) = (&lfo.pointwise, &lfo.pareto_k);
        let ahead = Some((lfo.least, lfo.fits.len()));
        Self { name, parts, pareto_k, ahead }
    }

    fn elpd(&self) -> f64 {
        sum_and_error(self.parts).0
    }

    /// The largest shape of the weights; NaN where one is unknown.
    fn largest_k(&self) -> f64 {
        let unknown = self.pareto_k.iter().any(|k| k.is_nan());
        let start = if unknown { f64::NAN } else { f64::NEG_INFINITY };
        self.pareto_k
            .iter()
            .fold(start, |top, k| if top.is_nan() { top } else { top.max(*k) })
    }

    /// How many shapes are above [`HIGH`], or unknown.
    fn high(&self) -> usize {
        let fine = |k: &&f64| **k <= HIGH;
        self.pareto_k.len() - self.pareto_k.iter().filter(fine).count()
    }

    /// The difference to the best and its standard error.
    fn behind(&self, best: &Self) -> (f64, f64) {
        if std::ptr::eq(self, best) {
            return (0.0, 0.0);
        }
        difference(self.parts, best.parts).unwrap_or((f64::NAN, f64::NAN))
    }

    fn json(&self, best: &Self) -> Value {
        let (elpd, se) = sum_and_error(self.parts);
        let (behind, its_se) = self.behind(best);
        let mut value = json!({
            "elpd": {"value": elpd, "se": se},
            "difference": {"value": behind, "se": its_se},
            "values": self.parts.len(),
            "pareto_k_max": self.largest_k(),
            "pareto_k_high": self.high(),
        });
        match self.ahead {
            None => value["method"] = json!("psis-loo"),
            Some((least, fits)) => {
                value["method"] = json!("psis-lfo");
                value["from"] = json!(least);
                value["fits"] = json!(fits);
            }
        }
        value
    }
}

/// The model that predicts best.
fn best<'p, 'a>(models: &'p [Predicted<'a>]) -> Option<&'p Predicted<'a>> {
    models.iter().max_by(|a, b| a.elpd().total_cmp(&b.elpd()))
}

/// The part of each model in the document for programs.
pub(super) fn documents(models: &[Predicted<'_>]) -> Vec<Value> {
    let Some(best) = best(models) else { return Vec::new() };
    models.iter().map(|model| model.json(best)).collect()
}

/// The table, and what is to be known of it.
pub(super) fn tell(models: &[Predicted<'_>], width: usize) -> String {
    let Some(best) = best(models) else { return String::new() };
    let mut text = table(models, best);
    text.push('\n');
    for model in models.iter().filter(|m| !std::ptr::eq(*m, best)) {
        text.push_str(&wrapped(&in_words(model, best), width));
    }
    for note in notes(models, best) {
        text.push_str(&wrapped(&note, width));
    }
    text
}

fn table(models: &[Predicted<'_>], best: &Predicted<'_>) -> String {
    let (title, last) = match best.ahead {
        None => ("elpd, one left out", "k > 0.7"),
        Some(_) => ("elpd, one ahead", "fits"),
    };
    let mut text = format!(
        "\n{:25} {title:>20} {:>19} {:>5} {last:>7}\n",
        "model", "to the best", "max k"
    );
    for model in models {
        if model.name.chars().count() > 25 {
            text.push_str(&format!("{}\n{:25}", model.name, ""));
        } else {
            text.push_str(&format!("{:25}", model.name));
        }
        let (elpd, se) = sum_and_error(model.parts);
        let elpd = format!("{elpd:.2} ± {se:.2}");
        let behind = match model.behind(best) {
            _ if std::ptr::eq(model, best) => "-".to_owned(),
            (value, se) => format!("{value:.2} ± {se:.2}"),
        };
        let k = shape(model.largest_k());
        let last = model.ahead.map_or(model.high(), |(_, fits)| fits);
        text.push_str(&format!(" {elpd:>20} {behind:>19} {k:>5} {last:>7}\n"));
    }
    text
}

/// A shape as it is printed; "-" where all weights were equal.
fn shape(k: f64) -> String {
    match k {
        k if k.is_nan() => "?".to_owned(),
        f64::NEG_INFINITY => "-".to_owned(),
        k => format!("{k:.2}"),
    }
}

/// Whether a difference is more than chance among the values. Below 4 it
/// does not matter, whatever its error (Sivula and others 2020); above, it
/// is set against twice its error.
fn in_words(model: &Predicted<'_>, best: &Predicted<'_>) -> String {
    let (behind, se) = model.behind(best);
    let (name, winner) = (&model.name, &best.name);
    if behind.is_nan() {
        return format!("{name}: its prediction could not be worked out.");
    }
    if behind > -4.0 {
        return format!(
            "{winner} and {name} predict about equally well (less than 4 \
             apart)."
        );
    }
    if behind > -2.0 * se {
        return format!(
            "{winner} may predict better than {name}, but the difference is \
             less than twice its standard error."
        );
    }
    format!("{winner} predicts better than {name}.")
}

fn notes(models: &[Predicted<'_>], best: &Predicted<'_>) -> Vec<String> {
    let mut notes = Vec::new();
    for model in models.iter().filter(|m| m.high() > 0) {
        notes.push(doubtful(model));
    }
    let values = best.parts.len();
    if values < FEW {
        notes.push(format!(
            "Note: with {values} values the standard errors of elpd are \
             themselves rough."
        ));
    }
    match best.ahead {
        Some((least, _)) => notes.push(format!(
            "Note: each value is predicted from those before it, from {least} \
             known values on."
        )),
        None if models.iter().any(|m| remembers(&m.name)) => {
            notes.push(CONDITIONAL.to_owned());
        }
        None => {}
    }
    notes
}

/// Whether a model's noise has a memory, by its name: "voellmy, ar(1)".
fn remembers(model: &str) -> bool {
    let mut blocks = model.split([',', '+']).map(str::trim);
    blocks.any(|b| b.starts_with("ar(") || b == "ou" || b == "matern32")
}

const CONDITIONAL: &str = "Note: where errors have a memory, a value is scored \
    given the values before it. Leaving it out does not hide it from the value after \
    it, so this is not how well a missing value would be predicted, and a \
    noise without memory is scored by another question. --lfo asks all \
    models the same: the next value, from the past alone.";

fn doubtful(model: &Predicted<'_>) -> String {
    let (name, high) = (&model.name, model.high());
    let (all, k) = (model.pareto_k.len(), model.largest_k());
    if k.is_nan() {
        return format!(
            "Warning, {name}: for {high} of {all} values it is unknown \
             whether elpd can be trusted: there are too few draws, or a \
             value has no density; ask for more --draws."
        );
    }
    let mend = match model.ahead {
        None => "; look at those values, or use --lfo, which fits again",
        Some(_) => "",
    };
    format!(
        "Warning, {name}: at {high} of {all} values the fit leans on the \
         value itself (Pareto k above 0.7, the largest {k:.2}); how it is \
         predicted without is not known unless the model is fitted again. \
         elpd is uncertain, most likely too high{mend}."
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(parts: &[f64], k: f64) -> Loo {
        let (elpd, se) = sum_and_error(parts);
        let pareto_k = vec![k; parts.len()];
        Loo { elpd, se, p_loo: 0.0, pointwise: parts.to_vec(), pareto_k }
    }

    #[test]
    fn the_table_fits_80_columns_and_says_what_is_doubtful() {
        let near: Vec<f64> = (0..400).map(|i| f64::from(i % 7)).collect();
        let far: Vec<f64> = near.iter().map(|p| p - 250.0).collect();
        let name = "coulomb + turbulent + cohesion, student";
        let [good, bad] = [of(&near, 0.2), of(&far, 0.91)];
        let models = [
            Predicted::left_out("voellmy, ar(1)".into(), &good),
            Predicted::left_out(name.into(), &bad),
        ];
        let text = tell(&models, 80);
        assert!(text.lines().all(|l| l.chars().count() <= 80), "{text}");
        for part in ["400 of 400", "0.91", "predicts better", "--lfo"] {
            let flat = text.replace("\n  ", " ");
            assert!(flat.contains(part), "{part}: {text}");
        }
        let json = documents(&models);
        assert_eq!(json[0]["difference"]["value"], 0.0);
        assert_eq!(json[1]["difference"]["value"], -100_000.0);
        assert_eq!(json[1]["pareto_k_high"], 400);
    }

    #[test]
    fn small_differences_are_not_told_apart() {
        let [a, b] = [of(&[-1.0; 50], 0.1), of(&[-1.02; 50], 0.1)];
        let models = [
            Predicted::left_out("a, iid".into(), &a),
            Predicted::left_out("b, iid".into(), &b),
        ];
        let text = tell(&models, 80);
        assert!(text.contains("equally well"), "{text}");
        assert!(text.contains("50 values"), "{text}");
    }
}
