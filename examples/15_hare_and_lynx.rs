//! A system of differential equations of one's own: hares and the lynxes that
//! eat them, as Lotka and Volterra have it. The pelts, in thousands, that the
//! Hudson's Bay Company took from 1900 to 1920 (Hewitt 1921), and the model
//! and priors of Carpenter's case study (2018, mc-stan.org).

use couloir::ode;
use couloir::prelude::*;

// 2. The model: y' = (alpha - beta lynx) hare, (-gamma + delta hare) lynx.
model! {
    pub(crate) struct Populations { hare: Vec<f64>, lynx: Vec<f64> }

    alpha ~ Truncated(Normal(1.0, 0.5), 0.0, f64::INFINITY);
    beta ~ Truncated(Normal(0.05, 0.05), 0.0, f64::INFINITY);
    gamma ~ Truncated(Normal(1.0, 0.5), 0.0, f64::INFINITY);
    delta ~ Truncated(Normal(0.05, 0.05), 0.0, f64::INFINITY);
    start[2] ~ LogNormal(10.0_f64.ln(), 1.0);
    sigma[2] ~ LogNormal(-1.0, 1.0);

    likelihood {
        let years: Vec<f64> = (0..hare.len()).map(|i| i as f64).collect();
        let path = ode::solve(
            |_, [u, v]| [(alpha - beta * v) * u, (-gamma + delta * u) * v],
            (0.0, [start[0], start[1]]),
            &years,
        )?;
        for (i, [u, v]) in path.into_iter().enumerate() {
            hare[i] ~ LogNormal(u.ln(), sigma[0]);
            lynx[i] ~ LogNormal(v.ln(), sigma[1]);
        }
        keep period = 2.0 * std::f64::consts::PI / (alpha * gamma).sqrt();
    }
}

/// 1. The data.
pub(crate) fn pelts() -> Populations {
    let hare = [
        30.0, 47.2, 70.2, 77.4, 36.3, 20.6, 18.1, 21.4, 22.0, 25.4, 27.1,
        40.3, 57.0, 76.6, 52.3, 19.5, 11.2, 7.6, 14.6, 16.2, 24.7,
    ];
    let lynx = [
        4.0, 6.1, 9.8, 35.2, 59.4, 41.7, 19.0, 13.0, 8.3, 9.1, 7.4, 8.0, 12.3,
        19.5, 45.7, 51.1, 29.7, 15.8, 9.7, 10.1, 8.6,
    ];
    Populations::new(hare.to_vec(), lynx.to_vec())
}

fn main() -> Result<()> {
    // 3. The inference.
    let model = pelts();
    let posterior = Posterior::new(&model)?;
    let found = infer(&Smc::default(), &posterior, Seed::new(1), &Quiet)?;

    // 4. The result: also the period of small oscillations, in years.
    println!("{found}");
    Ok(())
}
