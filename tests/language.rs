//! The language: what `model!` accepts, and what it makes of it. What it
//! refuses is tested by the package in tests/mistakes.

mod accepted;

use couloir::block::{Block, Field, List};
use couloir::model::{Collected, Collector, Point, Weights};
use couloir::noise::{Ar, Iid};
use couloir::physics::friction::{Cohesion, Coulomb, Turbulent, Voellmy};
use couloir::physics::friction::{Friction, Rate, Site, Varies};
use couloir::physics::{Sum, Track};
use couloir::prior::{
    Distribution, Gamma, InverseGamma, Normal, Prior, Support, Uniform,
};
use couloir::scalar::Kind;
use couloir::seed::Rng;
use couloir::{
    Declared, Event, Label, Model, Number, Outcome, Program, Real, Run, Seed,
    Series, Stop, model,
};

fn event(velocity: &[f64]) -> Event {
    let build = || {
        let times = (1..=velocity.len()).map(|i| i as f64).collect();
        let track =
            Track::from_points(&[0.0, 200.0, 600.0], &[150.0, 30.0, 0.0])?;
        let series = Series::velocity(times, velocity.to_vec())?;
        Event::on(track).depth(1.5).velocity(series).build()
    };
    build().expect("an event")
}

/// What a model says at a draw from its prior.
fn at_prior(model: &dyn Model, seed: Seed) -> Collected {
    let mut rng = seed.rng();
    let mut collector = Collector::default();
    let at = Point::Prior(&mut rng);
    model.evaluate(at, Some(&mut collector)).expect("a density");
    collector.collected
}

fn names(model: &dyn Model) -> Vec<String> {
    at_prior(model, Seed::new(1)).names
}

model! {
    /// Everything the language has, once.
    #[derive(Debug, Clone)]
    pub(crate) struct Whole {
        event: Event,
        /// Several events.
        events: Vec<Event>,
        runout: f64,
        n: usize,
    }

    /// The mean friction of all events.
    centre ~ Normal(0.3, 0.02);
    spread ~ Gamma(20.0, 0.001);
    z[events.len()] ~ Normal(0.0, 1.0);
    let drag = 1000.0 + 100.0 * centre;
    shift[i in 0..n] ~ Normal(z[i], 0.1);
    friction ~ Voellmy { mu: Normal(centre, spread), xi = drag };
    sum ~ Coulomb { mu: Gamma(90.0, 0.003) }
        + Turbulent { xi: Gamma(25.0, 40.0) }
        + Cohesion { cohesion = 0.1 * spread };
    own[i in 0..n] ~ Coulomb { mu = centre + spread * shift[i] };
    each[i in 0..n] ~ Voellmy { mu: Normal(centre, spread), xi = 900.0 };
    errors ~ Ar {
        phi: [Uniform(-0.9, 0.9), Normal(0.0, 0.1)],
        sigma2: InverseGamma(3.0, 20.0),
    };
    more ~ Ar { phi: [Uniform(-0.5, 0.5); n], sigma2 = 2.0 };
    known ~ Ar { phi = [0.1, 0.1 * centre], sigma2 = errors.sigma2 };

    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
        runout ~ Normal(flow.runout()?, 5.0);
        event.velocity ~ event.slide(&sum)?.velocity() + more;
        for (event, friction) in events.iter().zip(&own) {
            let flow = event.slide(friction)?;
            event.velocity ~ flow.velocity() + known;
        }
        for (i, event) in events.iter().enumerate() {
            if i > 0 {
                let flow = event.slide(&each[i])?;
                match event.velocity.is_empty() {
                    false => event.velocity ~ flow.velocity() + errors,
                    true => {}
                }
            }
        }
    }
}

/// [`Whole`] by hand.
struct Twin(Whole);

fn one(name: &str) -> Label<'_> {
    Label::new(name, "1")
}

