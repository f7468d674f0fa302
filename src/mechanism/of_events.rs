//! What mechanisms of several events have in common.

use super::Unknown;

/// An unknown of one event, by its label.
pub(super) fn of_event(unknown: &Unknown, label: &str) -> Unknown {
    let name = format!("{label}.{}", unknown.name);
    Unknown { name, ..unknown.clone() }
}

/// What is said of a mechanism with others inside, it says by one of them.
macro_rules! says_as {
    ($inner:ident) => {
        fn name(&self) -> &'static str {
            self.$inner().name()
        }
        fn label(&self) -> String {
            self.$inner().label()
        }
        fn family(&self) -> Family {
            self.$inner().family()
        }
        fn is_each_events_own(&self) -> bool {
            self.$inner().is_each_events_own()
        }
        fn noun(&self, amplitude: f64) -> Noun {
            self.$inner().noun(amplitude)
        }
        fn says(&self) -> &'static str {
            self.$inner().says()
        }
        fn unknowns(&self) -> Vec<Unknown> {
            self.unknowns.clone()
        }
        fn coordinate(&self) -> Option<Axis> {
            self.$inner().coordinate()
        }
        fn form(&self) -> Option<&'static str> {
            self.$inner().form()
        }
        fn reach(&self, values: &[f64]) -> Option<Reach> {
            self.$inner().reach(values)
        }
        fn contained_in(&self) -> &'static [&'static str] {
            self.$inner().contained_in()
        }
        fn needs(&self) -> &'static [&'static str] {
            self.$inner().needs()
        }
        fn formula(&self) -> String {
            self.$inner().formula()
        }
    };
}

pub(super) use says_as;
