//! A Poisson regression: pairs of peregrine falcons counted in forty years,
//! of which the logarithm of the mean is a cubic of the year. Data simulated
//! by Kery and Schaub (2012, Bayesian Population Analysis using WinBUGS,
//! section 3.3).

use couloir::prelude::*;

// 2. The model. `year` is standardised.
model! {
    pub(crate) struct Falcons { year: Vec<f64>, count: Vec<u32> }

    alpha ~ Uniform(-20.0, 20.0);
    beta[3] ~ Uniform(-10.0, 10.0);

    likelihood {
        for (t, count) in year.iter().zip(count) {
            let cubic = (beta[2] * *t + beta[1]) * *t + beta[0];
            count ~ Poisson((alpha + cubic * *t).exp());
        }
        keep least = (alpha - beta[0]).exp();
    }
}

/// 1. The data.
pub(crate) fn falcons() -> Falcons {
    let count = [
        29, 36, 19, 28, 36, 29, 20, 19, 35, 32, 34, 34, 33, 47, 48, 46, 46,
        49, 60, 64, 87, 85, 85, 95, 115, 127, 142, 168, 181, 194, 200, 210,
        208, 235, 244, 272, 239, 263, 239, 245,
    ];
    let sd = (1599.0_f64 / 12.0 * 40.0 / 39.0).sqrt();
    let year = (0..40).map(|i| (f64::from(i) - 19.5) / sd);
    Falcons::new(year.collect(), count.to_vec())
}

fn main() -> Result<()> {
    // 3. The inference.
    let model = falcons();
    let posterior = Posterior::new(&model)?;
    let backend = MetropolisHastings::default();
    let found = infer(&backend, &posterior, Seed::new(1), &Quiet)?;

    // 4. The result.
    println!("{found}");
    Ok(())
}