/// The block `sum`.
fn summed<'r, K: Number>(
    run: &mut Run<'r, K>,
    spread: Real<K>,
) -> Result<Declared<'r, K, Sums<Real<K>>>, Stop> {
    let mu = run.scalar(one("sum.mu"), Gamma::new(90.0, 0.003))?;
    let label = Label::new("xi", "m/s2");
    let xi = run.scalar(label, Gamma::new(25.0, 40.0))?;
    let cohesion = Cohesion { cohesion: 0.1 * spread };
    let sum = Sum::new(Coulomb { mu }, Turbulent { xi });
    Ok(run.declare(Sum::new(sum, cohesion)))
}

type Sums<S> = Sum<Sum<Coulomb<S>, Turbulent<S>>, Cohesion<S>>;

/// The block `errors`.
fn errors<'r, K: Number>(
    run: &mut Run<'r, K>,
) -> Result<Declared<'r, K, Ar<Real<K>>>, Stop> {
    let label = one("errors.phi");
    let phi = [
        run.scalar(label.at(0), Uniform::new(-0.9, 0.9))?,
        run.scalar(label.at(1), Normal::new(0.0, 0.1))?,
    ];
    let label = Label::new("sigma2", Ar::<Real<K>>::unit("sigma2"));
    let sigma2 = run.scalar(label, InverseGamma::new(3.0, 20.0))?;
    Ok(run.declare(Ar { phi: phi.into_iter().collect(), sigma2 }))
}

impl Program for Twin {
    fn run<K: Number>(&self, run: &mut Run<'_, K>) -> Outcome {
        let Whole { event, events, runout, n } = &self.0;
        let centre = run.scalar(one("centre"), Normal::new(0.3, 0.02))?;
        let spread = run.scalar(one("spread"), Gamma::new(20.0, 0.001))?;
        let standard = Normal::<K>::new(0.0, 1.0);
        let z = run.vector(one("z"), events.len(), standard)?;
        let drag = 1000.0 + 100.0 * centre;
        let mut shift = List::new();
        for i in 0..*n {
            let prior = Normal::new(z[i], 0.1);
            shift.push(run.scalar(one("shift").at(i), prior)?);
        }
        let around = Normal::new(centre, spread);
        let mu = run.scalar(one("friction.mu"), around)?;
        let friction = run.declare(Voellmy { mu, xi: drag });
        let sum = summed(run, spread)?;
        let own = shift.iter().map(|shift| centre + spread * shift);
        let own: Vec<_> = own.map(|mu| run.declare(Coulomb { mu })).collect();
        let mut each = Vec::new();
        for i in 0..*n {
            let mu = run.scalar(one("each.mu").at(i), around)?;
            each.push(run.declare(Voellmy { mu, xi: 900.0.into() }));
        }
        let errors = errors(run)?;
        let half = Uniform::<K>::new(-0.5, 0.5);
        let phi = run.vector(one("more.phi"), *n, half)?;
        let more = run.declare(Ar { phi, sigma2: Real::new(2.0) });
        let phi = [Real::new(0.1), 0.1 * centre].into_iter().collect();
        let known = run.declare(Ar { phi, sigma2: errors.sigma2 });

        let flow = event.slide(&friction)?;
        run.observe(&event.velocity, flow.velocity(), &errors)?;
        run.observe_each(runout, Normal::<K>::new(flow.runout()?, 5.0))?;
        let flow = event.slide(&sum)?;
        run.observe(&event.velocity, flow.velocity(), &more)?;
        for (event, friction) in events.iter().zip(&own) {
            let flow = event.slide(friction)?;
            run.observe(&event.velocity, flow.velocity(), &known)?;
        }
        for (event, friction) in events.iter().zip(&each).skip(1) {
            let flow = event.slide(friction)?;
            run.observe(&event.velocity, flow.velocity(), &errors)?;
        }
        Ok(())
    }
}

fn whole() -> Whole {
    let one = event(&[2.8, 5.5, 8.0, 10.1, 12.0]);
    let two = event(&[2.5, 5.1, 7.7, 10.0]);
    Whole::new(one.clone(), vec![one, two], 300.0, 2)
}

