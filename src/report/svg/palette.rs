//! Colours that the colour-blind can tell apart and that print in grey
//! (Okabe and Ito, 2008), with the pens that use them.

/// Text and recorded values.
pub(super) const INK: &str = "#1a1a1a";
/// Axes and secondary text.
pub(super) const GREY: &str = "#5c5c5c";
/// Grid lines.
pub(super) const FAINT: &str = "#e3e3e3";
/// The prior.
pub(super) const PRIOR: &str = "#8a6d00";
/// The posterior: its lines.
pub(super) const POSTERIOR: &str = "#0072b2";
/// The posterior flow alone: the inner band.
pub(super) const FLOW: &str = "#7db8dc";
/// The posterior flow with errors: the outer band.
pub(super) const FULL: &str = "#d3e7f4";
/// The mass on its track.
pub(super) const MASS: &str = "#d55e00";
/// One colour a chain, in turn.
pub(super) const CHAINS: [&str; 6] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

/// How a line is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pen {
    pub(super) colour: &'static str,
    pub(super) width: f64,
    pub(super) dash: &'static str,
    pub(super) opacity: f64,
}

impl Pen {
    /// A full line.
    pub(super) const fn new(colour: &'static str, width: f64) -> Self {
        Self { colour, width, dash: "", opacity: 1.0 }
    }

    /// The same, dashed.
    pub(super) const fn dashed(self) -> Self {
        Self { dash: "6 4", ..self }
    }

    /// The same, seen through.
    pub(super) const fn faded(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}
