//! What holds for every form of a diagnosis: words, terminal, page.

use super::*;
use crate::diagnosis::fixture::{adequate, all, diagnosis, of};
use crate::diagnosis::tell::pictures::figures;
use crate::report::fixture::assert_unique_ids;

const HOSTILE: &str = "<script>alert(1)</script>&\"'\u{1b}[31m";

/// Every tag is closed, in order, and no `<` or `&` stands alone.
fn assert_well_formed(svg: &str) {
    let mut open: Vec<&str> = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (inside, text) = tag.split_once('>').expect("a tag ends");
        assert!(!text.contains('>'), "{tag}");
        let name = inside.split([' ', '/']).next().unwrap();
        if let Some(closed) = inside.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed));
        } else {
            assert_eq!(inside.matches('"').count() % 2, 0, "{inside}");
            if !inside.ends_with('/') {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty(), "{open:?}");
    for rest in svg.split('&').skip(1) {
        let end = rest.find(';').expect("an entity ends");
        assert!(end < 6, "{rest}");
    }
}

#[test]
fn the_words_of_a_patch() {
    let words = in_words(&diagnosis());
    let all = words.join(" ");
    for said in [
        "Physics is missing: Voellmy friction with iid errors",
        "(synthetic data)",
        "From 132 to 187 m (8.1 to 10.6 s) the mass is braked by 0.90 m/s² \
         (90 % interval 0.60 to 1.20) more than Voellmy friction gives, as \
         if mu were 0.14 higher there.",
        "A patch of higher friction explains this (probability 0.93); \
         entrainment of snow along a stretch is the rival (0.05).",
        "friction-patch: delta_mu = 0.139 (0.111 to 0.167)",
        "falls from 1.9 m/s to 0.31 m/s",
        "a log10 Bayes factor of 21.3",
        "missed by 0.35 m/s instead of 2.2",
    ] {
        assert!(all.contains(said), "{said}\n{words:#?}");
    }
}

#[test]
fn rivals_are_told_once_and_of_the_same_term() {
    let with = |names: [&str; 2]| Rival {
        names: names.map(str::to_owned).to_vec(),
        log10_bayes_factor: 21.0,
    };
    let told = Diagnosis {
        selected: ["friction-patch", "clock-offset"]
            .map(str::to_owned)
            .to_vec(),
        rivals: vec![
            with(["clock-offset", "entrainment"]),
            with(["friction-patch", "surge"]),
            with(["clock-offset", "entrainment"]),
        ],
        ..diagnosis()
    };
    let words = in_words(&told).join(" ");
    let said = "explain this, and with entrainment of snow along a stretch \
                instead of a patch of higher friction nearly as well; alone,";
    assert!(words.contains(said), "{words}");
    // What differs by both terms is in no term's place.
    let told =
        Diagnosis { rivals: vec![with(["surge", "slope-bias"])], ..told };
    assert!(!in_words(&told).join(" ").contains("nearly as well"));
    // A force of free form that two of the named ones make.
    let rivals = vec![with(["friction-patch", "surge"])];
    let told = Diagnosis { rivals, ..of(Verdict::Unexplained, "unknown") };
    let words = in_words(&told).join(" ");
    assert!(words.contains("together do about as well"), "{words}");
}

#[test]
fn every_verdict_has_its_words() {
    for d in all() {
        let words = in_words(&d);
        let empty = d.mechanisms.is_empty();
        let fewest = if empty { 2 } else { 5 };
        assert!((fewest..=13).contains(&words.len()), "{words:#?}");
        assert!(words.iter().all(|w| w.ends_with('.')), "{words:#?}");
        let adequate = words[0].starts_with("Nothing is missing");
        assert_eq!(adequate, d.verdict == Verdict::Adequate);
        let synthetic = words[0].contains("synthetic data");
        assert_eq!(synthetic, d.event.contains("synthetic"));
    }
    let start = in_words(&of(Verdict::Measurement, "initial-velocity"));
    assert!(start[0].contains("the start of"), "{start:#?}");
    let unexplained = in_words(&of(Verdict::Unexplained, "unknown"));
    assert!(unexplained.join(" ").contains("comes nearest"));
}

#[test]
fn of_so_few_values_nothing_is_said() {
    let mut few = adequate();
    assert!(in_words(&few)[0].starts_with("Nothing is missing"));
    few.pictured.truncate(1);
    let pictured = few.pictured.first_mut().unwrap();
    pictured.values.truncate(1);
    few.baseline.priors =
        ["mu", "sigma2"].map(|name| (name.into(), "Flat()".into())).into();
    let words = in_words(&few);
    assert!(words[0].contains("cannot be told"), "{words:#?}");
    assert!(words[0].ends_with("has 1 value for 2 unknowns."), "{words:#?}");
}