#[test]
fn the_expansion_is_what_one_would_write_by_hand() {
    let (model, twin) = (whole(), Twin(whole()));
    let mut finite = 0;
    for i in 0..40 {
        let seed = Seed::new(7).child(i);
        let at = at_prior(&model, seed);
        assert_eq!(at, at_prior(&twin, seed));
        let (mut ours, mut theirs) =
            (vec![0.0; at.line.len()], vec![0.0; at.line.len()]);
        let weights = Weights::LINE;
        let density = model.gradient(&at.line, weights, &mut ours).unwrap();
        let other = twin.gradient(&at.line, weights, &mut theirs).unwrap();
        assert_eq!((density, &ours), (other, &theirs));
        finite += usize::from(density.on_line().is_finite());
        assert!(ours.iter().all(|slope| slope.is_finite()));
    }
    assert!(finite >= 20, "{finite}");
}

#[test]
fn unknowns_are_named_as_the_language_says() {
    assert_eq!(
        names(&whole()),
        [
            "centre",
            "spread",
            "z[1]",
            "z[2]",
            "shift[1]",
            "shift[2]",
            "friction.mu",
            "sum.mu",
            "xi",
            "each.mu[1]",
            "each.mu[2]",
            "errors.phi[1]",
            "errors.phi[2]",
            "sigma2",
            "more.phi[1]",
            "more.phi[2]",
        ]
    );
    let units = at_prior(&whole(), Seed::new(1)).units;
    assert_eq!([&units[6], &units[8]], ["1", "m/s2"]);
}

/// A law of one's own: r = a s, growing with the distance.
#[derive(Debug, Clone, Copy)]
struct Growing<S> {
    a: S,
}

impl<S: Copy> Block<S> for Growing<S> {
    const NAME: &'static str = "growing";
    const FIELDS: &'static [Field] = &[Field::new("a", "1/s2", "Flat()")];

    fn from_values(values: &[S]) -> Self {
        Self { a: values[0] }
    }
}

impl<K: Kind> Friction<K> for Growing<Real<K>> {
    fn varies(&self) -> Varies {
        Varies::WithPlace
    }

    fn rate(&self, at: &Site, _: Real<K>) -> Rate<K> {
        Rate { constant: self.a * at.distance, ..Rate::default() }
    }
}

/// A prior of one's own: an exponential one above a bound.
#[derive(Debug, Clone, Copy)]
struct Shifted<K: Kind> {
    low: Real<K>,
}

impl<K: Kind> Shifted<K> {
    fn new(low: impl Into<Real<K>>) -> Self {
        Self { low: low.into() }
    }
}

impl<K: Kind> Distribution<K> for Shifted<K> {
    fn log_density(&self, x: Real<K>) -> Real<K> {
        self.low - x
    }

    fn draw(&self, _: &mut Rng) -> Option<f64> {
        Prior::<K>::quantile(self, 0.5)
    }
}

impl<K: Kind> Prior<K> for Shifted<K> {
    fn support(&self) -> Support<K> {
        Support::Above(self.low)
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, p: f64) -> Option<f64> {
        Some(self.low.value() - (-p).ln_1p())
    }
}

model! {
    struct Extended { event: Event, low: f64 }

    base ~ self::Shifted(low);
    friction ~ Growing { a: self::Shifted(base) } + Coulomb { mu = 0.1 };
    errors ~ Iid { sigma2 = 4.0 };

    likelihood {
        event.velocity ~ event.slide(&friction)?.velocity() + errors;
        low ~ self::Shifted(base - 3.0);
    }
}

#[test]
fn laws_and_priors_of_ones_own_are_used_as_the_built_in_ones() {
    let model = Extended::new(event(&[2.8, 5.5, 8.0]), 0.001);
    let at = at_prior(&model, Seed::new(1));
    assert_eq!(
        (at.names, &*at.units[1]),
        (vec!["base".to_owned(), "a".to_owned()], "1/s2")
    );
    let two = 2.0_f64.ln();
    assert_eq!(at.natural, [0.001 + two, 0.001 + two + two]);
    let x = [0.0015, 0.002];
    let density = model.evaluate(Point::Natural(&x), None).unwrap();
    assert_eq!(density.log_prior, (0.001 - 0.0015) + (0.0015 - 0.002));
    assert!(density.log_likelihood.is_finite());
}

