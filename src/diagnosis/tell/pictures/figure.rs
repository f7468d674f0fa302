//! A picture, and what several of them draw.

use crate::report::svg::axes::{Axes, Scale};
use crate::report::svg::canvas::{Canvas, Frame, Sheet};
use crate::report::svg::palette::MASS;
use crate::report::svg::series::LOCATED;

/// How strongly a located stretch is filled.
const SHADE: f64 = 0.14;

/// A picture with what the reader has to know to read it.
#[derive(Debug)]
pub(crate) struct Figure {
    /// Unique on the page.
    pub(crate) id: String,
    #[cfg_attr(not(feature = "pages"), expect(dead_code))]
    pub(crate) caption: String,
    pub(crate) svg: String,
    /// The same for a narrow screen.
    #[cfg_attr(not(feature = "pages"), expect(dead_code))]
    pub(crate) phone: String,
}

impl Figure {
    /// A picture for a page, and for a narrow screen.
    pub(super) fn both(drawn: impl Fn(Sheet) -> Option<Self>) -> Option<Self> {
        let page = drawn(Sheet::Page)?;
        let phone = drawn(Sheet::Phone)?.svg;
        Some(Self { phone, ..page })
    }
}

/// Fills the stretches of a panel in which the mismatch lies.
pub(super) fn shade(
    canvas: &mut Canvas,
    axes: &Axes,
    stretches: &[(f64, f64)],
) {
    let Frame { top, bottom, .. } = axes.frame;
    canvas.of(LOCATED);
    for &(from, to) in stretches {
        let low = from.max(axes.x.low);
        let high = to.min(axes.x.high);
        if low < high {
            let (left, right) = (axes.at(low, 0.0).0, axes.at(high, 0.0).0);
            canvas.rectangle(Frame { left, top, right, bottom }, MASS, SHADE);
        }
    }
    canvas.of("");
}

/// A scale over the numbers, with some room at both ends.
pub(super) fn roomy(numbers: impl IntoIterator<Item = f64>) -> Scale {
    Scale::of(numbers).padded(0.04)
}