#[test]
fn what_nothing_in_particular_explains_is_not_called_sure() {
    let mut unsure = adequate();
    unsure.mechanisms[0].probability = 0.3;
    unsure.mechanisms[1].probability = 0.2;
    let words = in_words(&unsure);
    assert!(
        words[0].starts_with("Nothing is sure to be missing"),
        "{words:#?}"
    );
    let all: f64 = unsure.mechanisms[1..].iter().map(|m| m.probability).sum();
    let together = format!("together of probability {all:.2}, the most");
    assert!(words.join(" ").contains(&together), "{words:#?}");
    unsure.verdict = Verdict::Errors;
    let words = in_words(&unsure);
    assert!(words[0].starts_with("No force is sure to be missing"));
}

#[test]
fn noise_that_swallowed_the_physics_is_said() {
    let rich = &all()[6];
    let words = in_words(rich).join(" ");
    assert!(words.contains("7.2 m/s, 72 times the instrument's error"));
    assert!(words.contains("had swallowed"));
    assert!(words.contains("cannot tell"));
    assert!(words.contains("A release from higher up"));
    let mut weak = adequate();
    weak.baseline.stationary_sd = Some(6.0);
    weak.baseline.innovation_sd = Some(0.5);
    let words = in_words(&weak).join(" ");
    assert!(words.contains("this verdict is weak"), "{words}");
    assert!(words.contains("under iid the errors"), "{words}");
    weak.baseline.infers_noise = true;
    let words = in_words(&weak).join(" ");
    assert!(words.contains("under iid, which stands in for"), "{words}");
    weak.baseline.innovation_sd = Some(4.0);
    assert!(!in_words(&weak).join(" ").contains("Beware"));
}

#[test]
fn a_terminal_holds_the_summary() {
    for mut d in all() {
        for width in [0, 44, 60, 80, 200] {
            d.mechanisms.iter_mut().take(1).for_each(|m| {
                m.name = "friction-that-a-user-wrote-with-a-long-name".into();
            });
            let text = summary(&d, width);
            let widest = text.lines().map(|l| l.chars().count()).max();
            assert!(widest <= Some(width.clamp(44, 80)), "{text}");
            assert!(!text.contains("NaN") && !text.contains("inf "));
        }
    }
    let text = summary(&diagnosis(), 80);
    for said in ["log10 BF", "before", "1.90", "du/dt", "7 more"] {
        assert!(text.contains(said), "{said}\n{text}");
    }
}

/// The fixture with nothing but numbers that are none.
fn broken() -> Diagnosis {
    let nan = f64::NAN;
    let mut d = diagnosis();
    let pair = BeforeAfter { before: nan, after: nan };
    d.improvement = Improvement {
        log10_bayes_factor: nan,
        rmse: pair,
        elpd: BeforeAfter { before: f64::INFINITY, after: 1e300 },
        heldout_rmse: pair,
        coverage90: pair,
        ljung_box_p: pair,
        least_squares: pair,
        stationary_sd: pair,
    };
    for m in &mut d.mismatch {
        (m.from, m.to, m.time_from, m.place_to) = (nan, nan, nan, nan);
        (m.specific_force, m.specific_force_q05) = (nan, nan);
        m.delta_mu = nan;
    }
    for m in &mut d.mechanisms {
        (m.probability, m.log10_bayes_factor) = (nan, f64::NEG_INFINITY);
        for p in &mut m.parameters {
            (p.q05, p.q50, p.q95, p.sd) = (nan, nan, f64::INFINITY, nan);
        }
    }
    d.parameters.iter_mut().for_each(|p| (p.q50, p.sd) = (nan, nan));
    d.baseline.rmse = nan;
    d.baseline.ljung_box_p = nan;
    d.baseline.stationary_sd = Some(nan);
    d.baseline.instrument = Some(0.0);
    d.forces[0].band.mean[3] = nan;
    d.forces[1].band.sd[3] = f64::INFINITY;
    d.forces[2].log_bayes_factor = nan;
    d.pictured[0].values[4] = nan;
    d.pictured[0].places[7] = nan;
    d.pictured[0].after.full_high.truncate(3);
    d.pictured[0].track.1[2] = nan;
    d.pictured[0].marked[0][2] = (nan, nan);
    d.seconds = nan;
    d
}

#[test]
fn numbers_that_are_none() {
    let d = broken();
    let words = in_words(&d).join("\n");
    for text in [words, summary(&d, 80), page(&d)] {
        let found = ["NaN", "inf ", "inf<", "-inf", "−inf"]
            .into_iter()
            .find(|bad| text.contains(bad));
        assert_eq!(found, None, "{text}");
        assert!(text.contains("n/a"));
    }
}

#[test]
fn pictures_are_well_formed() {
    for d in all().into_iter().chain([broken()]) {
        for figure in figures(&d) {
            assert_well_formed(&figure.svg);
            assert!(!figure.svg.contains("NaN"), "{}", figure.id);
        }
    }
    assert_eq!(figures(&diagnosis()).len(), 4);
    assert!(figures(&Diagnosis::default()).is_empty());
}

