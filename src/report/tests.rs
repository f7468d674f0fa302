//! What holds for every form of the report at once: hostile names and
//! degenerate numbers.

use super::*;

const HOSTILE: &str = "<script>alert(1)</script>&\"'\u{1b}[31m";

/// Every text that the report can become.
fn all_texts(report: &CalibrationReport) -> Vec<String> {
    let mut out = vec![
        page(report),
        table(report, 80),
        picture(report, 80, 20),
        in_words(report).join("\n"),
        calibration_json(report).to_string(),
    ];
    out.extend(pictures(report).into_iter().map(|p| p.svg));
    out
}

fn no_broken_number(report: &CalibrationReport) {
    for svg in pictures(report).into_iter().map(|p| p.svg) {
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
    assert!(all_texts(report).iter().all(|t| !t.is_empty()));
}

#[test]
fn hostile_names_come_out_as_text() {
    let mut report = fixture::calibration();
    for text in [
        &mut report.event,
        &mut report.friction,
        &mut report.noise,
        &mut report.backend,
        &mut report.quantity,
        &mut report.unit,
    ] {
        *text = HOSTILE.to_owned();
    }
    report.warnings = vec![HOSTILE.to_owned()];
    for p in &mut report.parameters {
        p.name = HOSTILE.to_owned();
        p.unit = HOSTILE.to_owned();
        p.prior_text = HOSTILE.to_owned();
    }
    let html = page(&report);
    // The page's own.
    assert_eq!(html.matches("<script").count(), 1);
    assert!(html.contains("&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;"));
    for picture in pictures(&report) {
        assert!(!picture.svg.contains("<script"), "{}", picture.name);
        assert!(!picture.svg.contains('\u{1b}'), "{}", picture.name);
    }
    for text in [html, table(&report, 80), picture(&report, 80, 20)] {
        assert!(!text.contains('\u{1b}'));
    }
}

#[test]
fn nothing_at_all() {
    no_broken_number(&CalibrationReport::default());
}

/// One value and one parameter.
fn small() -> CalibrationReport {
    let mut report = fixture::calibration();
    report.parameters.truncate(1);
    report.times.truncate(1);
    report.values.truncate(1);
    report.innovations.truncate(1);
    report.innovation_times.truncate(1);
    report.autocorrelation.clear();
    report.bands = Bands::default();
    report.track.x.truncate(1);
    report
}

#[test]
fn one_value_and_one_parameter() {
    let report = small();
    no_broken_number(&report);
    let names: Vec<_> = pictures(&report).iter().map(|p| p.name).collect();
    assert_eq!(
        names,
        [
            "recording",
            "densities",
            "traces",
            "ranks",
            "residuals",
            "predictive"
        ]
    );
}

#[test]
fn zero_draws_and_constant_chains() {
    let mut report = fixture::calibration();
    report.parameters[0].chains = vec![vec![0.3; 100]; 4];
    report.parameters[0].pooled = vec![0.3; 100];
    report.parameters[0].sd = 0.0;
    report.parameters[0].posterior_density = vec![(0.3, f64::INFINITY)];
    report.parameters[1].chains = vec![vec![]; 4];
    report.parameters[1].pooled.clear();
    report.parameters[1].posterior_density.clear();
    no_broken_number(&report);
}

#[test]
fn numbers_that_are_none() {
    let mut report = fixture::calibration();
    for p in &mut report.parameters {
        (p.mean, p.sd, p.q05, p.q95) = (f64::NAN, f64::NAN, f64::NAN, 1e300);
        (p.rhat, p.ess_bulk) = (f64::NAN, f64::INFINITY);
        p.chains[0][5] = f64::NAN;
        p.pooled[7] = f64::NEG_INFINITY;
        p.posterior_density[3] = (f64::NAN, 1e308);
    }
    report.values[3] = f64::NAN;
    report.values[4] = 1e308;
    report.times[9] = f64::NAN;
    report.bands.flow_low[7] = f64::NAN;
    report.bands.full_high.truncate(3);
    report.innovations[0] = f64::INFINITY;
    report.autocorrelation[0] = f64::NAN;
    report.track.z[2] = f64::NAN;
    report.track.rest = Some((f64::NAN, f64::NAN, f64::NAN));
    report.checks = Checks::default();
    report.evidence = Some(EvidenceReport {
        value: f64::NAN,
        se: f64::NAN,
        method: String::new(),
    });
    report.seconds = f64::NAN;
    no_broken_number(&report);
}

/// Thirty parameters and 100 000 values.
fn large() -> CalibrationReport {
    let mut report = fixture::calibration();
    let one = report.parameters[1].clone();
    for i in 0..26 {
        let mut p = one.clone();
        p.name = format!("friction[{i}].turbulent.drag");
        report.parameters.push(p);
    }
    let n = 100_000;
    report.times = (0..n).map(|i| f64::from(i) * 3.5e-4).collect();
    report.values =
        report.times.iter().map(|t| 30.0 * (t / 12.0).sin()).collect();
    report.innovations = report.times.iter().map(|t| t.sin()).collect();
    report.innovation_times = report.times.clone();
    report.standard_errors = Some(vec![0.1; n as usize]);
    report.warnings = vec!["the chains are short".to_owned()];
    report
}

#[test]
fn many_parameters_and_many_values() {
    let report = large();
    no_broken_number(&report);
    let html = page(&report);
    assert!(html.len() < 4_000_000, "{} bytes", html.len());
    assert!(html.contains("Of 100000 values, 2000 evenly spread"));
    assert!(html.contains("The first 6 of 30 parameters"));
}

/// Writes the pictures to look at them:
/// `cargo test --lib report -- --ignored`.
#[test]
#[ignore = "writes files to look at"]
fn write_to_look_at() -> std::io::Result<()> {
    let folder = std::env::temp_dir().join("couloir-report");
    write(&folder, &fixture::calibration())?;
    write(&folder.join("small"), &small())?;
    write(&folder.join("large"), &large())
}

fn write(
    folder: &std::path::Path,
    report: &CalibrationReport,
) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("report.html"), page(report))?;
    for picture in pictures(report) {
        let file = folder.join(picture.name).with_extension("svg");
        std::fs::write(file, picture.svg)?;
    }
    let terminal = [
        in_words(report).join("\n"),
        table(report, 80),
        picture(report, 80, 22),
    ];
    std::fs::write(folder.join("terminal.txt"), terminal.join("\n\n"))
}
