//! The language: what `model!` accepts, what it makes of it, and the words
//! with which it refuses the rest.

use couloir::block::{Block, Field};
use couloir::model::{Collector, Point, Program, Weights};
use couloir::noise::{Ar, Iid};
use couloir::physics::friction::{Cohesion, Coulomb, Turbulent, Voellmy};
use couloir::physics::friction::{Friction, Rate, Site, Varies};
use couloir::physics::{Sum, Track};
use couloir::prior::{Gamma, InverseGamma, Normal, Prior, Support, Uniform};
use couloir::scalar::Kind;
use couloir::seed::Rng;
use couloir::{
    Event, Label, Model, Number, Outcome, Real, Result, Run, Seed, Series,
    model,
};

#[test]
fn mistakes_are_refused_in_plain_words() {
    let cases = trybuild::TestCases::new();
    cases.compile_fail("tests/ui/*.rs");
    cases.pass("tests/ui/pass/*.rs");
}
