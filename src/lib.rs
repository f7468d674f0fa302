//! Bayesian calibration of avalanche friction laws.
//!
//! A mass slides down a slope; somebody recorded how fast. Which friction
//! explains the recording, and how sure is that? A model is written as it is
//! spoken, a backend explores it:
//!
//! ```
//! use couloir::prelude::*;
//!
//! model! {
//!     struct Calibration { event: Event }
//!
//!     friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
//!     errors ~ Iid { sigma2: InverseGamma(3.0, 2.0) };
//!
//!     likelihood {
//!         let flow = event.slide(&friction)?;
//!         event.velocity ~ flow.velocity() + errors;
//!     }
//! }
//!
//! // Synthetic speeds: 35 degrees, mu = 0.3, xi = 1000 m/s2, h = 1.5 m.
//! let times = vec![2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0];
//! let speeds = vec![6.6, 11.1, 15.9, 17.8, 20.6, 20.4, 21.9, 21.5];
//! let event = Event::on(Track::incline(35.0, 1000.0)?)
//!     .depth(1.5)
//!     .velocity(Series::velocity(times, speeds)?)
//!     .build()?;
//! let model = Calibration::new(event);
//! let posterior = Posterior::new(&model)?;
//! let backend = MetropolisHastings::default();
//! let found = infer(&backend, &posterior, Seed::new(1), &Quiet)?;
//! println!("{found}"); // mean, sd, 90 % interval of mu, xi and sigma2
//! # let draws = found.draws.as_ref().map(couloir::draws::summarise);
//! # let mu = draws.and_then(|s| s.first().cloned()).ok_or(Error::input(""))?;
//! # assert!(mu.q05 < 0.3 && 0.3 < mu.q95, "{mu:?}");
//! # Ok::<(), Error>(())
//! ```
//!
//! Another law is another word in that line (`Coulomb { mu: .. }`), or a sum
//! (`Coulomb { .. } + Turbulent { .. }`); correlated errors are
//! `Ar { phi: [Uniform(-1.0, 1.0)], sigma2: .. }`. The whole grammar is told
//! at [`model!`], and `examples/` walks through it step by step.
//!
//! # The nouns
//!
//! - An [`Event`] is one avalanche: its [`Track`](physics::Track) (the
//!   terrain), its release, and what was recorded of it.
//! - A [`Series`] is a recording: what quantity, when, and the values.
//! - A [block](block::Block) is a named part of a model with named
//!   parameters: a [friction law](physics::friction) or a [`noise`].
//! - A [`Program`] declares parameters and scores data; [`model!`] writes it.
//!   Every program is a [`Model`].
//! - A [`Posterior`](model::Posterior) is a model to be explored. It counts
//!   every evaluation.
//! - A [`Backend`](infer::Backend) explores a posterior from a [`Seed`] and
//!   returns an [`Inference`](infer::Inference): draws, a mode, an evidence.
//! - [`Draws`](draws::Draws) can be summarised, diagnosed and
//!   [predicted from](predict).
//!
//! # The map
//!
//! From the bottom up; a module uses only those above it in this table.
//!
//! | modules | what they are |
//! |---|---|
//! | [`error`], [`seed`], [`scalar`], [`block`] | failure, chance, numbers with derivatives, named parts |
//! | [`prior`], [`draws`], [`context`], [`physics`] | distributions; samples and their diagnostics; buffers; terrain, laws, motion |
//! | [`noise`] | how recordings scatter |
//! | [`mechanism`] | what a model may lack: changes from outside, and their catalogue |
//! | [`declared`] | blocks as a model declared them |
//! | [`observe`] | events, series, and from the motion to what was measured |
//! | [`mod@model`] | one run of a model, asked in different ways |
//! | [`infer`], [`predict`] | backends; predictions |
//! | [`elpd`], [`io`], [`report`] | prediction of what was left out; event files in; tables, pictures and pages out |
//! | [`calibrate`], [`diagnosis`], [`mod@import`] | a whole calibration; what a model lacks; events from logs |
//! | [`averaged`], [`sbc`] | a calibration averaged over noises, and beside a force of free form; whether inference can be trusted |
//! | [`mod@reproduce`], [`challenge`], [`sweep`] | the paper's study, computed again; hidden effects, made without the engine, and the score; thousands of events |
//! | [`cli`] | the command: nothing below it prints |
//!
//! # Features
//!
//! - `cli`, on: the command and its studies; whoever only wants the library
//!   takes `default-features = false`.
//! - `import`, on: [`mod@import`], with the crates that read and project
//!   places.
//! - `pages`, of `cli`: results as pages of HTML.
//! - `nuts`, off: the backend `nuts`, by the crate nuts-rs.
//!
//! # Crates in signatures
//!
//! [`nalgebra`] (a peak, a covariance), [`rand`] and [`rand_distr`] (a noise
//! or a prior of one's own draws), [`smallvec`] (a [`block::List`]) and
//! [`serde_json`] (a report as JSON) are re-exported. A name taken from here,
//! such as `couloir::rand::RngExt`, is always of the version that fits.
//!
//! The reasons for all this are in `DESIGN.md`, the invariants in
//! `ARCHITECTURE.md`.
#![warn(clippy::print_stdout, clippy::print_stderr, clippy::unwrap_used)]

