//! What a diagnosis decides.

use crate::diagnosis::decide::chosen::Chosen;
use crate::diagnosis::evidence::fit::Fit;
use crate::diagnosis::evidence::table::Row;
use crate::diagnosis::findings::{
    Judged, JudgedNoise, Rival, Verdict, Withheld,
};
use crate::diagnosis::options::Options;
use crate::mechanism::Mechanism;

/// What was decided from the evidence.
pub(crate) struct Decision {
    /// Everything that was weighed, most probable first.
    pub(crate) judged: Vec<Judged>,
    /// The noises that are kept, most probable first.
    pub(crate) noises: Vec<JudgedNoise>,
    pub(crate) verdict: Verdict,
    /// Under which noise of the table the model goes on.
    pub(crate) row: usize,
    /// What is added to the model.
    pub(crate) chosen: Option<Chosen>,
    /// What does nearly as well as a force of free form that is not.
    pub(crate) equal: Option<Chosen>,
    /// What would be added if it did not make the fit worse.
    pub(crate) withheld: Option<Withheld>,
}

impl Decision {
    /// Whether the errors are all that is corrected.
    pub(crate) fn takes_noise(&self) -> bool {
        self.verdict == Verdict::Errors && self.withheld.is_none()
    }

    /// The noise of the corrected model: the named one where nothing is wrong,
    /// or where another makes the fit worse.
    pub(crate) fn noise(&self, row: &Row<'_>, options: &Options) -> String {
        let other = match self.verdict {
            Verdict::Adequate => options.infers_noise,
            Verdict::Errors => self.takes_noise(),
            _ => true,
        };
        if other { row.noisy.name.clone() } else { options.noise.clone() }
    }

    /// What would do nearly as well as what was decided.
    pub(crate) fn rivals(
        &self,
        all: &[Box<dyn Mechanism>],
        none: &Fit,
    ) -> Vec<Rival> {
        let of = |c: &Chosen| c.rivals(all, none);
        let mut rivals = self.chosen.as_ref().map(of).unwrap_or_default();
        rivals.extend(self.equal.iter().map(|c| c.as_rival(all, none)));
        rivals
    }
}
