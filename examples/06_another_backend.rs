//! A backend is one line too: the same posterior explored by all of them.

use couloir::infer::BACKENDS;
use couloir::prelude::*;

// 2. The model.
model! {
    struct Dragged { event: Event }

    friction ~ Coulomb { mu: Gamma(2.0, 0.02) }
        + Turbulent { xi: LogNormal(9.9, 1.0) };
    errors ~ Iid { sigma2: InverseGamma(2.0, 0.02) };

    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn main() -> Result<()> {
    // 1. The data: a car that coasted uphill, a real recording.
    let event = couloir::io::coastdown(&Laws::default())?.event;
    let model = Dragged::new(event);
    let posterior = Posterior::new(&model)?;

    // 3. The inference, by one backend after the other.
    let effort = Effort::new().chains(4).draws(5000).warmup(2500);
    for entry in BACKENDS {
        let backend = (entry.make)(&effort);
        let found = infer(backend.as_ref(), &posterior, Seed::new(1), &Quiet)?;

        // 4. The result: draws, an evidence or a mode, and what it cost.
        println!("{}: {}", entry.name, entry.about);
        println!("{} simulations", found.cost.simulations);
        println!("{found}");
    }
    Ok(())
}
