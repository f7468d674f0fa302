//! Cases put to a diagnosis, one after the other or side by side.

use super::case::Case;
use super::score::{Answer, Outcome, Score};
use crate::error::Result;
use crate::infer::{Progress, part};
use crate::parallel;

/// What a diagnosis is for the challenge: an answer to a case.
///
/// It is handed the truth with the case, as a matter of convenience, and is
/// to look at the recordings only.
pub type Diagnose<'a> = dyn Fn(&Case) -> Result<Answer> + Sync + 'a;

/// All cases with their answers, and the score.
#[derive(Debug, Clone, PartialEq)]
pub struct Scored {
    /// Case by case, in their order.
    pub outcomes: Vec<Outcome>,
    /// The score.
    pub score: Score,
}

/// Puts cases to a diagnosis: side by side if `parallel`, otherwise one after
/// the other, for a diagnosis that uses all processors itself.
///
/// ```
/// use couloir::challenge::{Answer, Errors, Mix, cases, run};
/// use couloir::infer::Quiet;
/// let diagnose = |_: &_| Ok(Answer {
///     verdict: "adequate".into(),
///     probabilities: vec![("none".into(), 1.0)],
///     ..Answer::default()
/// });
/// let some = cases(2, 1, Mix::One, Errors::Simple)?;
/// let scored = run(&some, &diagnose, false, &Quiet)?;
/// assert_eq!(scored.score.false_alarms.hits, 0);
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// That of the first case, in their order, whose diagnosis fails.
pub fn run(
    cases: &[Case],
    diagnose: &Diagnose<'_>,
    parallel: bool,
    progress: &dyn Progress,
) -> Result<Scored> {
    progress.begin("diagnosing", Some(cases.len() as u64));
    let answer = |case: &Case| {
        let make = || diagnose(case).map_err(|e| e.within(&case.name));
        let answer = part(progress, &case.name, make)?;
        progress.advance(1);
        let (case, truth) = (case.name.clone(), case.truth.clone());
        Ok(Outcome { case, truth, answer })
    };
    let outcomes: Vec<Result<Outcome>> = if parallel {
        parallel::map(cases, answer)
    } else {
        cases.iter().map(answer).collect()
    };
    let outcomes = outcomes.into_iter().collect::<Result<Vec<_>>>()?;
    let score = Score::of(&outcomes);
    Ok(Scored { outcomes, score })
}
