//! Prior and posterior density of each parameter, a panel each.

use super::axes::{Axes, Key, Labels, Scale, legend};
use super::canvas::{Canvas, Frame, Point, Sheet};
use super::palette::{FLOW, POSTERIOR, PRIOR, Pen};
use super::{Picture, with_unit};
use crate::report::text::{shorten, thinned};
use crate::report::{CalibrationReport, ParameterReport};

/// How many points of a density are drawn.
const POINTS: usize = 250;
const PANEL: f64 = 116.0;
const ROW: f64 = PANEL + 62.0;
const GAP: f64 = 26.0;

const PRIOR_LINE: Pen = Pen::new(PRIOR, 1.8).dashed();
const POSTERIOR_LINE: Pen = Pen::new(POSTERIOR, 1.8);

/// A panel for each parameter that has a density.
pub(super) fn draw(
    report: &CalibrationReport,
    sheet: Sheet,
) -> Option<Picture> {
    let shown: Vec<&ParameterReport> = report
        .parameters
        .iter()
        .filter(|p| p.posterior_density.len() > 1 || p.prior_density.len() > 1)
        .collect();
    if shown.is_empty() {
        return None;
    }
    let columns = sheet.columns(match shown.len() {
        1 => 1,
        2 | 4 => 2,
        _ => 3,
    });
    let rows = shown.len().div_ceil(columns);
    let mut canvas = Canvas::on(sheet, "densities", 30.0 + ROW * rows as f64);
    let keys = [
        (Key::Line(POSTERIOR_LINE), "posterior"),
        (Key::Line(PRIOR_LINE), "prior"),
        (Key::Fill(FLOW), "90 % interval"),
    ];
    let top = legend(&mut canvas, 12.0, 2.0, &keys);
    let width = (sheet.width() - 24.0 + GAP) / columns as f64;
    for (i, p) in shown.into_iter().enumerate() {
        let left = 12.0 + width * (i % columns) as f64;
        let top = top + 4.0 + ROW * (i / columns) as f64;
        let (right, bottom) = (left + width - GAP, top + PANEL);
        panel(&mut canvas, Frame { left, top, right, bottom }, p);
    }
    Some(Picture {
        name: "densities",
        title: "Prior and posterior",
        caption: "What was known of each parameter before the recording \
             (dashed) and after it (full line; the shaded part holds 90 %, \
             the upright line is the median). Where both curves agree, the \
             recording has taught nothing. Each panel has its own scale; a \
             prior that is wider is cut off."
            .to_owned(),
        phone: String::new(),
        svg: canvas.finish("Prior and posterior density of each parameter"),
    })
}

fn panel(canvas: &mut Canvas, frame: Frame, p: &ParameterReport) {
    let x = value_scale(p);
    let seen = |d: &[(f64, f64)]| -> Vec<f64> {
        let seen = d.iter().filter(|q| x.low <= q.0 && q.0 <= x.high);
        seen.map(|q| q.1).collect()
    };
    let mut heights = seen(&p.posterior_density);
    heights.extend(seen(&p.prior_density));
    let high = Scale::of(heights).high.max(1e-150) * 1.06;
    let axes = Axes { frame, x, y: Scale { low: 0.0, high } };
    canvas.clip(frame);
    canvas.of("90 % interval");
    draw_interval(canvas, &axes, p);
    canvas.of("prior");
    canvas.curve(&curve(&axes, &p.prior_density), PRIOR_LINE);
    canvas.of("posterior");
    canvas.curve(&curve(&axes, &p.posterior_density), POSTERIOR_LINE);
    canvas.unclip();
    let most = (frame.width() / 8.0) as usize;
    let name = shorten(&with_unit(&p.name, &p.unit), most);
    axes.draw(canvas, Labels { x: Some(&name), y: None });
    axes.describe(canvas, [&with_unit(&p.name, &p.unit), "density"]);
}

/// The posterior with as much again at both sides, where the prior reaches
/// that far.
fn value_scale(p: &ParameterReport) -> Scale {
    let prior = || Scale::of(p.prior_density.iter().map(|q| q.0));
    if p.posterior_density.is_empty() {
        return prior();
    }
    let posterior = Scale::of(p.posterior_density.iter().map(|q| q.0));
    if p.prior_density.is_empty() {
        return posterior;
    }
    posterior.padded(0.6).within(prior()).with(posterior)
}

fn curve(axes: &Axes, density: &[(f64, f64)]) -> Vec<Point> {
    let kept = thinned(density.len(), POINTS).into_iter();
    kept.map(|i| axes.at(density[i].0, density[i].1)).collect()
}

/// The part of the posterior inside its 90 % interval, and the median.
fn draw_interval(canvas: &mut Canvas, axes: &Axes, p: &ParameterReport) {
    let d = &p.posterior_density;
    let mut inside: Vec<(f64, f64)> = vec![(p.q05, height(d, p.q05))];
    let between = d.iter().filter(|q| p.q05 < q.0 && q.0 < p.q95);
    inside.extend(between);
    inside.push((p.q95, height(d, p.q95)));
    let high = curve(axes, &inside);
    let low: Vec<Point> =
        high.iter().map(|q| (q.0, axes.frame.bottom)).collect();
    canvas.area(&low, &high, FLOW, 0.75);
    let median = axes.at(p.q50, height(d, p.q50));
    canvas.line((median.0, axes.frame.bottom), median, POSTERIOR_LINE);
}

/// The density at a value, between two points that it is given at.
fn height(density: &[(f64, f64)], x: f64) -> f64 {
    let found = density.windows(2).find(|w| w[0].0 <= x && x <= w[1].0);
    let Some([(a, low), (b, high)]) = found else { return 0.0 };
    if b > a { low + (high - low) * (x - a) / (b - a) } else { *high }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_height_between_points_is_on_their_line() {
        let density = [(0.0, 0.0), (1.0, 2.0), (2.0, 0.0)];
        assert_eq!(height(&density, 0.25), 0.5);
        assert_eq!(height(&density, 3.0), 0.0);
        assert_eq!(height(&[], 3.0), 0.0);
    }
}
