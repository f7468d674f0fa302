//! What was chosen to be added to a model.

use std::f64::consts::LN_10;
use std::ops::Range;

use crate::diagnosis::compare::checks::rows_of;
use crate::diagnosis::decide::added::Added;
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::findings::{Judged, ParameterSummary, Rival};
use crate::draws::summarise;
use crate::mechanism::{Family, Mechanism};

/// What was chosen to be added to the model.
#[derive(Debug, Clone)]
pub(crate) struct Chosen {
    /// Which of the catalogue.
    pub(crate) which: Vec<usize>,
    pub(crate) fit: Fit,
    /// By how much more, in ln, it is worth where other noises count too.
    pub(crate) gain: f64,
    /// What would do nearly as well in its place, with ln of its evidence.
    pub(crate) rivals: Vec<(Vec<usize>, f64)>,
}

impl Chosen {
    pub(crate) fn new(which: Vec<usize>, fit: Fit) -> Self {
        Self { which, fit, gain: 0.0, rivals: Vec::new() }
    }

    /// What would do nearly as well, most evidence first.
    pub(crate) fn rivals(
        &self,
        all: &[Box<dyn Mechanism>],
        none: &Fit,
    ) -> Vec<Rival> {
        let rivals = self.rivals.iter();
        rivals.map(|(which, log)| rival(which, *log, all, none)).collect()
    }

    /// The same of the chosen themselves.
    pub(crate) fn as_rival(
        &self,
        all: &[Box<dyn Mechanism>],
        none: &Fit,
    ) -> Rival {
        rival(&self.which, self.fit.log_evidence, all, none)
    }

    /// Calls the chosen mechanisms by the signs that they have together: one
    /// that pushes alone may brake beside another.
    pub(crate) fn call(
        &self,
        judged: &mut [Judged],
        all: &[Box<dyn Mechanism>],
    ) {
        let columns = summarise(&self.fit.draws);
        for (mechanism, own) in self.columns(all) {
            let Some(column) = columns.get(own.start) else { continue };
            let amplitude = ParameterSummary::of(column).signed();
            let named = judged.iter_mut().find(|m| m.name == mechanism.name());
            if let Some(named) = named {
                named.noun = mechanism.noun(amplitude);
            }
        }
    }

    /// The family of all together: of the physics, where one of them is.
    pub(crate) fn family(&self, all: &[Box<dyn Mechanism>]) -> Option<Family> {
        self.mechanisms(all).iter().map(|m| m.family()).min()
    }

    /// The mechanisms themselves.
    pub(crate) fn mechanisms<'a>(
        &self,
        all: &'a [Box<dyn Mechanism>],
    ) -> Vec<&'a dyn Mechanism> {
        self.which.iter().map(|&i| all[i].as_ref()).collect()
    }

    /// The mechanisms with the columns of their parameters in the draws.
    pub(crate) fn columns<'a>(
        &self,
        all: &'a [Box<dyn Mechanism>],
    ) -> Vec<(&'a dyn Mechanism, Range<usize>)> {
        let mut end = 0;
        let mechanisms = self.mechanisms(all).into_iter();
        mechanisms
            .map(|mechanism| {
                let begin = end;
                end += mechanism.unknowns().len();
                (mechanism, begin..end)
            })
            .collect()
    }

    /// The mechanisms with their draws.
    pub(crate) fn added<'a>(
        &self,
        all: &'a [Box<dyn Mechanism>],
    ) -> Vec<Added<'a>> {
        let rows = rows_of(&self.fit.draws);
        let (mu, columns) = (self.mu(), self.columns(all).into_iter());
        columns.map(|(m, own)| Added::new(m, &rows, own, mu)).collect()
    }

    /// The column of the law's dry friction.
    fn mu(&self) -> Option<usize> {
        let is_mu = |name: &String| name == "mu" || name.ends_with(".mu");
        self.fit.draws.names().iter().position(is_mu)
    }

    /// Whether a law with dry friction keeps some of it wherever they act, in
    /// most draws.
    pub(crate) fn leaves_friction(&self, all: &[Box<dyn Mechanism>]) -> bool {
        let Some(mu) = self.mu() else { return true };
        let rows = rows_of(&self.fit.draws);
        let mut left: Vec<f64> = rows.iter().map(|row| row[mu]).collect();
        for added in self.added(all) {
            let taken = added.friction_taken();
            left.iter_mut().zip(taken).for_each(|(left, it)| *left -= it);
        }
        2 * left.iter().filter(|left| **left > 0.0).count() > left.len()
    }
}

fn rival(
    which: &[usize],
    log_evidence: f64,
    all: &[Box<dyn Mechanism>],
    none: &Fit,
) -> Rival {
    Rival {
        names: which.iter().map(|&i| all[i].name().to_owned()).collect(),
        log10_bayes_factor: (log_evidence - none.log_evidence) / LN_10,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;
    use crate::mechanism::catalogue::find;
    use crate::observe::{Event, Series};
    use crate::physics::Track;

    /// Two mechanisms chosen, with one draw of their parameters and mu.
    fn leaves(labels: [&str; 2], names: &[&str], draw: &[f64]) -> bool {
        let track = Track::incline(35.0, 500.0).unwrap();
        let seen = Series::velocity(vec![1.0, 20.0], vec![2.0, 20.0]);
        let event = Event::on(track).velocity(seen.unwrap()).build().unwrap();
        let extent = event.extent();
        let all = labels.map(|label| find(label, &extent, &[]).unwrap());
        let names: Vec<String> = names.iter().map(|n| n.to_string()).collect();
        let units = names.iter().map(|_| "1".to_owned()).collect();
        let mut draws = Draws::new(names, units).unwrap();
        draws.push_chain(draw.to_vec(), None).unwrap();
        let (best, warnings) = (draw.to_vec(), Vec::new());
        let added = all.iter().map(|m| m.unknowns().len()).sum();
        let (log_evidence, se) = (0.0, 0.0);
        let fit = Fit { log_evidence, se, draws, best, added, warnings };
        Chosen::new(vec![0, 1], fit).leaves_friction(&all)
    }

    #[test]
    fn terms_that_leave_no_friction_are_told_from_those_that_do() {
        let labels = ["turbulent-drag", "friction-step(distance)"];
        let names = ["drag", "delta_mu", "from", "mu"];
        assert!(leaves(labels, &names, &[0.001, -0.1, 50.0, 0.2]));
        assert!(!leaves(labels, &names, &[0.001, -0.3, 50.0, 0.2]));
        assert!(leaves(labels, &names, &[0.001, 0.3, 50.0, 0.2]));
        // A law without dry friction has none to lose.
        let names = ["drag", "delta_mu", "from", "xi"];
        assert!(leaves(labels, &names, &[0.001, -0.3, 50.0, 0.2]));
        // What two of them take adds up.
        let labels = ["friction-patch", "friction-step(distance)"];
        let names = ["delta_mu", "from", "length", "delta_mu2", "at", "mu"];
        let draw = |mu: f64| [-0.15, 10.0, 40.0, -0.1, 20.0, mu];
        assert!(leaves(labels, &names, &draw(0.3)));
        assert!(!leaves(labels, &names, &draw(0.2)));
    }
}
