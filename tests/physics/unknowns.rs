//! Unknowns that depend on each other or may be data, what is kept, added
//! and solved for: against closed forms.

use std::f64::consts::PI;

use couloir::draws::Draws;
use couloir::infer::{LaplaceMixture, kept};
use couloir::model::Weights;
use couloir::ode;
use couloir::prelude::*;
use couloir::scalar::Plain;

/// ln of the standard normal density.
fn ln_normal(x: f64, mean: f64, sd: f64) -> f64 {
    let d = (x - mean) / sd;
    -0.5 * d * d - sd.ln() - 0.5 * (2.0 * PI).ln()
}

/// The probability of a standard normal number below x.
fn below(x: f64) -> f64 {
    0.5 * statrs::function::erf::erfc(-x / 2.0_f64.sqrt())
}

/// Compares ln evidence with what it is known to be: five standard errors.
#[track_caller]
fn check_evidence(model: &dyn Model, known: f64) {
    let posterior = Posterior::new(model).unwrap();
    let backend = ImportanceSampling::default();
    let found = infer(&backend, &posterior, Seed::new(1), &Quiet).unwrap();
    let found = found.evidence.unwrap();
    assert!(found.se < 0.02, "{}", found.se);
    let off = (found.log - known).abs();
    assert!(off < 5.0 * found.se, "{} {known}", found.log);
}

model! {
    struct Votes { votes: [u32; 3] }
    share[3] ~ Dirichlet([2.0, 1.0, 3.5]);
    likelihood {
        for (votes, share) in votes.iter().zip(&share) {
            if *votes > 0 {
                log_density += f64::from(*votes) * share.ln();
            }
        }
    }
}

#[test]
fn shares_have_the_evidence_of_polya() {
    // Γ(6.5)/Γ(16.5) Π Γ(a_i + n_i)/Γ(a_i), of the votes in their order.
    use statrs::function::gamma::ln_gamma;
    let votes = [4, 1, 5];
    let known = [2.0, 1.0, 3.5]
        .iter()
        .zip(votes)
        .fold(ln_gamma(6.5) - ln_gamma(16.5), |sum, (a, n)| {
            sum + ln_gamma(a + f64::from(n)) - ln_gamma(*a)
        });
    check_evidence(&Votes::new(votes), known);
}

model! {
    struct Two { y: [f64; 2] }
    mu[2] ~ Ordered(Normal(0.0, 1.0));
    likelihood {
        for (y, mu) in y.iter().zip(&mu) {
            y ~ Normal(*mu, 1.0);
        }
    }
}

#[test]
fn ordered_numbers_have_the_evidence_of_both_orders() {
    // mu_2 - mu_1 given y, without the order, is N((y_2 - y_1)/2, 1).
    let y = [0.7, 0.2];
    let each = |y| ln_normal(y, 0.0, 2.0_f64.sqrt());
    let order = 2.0 * below(0.5 * (y[1] - y[0]));
    let known = each(y[0]) + each(y[1]) + order.ln();
    check_evidence(&Two::new(y), known);
}

model! {
    struct Cut { y: f64 }
    mu ~ Truncated(Normal(0.0, 1.0), 0.0, f64::INFINITY);
    likelihood { y ~ Normal(mu, 1.0); }
}

#[test]
fn a_truncated_prior_has_the_evidence_of_its_half() {
    // mu given y, without the cut, is N(y/2, 1/2).
    for y in [-1.0, 0.4] {
        let known = ln_normal(y, 0.0, 2.0_f64.sqrt())
            + (2.0 * below(y / 2.0_f64.sqrt())).ln();
        check_evidence(&Cut::new(y), known);
    }
}

