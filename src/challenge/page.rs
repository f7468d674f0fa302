//! The score in words and as one HTML page.

use std::collections::BTreeSet;

use maud::{Markup, html};

use super::case::{Coordinate, Interval, Mix, Truth};
use super::effects::{CATALOGUE, Class, OUTSIDE};
use super::power::{PowerTable, percent};
use super::scatter::Errors;
use super::score::{
    EffectScore, NONE, Outcome, Score, Share, UNKNOWN, failures,
};
use super::trial::Scored;
use crate::report::digits::share_interval;
use crate::report::svg::{
    Bin, Matrix, Picture, matrix as matrix_picture, reliability,
};
use crate::report::{Origin, figure, how_computed, standalone};

/// `81 % (76 to 85 %; 162 of 200)`.
fn told(share: &Share) -> String {
    let Share { hits, of } = share;
    if *of == 0 {
        return "no case".to_owned();
    }
    let (low, high) = share_interval(*hits, *of);
    let [value, low, high] =
        [share.value(), low, high].map(|share| 100.0 * share);
    format!("{value:.0} % ({low:.0} to {high:.0} %; {hits} of {of})")
}

fn two(x: f64) -> String {
    if x.is_finite() { format!("{x:.2}") } else { "–".to_owned() }
}

/// How well stretches were located, where any was.
fn overlap(s: &Score) -> String {
    if !s.median_iou.is_finite() {
        return String::new();
    }
    format!(
        "; the located stretch overlaps the true one by {} in the median \
         (intersection over union)",
        two(s.median_iou)
    )
}

/// What came out, in sentences; shares with their 90 % intervals.
pub fn words(scored: &Scored) -> Vec<String> {
    let s = &scored.score;
    let mut said = vec![found(s), visible(s)];
    said.push(format!(
        "Where nothing is missing, something was reported in {}.",
        told(&s.false_alarms)
    ));
    said.push(format!(
        "Where something is missing, it was noticed in {}{}.",
        told(&s.detected),
        overlap(s)
    ));
    said.push(format!(
        "The corrected model leaves at most 1.15 times the noise in {}.",
        told(&s.within_noise)
    ));
    let most = if s.most_worse > 0.0 {
        format!(", by {:.1} % of it at the most,", 100.0 * s.most_worse)
    } else {
        String::new()
    };
    said.push(format!(
        "The fit got worse in {} by its root mean square error{most} and in \
         {} by the least that the motion can have.",
        told(&s.worse),
        told(&s.worse_at_best)
    ));
    said.push(noises(s));
    said.push(format!(
        "Stated probabilities miss the share that is right by {} on average \
         (expected calibration error).",
        two(s.expected_calibration_error)
    ));
    said.extend(outside(s));
    said.push(format!(
        "A diagnosis took {:.1} s in the median, {:.1} s at most.",
        s.seconds.0, s.seconds.1
    ));
    said
}

fn found(s: &Score) -> String {
    format!(
        "{} cases, each with an effect that the diagnosis was not told of, \
         or none: the effect is in the reported group in {}, comes first in \
         {}, and has the most evidence, whatever the prior odds, in {}.",
        s.cases,
        told(&s.in_group),
        told(&s.top1),
        told(&s.leads)
    )
}

/// How often the most probable noise was like the errors, kind by kind.
fn noises(s: &Score) -> String {
    let each: Vec<String> = s
        .noise_kinds
        .iter()
        .map(|(scatter, share)| {
            format!("{} {} of {}", scatter.name(), share.hits, share.of)
        })
        .collect();
    format!(
        "The most probable noise is of the errors' kind in {}: {}.",
        told(&s.noise_kind),
        each.join(", ")
    )
}

