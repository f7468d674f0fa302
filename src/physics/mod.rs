//! The physics: terrain, friction laws, and how a mass slides under them.
//!
//! ds/dt = u and du/dt = g sin(theta(s)) - r(s, u), u never below 0: a mass
//! at rest stays while friction can hold it (Heredia et al. 2020, equation
//! 1). The track is a chain of pieces of constant slope, and on a piece every
//! law of the form r = A + B u + C u^2 has an exact solution.

pub(crate) mod depth;
pub mod forces;
pub mod friction;
pub mod track;

mod ahead;
mod by_speed;
mod changed;
mod defect;
mod eight;
mod elementary;
mod exact;
mod fitted;
mod lanes;
mod motion;
mod quadratic;
mod resistance;
mod sample;
mod skim;
mod slopes;
mod walk;

pub use changed::{rest_changed, sample_changed};
pub use depth::{Depth, DepthRows, DepthSteps};
pub use forces::Forces;
pub use friction::{Friction, Rate, Site, Sum, Varies};
pub use lanes::speeds;
pub use motion::{Path, Release, Rest, State};
pub(crate) use sample::{is_exact, sample_exact};
pub use sample::{rest, sample};
pub use track::Track;

/// The acceleration of gravity \[m/s2\].
pub const GRAVITY: f64 = 9.81;
