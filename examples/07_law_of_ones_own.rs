//! A law of one's own, used like a built-in one: in `model!`, and by its name
//! in the command that this program becomes when it gets arguments, such as
//! `calibrate --friction "coulomb + air-drag"`.

use couloir::prelude::*;
use std::process::ExitCode;

/// Air drag of the car, 1910 kg with 2.15 m2, in a head wind of 3.1 m/s:
/// r = k (u + w)^2 = k w^2 + 2 k w u + k u^2.
struct AirDrag<S> {
    cd: S,
}

impl<S: Copy> Block<S> for AirDrag<S> {
    const NAME: &'static str = "air-drag";
    const FIELDS: &'static [Field] =
        &[Field::new("cd", "1", "LogNormal(-1, 0.5)")];
    fn from_values(values: &[S]) -> Self {
        Self { cd: values[0] }
    }
}

impl<K: Kind> Friction<K> for AirDrag<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::Nowhere
    }
    fn rate(&self, _: &Site, _: Real<K>) -> Rate<K> {
        let (k, w) = (self.cd * (0.5 * 1.06 * 2.15 / 1910.0), 3.1);
        let (constant, linear) = (k * w * w, 2.0 * k * w);
        Rate { constant, linear, quadratic: k, ..Rate::default() }
    }
}

// 2. The model.
model! {
    struct Own { event: Event }
    friction ~ Coulomb { mu: Gamma(2.0, 0.02) } + AirDrag { cd: LogNormal(-1.0, 0.5) };
    errors ~ Iid { sigma2: InverseGamma(2.0, 0.02) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() -> Result<ExitCode> {
    let laws = Laws::default().with(couloir::law!(AirDrag));
    if std::env::args().len() > 1 {
        return Ok(couloir::cli::main_with(&laws));
    }
    // 1. The data: a car that coasted uphill, a real recording.
    let model = Own::new(couloir::io::coastdown(&laws)?.event);
    // 3. The inference.
    let (backend, posterior) = (Smc::default(), Posterior::new(&model)?);
    let found = infer(&backend, &posterior, Seed::new(1), &Quiet)?;
    // 4. The result: the report that the recording is from says 0.348.
    println!("{found}");
    Ok(ExitCode::SUCCESS)
}