pub mod averaged;
pub mod block;
pub mod calibrate;
#[cfg(feature = "cli")]
pub mod challenge;
pub mod checkpoint;
#[cfg(feature = "cli")]
pub mod cli;
pub mod context;
pub mod declared;
pub mod diagnosis;
pub mod draws;
pub mod elpd;
pub mod error;
pub mod export;
#[cfg(feature = "import")]
pub mod import;
pub mod infer;
pub mod io;
pub mod mechanism;
pub mod model;
pub mod noise;
pub mod observe;
pub mod ode;
mod parallel;
pub mod physics;
pub mod population;
pub mod predict;
pub mod prelude;
pub mod prior;
pub mod report;
#[cfg(feature = "cli")]
pub mod reproduce;
pub mod sbc;
pub mod scalar;
pub mod seed;
pub(crate) mod spelling;
#[cfg(feature = "cli")]
pub mod sweep;

/// Writes a model: its data, its unknowns, and how the data come about.
///
/// ```
/// use couloir::noise::Ar;
/// use couloir::physics::{Track, friction::Voellmy};
/// use couloir::model::Point;
/// use couloir::{Event, Model, Series, model};
///
/// model! {
///     /// Voellmy friction with errors correlated along the flow.
///     pub struct Calibration { event: Event }
///
///     friction ~ Voellmy { mu: Gamma(9.0, 0.03), xi: Gamma(2.5, 400.0) };
///     errors   ~ Ar { phi: [Uniform(-1.0, 1.0)], sigma2: InverseGamma(3.0, 20.0) };
///
///     likelihood {
///         let flow = event.slide(&friction)?;
///         event.velocity ~ flow.velocity() + errors;
///     }
/// }
///
/// # fn main() -> couloir::Result<()> {
/// let event = Event::on(Track::incline(35.0, 500.0)?)
///     .velocity(Series::velocity(vec![1.0, 2.0], vec![2.9, 5.6])?)
///     .build()?;
/// let model = Calibration::new(event);
/// // mu, xi, phi, sigma2
/// let density = model.evaluate(Point::Natural(&[0.3, 1000.0, 0.5, 0.1]), None)?;
/// assert!(density.natural().is_finite());
/// # Ok(())
/// # }
/// ```
pub use couloir_macros::model;

// Their types stand in the signatures of this library: whoever uses them from
// here cannot have another version than it has.
pub use nalgebra;
pub use rand;
pub use rand_distr;
pub use serde_json;
pub use smallvec;

pub use declared::Declared;
pub use error::{Error, Outcome, Result, Stop};
pub use model::{Label, Model, Number, Program, Run};
pub use observe::{Event, Flow, Series};
pub use scalar::Real;
pub use seed::Seed;

/// The README, so that its programs are tested with the others.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
