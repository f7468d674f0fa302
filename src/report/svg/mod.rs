//! The pictures of a calibration, one a file, as SVG that scales, prints
//! and keeps its text as text.
//!
//! Written by hand rather than through a plotting library: titles for screen
//! readers, clipping, dashes and small files need elements that those do not
//! offer.

pub(crate) mod axes;
mod boxes;
pub(crate) mod canvas;
mod curves;
mod densities;
mod histograms;
mod matrix;
mod pairs;
pub(crate) mod palette;
mod ranks;
mod recording;
mod reliability;
mod residuals;
pub(crate) mod series;
mod statistics;
mod traces;
mod track;

pub use boxes::{Boxes, box_plots};
pub use curves::{Curves, curves};
pub use histograms::{Histogram, histograms};
pub use matrix::{Matrix, matrix};
pub use reliability::{Bin, reliability};

use self::canvas::Sheet;
use super::{CalibrationReport, text};

/// A picture with what the reader has to know to read it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// A word for its file name: `recording`.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// How to read it.
    pub caption: String,
    /// The SVG document.
    pub svg: String,
    /// The same for a narrow screen; empty where there is none.
    pub phone: String,
}

/// All pictures for which the report has data, in the order to be read.
///
/// ```
/// use couloir::report::{CalibrationReport, pictures};
/// let mut report = CalibrationReport::default();
/// assert!(pictures(&report).is_empty());
/// (report.times, report.values) = (vec![0.0, 1.0], vec![0.0, 4.2]);
/// assert_eq!(pictures(&report)[0].name, "recording");
/// ```
pub fn pictures(report: &CalibrationReport) -> Vec<Picture> {
    type Draw = fn(&CalibrationReport, Sheet) -> Option<Picture>;
    let all: [Draw; 8] = [
        recording::draw,
        track::draw,
        densities::draw,
        pairs::draw,
        traces::draw,
        ranks::draw,
        residuals::draw,
        statistics::draw,
    ];
    let both = |draw: Draw| {
        let page = draw(report, Sheet::Page)?;
        let phone = draw(report, Sheet::Phone)?.svg;
        Some(Picture { phone, ..page })
    };
    all.into_iter().filter_map(both).collect()
}

/// `name [unit]`, or the name alone for a number without a unit.
pub(crate) fn with_unit(name: &str, unit: &str) -> String {
    match text::unit(unit).as_str() {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }
}
