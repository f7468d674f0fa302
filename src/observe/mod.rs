//! Observation: from the motion to what was measured.
//!
//! A recording is not the state. A [`Series`] says what was measured and
//! when, an [`Event`] holds the ground, the release and its series, and a
//! [`Flow`] is the motion at the moments that those need.

mod event;
mod extent;
mod flow;
mod moments;
mod motion;
mod scatter;
mod series;
mod thin;

pub use crate::mechanism::Extent;
pub use event::{Event, EventBuilder};
pub use flow::{Flow, Prediction, Recorded};
pub use moments::{Moments, MotionKind};
pub use series::{Quantity, Series};
pub use thin::{Thinned, Thinning};
