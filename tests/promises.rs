//! The four promises of ARCHITECTURE.md, each kept before one's eyes. Nothing
//! here is in the library: it is what a user would write.

use std::collections::BTreeMap;

use couloir::Declared;
use couloir::infer::Progress;
use couloir::model::Assembled;
use couloir::noise;
use couloir::prelude::*;

/// Speeds every second on 35 degrees under mu = 0.3; made up, without errors.
fn event() -> Event {
    let times: Vec<f64> = (1..=10).map(f64::from).collect();
    let a =
        9.81 * (35_f64.to_radians().sin() - 0.3 * 35_f64.to_radians().cos());
    let speeds = times.iter().map(|t| a * t).collect();
    Event::on(Track::incline(35.0, 1000.0).unwrap())
        .velocity(Series::velocity(times, speeds).unwrap())
        .build()
        .unwrap()
}

fn density(model: &dyn Model, values: &[f64]) -> f64 {
    let density = model.evaluate(Point::Natural(values), None).unwrap();
    assert_eq!(density.rejected, None);
    density.natural()
}

/// A model whose law is the one line that changes.
macro_rules! under {
    ($name:ident: $friction:ident ~ $($law:tt)*) => {
        model! {
            struct $name { event: Event }
            $friction ~ $($law)*;
            errors ~ Iid { sigma2: InverseGamma(3.0, 1.0) };
            likelihood {
                let flow = event.slide(&$friction)?;
                event.velocity ~ flow.velocity() + errors;
            }
        }
    };
}

under!(Dry: friction ~ Coulomb { mu: Gamma(9.0, 0.03) });
under!(Dragged: friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) });
under!(Summed: friction ~ Coulomb { mu: Gamma(9.0, 0.03) } + Cohesion { cohesion: Exponential(1.0) });

#[test]
fn swapping_the_law_is_one_line() {
    let names = |model: &dyn Model| {
        let posterior = Posterior::new(model).unwrap();
        let names = posterior.parameters().iter().map(|p| p.name.clone());
        names.collect::<Vec<_>>().join(" ")
    };
    assert_eq!(names(&Dry::new(event())), "mu sigma2");
    assert_eq!(names(&Dragged::new(event())), "mu xi sigma2");
    assert_eq!(names(&Summed::new(event())), "mu cohesion sigma2");
    let right = density(&Dry::new(event()), &[0.3, 0.1]);
    assert!(right > density(&Dry::new(event()), &[0.35, 0.1]) + 10.0);
}

/// A law of one's own: a road across the slope brakes beyond 400 m.
#[derive(Debug, Clone, Copy)]
struct Road<S> {
    brake: S,
}

impl<S: Copy> Block<S> for Road<S> {
    const NAME: &'static str = "road";
    const FIELDS: &'static [Field] =
        &[Field::new("brake", "m/s2", "Exponential(1)")];
    fn from_values(values: &[S]) -> Self {
        Self { brake: values[0] }
    }
}

impl<K: Kind> Friction<K> for Road<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::WithPlace
    }
    fn rate(&self, at: &Site, _: Real<K>) -> Rate<K> {
        let on = if at.distance > 400.0 { 1.0 } else { 0.0 };
        Rate { constant: self.brake * on, ..Rate::default() }
    }
}

under!(Crossed: friction ~ Coulomb { mu: Gamma(9.0, 0.03) } + Road { brake: Exponential(1.0) });

#[test]
fn a_new_law_works_in_the_language_and_by_its_name() {
    let compiled = Crossed::new(event());
    let laws = Laws::default().with(couloir::law!(Road));
    let sum = laws.parse("coulomb + road").unwrap();
    let errors = noise::parse("iid").unwrap();
    let priors = ["Gamma(9, 0.03)", "Exponential(1)", "InverseGamma(3, 1)"]
        .map(|text| couloir::prior::AnyPrior::parse(text).unwrap());
    let names = ["mu", "brake", "sigma2"].map(String::from);
    let priors = BTreeMap::from_iter(names.into_iter().zip(priors));
    let named = Assembled::new(event(), sum, errors, &priors).unwrap();
    for values in [[0.3, 0.5, 0.1], [0.25, 2.0, 1.0]] {
        let (a, b) = (density(&compiled, &values), density(&named, &values));
        assert!((a - b).abs() < 1e-12 * a.abs(), "{a} {b}");
    }
    assert!(Laws::default().parse("coulomb + road").is_err());
}

/// A backend of one's own: draws from the prior, weighed and kept or not.
#[derive(Debug)]
struct Rejection {
    tries: u64,
}

