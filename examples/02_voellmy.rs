//! Another law is one line: Voellmy's adds a drag that grows with the square
//! of the speed. The evidence says how much better it explains the speeds.

use couloir::prelude::*;

// 2. The models: they differ in one line, and in the field that it brings.
model! {
    struct Dry { event: Event }

    friction ~ Coulomb { mu: Gamma(2.0, 0.02) };
    errors ~ Iid { sigma2: InverseGamma(2.0, 0.02) };

    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

model! {
    struct Dragged { event: Event }

    friction ~ Voellmy { mu: Gamma(2.0, 0.02), xi: LogNormal(9.9, 1.0) };
    errors ~ Iid { sigma2: InverseGamma(2.0, 0.02) };

    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() -> Result<()> {
    // 1. The data: a car that coasted uphill, a real recording.
    let event = couloir::io::coastdown(&Laws::default())?.event;

    // 3. The inference: importance sampling yields draws and the evidence.
    let explore = |model: &dyn Model| {
        let posterior = Posterior::new(model)?;
        let backend = ImportanceSampling::default();
        infer(&backend, &posterior, Seed::new(1), &Quiet)
    };
    let dry = explore(&Dry::new(event.clone()))?;
    let dragged = explore(&Dragged::new(event))?;

    // 4. The result.
    println!("Coulomb\n{dry}\nVoellmy\n{dragged}");
    if let (Some(dry), Some(dragged)) = (dry.evidence, dragged.evidence) {
        let factor = (dragged.log - dry.log) / std::f64::consts::LN_10;
        println!("log10 Bayes factor for Voellmy: {factor:.1}");
    }
    Ok(())
}
