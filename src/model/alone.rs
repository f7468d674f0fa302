//! One of several events of a program, and what all of them have in common.

use super::any_program::AnyProgram;
use super::number::Number;
use super::program::Program;
use super::run::{Entered, Run};
use crate::error::Outcome;
use crate::mechanism::Unknown;

/// A program for one of its events alone; itself a program.
#[derive(Debug)]
pub(crate) struct Alone<'a> {
    program: &'a dyn AnyProgram,
    event: usize,
}

impl<'a> Alone<'a> {
    /// The program for its `event`-th event.
    pub(crate) fn new(program: &'a dyn AnyProgram, event: usize) -> Self {
        Self { program, event }
    }
}

impl Program for Alone<'_> {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        run.entering(Entered::Only(self.event), |run| self.program.run(run))
    }
}

/// The parameters that all events of a program have in common, those of
/// mechanisms first, under their priors; a program without data.
#[derive(Debug)]
pub(crate) struct Common<'a> {
    program: &'a dyn AnyProgram,
    added: Vec<Unknown>,
}

impl<'a> Common<'a> {
    /// What a program's events have in common, with what mechanisms add to
    /// it, by name.
    pub(crate) fn new(
        program: &'a dyn AnyProgram,
        added: Vec<Unknown>,
    ) -> Self {
        Self { program, added }
    }
}

impl Program for Common<'_> {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        run.amounts(&self.added)?;
        run.entering(Entered::Nothing, |run| self.program.run(run))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Label, Model, Posterior};
    use crate::prior::Normal;
    use crate::scalar::Real;

    /// Two events, each with a value of its own about a common centre; one
    /// more parameter, or value, stands after them.
    struct Two {
        late_parameter: bool,
        late_value: bool,
    }

    impl Program for Two {
        fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
            let label = |name| Label::new(name, "1");
            let about = |centre: Real<K>| Normal::new(centre, 1.0);
            let centre = run.scalar(label("centre"), about(Real::new(0.0)))?;
            for (i, event) in ["a", "b"].into_iter().enumerate() {
                run.of_event(i, event, |run| {
                    let own = run.scalar(label("own"), about(centre))?;
                    run.observe_each(&(i as f64), about(own))
                })?;
            }
            if self.late_parameter {
                run.scalar(label("late"), about(Real::new(0.0)))?;
            }
            if self.late_value {
                run.observe_each(&1.0, about(centre))?;
            }
            Ok(())
        }

        fn events(&self) -> usize {
            2
        }
    }

    #[test]
    fn an_event_alone_has_what_is_common_and_its_own() {
        let two = Two { late_parameter: false, late_value: false };
        let names = |program: &dyn Model| -> Vec<String> {
            let posterior = Posterior::new(program).unwrap();
            posterior.parameters().iter().map(|p| p.name.clone()).collect()
        };
        assert_eq!(names(&two), ["centre", "a.own", "b.own"]);
        assert_eq!(names(&Alone::new(&two, 1)), ["centre", "b.own"]);
        let common = Common::new(&two, Vec::new());
        assert_eq!(names(&common), ["centre"]);
    }

    #[test]
    fn what_is_of_no_event_comes_before_them_and_is_not_scored() {
        for late_parameter in [true, false] {
            let two = Two { late_parameter, late_value: !late_parameter };
            Posterior::new(&two).unwrap();
            let alone = Alone::new(&two, 0);
            assert!(Posterior::new(&alone).unwrap_err().is_input());
        }
    }
}
