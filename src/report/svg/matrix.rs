//! Counts by two names: who was taken for whom.

use super::Picture;
use super::canvas::{Anchor, Canvas, FONT, Frame, Point, WIDTH, text_width};
use super::palette::{FAINT, INK, POSTERIOR, Pen};

/// Counts by a row's and a column's name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Matrix {
    /// The names at the left: what was true.
    pub rows: Vec<String>,
    /// The names above: what was answered.
    pub columns: Vec<String>,
    /// A row of counts for each row.
    pub counts: Vec<Vec<usize>>,
}

const ROW: f64 = 20.0;
const WHITE: &str = "#fff";

/// The counts as cells, the darker the more of its row a cell has.
///
/// ```
/// use couloir::report::svg::{Matrix, matrix};
/// let names = vec!["surge".to_owned(), "none".to_owned()];
/// let counts = vec![vec![3, 1], vec![0, 7]];
/// let m = Matrix { rows: names.clone(), columns: names, counts };
/// let picture = matrix("taken", "Taken for", "", &m);
/// assert!(picture.svg.contains(">7</text>"));
/// ```
pub fn matrix(
    name: &'static str,
    title: &'static str,
    caption: &str,
    matrix: &Matrix,
) -> Picture {
    let widest = |names: &[String]| {
        names.iter().map(|n| text_width(n)).fold(0.0, f64::max)
    };
    let (left, top) = (widest(&matrix.rows) + 16.0, widest(&matrix.columns));
    let top = top + 16.0;
    let height = top + ROW * matrix.rows.len() as f64;
    let mut canvas = Canvas::new(name, height + 8.0);
    let columns = matrix.columns.len().max(1) as f64;
    let width = ((WIDTH - 8.0 - left) / columns).min(3.0 * ROW);
    let right = left + width * columns;
    for (i, name) in matrix.columns.iter().enumerate() {
        let middle = left + width * (i as f64 + 0.5);
        let centre = top - 8.0 - 0.5 * text_width(name);
        canvas.upwards((middle + 4.5, centre), INK, name);
        rule(&mut canvas, (middle - 0.5 * width, top), (0.0, height - top));
    }
    for (i, name) in matrix.rows.iter().enumerate() {
        let above = top + ROW * i as f64;
        let at = (left - 8.0, above + 0.5 * ROW + 4.5);
        canvas.text(at, Anchor::End, INK, name);
        rule(&mut canvas, (left, above), (right - left, 0.0));
        let row = matrix.counts.get(i).map_or(&[][..], Vec::as_slice);
        draw_row(&mut canvas, (left, above), width, row);
    }
    Picture {
        name,
        title,
        caption: caption.to_owned(),
        phone: String::new(),
        svg: canvas.finish(title),
    }
}

fn rule(canvas: &mut Canvas, (x, y): Point, (dx, dy): Point) {
    canvas.line((x, y), (x + dx, y + dy), Pen::new(FAINT, 1.0));
}

fn draw_row(canvas: &mut Canvas, at: Point, width: f64, counts: &[usize]) {
    let all = counts.iter().sum::<usize>().max(1) as f64;
    for (i, count) in counts.iter().enumerate().filter(|(_, n)| **n > 0) {
        let left = at.0 + width * i as f64;
        let (right, top, bottom) = (left + width, at.1, at.1 + ROW);
        let share = *count as f64 / all;
        let cell = Frame { left, top, right, bottom };
        canvas.rectangle(cell, POSTERIOR, 0.12 + 0.88 * share);
        let colour = if share > 0.5 { WHITE } else { INK };
        let middle = (left + 0.5 * width, top + 0.5 * (ROW + FONT) - 2.0);
        canvas.text(middle, Anchor::Middle, colour, &count.to_string());
    }
}
