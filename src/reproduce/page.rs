//! The reproduction in words, as a terminal table and as one HTML page.

use maud::{Markup, html};

use super::{ModelStudy, PriorStudy, Reading, Reproduction, Which, error_of};
use crate::draws::median;
use crate::report::digits::share_interval;
use crate::report::svg::{
    Boxes, Curves, Histogram, Picture, box_plots, curves, histograms,
};
use crate::report::{figure, how_computed, standalone};

/// Table 5 of the paper, in percent: mu, xi, sigma2, and mu, xi, phi, sigma2.
const PAPER: [&[usize]; 2] = [&[64, 84, 0], &[98, 82, 93, 98]];

fn paper(which: Which) -> &'static [usize] {
    PAPER[which as usize]
}

fn per_cent(count: usize, samples: usize) -> f64 {
    100.0 * count as f64 / samples as f64
}

/// A share of the series in per cent, with its 90 % interval.
fn share(count: usize, samples: usize) -> String {
    let (low, high) = share_interval(count, samples);
    let [low, high] = [low, high].map(|end| 100.0 * end);
    format!("{:.0} ({low:.0} to {high:.0})", per_cent(count, samples))
}

fn above(values: &[f64], threshold: f64) -> usize {
    values.iter().filter(|x| **x > threshold).count()
}

/// How far a count lies from a share of the paper's, in standard errors of
/// both: the paper's is a count of 100 series.
fn apart(count: usize, samples: usize, paper: usize) -> f64 {
    let both = error_of(count, samples).hypot(error_of(paper, 100));
    (per_cent(count, samples) - paper as f64) / both
}

/// What came out, in sentences.
pub fn words(found: &Reproduction) -> Vec<String> {
    let [wide, printed] = &found.priors;
    let mut said = vec![format!(
        "{} synthetic series from the paper's Table 2, on a Lautaret-like \
         track: neither the recording nor the surveyed track are published, \
         so its Table 4 cannot be computed again.",
        found.samples
    )];
    said.extend(left_out(found));
    said.extend([wide, printed].map(favoured));
    for study in [wide, printed] {
        said.push(agreement(study, found.samples));
    }
    said.push(sampler_agrees(found));
    said.push(explained(found));
    let (count, least) = least_p(found);
    said.push(format!(
        "Simulation-based calibration of both models, {} replications: of \
         {count} rank histograms the least even one has p = {least:.3}.",
        2 * (found.samples + found.left_out)
    ));
    said.push(windows_matter(found));
    said.push(format!(
        "On the first series M1's median speed is {:+.2} m/s from M0's over \
         240 m on average (Delta1; 1.31 in the paper, on its own recording), \
         {:.2} m/s root mean square (Delta2; 1.72).",
        found.case.delta1, found.case.delta2
    ));
    said
}

/// How often M1 is favoured, and how much.
fn favoured(study: &PriorStudy) -> String {
    let bf = study.log10_bf();
    format!(
        "With xi ~ {}: log10 B10 has the median {:.2}, lies above 0 for \
         {} % of the series and above 2 (decisive) for {} %. The paper \
         has every series above 2.",
        study.priors.xi,
        median(&bf),
        percent(above(&bf, 0.0), bf.len()),
        percent(above(&bf, 2.0), bf.len()),
    )
}

/// What comes of taking a mean speed for that of an instant.
fn windows_matter(found: &Reproduction) -> String {
    let [right, wrong] = &found.windows;
    format!(
        "Equation 13's values are mean speeds over the last second. Taken as \
         such, the 90 % intervals of mu and xi under M1 hold the truth for \
         {} and {} % of {} series; taken for speeds of one instant, {} and \
         {} %.",
        percent(right.covered[1][0], right.samples),
        percent(right.covered[1][1], right.samples),
        right.samples,
        percent(wrong.covered[1][0], wrong.samples),
        percent(wrong.covered[1][1], wrong.samples),
    )
}

/// How many series are missing, where some are.
fn left_out(found: &Reproduction) -> Option<String> {
    let others = found.readings.iter().chain(&found.windows);
    let others: usize = others.map(|reading| reading.left_out).sum();
    (found.left_out + others > 0).then(|| {
        format!(
            "{} series of the study and {others} of its other readings are \
             left out: their errors carry them off the track.",
            found.left_out
        )
    })
}

