//! Colours that the colour-blind can tell apart and that print in grey
//! (Okabe and Ito, 2008), with the pens that use them.

/// Text and recorded values.
pub(crate) const INK: &str = "#1a1a1a";
/// Axes and secondary text.
pub(crate) const GREY: &str = "#5c5c5c";
/// Grid lines.
pub(crate) const FAINT: &str = "#e3e3e3";
/// The prior.
pub(crate) const PRIOR: &str = "#8a6d00";
/// The posterior: its lines.
pub(crate) const POSTERIOR: &str = "#0072b2";
/// The posterior flow alone: the inner band.
pub(crate) const FLOW: &str = "#7db8dc";
/// The posterior flow with errors: the outer band.
pub(crate) const FULL: &str = "#d3e7f4";
/// The mass on its track.
pub(crate) const MASS: &str = "#d55e00";
/// A stretch that is marked, as its shade looks on white.
pub(crate) const MARKED: &str = "#f9e8dc";
/// One colour a chain, in turn.
pub(crate) const CHAINS: [&str; 6] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

/// How a line is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pen {
    pub(crate) colour: &'static str,
    pub(crate) width: f64,
    pub(crate) dash: &'static str,
    pub(crate) opacity: f64,
}

impl Pen {
    /// A full line.
    pub(crate) const fn new(colour: &'static str, width: f64) -> Self {
        Self { colour, width, dash: "", opacity: 1.0 }
    }

    /// The same, dashed.
    pub(crate) const fn dashed(self) -> Self {
        Self { dash: "6 4", ..self }
    }

    /// The same, seen through.
    pub(crate) const fn faded(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}