#[test]
fn draws_from_the_prior_keep_the_order_and_the_sum() {
    let votes = Votes::new([1, 1, 1]);
    let (two, seed) = (Two::new([0.0, 1.0]), Seed::new(3));
    let (two, votes) = (Posterior::new(&two), Posterior::new(&votes));
    let (two, votes) = (two.unwrap(), votes.unwrap());
    let mut rng = seed.rng();
    let n = 4000;
    let (mut first, mut lower) = (0.0, 0.0);
    for _ in 0..n {
        let mu = two.draw_prior(&mut rng).unwrap().1.natural;
        assert!(mu[0] < mu[1]);
        lower += mu[0] / f64::from(n);
        let share = votes.draw_prior(&mut rng).unwrap().1.natural;
        assert!(share.len() == 2 && share[0] + share[1] < 1.0);
        first += share[0] / f64::from(n);
    }
    // Means 2/6.5 and -1/sqrt(pi), with sds 0.17 and 0.83: five standard
    // errors.
    let se = 5.0 / f64::from(n).sqrt();
    assert!((first - 2.0 / 6.5).abs() < 0.17 * se, "{first}");
    assert!((lower + 1.0 / PI.sqrt()).abs() < 0.83 * se, "{lower}");
}

model! {
    struct Walk { seen: Vec<Option<f64>> }
    step ~ HalfNormal(1.0);
    x[i in 0..seen.len()] ~ Normal(
        if i > 0 { x[i - 1] } else { 0.0.into() },
        step,
    ) given seen[i];
    likelihood { 0.5 ~ Normal(x[2], 1.0); }
}

#[test]
fn a_missing_value_is_an_unknown_and_the_others_are_data() {
    let walk = Walk::new(vec![Some(1.0), None, Some(-0.5)]);
    let posterior = Posterior::new(&walk).unwrap();
    let names: Vec<_> =
        posterior.parameters().iter().map(|p| &p.name[..]).collect();
    assert_eq!(names, ["step", "x[2]"]);
    let (step, missing) = (0.8, 0.1);
    let found = posterior.density(Point::Natural(&[step, missing])).unwrap();
    let half = ln_normal(step, 0.0, 1.0) + 2.0_f64.ln();
    let prior = half + ln_normal(missing, 1.0, step);
    let data = ln_normal(1.0, 0.0, step)
        + ln_normal(-0.5, missing, step)
        + ln_normal(0.5, -0.5, 1.0);
    // A handful of roundings.
    assert!((found.log_prior - prior).abs() < 1e-13);
    assert!((found.log_likelihood - data).abs() < 1e-13);
}

model! {
    struct Keeping { y: Vec<f64> }
    mu ~ Normal(0.0, 1.0);
    keep twice = 2.0 * mu;
    likelihood {
        y ~ Normal(mu, 1.0);
        for i in 0..2 {
            keep power[i] = [mu, mu * twice];
        }
        keep next ~ Normal(mu, 1.0);
    }
}

#[test]
fn what_is_kept_stands_beside_the_draws() {
    let model = Keeping::new(vec![1.0; 8]);
    let posterior = Posterior::new(&model).unwrap();
    let backend = MetropolisHastings::default();
    let seed = Seed::new(5);
    let found = infer(&backend, &posterior, seed, &Quiet).unwrap();
    let (draws, kept_too) = (found.draws.unwrap(), found.kept.unwrap());
    assert_eq!(kept_too.variables(), ["twice", "power", "next"]);
    assert_eq!(kept_too.names()[2], "power[1,2]");
    let power = kept_too.array("power").unwrap();
    assert_eq!(power.shape, [4, draws.iterations(), 2, 2]);
    assert_eq!(draws.array("mu").unwrap().shape, [4, draws.iterations()]);
    for (row, kept) in draws.rows().zip(kept_too.rows()) {
        assert_eq!(kept[0], 2.0 * row[0]);
        assert_eq!(kept[4], 2.0 * row[0] * row[0]);
    }
    // y is N(8/9, 1/9) in mu, so that the next is N(8/9, 10/9): five
    // standard errors of 40 000 draws, of which about 1 in 8 counts.
    let next = kept_too.mean()[5];
    assert!((next - 8.0 / 9.0).abs() < 5.0 * (1.2 / 5000.0_f64).sqrt());
    let again = kept(&posterior, &draws, seed.called("kept")).unwrap();
    assert_eq!(again.unwrap(), kept_too);
}

