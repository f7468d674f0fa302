//! Where the draws of each chain rank among those of all chains (Vehtari et
//! al. 2021, section 4.3).

use super::axes::{Axes, Key, Scale, legend};
use super::canvas::{Canvas, Frame, Point, Sheet};
use super::palette::{CHAINS, GREY, Pen};
use super::series::CHAIN_NAMES;
use super::{Picture, with_unit};
use crate::report::text::shorten;
use crate::report::{CalibrationReport, ParameterReport};

/// The most bins, and the fewest draws that a chain has in one on average.
const BINS: usize = 20;
const IN_A_BIN: usize = 10;
const PANEL: f64 = 96.0;
const ROW: f64 = PANEL + 62.0;
const GAP: f64 = 26.0;

const EVEN: Pen = Pen::new(GREY, 1.4).dashed();

/// A panel for each parameter that has several chains of some length.
pub(super) fn draw(
    report: &CalibrationReport,
    sheet: Sheet,
) -> Option<Picture> {
    let all = report.parameters.iter();
    let shown: Vec<(&ParameterReport, Vec<Vec<usize>>)> =
        all.filter_map(|p| Some((p, ranked(&p.chains)?))).collect();
    let chains = shown.iter().map(|(_, counts)| counts.len()).max()?;
    let columns = sheet.columns(shown.len().min(2));
    let rows = shown.len().div_ceil(columns);
    let mut canvas = Canvas::on(sheet, "ranks", 30.0 + ROW * rows as f64);
    let top = legend(&mut canvas, 12.0, 2.0, &entries(chains));
    let width = (sheet.width() - 24.0 + GAP) / columns as f64;
    for (i, (p, counts)) in shown.iter().enumerate() {
        let left = 12.0 + width * (i % columns) as f64;
        let top = top + 4.0 + ROW * (i / columns) as f64;
        let (right, bottom) = (left + width - GAP, top + PANEL);
        panel(&mut canvas, Frame { left, top, right, bottom }, p, counts);
    }
    Some(Picture {
        name: "ranks",
        title: "Ranks of the chains",
        caption: "How many draws of a chain rank where among those of all \
             chains, from the smallest on the left to the largest on the \
             right. Chains that have found the same posterior go up and down \
             about the dashed line; one that stays above it at one side has \
             been elsewhere."
            .to_owned(),
        phone: String::new(),
        svg: canvas.finish("Ranks of each chain's draws among all"),
    })
}

fn entries(chains: usize) -> Vec<(Key, &'static str)> {
    let keys = CHAIN_NAMES.iter().zip(CHAINS);
    let lines = keys
        .take(chains)
        .map(|(name, colour)| (Key::Line(Pen::new(colour, 2.5)), *name));
    lines.chain([(Key::Line(EVEN), "evenly")]).collect()
}

/// How many draws of each chain lie in each bin of ranks; `None` where there
/// are too few to say.
fn ranked(chains: &[Vec<f64>]) -> Option<Vec<Vec<usize>>> {
    let shortest = chains.iter().map(Vec::len).min()?;
    let bins = (shortest / IN_A_BIN).min(BINS);
    if chains.len() < 2 || bins < 2 {
        return None;
    }
    let numbered = chains.iter().enumerate();
    let mut all: Vec<(f64, usize)> = numbered
        .flat_map(|(i, chain)| chain.iter().map(move |x| (*x, i)))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut counts = vec![vec![0; bins]; chains.len()];
    for (rank, (_, chain)) in all.iter().enumerate() {
        counts[*chain][rank * bins / all.len()] += 1;
    }
    Some(counts)
}

fn panel(
    canvas: &mut Canvas,
    frame: Frame,
    p: &ParameterReport,
    counts: &[Vec<usize>],
) {
    let draws: usize = counts.iter().flatten().sum();
    let bins = counts.first().map_or(1, Vec::len);
    let even = draws as f64 / (counts.len() * bins) as f64;
    let most = counts.iter().flatten().map(|n| *n as f64);
    let y = Scale { low: 0.0, high: 1.08 * most.fold(2.0 * even, f64::max) };
    let axes = Axes { frame, x: Scale { low: 0.0, high: bins as f64 }, y };
    let letters = (frame.width() / 8.0) as usize;
    let name = shorten(&with_unit(&p.name, &p.unit), letters);
    canvas.clip(frame);
    let colours = CHAINS.into_iter().cycle();
    for (i, (chain, colour)) in counts.iter().zip(colours).enumerate() {
        canvas.of(CHAIN_NAMES.get(i).copied().unwrap_or_default());
        canvas.curve(&steps(&axes, chain), Pen::new(colour, 1.4).faded(0.8));
    }
    canvas.of("evenly");
    canvas.line(axes.at(0.0, even), axes.at(bins as f64, even), EVEN);
    canvas.unclip();
    let Frame { left, right, bottom, .. } = frame;
    canvas.line((left, bottom), (right, bottom), Pen::new(GREY, 1.0));
    axes.draw_name(canvas, &name);
}

/// A line that is level over each bin.
fn steps(axes: &Axes, counts: &[usize]) -> Vec<Point> {
    let level = |(i, n): (usize, &usize)| {
        [i, i + 1].map(|end| axes.at(end as f64, *n as f64))
    };
    counts.iter().enumerate().flat_map(level).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_apart_fill_different_bins() {
        let low: Vec<f64> = (0..40).map(f64::from).collect();
        let high: Vec<f64> = (40..80).map(f64::from).collect();
        let counts = ranked(&[low.clone(), high]).unwrap();
        assert_eq!(counts, [[20, 20, 0, 0], [0, 0, 20, 20]]);
        let alike: Vec<f64> = low.iter().map(|x| x + 0.5).collect();
        let counts = ranked(&[low.clone(), alike]).unwrap();
        assert!(counts.iter().flatten().all(|n| *n == 10), "{counts:?}");
        assert!(ranked(&[low]).is_none());
        assert!(ranked(&[vec![0.0; 9], vec![1.0; 9]]).is_none());
    }
}
