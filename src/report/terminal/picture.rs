//! The recording and its predictive bands, drawn with characters.

use crate::report::digits::ticks;
use crate::report::text::{plain, unit};
use crate::report::{Bands, CalibrationReport};

const VALUE: char = '●';
const MEDIAN: char = '─';
const FLOW: char = '▒';
const FULL: char = '░';

/// The plane of the picture: what each cell stands for.
struct Plane {
    time: (f64, f64),
    value: (f64, f64),
    columns: usize,
    rows: usize,
    cells: Vec<char>,
}

/// The recording as dots over the 90 % bands, `width` by `height`
/// characters, axes and legend included (at least 40 by 8).
///
/// ```
/// use couloir::report::{CalibrationReport, picture};
/// let text = picture(&CalibrationReport::default(), 80, 20);
/// assert!(text.contains("nothing to draw"));
/// ```
pub fn picture(
    report: &CalibrationReport,
    width: usize,
    height: usize,
) -> String {
    let (width, height) = (width.clamp(40, 400), height.clamp(8, 200));
    let Some((time, value)) = bounds(report) else {
        return "nothing to draw\n".to_owned();
    };
    let rows = height - 4;
    let marks = ticks(value.0, value.1, (rows / 3).max(2));
    let longest = marks.iter().map(|m| m.1.chars().count()).max();
    let margin = longest.unwrap_or(0).min(width / 3);
    let columns = width - margin - 2;
    let cells = vec![' '; columns * rows];
    let mut plane = Plane { time, value, columns, rows, cells };
    plane.draw_bands(&report.bands);
    for (&t, &v) in report.times.iter().zip(&report.values) {
        plane.set(t, v, VALUE);
    }
    let (quantity, unit) = (plain(&report.quantity), unit(&report.unit));
    let mut lines = vec![format!("{:margin$} {quantity} [{unit}]", "")];
    lines.extend(plane.lines(margin, &marks));
    lines.extend(plane.time_axis(margin));
    lines.push(legend(margin, width));
    let mut out = String::new();
    for line in lines {
        out.extend(line.trim_end().chars().take(width));
        out.push('\n');
    }
    out
}

fn legend(margin: usize, width: usize) -> String {
    let long = format!(
        "{VALUE} recording  {MEDIAN} median  {FLOW} 90 % of flows  \
         {FULL} with errors"
    );
    let short = format!("{VALUE} data {FLOW} flow {FULL} with errors");
    let fits = margin + 2 + long.chars().count() <= width;
    format!("{:margin$}  {}", "", if fits { long } else { short })
}

/// The least and the greatest of the finite numbers, kept apart.
fn range(numbers: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let finite = numbers.filter(|x| x.abs() < 1e150);
    let (low, high) = finite
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
    if low > high {
        return None;
    }
    let apart = high - low > 1e-9 * low.abs().max(high.abs());
    let pad = if apart { 0.0 } else { (0.05 * high.abs()).max(0.5) };
    Some((low - pad, high + pad))
}

type Range = (f64, f64);

fn bounds(report: &CalibrationReport) -> Option<(Range, Range)> {
    let bands = &report.bands;
    let times = report.times.iter().chain(&bands.times).copied();
    let values = report.values.iter().chain(&bands.full_low);
    let values = values.chain(&bands.full_high).chain(&bands.median);
    Some((range(times)?, range(values.copied())?))
}

impl Plane {
    fn column(&self, t: f64) -> Option<usize> {
        place(t, self.time, self.columns)
    }

    fn row(&self, v: f64) -> Option<usize> {
        place(v, self.value, self.rows).map(|up| self.rows - 1 - up)
    }

    fn set(&mut self, t: f64, v: f64, mark: char) {
        if let (Some(column), Some(row)) = (self.column(t), self.row(v)) {
            self.cells[row * self.columns + column] = mark;
        }
    }

    fn draw_bands(&mut self, bands: &Bands) {
        let step = (self.time.1 - self.time.0) / (self.columns - 1) as f64;
        for column in 0..self.columns {
            let t = self.time.0 + step * column as f64;
            let at = |series: &[f64]| interpolate(&bands.times, series, t);
            self.fill(column, at(&bands.full_low), at(&bands.full_high), FULL);
            self.fill(column, at(&bands.flow_low), at(&bands.flow_high), FLOW);
            self.fill(column, at(&bands.median), at(&bands.median), MEDIAN);
        }
    }

