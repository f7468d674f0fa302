//! The errors in words: what made them, and whether the named noise does.

use crate::diagnosis::tell::phrases::{joined, log10, probability};
use crate::diagnosis::{Diagnosis, JudgedNoise, Verdict};
use crate::noise::Form;
use crate::report::text::plain;

/// What the errors are taken for, where that is not the named noise, or none
/// was named.
pub(crate) fn noise(d: &Diagnosis) -> Option<String> {
    if !is_other(d) {
        return None;
    }
    let taken = d.noise.iter().find(|n| n.name == d.selected_noise)?;
    if d.baseline.infers_noise {
        return Some(format!(
            "No noise was named: the errors are taken for {} ({}).",
            called(taken),
            how_probable(d, taken),
        ));
    }
    let named = plain(&d.baseline.noise);
    let against = log10(taken.log10_bayes_factor).replace('-', "−");
    Some(format!(
        "The errors are taken for {} ({}), a log10 Bayes factor of {against} \
         against {named}.",
        called(taken),
        how_probable(d, taken),
    ))
}

/// A noise by its name, how probable it is, and which is more so, of those that
/// the recording tells too little apart to go on with another.
fn how_probable(d: &Diagnosis, taken: &JudgedNoise) -> String {
    let said = |noise: &JudgedNoise| {
        (plain(&noise.name), probability(noise.probability))
    };
    let (name, own) = said(taken);
    let by_probability = |a: &&JudgedNoise, b: &&JudgedNoise| {
        a.probability.total_cmp(&b.probability)
    };
    let most = d.noise.iter().max_by(by_probability).map(said);
    match most.filter(|(_, most)| *most != own) {
        Some((other, most)) => {
            format!("{name}, probability {own}, where {other} has {most}")
        }
        None => format!("{name}, probability {own}"),
    }
}

/// Whether the model goes on with another noise than the named one.
pub(crate) fn is_other(d: &Diagnosis) -> bool {
    if d.baseline.infers_noise {
        return !d.noise.is_empty();
    }
    let adequate = d.verdict == Verdict::Adequate;
    let named = d.noise.is_empty() || d.selected_noise == d.baseline.noise;
    !adequate && !named
}

/// "smooth ones beside independent ones, with outliers".
fn called(noise: &JudgedNoise) -> String {
    let form = Form::of(&noise.name);
    let blocks: Vec<String> =
        form.memory.split(" + ").map(block_called).collect();
    let mut words = joined(&blocks, "beside");
    if noise.has_tails {
        words += ", with outliers";
    }
    if noise.grows {
        words += ", of a size that changes along the recording";
    }
    words
}

fn block_called(block: &str) -> String {
    match block {
        "white" => "independent ones".to_owned(),
        "ou" | "ar(1)" => "ones correlated in time".to_owned(),
        "matern32" => "smooth ones".to_owned(),
        other => format!("{} ones", plain(other)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::fixture::diagnosis;

    #[test]
    fn another_noise_is_told_and_the_named_one_is_not() {
        let mut d = diagnosis();
        assert_eq!(noise(&d), None);
        d.noise[1].name = "matern32 + white + tails".to_owned();
        d.noise[1].has_tails = true;
        d.noise[1].log10_bayes_factor = 3.12;
        d.selected_noise = d.noise[1].name.clone();
        let said = noise(&d).unwrap();
        assert_eq!(
            said,
            "The errors are taken for smooth ones beside independent ones, \
             with outliers (matern32 + white + tails, probability 0.30, where \
             iid has 0.70), a log10 Bayes factor of +3.1 against iid."
        );
        // Where none was named, there is nothing to be against.
        d.baseline.infers_noise = true;
        d.noise[0].probability = 0.25;
        let said = noise(&d).unwrap();
        assert!(said.starts_with("No noise was named: the errors"), "{said}");
        assert!(said.ends_with("white + tails, probability 0.30)."), "{said}");
    }
}
