//! Scales, axes with round ticks, and legends.

use super::canvas::{
    Anchor, Canvas, Ends, FONT, Frame, Point, WIDTH, text_width,
};
use super::palette::{FAINT, GREY, INK, Pen};
use crate::report::digits::ticks;

/// A line of numbers laid on the canvas.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scale {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Scale {
    /// The range of the finite numbers; from 0 to 1 where there are none.
    pub(crate) fn of(numbers: impl IntoIterator<Item = f64>) -> Self {
        let finite = numbers.into_iter().filter(|x| x.abs() < 1e150);
        let (low, high) = finite
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        let apart = high - low > 1e-9 * low.abs().max(high.abs());
        let pad = if apart { 0.0 } else { (0.05 * high.abs()).max(0.5) };
        Self { low: low - pad, high: high + pad }
    }

    pub(crate) fn span(&self) -> f64 {
        self.high - self.low
    }

    /// The same with a share of its span added at both ends.
    pub(crate) fn padded(self, share: f64) -> Self {
        let pad = share * self.span();
        Self { low: self.low - pad, high: self.high + pad }
    }

    /// What both scales have in common; this one where that is nothing.
    pub(crate) fn within(self, other: Self) -> Self {
        let both = Self {
            low: self.low.max(other.low),
            high: self.high.min(other.high),
        };
        if both.span() > 0.0 { both } else { self }
    }

    /// The least scale that holds both.
    pub(crate) fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
}

/// Two scales on a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Axes {
    pub(crate) frame: Frame,
    pub(crate) x: Scale,
    pub(crate) y: Scale,
}

/// Which labels an axis bears: its ticks' and its name.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Labels<'a> {
    pub(crate) x: Option<&'a str>,
    pub(crate) y: Option<&'a str>,
}

impl Axes {
    /// Where a pair of numbers lies.
    pub(crate) fn at(&self, x: f64, y: f64) -> Point {
        let across = (x - self.x.low) / self.x.span();
        let up = (y - self.y.low) / self.y.span();
        (
            self.frame.left + across * self.frame.width(),
            self.frame.bottom - up * self.frame.height(),
        )
    }

    /// Where pairs of numbers lie.
    pub(crate) fn points(&self, x: &[f64], y: &[f64]) -> Vec<Point> {
        x.iter().zip(y).map(|(x, y)| self.at(*x, *y)).collect()
    }

    /// The room that the labels of the y axis need at its left.
    pub(crate) fn margin(y: Scale, height: f64) -> f64 {
        let labels = y_ticks(y, height);
        let widest = labels.iter().map(|t| text_width(&t.1));
        (widest.fold(0.0, f64::max) + 34.0).min(0.25 * WIDTH)
    }

    /// Draws grid, ticks, axes and names.
    pub(crate) fn draw(&self, canvas: &mut Canvas, labels: Labels<'_>) {
        if let (Some(x), Some(y)) = (labels.x, labels.y) {
            self.describe(canvas, [x, y]);
        }
        if let Some(name) = labels.y {
            self.draw_y(canvas, name);
        }
        if let Some(name) = labels.x {
            self.draw_x(canvas, name);
        }
        let Frame { left, bottom, right, top } = self.frame;
        let pen = Pen::new(GREY, 1.0);
        canvas.line((left, bottom), (right, bottom), pen);
        if labels.y.is_some() {
            canvas.line((left, top), (left, bottom), pen);
        }
    }

    /// Says what the numbers are, for a page that reads them out.
    pub(crate) fn describe(&self, canvas: &mut Canvas, names: [&str; 2]) {
        let [x, y] = [(self.x, names[0]), (self.y, names[1])]
            .map(|(Scale { low, high }, name)| Ends { low, high, name });
        canvas.panel(self.frame, &x, &y);
    }