    fn fill(
        &mut self,
        column: usize,
        low: Option<f64>,
        high: Option<f64>,
        mark: char,
    ) {
        let inside =
            |v: Option<f64>| v.map(|v| v.clamp(self.value.0, self.value.1));
        let bottom = inside(low).and_then(|v| self.row(v));
        let top = inside(high).and_then(|v| self.row(v));
        if let (Some(bottom), Some(top)) = (bottom, top) {
            for row in top..=bottom {
                self.cells[row * self.columns + column] = mark;
            }
        }
    }

    fn lines(&self, margin: usize, marks: &[(f64, String)]) -> Vec<String> {
        let mut labels = vec![None; self.rows];
        for (value, label) in marks {
            if let Some(row) = self.row(*value) {
                labels[row] = Some(label.as_str());
            }
        }
        let rows = self.cells.chunks(self.columns).zip(labels);
        rows.map(|(cells, label)| {
            let axis = if label.is_some() { '┤' } else { '│' };
            let label = label.unwrap_or_default();
            let label: String = label.chars().take(margin).collect();
            format!("{label:>margin$} {axis}{}", String::from_iter(cells))
        })
        .collect()
    }

    fn time_axis(&self, margin: usize) -> [String; 2] {
        let mut axis = vec!['─'; self.columns];
        let mut labels = vec![' '; self.columns];
        let mut free = 0;
        for (t, label) in ticks(self.time.0, self.time.1, self.columns / 12) {
            let Some(column) = self.column(t) else { continue };
            let label: Vec<char> = format!("{label} s").chars().collect();
            let most = self.columns.saturating_sub(label.len());
            let from = column.saturating_sub(label.len() / 2).min(most);
            axis[column] = '┬';
            if from >= free && label.len() <= self.columns {
                labels[from..from + label.len()].copy_from_slice(&label);
                free = from + label.len() + 1;
            }
        }
        let (axis, labels) =
            (String::from_iter(axis), String::from_iter(labels));
        [
            format!("{:margin$} └{axis}", ""),
            format!("{:margin$}  {labels}", ""),
        ]
    }
}

/// Which of `count` equal cells of the range holds a number.
fn place(x: f64, range: Range, count: usize) -> Option<usize> {
    let share = (x - range.0) / (range.1 - range.0);
    if !(-1e-9..=1.0 + 1e-9).contains(&share) {
        return None;
    }
    Some(((share * count as f64) as usize).min(count - 1))
}

/// The series at a time between two of its own.
fn interpolate(times: &[f64], series: &[f64], t: f64) -> Option<f64> {
    let right = times.partition_point(|x| *x < t);
    let left = right.saturating_sub(1);
    let (a, b) = (*times.get(left)?, *times.get(right)?);
    let (low, high) = (*series.get(left)?, *series.get(right)?);
    let share = if b > a { (t - a) / (b - a) } else { 0.0 };
    let value = low + share.clamp(0.0, 1.0) * (high - low);
    (a <= t && t <= b && value.is_finite()).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture;

    #[test]
    fn a_picture_keeps_to_its_size() {
        for (width, height) in [(0, 0), (40, 8), (80, 20), (200, 60)] {
            let text = picture(&fixture::calibration(), width, height);
            let widest = text.lines().map(|l| l.chars().count()).max();
            assert!(widest <= Some(width.max(40)), "{text}");
            assert_eq!(text.lines().count(), height.max(8));
            assert!(text.contains(VALUE) && text.contains("[m/s]"));
        }
    }

    #[test]
    fn what_is_between_two_times_is_on_their_line() {
        let at = |t| interpolate(&[0.0, 2.0], &[1.0, 3.0], t);
        assert_eq!(at(0.5), Some(1.5));
        assert_eq!(at(2.5), None);
        assert_eq!(at(-0.5), None);
        assert_eq!(interpolate(&[], &[], 0.0), None);
    }
}
