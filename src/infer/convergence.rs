//! Whether chains can be believed, after Vehtari, Gelman, Simpson, Carpenter,
//! Buerkner (2021): R-hat at most 1.01, and effective sizes of bulk and tail
//! of 100 for each chain at the least.

use super::inference::Inference;
use crate::draws::{Draws, Summary, summarise};
use crate::error::Result;
use crate::model::{Point, Posterior};

const HIGHEST_RHAT: f64 = 1.01;
const LEAST_EFFECTIVE: f64 = 100.0;

/// How many draws are asked whether the model has the same parameters there.
const ASKED: usize = 100;

/// Looks at the draws of a backend's chains: whether the model is the same
/// one at all of them, and whether the chains agree and are long enough.
pub(super) fn check(
    posterior: &Posterior<'_>,
    found: &mut Inference,
) -> Result<()> {
    let Some(draws) = &found.draws else { return Ok(()) };
    if !are_chains(draws) {
        return Ok(());
    }
    for row in draws.thinned(ASKED) {
        posterior.collect(Point::Natural(row))?;
    }
    found.summaries = summarise(draws);
    found.warnings.extend(convergence(&found.summaries, draws.chains()));
    Ok(())
}

/// Whether each draw followed from the one before it: what is resampled
/// comes as one set, and nothing was accepted.
fn are_chains(draws: &Draws) -> bool {
    draws.chains() > 1 || draws.acceptance().iter().any(|a| a.is_finite())
}

/// What to know of chains before trusting them; figures that do not exist,
/// of draws that are all the same, are as bad as poor ones.
pub(crate) fn convergence(
    summaries: &[Summary],
    chains: usize,
) -> Vec<String> {
    let effective = |s: &Summary| s.ess_bulk.min(s.ess_tail);
    let agrees = |s: &&Summary| s.rhat <= HIGHEST_RHAT;
    let least = LEAST_EFFECTIVE * chains as f64;
    let apart = Poor::of(summaries, |s| s.rhat, agrees);
    // What has no such number is worse than any.
    let lacks = |s: &Summary| match effective(s) {
        none if none.is_nan() => f64::INFINITY,
        some => -some,
    };
    let few = Poor::of(summaries, lacks, |s| effective(s) >= least);
    let mut warnings = Vec::new();
    if let Some(Poor { worst, others }) = apart {
        warnings.push(format!(
            "the chains have not agreed on {}{others} (R-hat {:.4}, should \
             be at most {HIGHEST_RHAT}): take more warmup and draws, or \
             compare with smc",
            worst.name, worst.rhat
        ));
    }
    if let Some(Poor { worst, others }) = few {
        warnings.push(format!(
            "only {:.0} effective draws of {}{others} (bulk {:.0}, tail \
             {:.0}; {least:.0} are enough): take more draws",
            effective(worst),
            worst.name,
            worst.ess_bulk,
            worst.ess_tail
        ));
    }
    warnings
}

/// The parameter that is worst off, and how many more are poor.
struct Poor<'s> {
    worst: &'s Summary,
    others: String,
}

impl<'s> Poor<'s> {
    fn of(
        summaries: &'s [Summary],
        badness: impl Fn(&Summary) -> f64,
        is_fine: impl Fn(&&Summary) -> bool,
    ) -> Option<Self> {
        let poor = || summaries.iter().filter(|s| !is_fine(s));
        let worst = poor().max_by(|a, b| badness(a).total_cmp(&badness(b)))?;
        let others = match poor().count() - 1 {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        Some(Self { worst, others })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Error, Outcome};
    use crate::infer::{
        Backend, Effort, MetropolisHastings, Quiet, Smc, infer,
    };
    use crate::model::{Label, Number, Program, Run};
    use crate::prior::Normal;
    use crate::scalar::Real;
    use crate::seed::Seed;

    /// What changes with the value of mu, or a funnel, or nothing.
    #[derive(Clone, Copy, PartialEq)]
    enum What {
        Number,
        Order,
        Funnel,
        Nothing,
    }

    impl Program for What {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let normal = || Normal::<K>::new(0.0, 1.0);
            let pure = |name| Label::new(name, "1");
            let mu = run.scalar(pure("mu"), normal())?;
            let above = mu > 0.0;
            match self {
                Self::Number => {
                    let n = if above { 2 } else { 1 };
                    run.vector(pure("z"), n, normal())?;
                }
                Self::Order => {
                    let names = if above { ["a", "b"] } else { ["b", "a"] };
                    for name in names {
                        run.scalar(pure(name), normal())?;
                    }
                }
                Self::Funnel => {
                    let wide = (4.0 * mu).exp();
                    run.scalar(pure("x"), Normal::new(0.0, wide))?;
                }
                Self::Nothing => {}
            }
            run.observe_each(&0.3, Normal::new(mu, Real::new(1.0)))
        }
    }

