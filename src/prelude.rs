//! What a calibration needs: `use couloir::prelude::*`.

pub use crate::block::{Block, Field};
pub use crate::error::{Error, Outcome, Result, Stop};
#[cfg(feature = "nuts")]
pub use crate::infer::Nuts;
pub use crate::infer::{
    Backend, Bridge, Effort, ImportanceSampling, Inference, Map,
    MetropolisHastings, Quiet, ReciprocalImportance, Smc, infer,
};
pub use crate::model::{Label, Model, Number, Point, Posterior, Program, Run};
pub use crate::noise::{Ar, Growth, Iid, Matern32, Ou, Student, Tails, White};
pub use crate::observe::{Event, Series};
pub use crate::physics::friction::{
    Cohesion, Coulomb, Curvature, Entrainment, Laws, Pcm, Turbulent,
    VelocityWeakening, Viscous, Voellmy,
};
pub use crate::physics::{Friction, Rate, Site, Sum, Track, Varies};
pub use crate::predict::simulate;
pub use crate::scalar::{Kind, Real};
pub use crate::seed::Seed;
pub use couloir_macros::model;