fn visible(s: &Score) -> String {
    format!(
        "In {} of them the truth gains less than 8 on the best baseline (log \
         likelihood), too little to outweigh prior odds and parameters: it \
         can hardly come first. Of the others it is in the group in {}, and \
         first in {}.",
        s.in_group.of - s.in_group_visible.of,
        told(&s.in_group_visible),
        told(&s.top1_visible)
    )
}

fn outside(s: &Score) -> Option<String> {
    let o = &s.outside;
    (o.detected.of > 0).then(|| {
        format!(
            "Of {} effects that no catalogue has, {} were noticed, {} called \
             unknown, and {} explained down to the noise by terms that the \
             catalogue has.",
            o.detected.of, o.detected.hits, o.unknown.hits, o.explained.hits
        )
    })
}

/// `challenge.html`. `seed` is that of the cases.
pub fn page(
    scored: &Scored,
    mix: Mix,
    errors: Errors,
    seed: u64,
    origin: &Origin,
) -> String {
    let recordings = match mix {
        Mix::One => "one recording each",
        Mix::Two => "two recordings each, from different starts",
    };
    let scattered = match errors {
        Errors::Simple => "simple errors",
        Errors::Real => {
            "errors as real sensors make them, called ar(1) in all"
        }
    };
    let body = html! {
        h1 { "What was hidden, and what was found" }
        p.sub {
            span.synthetic { "synthetic data" } " "
            (scored.score.cases) " cases, " (recordings) ", " (scattered)
            ", seed " (seed)
        }
        ul.words { @for sentence in words(scored) { li { (sentence) } } }
        (figure(&confusion(&scored.score)))
        (figure(&calibration(&scored.score)))
        (effects_table(&scored.score))
        (failures_table(&failures(&scored.outcomes)))
        p.note { "Tracks, motion, effects and noise come from code that \
                  shares nothing with the diagnosis. Sizes are uniform in \
                  their ranges and drawn before anything else; none is left \
                  out for being weak. Not drawn are tracks on which an effect \
                  is nothing at all, or the same as another mu in every \
                  value: constant slopes for a release elsewhere, for a \
                  bend's load, and under Coulomb friction for cohesion, \
                  scale, drift and slope." }
        (computed(origin, seed))
    };
    standalone("couloir challenge", &body)
}

/// What the cases come from: a seed, and no file.
fn computed(origin: &Origin, seed: u64) -> Markup {
    let mut facts = origin.facts();
    facts.push(("seed".to_owned(), seed.to_string()));
    how_computed(&facts, &[])
}

fn known(class: Class) -> bool {
    class != Class::Outside
}

/// The names of the catalogue, `none` before them and those outside after.
fn order() -> impl Iterator<Item = &'static str> {
    let all = CATALOGUE.iter().chain(&OUTSIDE).map(|kind| kind.name);
    [NONE].into_iter().chain(all)
}