fn percent(count: usize, samples: usize) -> String {
    format!("{:.0}", per_cent(count, samples))
}

/// Which of the paper's coverages the study gives too, and which not.
fn agreement(study: &PriorStudy, samples: usize) -> String {
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for m in &study.models {
        for (i, name) in m.names.iter().enumerate() {
            let paper = paper(m.which)[i];
            let label = format!("{}'s {name}", m.which.name());
            if apart(m.covered[i], samples, paper).abs() < 3.0 {
                with.push(label);
            } else {
                let here = share(m.covered[i], samples);
                without.push(format!("{label} ({here} % against {paper})"));
            }
        }
    }
    let listed = |list: Vec<String>| match list.is_empty() {
        true => "none".to_owned(),
        false => list.join(", "),
    };
    format!(
        "With xi ~ {}, within 3 standard errors of the paper's Table 5: {}; \
         beyond: {}.",
        study.priors.xi,
        listed(with),
        listed(without)
    )
}

fn sampler_agrees(found: &Reproduction) -> String {
    let counts = found.priors.iter().flat_map(|p| &p.models).flat_map(|m| {
        m.covered.iter().zip(&m.covered_exactly).map(|(a, b)| a.abs_diff(*b))
    });
    let evidence = found.priors.iter().flat_map(|p| {
        let exact = p.log10_bf_exact();
        p.log10_bf().into_iter().zip(exact).map(|(a, b)| (a - b).abs())
    });
    let apart: Vec<f64> = evidence.collect();
    format!(
        "Samplers and quadrature on the same series: coverages differ by {} \
         of {} series at the most, log10 B10 by {:.3} in the median.",
        counts.max().unwrap_or(0),
        found.samples,
        median(&apart)
    )
}

/// Whether another reading of the protocol gives the paper's two odd figures.
fn explained(found: &Reproduction) -> String {
    let fits = |r: &&Reading| {
        let near = |m: usize| {
            r.covered[m].iter().zip(PAPER[m]).all(|(count, paper)| {
                apart(*count, r.samples, *paper).abs() < 3.0
            })
        };
        near(0) && near(1)
    };
    match found.readings.iter().find(fits) {
        Some(reading) => format!(
            "One other reading of the protocol comes within 3 standard \
             errors of the whole of Table 5: {}.",
            reading.what
        ),
        None => format!(
            "None of {} other readings of the protocol gives the whole of \
             the paper's Table 5; no sampler error would: quadrature has none.",
            found.readings.len()
        ),
    }
}

/// `reproduction.html`.
pub fn page(found: &Reproduction) -> String {
    let [wide, printed] = &found.priors;
    let body = html! {
        h1 { "Heredia, Eckert, Prieur and Thibert (2020), computed again" }
        p.sub {
            span.synthetic { "synthetic data" } " "
            (found.samples) " series on a Lautaret-like track, seed "
            (found.seed)
        }
        ul.words { @for sentence in words(found) { li { (sentence) } } }
        (coverage_table(found))
        (figure(&modes(found)))
        (figure(&bayes_factors(found)))
        (readings_table(
            "Other readings of the protocol",
            &found.readings, wide))
        (readings_table(
            "Mean speeds over a second (equation 13)",
            &found.windows, wide))
        (figure(&ranks(found)))
        (sensitivity_table(found))
        (figure(&sensitivity_curves(found, Which::M0)))
        (figure(&sensitivity_curves(found, Which::M1)))
        h2 { "One series in detail" }
        p { "Priors and posteriors, pairs, predictive bands and residual \
             tests of the first series (the paper's Figures 4 to 7): "
            a href="m0.html" { "M0" } " and " a href="m1.html" { "M1" } "." }
        p.note { "xi's prior is " (wide.priors.xi) " where nothing else is \
                  said; as printed it is " (printed.priors.xi) ", whose mean \
                  of 1000 and sd of 200 do not go with the paper's own \
                  posterior (sd 306, mode 496)." }
        (computed(found))
    };
    standalone("Heredia et al. (2020), computed again", &body)
}

/// What the series come from: a seed, and no file.
fn computed(found: &Reproduction) -> Markup {
    let mut facts = found.origin.facts();
    facts.push(("seed".to_owned(), found.seed.to_string()));
    how_computed(&facts, &[])
}

