//! Amplitudes that may have either sign: two modes of one posterior, of which
//! one interval over both says nothing.

use crate::diagnosis::tell::phrases::{
    amounts, own_name, probability, with_unit,
};
use crate::diagnosis::{Diagnosis, ParameterSummary};
use crate::draws::median;
use crate::report::digits::significant;
use crate::report::text::plain;

/// A mode of less than this share is told by the interval already.
const TOLD: f64 = 0.02;
/// Between two modes, within this part of the nearer one's size about zero,
/// there are at the most so many draws for one as near that mode.
const NEAR: f64 = 0.25;
const FEW: f64 = 0.5;

/// Which amplitudes of the selected mechanisms may have either sign: "Of
/// delta_mu either sign fits: 0.10 (probability 0.55) or -0.16 (0.45)."
pub(crate) fn either_sign(d: &Diagnosis) -> Option<String> {
    let told: Vec<String> = d
        .selected
        .iter()
        .filter_map(|name| {
            let amplitude = *amounts(d, name).first()?;
            let said = two_modes(d, amplitude)?;
            let own = plain(own_name(amplitude, name));
            Some(format!("Of {own} either sign fits: {said}."))
        })
        .collect();
    (!told.is_empty()).then(|| told.join(" "))
}

/// The modes of either sign, the likelier one first; `None` where there is
/// one mode only.
fn two_modes(d: &Diagnosis, amplitude: &ParameterSummary) -> Option<String> {
    let draws = d.draws.as_ref()?;
    let of = |name: &String| *name == amplitude.name;
    let all = draws.pooled(draws.names().iter().position(of)?);
    let (up, down): (Vec<f64>, Vec<f64>) = all.iter().partition(|x| **x > 0.0);
    let count = all.len() as f64;
    let share = |part: &[f64]| part.len() as f64 / count;
    if share(&up).min(share(&down)) < TOLD {
        return None;
    }
    let mut modes = [(share(&up), median(&up)), (share(&down), median(&down))];
    let [(_, above), (_, below)] = modes;
    let nearer = if above < -below { above } else { below };
    let about = |place: f64| {
        let near = |x: &&f64| (**x - place).abs() < NEAR * nearer.abs();
        all.iter().filter(near).count() as f64
    };
    if about(0.0) > FEW * about(nearer) {
        return None;
    }
    modes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let [(p, x), (q, y)] = modes.map(|(share, middle)| {
        let middle = with_unit(&significant(middle, 2), &amplitude.unit);
        (probability(share), middle)
    });
    Some(format!("{x} (probability {p}) or {y} ({q})"))
}

#[cfg(test)]
mod tests {
    use statrs::distribution::{ContinuousCDF, Normal};

    use super::*;
    use crate::diagnosis::fixture::diagnosis;
    use crate::draws::Draws;

    fn with(values: Vec<f64>) -> Option<String> {
        let (names, units) =
            (vec!["friction-patch.delta_mu".into()], vec!["1".into()]);
        let mut draws = Draws::new(names, units).unwrap();
        draws.push_chain(values, None).unwrap();
        either_sign(&Diagnosis { draws: Some(draws), ..diagnosis() })
    }

    #[test]
    fn two_modes_of_either_sign_are_told() {
        let two: Vec<f64> =
            (0..100).map(|i| if i < 60 { 0.1 } else { -0.16 }).collect();
        let said = with(two).unwrap();
        assert_eq!(
            said,
            "Of delta_mu either sign fits: 0.10 (probability 0.60) or -0.16 \
             (0.40)."
        );
        // One mode on one side, and one about zero.
        assert_eq!(with(vec![0.1; 100]), None);
        let one = (0..100).map(|i| 0.01 * f64::from(i) - 0.5).collect();
        assert_eq!(with(one), None);
        let wide = Normal::new(1.5, 1.0).unwrap();
        let at = |i| wide.inverse_cdf((f64::from(i) + 0.5) / 1000.0);
        assert_eq!(with((0..1000).map(at).collect()), None);
    }
}
