//! The few SVG elements that the pictures are made of.
//!
//! Every text goes through `escape`, every coordinate through `number`, so
//! no name and no number can break the document.

use std::fmt::Write;

use super::palette::{INK, Pen};
use crate::report::text::escape;

/// The font size of all text [px at full size].
pub(crate) const FONT: f64 = 13.0;
/// The width of pictures that are drawn for a page alone.
pub(crate) const WIDTH: f64 = 640.0;

/// What a picture is drawn for: on a page panels stand side by side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sheet {
    Page,
    Phone,
}

impl Sheet {
    /// How wide it is, so that text has the size of the text around it.
    pub(crate) fn width(self) -> f64 {
        match self {
            Self::Page => WIDTH,
            Self::Phone => 360.0,
        }
    }

    /// So many columns where there is room for them.
    pub(crate) fn columns(self, most: usize) -> usize {
        if self == Self::Page { most } else { 1 }
    }
}

/// A point on the canvas, y downwards.
pub(crate) type Point = (f64, f64);

/// Where a text is fixed to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A rectangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Frame {
    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }
}

/// The numbers at the ends of an axis, and what they are of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ends<'a> {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) name: &'a str,
}

/// A picture being drawn.
#[derive(Debug)]
pub(crate) struct Canvas {
    name: String,
    width: f64,
    height: f64,
    clips: usize,
    /// What is being drawn, as the legend names it; empty for the rest.
    series: &'static str,
    body: String,
}