#[test]
fn each_stretch_of_a_track_is_a_mark_of_its_own_with_its_label() {
    let mut d = diagnosis();
    let mut other = d.mismatch[0].clone();
    (other.place_from, other.place_to) = (230.0, 260.0);
    d.mismatch.push(other);
    let x = [230.0, 245.0, 260.0];
    d.pictured[0].marked.push(x.map(|x| (x, -0.5 * x)).to_vec());
    let all = figures(&d);
    let track = all.iter().find(|f| f.id.starts_with("track")).unwrap();
    for label in ["132 to 187 m", "230 to 260 m"] {
        assert!(track.svg.contains(label), "{label}");
    }
    // The track itself, its two marks, and one in the legend.
    let curves = track.svg.matches("fill=\"none\"").count();
    let mut one = diagnosis();
    one.mismatch.truncate(1);
    let all = figures(&one);
    let track = all.iter().find(|f| f.id.starts_with("track")).unwrap();
    assert_eq!(curves, track.svg.matches("fill=\"none\"").count() + 1);
}

#[test]
fn evidence_over_all_noises_and_residuals_that_are_left_are_told() {
    let mut d = diagnosis();
    let said = in_words(&d).join(" ");
    assert!(said.contains("a log10 Bayes factor of 21.3."), "{said}");
    assert!(!said.contains("still correlated"), "{said}");
    d.mechanisms[0].log10_bayes_factor = 3.0;
    d.improvement.ljung_box_p.after = 0.002;
    let said = in_words(&d).join(" ");
    for told in [
        "a log10 Bayes factor of 3.0 over all noises (21.3 with ",
        "still correlated (Ljung-Box p < 0.01): its intervals may be too",
    ] {
        assert!(said.contains(told), "{said}");
    }
}

#[test]
fn odds_that_were_given_are_told() {
    let mut d = diagnosis();
    let even = "the other half shared evenly. ";
    assert!(page(&d).contains(even));
    d.odds.insert("surge".to_owned(), 3.0);
    let told = "shared evenly, times the odds given: surge 3. ";
    assert!(page(&d).contains(told));
}

#[test]
fn hostile_names_come_out_as_text() {
    let mut d = diagnosis();
    for text in [
        &mut d.event,
        &mut d.baseline.friction,
        &mut d.baseline.noise,
        &mut d.selected[0],
        &mut d.corrected.model,
        &mut d.corrected.labels[0],
    ] {
        *text = HOSTILE.to_owned();
    }
    for p in &mut d.pictured {
        p.event = HOSTILE.to_owned();
        p.quantity = HOSTILE.to_owned();
        p.unit = HOSTILE.to_owned();
    }
    d.separating = Some(HOSTILE.to_owned());
    d.warnings = vec![HOSTILE.to_owned()];
    d.corrected.equation = vec![HOSTILE.to_owned()];
    d.group = vec![HOSTILE.to_owned(); 2];
    for p in &mut d.parameters {
        (p.name, p.unit) = (HOSTILE.to_owned(), HOSTILE.to_owned());
    }
    for m in &mut d.mechanisms {
        (m.name, m.says) = (HOSTILE.to_owned(), HOSTILE.to_owned());
        m.noun.words = HOSTILE.to_owned();
    }
    let html = page(&d);
    // The page's own.
    assert_eq!(html.matches("<script").count(), 1);
    assert!(html.contains("&lt;script&gt;alert(1)"));
    for text in [html, summary(&d, 80), in_words(&d).join("\n")] {
        assert!(!text.contains('\u{1b}'));
    }
    for figure in figures(&d) {
        assert!(!figure.svg.contains("<script"), "{}", figure.id);
        assert_well_formed(&figure.svg);
    }
}

#[test]
fn the_page_stands_alone() {
    for d in all() {
        let html = page(&d);
        let inner = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        for outside in ["http", "//", "<link", "@import", "src=", "fetch("] {
            assert!(!inner.contains(outside), "{outside}");
        }
        assert_unique_ids(&html);
    }
    let html = page(&diagnosis());
    // Each for a page and for a phone.
    assert_eq!(html.matches("<svg").count(), 8);
    assert!(html.contains("mechanisms = [&quot;friction-patch&quot;]"));
    assert!(html.contains("<span class=\"synthetic\">"));
}

/// Writes the pages to look at them:
/// `cargo test --lib diagnosis -- --ignored write`.
#[test]
#[ignore = "writes files to look at"]
fn write_to_look_at() -> std::io::Result<()> {
    let folder = std::env::temp_dir().join("couloir-diagnosis");
    std::fs::create_dir_all(&folder)?;
    for (i, d) in all().iter().enumerate() {
        let file = folder.join(format!("{i}.html"));
        std::fs::write(file, page(d))?;
        let text = [in_words(d).join("\n"), summary(d, 80)].join("\n\n");
        std::fs::write(folder.join(format!("{i}.txt")), text)?;
    }
    Ok(())
}
