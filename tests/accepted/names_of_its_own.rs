//! The user's own `K`, `S`, `Block0`, `run`, `all`, `one` and `value_0_0` are
//! not the macro's.
#![deny(warnings)]
use couloir::model;
use own::S;

mod own {
    use couloir::Real;
    use couloir::block::{Block, Field};
    use couloir::physics::friction::{Friction, Rate, Site, Varies};
    use couloir::scalar::Kind;

    pub(super) struct S<N> {
        pub(super) mu: N,
    }

    impl<N: Copy> Block<N> for S<N> {
        const NAME: &'static str = "s";
        const FIELDS: &'static [Field] = &[Field::new("mu", "1", "Flat()")];

        fn from_values(values: &[N]) -> Self {
            Self { mu: values[0] }
        }
    }

    impl<K: Kind> Friction<K> for S<Real<K>> {
        fn varies(&self) -> Varies {
            Varies::Nowhere
        }
        fn rate(&self, _: &Site, _: Real<K>) -> Rate<K> {
            Rate { mu: self.mu, ..Rate::default() }
        }
    }

    pub(super) struct K(pub(super) f64);
    pub(super) struct Block0(pub(super) f64);
}

fn run(x: f64) -> f64 {
    x
}

model! {
    struct Names {
        run: f64,
        event: couloir::Event,
        data: Vec<f64>,
        count: usize,
        text: &'static str,
    }

    all ~ Normal(run, 1.0);
    one ~ Normal(0.0, 1.0);
    let value_0_0 = all + one;
    r#type[all in 0..count] ~ couloir::noise::Iid { sigma2: Gamma(2.0, value_0_0.exp()) };
    law ~ S { mu = value_0_0 } + S { mu = 0.1 };

    likelihood {
        use own::{Block0, K};
        let at = K(1.0).0 + Block0(3.0).0 + text.len() as f64;
        for (y, errors) in data.iter().zip(&r#type) {
            y ~ Normal(at * errors.sigma2, 1.0);
        }
        let flow = event.slide(&law)?;
        event.velocity ~ flow.velocity() + r#type[0];
        self::run(1.0) ~ Normal(0.0, 1.0);
    }
}

#[test]
fn a_model_with_names_like_the_macros() {
    let _ = Names::new;
}