/// A coordinate: one decimal, never far off or not a number.
fn number(x: f64) -> String {
    let x = if x.is_finite() { x.clamp(-1e5, 1e5) } else { -1e5 };
    let text = format!("{x:.1}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// About how wide a text is drawn.
pub(crate) fn text_width(text: &str) -> f64 {
    0.56 * FONT * text.chars().count() as f64
}

impl Canvas {
    /// An empty canvas for a page; the name makes its identifiers unique.
    pub(crate) fn new(name: impl Into<String>, height: f64) -> Self {
        Self::on(Sheet::Page, name, height)
    }

    /// The same for a sheet.
    pub(crate) fn on(
        sheet: Sheet,
        name: impl Into<String>,
        height: f64,
    ) -> Self {
        let mut name = name.into();
        if sheet == Sheet::Phone {
            name.push_str("-phone");
        }
        let (width, body) = (sheet.width(), String::new());
        Self { name, width, height, clips: 0, series: "", body }
    }

    /// How wide it is.
    pub(crate) fn width(&self) -> f64 {
        self.width
    }

    /// Makes sure that the canvas reaches down to y.
    pub(crate) fn reach(&mut self, y: f64) {
        self.height = self.height.max(y);
    }

    /// From here on what is drawn is of a series, by its name in the legend,
    /// until another is named or a clip ends; a page lets the reader hide it
    /// and reads its values out.
    pub(crate) fn of(&mut self, series: &'static str) {
        self.series = series;
    }

    /// The attribute that says of which series an element is.
    fn series(&self) -> String {
        match self.series {
            "" => String::new(),
            name => format!(" data-series=\"{}\"", escape(name)),
        }
    }

    // Writing into a String cannot fail.
    fn push(&mut self, text: std::fmt::Arguments<'_>) {
        let _ = self.body.write_fmt(text);
        self.body.push('\n');
    }

    /// A straight line.
    pub(crate) fn line(&mut self, a: Point, b: Point, pen: Pen) {
        self.curve(&[a, b], pen);
    }

    /// A line through points, broken where one is not finite.
    pub(crate) fn curve(&mut self, points: &[Point], pen: Pen) {
        let path = path(points);
        if !path.is_empty() {
            self.push(format_args!(
                "<path d=\"{path}\" fill=\"none\"{}{}/>",
                stroke(pen),
                self.series()
            ));
        }
    }

    /// The area between two lines with the same x, broken where either is
    /// not finite.
    pub(crate) fn area(
        &mut self,
        low: &[Point],
        high: &[Point],
        fill: &str,
        opacity: f64,
    ) {
        let pairs: Vec<_> = low.iter().zip(high).collect();
        let fine = |p: &Point| p.0.is_finite() && p.1.is_finite();
        for run in pairs.split(|(a, b)| !(fine(a) && fine(b))) {
            let there = run.iter().map(|(a, _)| **a);
            let back = run.iter().rev().map(|(_, b)| **b);
            let outline: Vec<Point> = there.chain(back).collect();
            if run.len() > 1 {
                self.push(format_args!(
                    "<path d=\"{}z\" fill=\"{fill}\" \
                     fill-opacity=\"{opacity}\"{}/>",
                    path(&outline),
                    self.series()
                ));
            }
        }
    }

    /// Round dots, all in one path: lines of no length with round ends.
    pub(crate) fn dots(&mut self, points: &[Point], pen: Pen) {
        let mut path = String::new();
        for p in points.iter().filter(|p| p.0.is_finite() && p.1.is_finite()) {
            let _ = write!(path, "M{} {}h.01", number(p.0), number(p.1));
        }
        if !path.is_empty() {
            self.push(format_args!(
                "<path d=\"{path}\" fill=\"none\" \
                 stroke-linecap=\"round\"{}{}/>",
                stroke(pen),
                self.series()
            ));
        }
    }

    /// A filled rectangle.
    pub(crate) fn rectangle(&mut self, at: Frame, fill: &str, opacity: f64) {
        self.push(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" \
             fill=\"{fill}\" fill-opacity=\"{opacity}\"{}/>",
            number(at.left),
            number(at.top),
            number(at.width().max(0.0)),
            number(at.height().max(0.0)),
            self.series()
        ));
    }

    /// What a page needs to read values out of a panel: its frame, and at
    /// whose ends which numbers lie.
    pub(crate) fn panel(&mut self, at: Frame, x: &Ends<'_>, y: &Ends<'_>) {
        self.push(format_args!(
            "<rect class=\"panel\" x=\"{}\" y=\"{}\" width=\"{}\" \
             height=\"{}\" fill=\"none\" data-x=\"{} {}\" data-y=\"{} {}\" \
             data-across=\"{}\" data-up=\"{}\"/>",
            number(at.left),
            number(at.top),
            number(at.width().max(0.0)),
            number(at.height().max(0.0)),
            x.low,
            x.high,
            y.low,
            y.high,
            escape(x.name),
            escape(y.name),
        ));
    }

    /// The sign and the words of a legend entry, drawn together.
    pub(crate) fn key(&mut self, name: &str, draw: impl FnOnce(&mut Self)) {
        self.push(format_args!(
            "<g class=\"key\" data-key=\"{}\">",
            escape(name)
        ));
        draw(self);
        self.push(format_args!("</g>"));
    }

    /// A text on one line.
    pub(crate) fn text(
        &mut self,
        at: Point,
        anchor: Anchor,
        colour: &str,
        text: &str,
    ) {
        self.label(at, anchor, colour, "", text);
    }

    /// A text in bold type.
    pub(crate) fn heading(&mut self, at: Point, text: &str) {
        self.bold(at, Anchor::Start, text);
    }

    /// The same, fixed to its point as said.
    pub(crate) fn bold(&mut self, at: Point, anchor: Anchor, text: &str) {
        let bold = " font-weight=\"600\"";
        self.label(at, anchor, INK, bold, text);
    }

    /// A text in the middle of a point, read from below to above.
    pub(crate) fn upwards(&mut self, at: Point, colour: &str, text: &str) {
        let turn = format!(
            " transform=\"rotate(-90 {} {})\"",
            number(at.0),
            number(at.1)
        );
        self.label(at, Anchor::Middle, colour, &turn, text);
    }

    fn label(
        &mut self,
        at: Point,
        anchor: Anchor,
        colour: &str,
        more: &str,
        text: &str,
    ) {
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        self.push(format_args!(
            "<text x=\"{}\" y=\"{}\" fill=\"{colour}\"{anchor}{more}>{}</text>",
            number(at.0),
            number(at.1),
            escape(text)
        ));
    }

    /// From here on only what lies inside the frame is seen.
    pub(crate) fn clip(&mut self, to: Frame) {
        let id = format!("{}-{}", self.name, self.clips);
        self.clips += 1;
        self.push(format_args!(
            "<clipPath id=\"{id}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" \
             height=\"{}\"/></clipPath><g clip-path=\"url(#{id})\">",
            number(to.left),
            number(to.top),
            number(to.width().max(0.0)),
            number(to.height().max(0.0)),
        ));
    }

    /// Ends what `clip` began, and the series.
    pub(crate) fn unclip(&mut self) {
        self.of("");
        self.push(format_args!("</g>"));
    }

    /// The document, with what a screen reader says about it.
    pub(crate) fn finish(self, title: &str) -> String {
        let (title, height) = (escape(title), number(self.height));
        let width = number(self.width);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" \
             aria-label=\"{title}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"system-ui, 'Helvetica Neue', Arial, \
             'DejaVu Sans', sans-serif\" font-size=\"{FONT}\">\n\
             <title>{title}</title>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
             {}</svg>\n",
            self.body
        )
    }
}

fn path(points: &[Point]) -> String {
    let mut out = String::new();
    let mut down = false;
    for &(x, y) in points {
        if !(x.is_finite() && y.is_finite()) {
            down = false;
            continue;
        }
        let verb = if down { 'L' } else { 'M' };
        let _ = write!(out, "{verb}{} {}", number(x), number(y));
        down = true;
    }
    out
}

fn stroke(pen: Pen) -> String {
    let mut out = format!(
        " stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"",
        pen.colour, pen.width
    );
    if !pen.dash.is_empty() {
        let _ = write!(out, " stroke-dasharray=\"{}\"", pen.dash);
    }
    if pen.opacity < 1.0 {
        let _ = write!(out, " stroke-opacity=\"{}\"", pen.opacity);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finite_breaks_the_line() {
        let gap = [(0.0, 0.0), (1.0, f64::NAN), (2.0, 1.0), (3.0, 1e300)];
        assert_eq!(path(&gap), "M0 0M2 1L3 100000");
    }

    #[test]
    fn names_come_out_as_text() {
        let mut canvas = Canvas::new("test", 10.0);
        canvas.text((0.0, 0.0), Anchor::Start, INK, "<b>&\"");
        let svg = canvas.finish("<script>");
        assert!(svg.contains(">&lt;b&gt;&amp;&quot;</text>"));
        assert!(!svg.contains("<script>"));
    }
}
