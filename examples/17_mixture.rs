//! Two groups that nobody told apart, and a measurement that was lost: a
//! mixture with its centres in order, shares that sum to 1, a missing value,
//! and what is kept beside the parameters. Synthetic data.

use couloir::prelude::*;

// 2. The model: sizes of a mixed sample, and weights that follow from them.
model! {
    struct Sample { size: Vec<f64>, weight: Vec<f64>, lost: Vec<f64> }

    share[2] ~ Dirichlet([5.0, 5.0]);
    centre[2] ~ Ordered(Normal(0.0, 10.0));
    spread[2] ~ HalfNormal(2.0);
    slope ~ Normal(0.0, 1.0);
    x[i in 0..lost.len()] ~ Normal(centre[1], spread[1]) given lost[i];

    likelihood {
        for size in size {
            size ~ Mixture(&share, [
                Normal(centre[0], spread[0]),
                Normal(centre[1], spread[1]),
            ]);
        }
        for (weight, x) in weight.iter().zip(&x) {
            weight ~ Normal(slope * *x, 0.5);
        }
        keep apart = centre[1] - centre[0];
        keep next ~ Normal(centre[1], spread[1]);
    }
}

fn main() -> Result<()> {
    // 1. The data: synthetic, centres -3 and 3, spreads 1, slope 2. The size
    // of the third of three large ones was lost, its weight was not.
    let step = |i: i32| f64::from(i) / 20.0 - 1.0;
    let of = |centre: f64| (0..40).map(move |i| centre + 1.7 * step(i));
    let size = of(-3.0).chain(of(3.0)).collect();
    let lost = vec![2.5, 3.5, f64::NAN];
    let model = Sample::new(size, vec![5.2, 6.9, 8.0], lost);

    // 3. The inference.
    let posterior = Posterior::new(&model)?;
    let found = infer(&Smc::default(), &posterior, Seed::new(1), &Quiet)?;

    // 4. The result: x[3] is near 4, and weight and size agree.
    println!("{found}");
    Ok(())
}