model! {
    struct Clash { y: f64 }
    mu ~ Normal(0.0, 1.0);
    likelihood {
        y ~ Normal(mu, 1.0);
        for i in 0..2 { keep sum = mu + f64::from(i); }
    }
}

#[test]
fn two_kept_quantities_of_one_name_are_refused() {
    let clash = Clash::new(0.0);
    let posterior = Posterior::new(&clash).unwrap();
    let backend = LaplaceMixture::default();
    let error = infer(&backend, &posterior, Seed::new(1), &Quiet).unwrap_err();
    assert!(error.is_input());
    assert!(error.to_string().contains("two quantities are called sum"));
}

model! {
    /// Decay with a driving force: y' = -a y + b cos t.
    struct Driven { times: Vec<f64>, y: Vec<f64>, more: usize }
    a ~ LogNormal(0.0, 1.0);
    b ~ Normal(0.0, 1.0);
    start ~ Normal(0.0, 1.0);
    idle[more] ~ Normal(0.0, 1.0);
    likelihood {
        let _ = &idle;
        let path = ode::solve(
            |t, [y]| [-a * y + b * t.cos()],
            (0.0, [start]),
            times,
        )?;
        for (seen, [y]) in y.iter().zip(path) {
            seen ~ Normal(y, 0.1);
        }
    }
}

#[test]
fn a_solved_system_has_the_gradient_of_its_formula() {
    let (times, seen) = ([0.0, 0.7, 2.5], [0.3, 0.5, -0.1]);
    let exact = |a: f64, b: f64, start: f64| -> f64 {
        let forced = |t: f64| b * (a * t.cos() + t.sin()) / (a * a + 1.0);
        let at = |t: f64| (start - forced(0.0)) * (-a * t).exp() + forced(t);
        let all = times.iter().zip(seen);
        all.map(|(t, y)| ln_normal(y, at(*t), 0.1)).sum()
    };
    let (a, b, start) = (0.8_f64, 0.6, 0.4);
    // Below 17 unknowns derivatives are carried along, above a tape would be
    // used that does not know the solver.
    for more in [0, 20] {
        let model = Driven::new(times.to_vec(), seen.to_vec(), more);
        let posterior = Posterior::new(&model).unwrap();
        let mut z = vec![0.0; 3 + more];
        z[..3].copy_from_slice(&[a.ln(), b, start]);
        let mut gradient = vec![0.0; z.len()];
        let weights = Weights { prior: 0.0, jacobian: 0.0, likelihood: 1.0 };
        let found = posterior.gradient(&z, weights, &mut gradient).unwrap();
        // The solver's errors, some 1e-8 from step to step, times residuals
        // over variances of 1e-2.
        let off = (found.log_likelihood - exact(a, b, start)).abs();
        assert!(off < 1e-4, "{off}");
        let h = 1e-5;
        let by = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
        let known = [
            by(&|h| exact(a * h.exp(), b, start)),
            by(&|h| exact(a, b + h, start)),
            by(&|h| exact(a, b, start + h)),
        ];
        for (found, known) in gradient.iter().zip(known) {
            let off = (found - known).abs();
            assert!(off < 1e-3, "{off} {found} {known}");
        }
        assert!(gradient[3..].iter().all(|slope| *slope == 0.0));
    }
}

#[test]
fn systems_that_cannot_be_solved_are_rejected() {
    // y' = y^2 from 1 is infinite at t = 1.
    let rate = |_: f64, [y]: [Real; 1]| [y * y];
    let start = (0.0, [Real::new(1.0)]);
    let stop = ode::solve(rate, start, &[0.5, 2.0]).unwrap_err();
    assert!(matches!(stop, Stop::Reject(_)));
    for times in [vec![1.0, 0.5], vec![-1.0], vec![f64::NAN]] {
        let decay = |_: f64, [y]: [Real; 1]| [-y];
        let stop = ode::solve(decay, start, &times).unwrap_err();
        assert!(matches!(stop, Stop::Fail(_)));
    }
}

