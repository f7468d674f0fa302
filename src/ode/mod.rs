//! Systems of ordinary differential equations of a user's own, solved with
//! derivatives.
//!
//! The state carries its derivatives by the model's unknowns, and both are
//! integrated together: y' = f(y) and, for each unknown p, (dy/dp)' =
//! (df/dy) dy/dp + df/dp, the sensitivity equations (Hairer, Norsett and
//! Wanner 1993, section I.14). Their right side is exact, as f is written
//! over numbers with derivatives. The steps are those of ode_solvers'
//! Dopri5, short enough for the state and its derivatives alike.
//!
//! ```
//! use couloir::prelude::*;
//! use couloir::ode;
//! model! {
//!     /// Something cools down to 20 degrees from 90 or so.
//!     struct Cooling { times: Vec<f64>, degrees: Vec<f64> }
//!     rate ~ LogNormal(-2.0, 1.0);
//!     start ~ Normal(90.0, 5.0);
//!     sigma ~ HalfNormal(2.0);
//!     likelihood {
//!         let path =
//!             ode::solve(|_, [y]| [-rate * (y - 20.0)], (0.0, [start]), times)?;
//!         for (degrees, [y]) in degrees.iter().zip(path) {
//!             degrees ~ Normal(y, sigma);
//!         }
//!     }
//! }
//! let (times, degrees) = (vec![5.0, 10.0, 20.0], vec![62.0, 45.0, 29.0]);
//! let cooling = Cooling::new(times, degrees);
//! let posterior = Posterior::new(&cooling)?;
//! let at = posterior.density(Point::Natural(&[0.1, 90.0, 1.0]))?;
//! let exact = |t: f64| 20.0 + 70.0 * (-0.1 * t).exp();
//! let seen = [(5.0, 62.0), (10.0, 45.0), (20.0, 29.0)];
//! let chi2: f64 = seen.iter().map(|(t, y)| (y - exact(*t)).powi(2)).sum();
//! let log = -0.5 * chi2 - 1.5 * (2.0 * std::f64::consts::PI).ln();
//! assert!((at.log_likelihood - log).abs() < 1e-6);
//! # Ok::<(), Error>(())
//! ```

mod solver;
mod state;
mod system;

pub use solver::{Solver, solve};
pub use system::System;