impl Backend for Rejection {
    fn name(&self) -> &'static str {
        "rejection"
    }

    fn explore(
        &self,
        posterior: &Posterior<'_>,
        seed: Seed,
        _: &dyn Progress,
    ) -> Result<Inference> {
        posterior.require_proper(self.name())?;
        let mut rng = seed.rng();
        let mut found = Vec::new();
        for _ in 0..self.tries {
            let (density, said) = posterior.draw_prior(&mut rng)?;
            if density.rejected.is_none() {
                found.push((density.log_likelihood, said.natural));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.truncate(found.len() / 100);
        let rows = found.into_iter().flat_map(|(_, row)| row).collect();
        let parameters = posterior.parameters();
        let mut draws = couloir::draws::Draws::new(
            parameters.iter().map(|p| p.name.clone()).collect(),
            parameters.iter().map(|p| p.unit.clone()).collect(),
        )?;
        draws.push_chain(rows, None)?;
        Ok(Inference::of_draws(draws))
    }
}

#[test]
fn a_new_backend_runs_on_any_posterior() {
    let (dry, dragged) = (Dry::new(event()), Dragged::new(event()));
    let models: [&dyn Model; 2] = [&dry, &dragged];
    for model in models {
        let posterior = Posterior::new(model).unwrap();
        let backend = Rejection { tries: 2000 };
        let found = infer(&backend, &posterior, Seed::new(1), &Quiet).unwrap();
        assert_eq!(found.cost.densities, 2000);
        assert!(found.cost.simulations >= 1900);
        let draws = found.draws.unwrap();
        assert_eq!(draws.dimension(), posterior.dimension());
        let mu = draws.mean()[0];
        assert!((mu - 0.3).abs() < 0.1, "{mu}");
    }
}

/// A change from outside: whatever law it holds, more of it from a place on.
#[derive(Debug, Clone, Copy)]
struct Harder<L, S> {
    law: L,
    delta_mu: S,
    from: f64,
}

impl<K: Kind, L: Friction<K>> Friction<K> for Harder<L, Real<K>> {
    fn varies(&self) -> Varies {
        self.law.varies().max(Varies::WithPlace)
    }
    fn rate(&self, at: &Site, speed: Real<K>) -> Rate<K> {
        let mut rate = self.law.rate(at, speed);
        if at.distance > self.from {
            rate.mu += self.delta_mu;
        }
        rate
    }
}

// The decorated law in a model: the base is declared, the change wraps it.
model! {
    struct Changed { event: Event, from: f64 }

    base ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
    delta_mu ~ Normal(0.0, 0.15);
    errors ~ Iid { sigma2: InverseGamma(3.0, 1.0) };

    likelihood {
        let friction = Declared::new(
            Harder { law: *base, delta_mu, from },
            base.context(),
        );
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

#[test]
fn a_change_wraps_a_declared_law_from_outside() {
    let same = density(&Dragged::new(event()), &[0.3, 900.0, 0.1]);
    let prior = -(0.15_f64 * (2.0 * std::f64::consts::PI).sqrt()).ln();
    // Zero amplitude gives the base model back, as does a far place.
    let none = density(&Changed::new(event(), 0.0), &[0.3, 900.0, 0.0, 0.1]);
    assert!((none - same - prior).abs() < 1e-9, "{none} {same}");
    let moved = density(&Changed::new(event(), 0.0), &[0.3, 900.0, -0.1, 0.1]);
    assert!((moved - none).abs() > 1.0);
    let far = density(&Changed::new(event(), 900.0), &[0.3, 900.0, -0.1, 0.1]);
    let here = density(&Changed::new(event(), 900.0), &[0.3, 900.0, 0.0, 0.1]);
    let prior = -0.5 * (0.1_f64 / 0.15).powi(2);
    assert!((far - here - prior).abs() < 1e-9, "{far} {here}");

    // It is a model like any other: its gradient is exact.
    let model = Changed::new(event(), 0.0);
    let posterior = Posterior::new(&model).unwrap();
    let z = posterior.line(&[0.28, 900.0, 0.05, 0.5]).unwrap();
    let mut gradient = [0.0; 4];
    let at = |z: &[f64]| posterior.density(Point::Line(z)).unwrap().on_line();
    let weights = couloir::model::Weights::LINE;
    posterior.gradient(&z, weights, &mut gradient).unwrap();
    for (i, slope) in gradient.into_iter().enumerate() {
        let (mut up, mut down) = (z.clone(), z.clone());
        up[i] += 1e-5;
        down[i] -= 1e-5;
        let difference = (at(&up) - at(&down)) / 2e-5;
        let error = (slope - difference).abs();
        assert!(error < 1e-5 * slope.abs().max(1.0), "{slope} {difference}");
    }
}
