//! rustc: a struct that is no block.
use couloir::noise::Iid;
use couloir::{Event, model};

struct Own<S> {
    mu: S,
}

model! {
    pub struct Calibration { event: Event }

    friction ~ Own { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
