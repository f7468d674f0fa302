//! The pictures of a diagnosis, one a file, on the canvas of all reports.

mod along;
mod bars;
mod figure;
mod force;
mod recording;
mod track;

pub(crate) use bars::bars;
pub(crate) use figure::Figure;
pub(crate) use force::{forces, left_over};
use recording::recording;
use track::track;

use crate::diagnosis::{Diagnosis, Pictured};

/// The track and the recording of an event, which is the i-th.
pub(crate) fn of_event(
    d: &Diagnosis,
    p: &Pictured,
    i: usize,
) -> [Option<Figure>; 2] {
    let name = |what: &str| format!("{what}-{i}");
    [track(d, p, &name("track")), recording(d, p, &name("recording"))]
}

/// All pictures of a diagnosis.
pub(crate) fn figures(d: &Diagnosis) -> Vec<Figure> {
    let events = d.pictured.iter().enumerate();
    let each = events.flat_map(|(i, p)| of_event(d, p, i));
    each.chain([forces(d), left_over(d), bars(d)]).flatten().collect()
}

/// The pictures of a diagnosis as files: the name of each, and an SVG document
/// on white that needs nothing else.
///
/// ```
/// use couloir::diagnosis::{Diagnosis, pictures};
/// assert!(pictures(&Diagnosis::default()).is_empty());
/// ```
pub fn pictures(d: &Diagnosis) -> Vec<(String, String)> {
    let white = "<svg style=\"background: #fff\" ";
    let file = |f: Figure| {
        (format!("{}.svg", f.id), f.svg.replacen("<svg ", white, 1))
    };
    figures(d).into_iter().map(file).collect()
}
