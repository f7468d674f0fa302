//! What leaves the program for others: draws with what they say of the data,
//! as ArviZ's InferenceData in Zarr; the draws as Parquet; the figures as a
//! table in LaTeX; pictures as PNG.
//!
//! [`gather`] makes one plain structure of a posterior and its draws,
//! [`InferenceData`]: groups of named arrays, named as ArviZ names them
//! (`posterior`, `log_likelihood`, `sample_stats`, `prior`,
//! `prior_predictive`, `posterior_predictive`, `observed_data`,
//! `constant_data`). Each format is a file of this room and reads nothing
//! else. Draws as CSV are [`Draws::to_csv`](crate::draws::Draws::to_csv).
//!
//! ```
//! use couloir::export::{Scope, gather};
//! use couloir::prelude::*;
//! model! {
//!     struct Dry { event: Event }
//!     friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
//!     errors ~ Iid { sigma2: InverseGamma(3.0, 1.0) };
//!     likelihood {
//!         let flow = event.slide(&friction)?;
//!         event.velocity ~ flow.velocity() + errors;
//!     }
//! }
//! let event = Event::on(Track::incline(35.0, 500.0)?)
//!     .velocity(Series::velocity(vec![1.0, 2.0], vec![3.1, 6.6])?)
//!     .build()?;
//! let model = Dry::new(event);
//! let posterior = Posterior::new(&model)?;
//! let sampler = MetropolisHastings::adaptive(
//!     &Effort::new().chains(2).draws(500).warmup(500),
//! );
//! let found = infer(&sampler, &posterior, Seed::new(1), &Quiet)?;
//! let draws = found.draws.ok_or(Error::inference("no draws"))?;
//! let data = gather(&posterior, &draws, &Scope::default(), Seed::new(2))?;
//! let likely = data.variable("log_likelihood", "velocity").ok_or("none");
//! # let likely = likely.map_err(Error::inference)?;
//! assert_eq!(likely.dimensions, ["chain", "draw", "time"]);
//! assert_eq!(likely.shape, [2, 500, 2]);
//! # Ok::<(), Error>(())
//! ```
//!
//! # Where one number is a choice
//!
//! `log_likelihood` has ln of the density of each value given those before it,
//! which for independent errors is its own. ArviZ's `loo` then leaves out one
//! such factor at a time (see [`elpd`](crate::elpd)). A parameter in a list is
//! one variable with a dimension (`phi[1]`, `phi[2]`: `phi` along
//! `phi_dim_0`), and one of each event has the dimension `event`. A calibration
//! averaged over noises has draws of no single model: of it there is the group
//! `posterior` alone.
//!
//! # Draws that are not of chains
//!
//! Every backend that gives draws gives even ones: `importance`,
//! `laplace-mixture`, `bridge` and `reciprocal` resample theirs by their
//! weights, as many as those are worth, and `smc` keeps its last particles.
//! They are written as one chain, whose order says nothing; R-hat and
//! effective size of it then see repeated values, and no more. The attribute
//! `sampling` says which of both it is. `map` and `quadrature` have no draws,
//! and a calibration refuses them.

mod data;
mod gather;
mod heard;
mod latex;
mod left_out;
#[cfg(feature = "export")]
mod parquet;
#[cfg(feature = "export")]
mod png;
mod recorded;
#[cfg(feature = "export")]
mod sheet;
mod table;
mod vector;
#[cfg(feature = "export")]
mod zarr;

pub use data::{Group, InferenceData, LeftOut, Values, Variable};
pub use gather::{MOST_NUMBERS, PRIOR_DRAWS, Scope, gather, of_draws};
pub use latex::latex;
#[cfg(feature = "export")]
pub use parquet::parquet;
#[cfg(feature = "export")]
pub use png::png;
#[cfg(all(feature = "export", feature = "cli"))]
pub(crate) use sheet::{Column, Sheet};
#[cfg(feature = "export")]
pub use zarr::zarr;