/// What was hidden or answered, in order; whatever else was answered last.
fn columns(s: &Score) -> Vec<String> {
    let answered: BTreeSet<&str> =
        s.confusion.values().flatten().map(|(n, _)| n.as_str()).collect();
    let outside = |name: &str| OUTSIDE.iter().any(|k| k.name == name);
    let hidden = |name: &str| s.confusion.contains_key(name);
    let mut all: Vec<&str> = order()
        .chain([UNKNOWN])
        .filter(|n| answered.contains(n) || (hidden(n) && !outside(n)))
        .collect();
    for name in answered {
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all.into_iter().map(str::to_owned).collect()
}

/// Rows: what was hidden; columns: what came first.
fn confusion(s: &Score) -> Picture {
    let hidden = order().filter(|name| s.confusion.contains_key(*name));
    let rows: Vec<String> = hidden.map(str::to_owned).collect();
    let columns = columns(s);
    let count = |row: &String, column: &String| {
        s.confusion.get(row).and_then(|r| r.get(column)).copied()
    };
    let line = |row: &String| {
        columns.iter().map(|c| count(row, c).unwrap_or(0)).collect()
    };
    let counts = rows.iter().map(line).collect();
    matrix_picture(
        "confusion",
        "Hidden, and taken for",
        "At the left what was hidden, above what came first; how many cases. \
         The darker, the larger a part of its row.",
        &Matrix { rows, columns, counts },
    )
}

fn calibration(s: &Score) -> Picture {
    let bins: Vec<Bin> = s
        .bins
        .iter()
        .filter(|b| b.count > 0)
        .map(|b| {
            let hits = (b.right * b.count as f64).round() as usize;
            let se = Share { hits, of: b.count }.se();
            Bin { stated: b.stated, right: b.right, se, count: b.count }
        })
        .collect();
    reliability(
        "calibration",
        "Whether probabilities mean what they say",
        "The probability of what came first against the share of answers \
         that were right, in five equal bins; cases weigh as the prior odds \
         have it. Beside each dot how many cases; bars: one standard error.",
        &bins,
    )
}

fn effects_table(s: &Score) -> Markup {
    html! {
        h2 { "Effect by effect" }
        div.wide { table {
            thead { tr {
                @for heading in ["hidden", "cases", "visible", "first",
                    "in group", "noticed", "small", "middle", "large",
                    "overlap"] {
                    th scope="col" { (heading) }
                }
            } }
            tbody { @for e in &s.effects { (effect_row(e)) } }
        } }
        p.note { "Visible: how many recordings show enough of the effect for \
                  it to come first. Then in per cent. Noticed: any verdict \
                  but “adequate”, over all sizes and over the thirds of \
                  their range; where nothing is hidden that is a false \
                  alarm. Overlap: median intersection over union of the \
                  located and the true stretch." }
    }
}

fn effect_row(e: &EffectScore) -> Markup {
    let [small, middle, large] = &e.by_size;
    let first = if known(e.class) { percent(&e.first) } else { "–".into() };
    let group =
        if known(e.class) { percent(&e.in_group) } else { "–".into() };
    html! {
        tr {
            td.name { (e.name) }
            td { (e.first.of) }
            td { (e.visible.hits) }
            td { (first) }
            td { (group) }
            td { (percent(&e.detected)) }
            td { (percent(small)) }
            td { (percent(middle)) }
            td { (percent(large)) }
            td { (e.median_iou.map_or("–".to_owned(), two)) }
        }
    }
}

fn failures_table(failures: &[&Outcome]) -> Markup {
    html! {
        h2 { "What went wrong" }
        @if failures.is_empty() { p { "Nothing." } } @else {
            div.wide { table {
                thead { tr {
                    th scope="col" { "case" }
                    @for heading in ["hidden", "answered", "located"] {
                        th.left scope="col" { (heading) }
                    }
                    th scope="col" { "error / noise [m/s]" }
                } }
                tbody { @for o in failures { (failure_row(o)) } }
            } }
            p.note { "Answered: what came first, its probability, and in \
                      brackets the rest of the group. Error: of the \
                      corrected model, root mean square, beside that of the \
                      noise itself." }
        }
    }
}

fn failure_row(o: &Outcome) -> Markup {
    let (name, p) = o.answer.top();
    let rest: Vec<&str> = o
        .answer
        .group
        .iter()
        .map(String::as_str)
        .filter(|other| *other != name)
        .collect();
    let located: Vec<String> = o.answer.mismatch.iter().map(place).collect();
    html! {
        tr {
            td { (o.case) }
            td.said { (hidden(&o.truth)) }
            td.said {
                (name) ", " (two(p))
                @if !rest.is_empty() { " (" (rest.join(", ")) ")" }
            }
            td.said { (located.join(", ")) }
            td { (two(o.answer.rmse_after)) " / " (two(o.truth.noise_rms)) }
        }
    }
}

/// `friction-patch of 0.18, 132 to 187 m`.
fn hidden(truth: &Truth) -> String {
    let unit = match truth.unit {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let at = truth.interval.map(|i| format!(", {}", place(&i)));
    match truth.class {
        Class::None => NONE.to_owned(),
        _ => format!(
            "{} of {:.2}{unit}{}",
            truth.effect,
            truth.size,
            at.unwrap_or_default()
        ),
    }
}

fn place(i: &Interval) -> String {
    match i.coordinate {
        Coordinate::Arclength => format!("{:.0} to {:.0} m", i.from, i.to),
        Coordinate::Time => format!("{:.1} to {:.1} s", i.from, i.to),
    }
}

/// The page of the power study: what each effect needs to be seen.
pub fn power_page(
    tables: &[PowerTable],
    seed: u64,
    origin: &Origin,
) -> String {
    let body = html! {
        h1 { "What each effect needs to be seen" }
        p.sub { span.synthetic { "synthetic data" } " seed " (seed) }
        @for table in tables { (power_table(table)) }
        p.note { "Per cent of the cases in which anything was reported, in \
                  brackets in which the effect was in the group; by the \
                  effect's size and the standard deviation of the noise." }
        (computed(origin, seed))
    };
    standalone("couloir challenge: power", &body)
}

fn power_table(table: &PowerTable) -> Markup {
    let unit = match table.unit {
        "1" => String::new(),
        unit => format!(" [{unit}]"),
    };
    html! {
        h2 { (table.mechanism) }
        div.wide { table {
            thead { tr {
                th scope="col" { "size" (unit) }
                @for sd in &table.noises {
                    th scope="col" { (two(*sd)) " m/s" }
                }
            } }
            tbody { @for (i, size) in table.sizes.iter().enumerate() {
                tr {
                    td { (format!("{size:.3}")) }
                    @for (all, named) in
                        table.detected[i].iter().zip(&table.in_group[i])
                    {
                        td { (percent(all)) " (" (percent(named)) ")" }
                    }
                }
            } }
        } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::challenge::score::tests::outcome;

    fn some() -> Scored {
        let outcomes = vec![
            outcome("none", "none", 0.95),
            outcome("friction-patch", "surge", 0.6),
            outcome("sensor-drift", "sensor-drift", 0.75),
            outcome("wall-drag", "unknown", 0.5),
        ];
        let score = Score::of(&outcomes);
        Scored { outcomes, score }
    }

    #[test]
    fn the_words_have_the_counts() {
        let said = words(&some()).join("\n");
        assert!(said.contains("in the reported group in 50 % ("), "{said}");
        assert!(said.contains("reported in 0 % (0 to"), "{said}");
        assert!(said.contains("Of 1 effects that no catalogue"), "{said}");
    }

    #[test]
    fn the_page_shows_names_counts_and_failures() {
        let command = "couloir challenge --seed 7".to_owned();
        let origin = Origin { command, ..Origin::default() };
        let html = page(&some(), Mix::One, Errors::Real, 7, &origin);
        for part in [
            "id=\"confusion\"",
            "id=\"calibration\"",
            ">friction-patch</text>",
            "friction-patch of 0.25, 100 to 150 m",
            "called ar(1) in all",
            "seed 7",
            "<dd>couloir challenge --seed 7</dd>",
            "<dt>program</dt>",
        ] {
            assert!(html.contains(part), "{part}");
        }
        assert!(!html.contains("NaN"));
    }

    #[test]
    fn an_answer_without_names_does_not_break_the_page() {
        let mut outcomes = some().outcomes;
        outcomes[1].answer = Default::default();
        let score = Score::of(&outcomes);
        let scored = Scored { outcomes, score };
        let origin = Origin::default();
        let html = page(&scored, Mix::Two, Errors::Simple, 1, &origin);
        assert!(html.len() > 1000);
        let power = power_page(&[], 1, &origin);
        assert!(power.contains("What each effect needs"));
        assert!(power.contains("<dt>program</dt>"));
    }
}
