use couloir::mechanism::catalogue::find;
use couloir::infer::Evidence;
use couloir::model::With;
use couloir::prelude::*;

model! {
    struct Before { event: Event }
    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 0.02) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn evidence(event: Event) -> Result<Option<Evidence>> {
    let extent = event.extent();
    let before = Before::new(event);
    let added_0 = find("turbulent-drag", &extent, &[])?;
    let corrected = With::new(&before, &[added_0.as_ref()]);
    let posterior = Posterior::new(&corrected)?;
    let found = infer(&Smc::default(), &posterior, Seed::new(1), &Quiet)?;
    Ok(found.evidence)
}