model! {
    struct Successes { y: u64, trials: f64 }
    p ~ Beta(2.0, 3.0);
    likelihood { y ~ Binomial(trials, p); }
}

#[test]
fn shares_of_trials_have_the_evidence_of_the_beta_binomial() {
    // C(10, y) B(2 + y, 3 + 10 - y) / B(2, 3).
    use statrs::function::beta::ln_beta;
    use statrs::function::factorial::ln_binomial;
    for y in [0, 7, 10] {
        let (won, lost) = (y as f64, 10.0 - y as f64);
        let known = ln_binomial(10, y) + ln_beta(2.0 + won, 3.0 + lost)
            - ln_beta(2.0, 3.0);
        check_evidence(&Successes::new(y, 10.0), known);
    }
}

model! {
    struct Gap { seen: [f64; 2] }
    mu ~ Mixture([0.5, 0.5], [Uniform(0.1, 0.2), Uniform(0.3, 0.4)]);
    top ~ HalfNormal(10.0);
    x[i in 0..2] ~ Uniform(0.0, top) given seen[i];
    last ~ Exponential(1.0);
    likelihood {
        log_density += 0.0 * (mu + last + x[0]);
    }
}

#[test]
fn a_prior_with_a_gap_in_its_middle_hides_nothing_behind_it() {
    // 0.25, the middle of mu, is in the gap, and 3 is above that of `top`.
    let model = Gap::new([3.0, f64::NAN]);
    let posterior = Posterior::new(&model).unwrap();
    let names = posterior.parameters().iter().map(|p| p.name.as_str());
    assert_eq!(names.collect::<Vec<_>>(), ["mu", "top", "x[2]", "last"]);
}

#[test]
fn what_depends_on_a_datum_is_simulated_from_the_one_that_was_made() {
    let model = Walk::new(vec![Some(0.0); 4000]);
    let made = simulate(&model, &[0.5], Seed::new(1)).unwrap().elements;
    let steps = made[..4000].windows(2).map(|pair| pair[1] - pair[0]);
    let sd = (steps.map(|d| d * d).sum::<f64>() / 3999.0).sqrt();
    // Of 4000 steps their sd is known to 0.006; were each made beside the
    // datum and not the one made before, it would be 0.7.
    assert!((sd - 0.5).abs() < 0.03, "{sd}");
}

model! {
    struct Sometimes { seen: [f64; 1] }
    mu ~ Normal(0.0, 1.0);
    likelihood {
        if mu.value() > 0.0 {
            keep big = mu;
        }
        seen[0] ~ Normal(mu, 1.0);
    }
}

#[test]
fn what_is_kept_at_some_draws_alone_is_refused() {
    let model = Sometimes::new([0.0]);
    let posterior = Posterior::new(&model).unwrap();
    for first in [-1.0, 1.0] {
        let mut draws =
            Draws::new(vec!["mu".into()], vec!["1".into()]).unwrap();
        draws.push_chain(vec![first, -first, 0.5, -0.5], None).unwrap();
        let error = kept(&posterior, &draws, Seed::new(1)).unwrap_err();
        assert!(error.to_string().contains("other quantities"), "{error}");
    }
}

#[test]
fn shares_that_are_nearly_nothing_are_still_inside() {
    let prior =
        couloir::prior::Dirichlet::new([0.02; 3].map(Real::<Plain>::new));
    let mut rng = Seed::new(1).rng();
    for _ in 0..2000 {
        let shares = couloir::prior::Joint::draw(&prior, 3, &mut rng).unwrap();
        // The last is what the others leave.
        let (last, others) = shares.split_last().unwrap();
        let inside = others.iter().all(|x| *x > 0.0 && *x < 1.0);
        assert!(inside && *last > 0.0, "{shares:?}");
    }
}