fn coverage_table(found: &Reproduction) -> Markup {
    html! {
        h2 { "Coverage of 90 % intervals (Table 5)" }
        div.wide { table {
            thead { tr {
                @for heading in ["model", "parameter", "paper",
                    "xi wide", "exact", "xi as printed", "exact"] {
                    th scope="col" { (heading) }
                }
            } }
            tbody {
                @for which in Which::BOTH { (coverage_rows(found, which)) }
            }
        } }
        p.note { "Per cent of the series, with a 90 % interval by the \
                  number of series; exact: the intervals by quadrature, of the same \
                  series. The truth is that of Table 2, for sigma2 the \
                  variance of the innovations under both models." }
    }
}

fn coverage_rows(found: &Reproduction, which: Which) -> Markup {
    let [a, b] = found.priors.each_ref().map(|p| &p.models[which as usize]);
    let cell = |m: &ModelStudy, i: usize| share(m.covered[i], found.samples);
    let exact = |m: &ModelStudy, i: usize| {
        percent(m.covered_exactly[i], found.samples)
    };
    html! {
        @for (i, name) in a.names.iter().enumerate() {
            tr {
                td { (which.name()) }
                td.name { (name) }
                td { (paper(which)[i]) }
                td { (cell(a, i)) }
                td { (exact(a, i)) }
                td { (cell(b, i)) }
                td { (exact(b, i)) }
            }
        }
    }
}

/// What the paper's parameters are called, with their units.
const AXES: [(&str, &str, f64); 4] = [
    ("mu", "mu", 0.32),
    ("xi", "xi [m/s²]", 495.73),
    ("sigma2", "sigma2 [m²/s²]", 8.07),
    ("phi", "phi", 0.65),
];

fn modes(found: &Reproduction) -> Picture {
    let panel = |(name, label, truth): (&str, &str, f64)| {
        let of = |p: &PriorStudy| -> Vec<(String, Vec<f64>)> {
            p.models
                .iter()
                .filter_map(|m| {
                    let i = m.names.iter().position(|n| n == name)?;
                    let label = format!("{}, {}", m.which.name(), p.name);
                    Some((label, m.modes[i].clone()))
                })
                .collect()
        };
        let samples = found.priors.iter().flat_map(of).collect();
        Boxes { label: label.to_owned(), truth: Some(truth), samples }
    };
    box_plots(
        "modes",
        "Modes of all series (Figure 8 a to d)",
        "Box: the quartiles and the median of the posterior modes; whiskers \
         from 5 to 95 %; dashed: the truth.",
        &AXES.map(panel),
    )
}

fn bayes_factors(found: &Reproduction) -> Picture {
    let samples = found
        .priors
        .iter()
        .flat_map(|p| {
            [
                (format!("{}, sampled", p.name), p.log10_bf()),
                (format!("{}, exact", p.name), p.log10_bf_exact()),
            ]
        })
        .collect();
    let panel =
        Boxes { label: "log10 B10".to_owned(), truth: Some(2.0), samples };
    box_plots(
        "bayes-factors",
        "Bayes factor of M1 against M0 (Figure 8 e)",
        "Of every series, by bridge sampling and by quadrature; dashed: \
         2, from where evidence is called decisive (Kass and Raftery 1995).",
        &[panel],
    )
}

fn ranks(found: &Reproduction) -> Picture {
    let both = Which::BOTH.iter().zip(&found.ranks);
    let panels: Vec<Histogram> = both
        .flat_map(|(which, ranks)| {
            ranks.names.iter().enumerate().map(|(i, name)| Histogram {
                label: format!(
                    "{}, {name}: p {:.2}",
                    which.name(),
                    ranks.p(i)
                ),
                counts: ranks.histogram(i).to_vec(),
            })
        })
        .collect();
    histograms(
        "ranks",
        "Simulation-based calibration",
        "Not in the paper. The rank of a true value drawn from the prior \
         (xi's wide) among draws of its posterior, in tenths, on a longer slope: even where \
         model and sampler are right. Line: the mean; dashed: where a tenth \
         lies 99 times in 100; p: that of an unevenness so large, by \
         chi-squared.",
        &panels,
    )
}

/// The least p-value of all ranks.
fn least_p(found: &Reproduction) -> (usize, f64) {
    let all = found.ranks.iter();
    let all = all.flat_map(|r| (0..r.names.len()).map(|i| r.p(i)));
    all.fold((0, 1.0), |(n, least), p| (n + 1, f64::min(least, p)))
}

