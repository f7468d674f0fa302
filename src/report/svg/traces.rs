//! The draws of each parameter in the order in which the chains made them.

use super::axes::{Axes, Key, Labels, Scale, legend};
use super::canvas::{Canvas, FONT, Frame, Sheet};
use super::palette::{CHAINS, Pen};
use super::series::CHAIN_NAMES;
use super::{Picture, with_unit};
use crate::report::text::{shorten, thinned};
use crate::report::{CalibrationReport, ParameterReport};

/// How many points all panels share.
const POINTS: usize = 24_000;
const PANEL: f64 = 84.0;
const ROW: f64 = PANEL + FONT + 18.0;

/// A panel for each parameter that has chains.
pub(super) fn draw(
    report: &CalibrationReport,
    sheet: Sheet,
) -> Option<Picture> {
    let shown: Vec<&ParameterReport> = report
        .parameters
        .iter()
        .filter(|p| p.chains.iter().any(|c| c.len() > 1))
        .collect();
    let chains = shown.iter().map(|p| p.chains.len()).max()?;
    let longest = shown.iter().flat_map(|p| &p.chains).map(Vec::len).max()?;
    let most = (POINTS / (chains * shown.len())).clamp(60, 600);
    let height = 30.0 + ROW * shown.len() as f64 + 2.0 * FONT + 14.0;
    let mut canvas = Canvas::on(sheet, "traces", height);
    let top = legend(&mut canvas, 12.0, 2.0, &entries(chains));
    let scales: Vec<Scale> = shown.iter().map(|p| scale(p)).collect();
    let margins = scales.iter().map(|y| Axes::margin(*y, PANEL) - 18.0);
    let left = margins.fold(30.0, f64::max);
    let x = Scale { low: 0.0, high: (longest - 1).max(1) as f64 };
    for (i, (p, y)) in shown.iter().zip(scales).enumerate() {
        let top = top + FONT + 6.0 + ROW * i as f64;
        let (right, bottom) = (sheet.width() - 14.0, top + PANEL);
        let frame = Frame { left, top, right, bottom };
        let axes = Axes { frame, x, y };
        let last = i + 1 == shown.len();
        let name = last.then_some("kept draw");
        axes.draw(&mut canvas, Labels { x: name, y: Some("") });
        let title = shorten(&with_unit(&p.name, &p.unit), 64);
        canvas.heading((left, top - 6.0), &title);
        lines(&mut canvas, &axes, p, most);
    }
    Some(Picture {
        name: "traces",
        title: "Traces",
        caption: caption(longest, most),
        phone: String::new(),
        svg: canvas.finish("The draws of each chain in their order"),
    })
}

fn entries(chains: usize) -> Vec<(Key, &'static str)> {
    let keys = CHAIN_NAMES.iter().zip(CHAINS);
    let mut out: Vec<_> = keys
        .take(chains)
        .map(|(name, c)| (Key::Line(Pen::new(c, 2.5)), *name))
        .collect();
    if chains > out.len() {
        out.truncate(2);
        out.push((Key::Line(Pen::new(CHAINS[2], 2.5)), "and so on"));
    }
    out
}

fn scale(p: &ParameterReport) -> Scale {
    Scale::of(p.chains.iter().flatten().copied()).padded(0.05)
}

fn lines(canvas: &mut Canvas, axes: &Axes, p: &ParameterReport, most: usize) {
    canvas.clip(axes.frame);
    let colours = CHAINS.into_iter().cycle();
    for (i, (chain, colour)) in p.chains.iter().zip(colours).enumerate() {
        canvas.of(CHAIN_NAMES.get(i).copied().unwrap_or_default());
        let kept = thinned(chain.len(), most).into_iter();
        let points: Vec<_> =
            kept.map(|i| axes.at(i as f64, chain[i])).collect();
        canvas.curve(&points, Pen::new(colour, 0.9).faded(0.75));
    }
    canvas.unclip();
}

fn caption(longest: usize, most: usize) -> String {
    let mut out = "Chains that have found the posterior look like noise of \
         one level and one width and lie on top of each other; steps, \
         trends or chains apart mean that the run was too short."
        .to_owned();
    if longest > most {
        out.push_str(&format!(
            " Of up to {longest} draws a chain, {most} evenly spread ones \
             are drawn."
        ));
    }
    out
}