    const EFFORT: Effort = Effort { chains: 4, draws: 2000, warmup: 1000 };

    fn found(what: What, backend: &dyn Backend) -> Result<Inference> {
        let posterior = Posterior::new(&what)?;
        infer(backend, &posterior, Seed::new(1), &Quiet)
    }

    #[test]
    fn parameters_that_depend_on_a_value_stop_the_run() {
        let walks: [&dyn Backend; 3] = [
            &MetropolisHastings::adaptive(&EFFORT),
            &MetropolisHastings::random_walk(&EFFORT),
            &Smc::of_effort(&EFFORT),
        ];
        let stopped = |what, backend: &dyn Backend| -> Error {
            let error = found(what, backend).expect_err(backend.name());
            let text = error.to_string();
            assert!(error.is_input() && text.contains("must not depend"));
            assert!(text.contains("as many as there can be"), "{text}");
            error
        };
        for backend in walks {
            let error = stopped(What::Number, backend).to_string();
            assert!(error.contains("z[2]"), "{error}");
            let error = stopped(What::Order, backend).to_string();
            assert!(error.contains("declared a where it had b"), "{error}");
        }
    }

    #[test]
    fn chains_that_have_not_converged_are_warned_of() {
        let walks = [
            MetropolisHastings::adaptive(&EFFORT),
            MetropolisHastings::random_walk(&EFFORT),
        ];
        for walk in walks {
            let poor = found(What::Funnel, &walk).unwrap();
            let said = poor.warnings.join("; ");
            assert!(said.contains("R-hat"), "{said}");
            assert!(said.contains("effective draws"), "{said}");
            let fine = found(What::Nothing, &walk).unwrap();
            assert!(fine.warnings.is_empty(), "{:?}", fine.warnings);
            assert_eq!(fine.summaries.len(), 1);
        }
        // A set of particles is no chain.
        let found = found(What::Funnel, &Smc::of_effort(&EFFORT)).unwrap();
        assert!(found.summaries.is_empty());
    }

    fn summary(name: &str, rhat: f64, bulk: f64, tail: f64) -> Summary {
        let mut draws =
            Draws::new(vec![name.to_owned()], vec!["1".to_owned()]).unwrap();
        draws.push_chain(vec![1.0, 2.0], None).unwrap();
        let known = summarise(&draws).remove(0);
        Summary { rhat, ess_bulk: bulk, ess_tail: tail, ..known }
    }

    #[test]
    fn what_is_poor_is_told_once_with_the_worst() {
        let fine = summary("a", 1.01, 400.0, 400.0);
        assert!(convergence(std::slice::from_ref(&fine), 4).is_empty());
        let b = summary("b", 1.02, 400.0, 400.0);
        let c = summary("c", 1.3, 900.0, 399.0);
        let said = convergence(&[fine.clone(), b, c], 4);
        assert_eq!(said.len(), 2);
        assert!(said[0].contains("on c and 1 more (R-hat 1.300"), "{said:?}");
        assert!(said[1].contains("only 399 effective draws of c (bulk 900"));
        let stuck = summary("d", f64::NAN, f64::NAN, f64::NAN);
        let said = convergence(&[stuck, fine], 4);
        assert!(said[0].contains("on d (R-hat NaN"), "{said:?}");
        assert_eq!(said.len(), 2);
    }
}
