//! A model inside a function, with everything by its path and all warnings
//! denied.
#![deny(warnings)]

#[test]
fn a_model_inside_a_function() {
    couloir::model! {
        #[derive(Debug, Clone)]
        struct Local { event: couloir::Event, }

        friction ~ couloir::physics::friction::Coulomb { mu: Flat(), };
        errors ~ couloir::noise::Iid { sigma2: HalfCauchy(1.0) };

        likelihood {
            let flow = event.slide(&friction)?;
            event.velocity ~ flow.velocity() + errors;
        }
    }
    let _ = Local::new;
}
