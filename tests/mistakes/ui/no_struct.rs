//! A model without data.
use couloir::model;

model! {
    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 20.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() {}