fn readings_table(title: &str, all: &[Reading], wide: &PriorStudy) -> Markup {
    let shares = |r: &Reading, m: usize| -> Vec<String> {
        r.covered[m].iter().map(|n| percent(*n, r.samples)).collect()
    };
    let heading =
        |m: usize| format!("M{m}: {}", wide.models[m].names.join(" / "));
    html! {
        h2 { (title) }
        div.wide { table {
            thead { tr {
                th scope="col" { "series" }
                th scope="col" { (heading(0)) }
                th scope="col" { (heading(1)) }
                th scope="col" { "log10 B10" }
            } }
            tbody { @for r in all { tr {
                td.said { (r.what) }
                td { (shares(r, 0).join(" / ")) }
                td { (shares(r, 1).join(" / ")) }
                td { (format!("{:.2}", median(&r.log10_bf))) }
            } } }
        } }
        (readings_note(all))
    }
}

fn readings_note(all: &[Reading]) -> Markup {
    let samples = all.first().map_or(1, |r| r.samples);
    let se = error_of(samples * 4 / 5, samples).round();
    let widths: Vec<String> = all
        .iter()
        .map(|r| format!("{:.3} and {:.3}", r.width_mu[0], r.width_mu[1]))
        .collect();
    html! {
        p.note { "Coverage of exact 90 % intervals in per cent of " (samples)
            " series (standard error about " (se) "), xi's prior wide, and \
             the median of log10 B10. Mean width of mu's interval under M0 \
             and M1, line by line: " (widths.join("; ")) "." }
    }
}

fn sensitivity_table(found: &Reproduction) -> Markup {
    html! {
        h2 { "Prior sensitivity (Table 6)" }
        div.wide { table {
            thead { tr {
                @for heading in ["set", "priors of mu, xi, sigma2",
                    "posterior median (90 % interval)"] {
                    th scope="col" { (heading) }
                }
            } }
            tbody { @for s in &found.sensitivity { tr {
                td { (s.set) ", " (s.which.name()) }
                td { @for prior in [s.priors.mu, s.priors.xi, s.priors.sigma2]
                    { div { (prior) } } }
                td { @for (name, [low, middle, high]) in &s.quantiles {
                    div { (format!(
                        "{name} {} ({} to {})",
                        three(*middle), three(*low), three(*high)
                    )) }
                } }
            } } }
        } }
        p.note { "The first series; largest R-hat "
            (format!("{:.3}", found.sensitivity.iter()
                .map(|s| s.rhat).fold(1.0, f64::max)))
            ". The paper does not define its vague \
                  priors: here they are uniform, over 0 to 2, 0 to 20 000 \
                  m/s² and 0 to 1000 m²/s². Its set 6 names an inverse gamma \
                  prior for xi, taken for a slip of the column: xi's \
                  informative prior is kept with M1, as its text says." }
    }
}

fn three(x: f64) -> String {
    match x.abs() {
        a if a >= 100.0 => format!("{x:.0}"),
        a if a >= 1.0 => format!("{x:.1}"),
        _ => format!("{x:.2}"),
    }
}

fn sensitivity_curves(found: &Reproduction, which: Which) -> Picture {
    let sets: Vec<_> =
        found.sensitivity.iter().filter(|s| s.which == which).collect();
    let names: Vec<String> =
        sets.iter().map(|s| format!("set {}", s.set)).collect();
    let panels: Vec<Curves> = AXES
        .iter()
        .filter_map(|(name, label, _)| {
            let of = |s: &&super::Sensitivity| {
                s.quantiles.iter().position(|(n, _)| n == name)
            };
            let curves: Vec<_> = sets
                .iter()
                .enumerate()
                .filter_map(|(k, s)| Some((k, s.densities[of(s)?].clone())))
                .collect();
            let label = (*label).to_owned();
            (!curves.is_empty()).then_some(Curves { label, curves })
        })
        .collect();
    let (name, title) = match which {
        Which::M0 => ("sets-m0", "Posteriors under each prior, M0 (Figure 9)"),
        Which::M1 => ("sets-m1", "Posteriors under each prior, M1 (Figure 9)"),
    };
    curves(name, title, "Each curve is one set of Table 6.", &names, &panels)
}
