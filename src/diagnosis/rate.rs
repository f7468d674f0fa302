//! Whether what a diagnosis says hangs on how dense the recording is.

use crate::diagnosis::{Diagnosis, Verdict};

impl Diagnosis {
    /// Compares with a diagnosis of the same recordings at half the rate, and
    /// warns, before all else, where the verdict or the group is another: a
    /// reason not to use it.
    ///
    /// ```
    /// use couloir::diagnosis::{Diagnosis, Verdict};
    /// let mut found = Diagnosis::default();
    /// let mut halved = Diagnosis::default();
    /// found.check_rate(&halved);
    /// assert!(found.warnings.is_empty() && found.notes.len() == 1);
    /// halved.verdict = Verdict::Errors;
    /// found.check_rate(&halved);
    /// assert!(found.warnings[0].contains("the verdict is \"noise\""));
    /// ```
    pub fn check_rate(&mut self, halved: &Self) {
        let verdict = differs(&self.verdict, &halved.verdict, |verdict| {
            format!("the verdict is \"{}\"", Verdict::name(*verdict))
        });
        let group = differs(&sorted(self), &sorted(halved), |group| {
            format!("the group is {}", group.join(", "))
        });
        let other: Vec<String> =
            [verdict, group].into_iter().flatten().collect();
        if other.is_empty() {
            self.notes.push(
                "At half the rate verdict and group are the same.".to_owned(),
            );
            return;
        }
        let said = format!(
            "at half the rate {}: what is found hangs on how dense the \
             recording is, as it does where the noise is not the right one",
            other.join(", and ")
        );
        self.doubts.insert(0, said.clone());
        self.warnings.insert(0, said);
    }
}

/// The names of the group, whatever their order.
fn sorted(d: &Diagnosis) -> Vec<String> {
    let mut group = d.group.clone();
    group.sort();
    group
}

/// `the verdict is "a" instead of "b"`, where they differ.
fn differs<T: PartialEq>(
    before: &T,
    halved: &T,
    told: impl Fn(&T) -> String,
) -> Option<String> {
    if before == halved {
        return None;
    }
    let before = told(before);
    let instead = before.split_once(" is ").map_or("", |(_, name)| name);
    Some(format!("{} instead of {instead}", told(halved)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_group_is_told_first() {
        let of = |group: &[&str]| Diagnosis {
            group: group.iter().map(|&name| name.to_owned()).collect(),
            warnings: vec!["a climb failed".to_owned()],
            ..Diagnosis::default()
        };
        let mut found = of(&["surge", "entrainment"]);
        found.check_rate(&of(&["entrainment", "surge"]));
        assert_eq!(found.warnings.len(), 1);
        found.check_rate(&of(&["surge"]));
        let said = "at half the rate the group is surge instead of \
                    entrainment, surge:";
        assert!(found.warnings[0].starts_with(said), "{:?}", found.warnings);
        assert_eq!(found.doubts, found.warnings[..1]);
    }
}