    fn draw_y(&self, canvas: &mut Canvas, name: &str) {
        let Frame { left, right, top, bottom } = self.frame;
        let mut widest: f64 = 0.0;
        for (value, label) in y_ticks(self.y, self.frame.height()) {
            let y = self.at(0.0, value).1;
            let label = label.replace('-', "−");
            widest = widest.max(text_width(&label));
            canvas.line((left, y), (right, y), Pen::new(FAINT, 1.0));
            canvas.text((left - 6.0, y + 4.5), Anchor::End, GREY, &label);
        }
        let x = (left - widest - 16.0).max(FONT);
        if !name.is_empty() {
            canvas.upwards((x, 0.5 * (top + bottom)), INK, name);
        }
    }

    fn draw_x(&self, canvas: &mut Canvas, name: &str) {
        let Frame { bottom, .. } = self.frame;
        let mut free = 3.0;
        for (value, label) in self.x_ticks() {
            let x = self.at(value, 0.0).0;
            let label = label.replace('-', "−");
            let half = 0.5 * text_width(&label);
            let tick = Pen::new(GREY, 1.0);
            canvas.line((x, bottom), (x, bottom + 4.0), tick);
            if x - half > free && x + half < canvas.width() {
                let at = (x, bottom + 5.0 + FONT);
                canvas.text(at, Anchor::Middle, GREY, &label);
                free = x + half + 6.0;
            }
        }
        self.draw_name(canvas, name);
    }

    /// Draws the name below the x axis, under where its numbers are.
    pub(crate) fn draw_name(&self, canvas: &mut Canvas, name: &str) {
        let Frame { left, right, bottom, .. } = self.frame;
        let at = (0.5 * (left + right), bottom + 10.0 + 2.0 * FONT + 2.0);
        canvas.text(at, Anchor::Middle, INK, name);
        // A legend may have taken more lines than there was room for.
        canvas.reach(at.1 + 0.5 * FONT);
    }

    fn x_ticks(&self) -> Vec<(f64, String)> {
        let labels = ticks(self.x.low, self.x.high, 4);
        let widest = labels.iter().map(|t| text_width(&t.1));
        let room = widest.fold(0.0, f64::max).max(24.0) + 26.0;
        let count = (self.frame.width() / room) as usize;
        ticks(self.x.low, self.x.high, count.clamp(2, 10))
    }
}

fn y_ticks(scale: Scale, height: f64) -> Vec<(f64, String)> {
    ticks(scale.low, scale.high, ((height / 42.0) as usize).clamp(2, 8))
}

/// The sign of a legend entry.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Key {
    Line(Pen),
    Dot(Pen),
    Fill(&'static str),
}

impl Key {
    /// Draws the sign from x on, about a height.
    fn draw(self, canvas: &mut Canvas, x: f64, middle: f64) {
        match self {
            Self::Line(pen) => {
                canvas.line((x, middle), (x + 24.0, middle), pen);
            }
            Self::Dot(pen) => canvas.dots(&[(x + 12.0, middle)], pen),
            Self::Fill(fill) => {
                let (left, right) = (x, x + 24.0);
                let (top, bottom) = (middle - 5.5, middle + 5.5);
                let at = Frame { left, top, right, bottom };
                canvas.rectangle(at, fill, 1.0);
            }
        }
    }
}

/// Draws a legend from the left, in as many lines as it takes, its first at
/// `top`; returns where it ends.
pub(crate) fn legend(
    canvas: &mut Canvas,
    left: f64,
    top: f64,
    entries: &[(Key, &str)],
) -> f64 {
    let (mut x, mut y) = (left, top + FONT);
    for (key, text) in entries {
        let width = 32.0 + text_width(text) + 14.0;
        if x > left && x + width > canvas.width() {
            (x, y) = (left, y + FONT + 6.0);
        }
        canvas.key(text, |canvas| {
            key.draw(canvas, x, y - 4.5);
            canvas.text((x + 30.0, y), Anchor::Start, INK, text);
        });
        x += width;
    }
    y + 12.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_never_has_span_zero() {
        for numbers in [vec![], vec![3.0], vec![0.0; 4], vec![f64::NAN]] {
            let scale = Scale::of(numbers);
            assert!(scale.span() > 0.0, "{scale:?}");
        }
        assert!(Scale::of([1e300, -1e300, 2.0]).span() < 2.0);
    }
}