model! {
    struct Each { event: Event, data: [f64; 3], many: Vec<f64> }

    mean ~ Flat();
    sd ~ HalfNormal(1.0);

    likelihood {
        let _ = event;
        data ~ Normal(mean, sd);
        for y in many {
            y ~ Normal(mean, sd);
        }
        data[0] ~ Normal(mean, sd);
        event.velocity ~ Normal(mean, sd);
    }
}

#[test]
fn a_distribution_scores_value_by_value() {
    let model = Each::new(event(&[2.0]), [1.0, 2.0, 3.0], vec![4.0, 5.0]);
    let mut collector = Collector::default();
    let at = Point::Natural(&[2.5, 1.5]);
    let density = model.evaluate(at, Some(&mut collector)).unwrap();
    let normal = Normal::<couloir::scalar::Plain>::new(2.5, 1.5);
    let score = |x: f64| normal.log_density(Real::new(x)).value();
    let expected = [1.0, 2.0, 3.0, 4.0, 5.0, 1.0, 2.0].map(score);
    assert_eq!(collector.collected.pointwise, expected);
    let total: f64 = expected.iter().sum();
    assert!((density.log_likelihood - total).abs() < 1e-12);
}

model! {
    /// Errors of each event's own, a list of coefficients in each.
    struct OwnErrors {
        events: Vec<Event>,
    }

    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors[i in 0..events.len()] ~ Ar {
        phi: [Uniform(-0.5, 0.5); 2],
        sigma2: InverseGamma(3.0, 20.0),
    };

    likelihood {
        for (event, errors) in events.iter().zip(&errors) {
            let flow = event.slide(&friction)?;
            event.velocity ~ flow.velocity() + errors;
        }
    }
}

#[test]
fn a_list_in_one_of_several_blocks_has_two_indices() {
    let events = vec![event(&[8.0, 9.0, 9.5]), event(&[7.0, 8.0, 8.5])];
    assert_eq!(
        names(&OwnErrors::new(events)),
        [
            "mu",
            "phi[1,1]",
            "phi[1,2]",
            "sigma2[1]",
            "phi[2,1]",
            "phi[2,2]",
            "sigma2[2]",
        ]
    );
}

model! {
    struct Faulty { data: Vec<f64>, more: [f64; 1] }

    mean ~ self::Peaked();
    likelihood {
        more ~ Normal(mean, 1.0);
        data ~ Normal(mean, 1.0);
    }
}

/// A prior of one's own whose quantiles nobody has worked out:
/// p(x) = 1 - |x| between -1 and 1.
#[derive(Debug, Clone, Copy)]
struct Peaked;

impl Peaked {
    fn new() -> Self {
        Self
    }
}

impl<K: Kind> Distribution<K> for Peaked {
    fn log_density(&self, x: Real<K>) -> Real<K> {
        (1.0 - x.abs()).ln()
    }

    fn draw(&self, rng: &mut Rng) -> Option<f64> {
        let half = Uniform::<couloir::scalar::Plain>::new(-0.5, 0.5);
        Some(half.draw(rng)? + half.draw(rng)?)
    }
}

impl<K: Kind> Prior<K> for Peaked {
    fn support(&self) -> Support<K> {
        Support::Between(Real::new(-1.0), Real::new(1.0))
    }

    fn is_proper(&self) -> bool {
        true
    }

    fn quantile(&self, _: f64) -> Option<f64> {
        None
    }
}

#[test]
fn a_prior_without_quantiles_is_proper_where_it_says_so() {
    let model = Faulty::new(vec![0.2; 3], [0.1]);
    let posterior = couloir::model::Posterior::new(&model).unwrap();
    assert!(posterior.is_proper());
    assert!(posterior.require_proper("smc").is_ok());
}

#[test]
fn a_datum_that_is_no_number_is_named() {
    let model = Faulty::new(vec![0.2, 0.3, f64::NAN], [0.1]);
    let error = model.evaluate(Point::Natural(&[0.0]), None).unwrap_err();
    assert!(error.is_input());
    let text = error.to_string();
    assert!(text.starts_with("data: value 3 of 3 is NaN; expected"), "{text}");
}
