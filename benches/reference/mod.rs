//! The event that every benchmark runs on: `tests/data/voellmy-21`.
#![allow(dead_code, reason = "not every bench needs all of it")]

use std::path::Path;

use couloir::Event;
use couloir::io::load;
use couloir::model;
use couloir::noise::Ar;
use couloir::physics::friction::{Laws, Voellmy};

model! {
    /// The paper's M1: Voellmy friction, AR(1) errors.
    pub(crate) struct M1 { event: Event }

    friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    errors ~ Ar { phi: [Uniform(-1.0, 1.0)], sigma2: InverseGamma(3.0, 20.0) };

    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

/// The synthetic event.
pub(crate) fn event() -> Event {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/voellmy-21");
    match load(Path::new(folder), &Laws::default()) {
        Ok(file) => file.event,
        Err(error) => panic!("{error}"),
    }
}

/// Parameters near the posterior's middle: mu, xi, phi, sigma2.
pub(crate) const MIDDLE: [f64; 4] = [0.25, 390.0, 0.58, 9.0];
