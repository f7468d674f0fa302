//! The command as a user runs it: exit codes, messages, files.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn couloir(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_couloir"))
        .args(arguments)
        .env("COLUMNS", "80")
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn printed(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// A fresh folder of this name.
fn fresh(name: &str) -> PathBuf {
    let folder =
        Path::new(env!("CARGO_TARGET_TMPDIR")).join("command").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

const REFERENCE: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/voellmy-21");

/// Little work, for tests that look at the form of a result.
const QUICK: [&str; 6] =
    ["--draws", "500", "--warmup", "500", "--chains", "2"];

#[test]
fn every_malformed_input_ends_in_exit_code_2_and_writes_nothing() {
    let root = fresh("bad-input");
    let mut wrong = Vec::new();
    for case in crate::cases::all() {
        let path = case.write(&root).unwrap();
        let out = fresh("bad-input-out");
        let output = couloir(&[
            "calibrate",
            &path.to_string_lossy(),
            "--out",
            &out.to_string_lossy(),
        ]);
        let text = said(&output);
        let lines = text.lines().count();
        let complete = case.expected.iter().all(|part| text.contains(part));
        if output.status.code() != Some(2)
            || lines != 1
            || !complete
            || !output.stdout.is_empty()
            || out.exists()
        {
            wrong.push(format!("{}: {:?} {text}", case.name, output.status));
        }
    }
    let _ = std::fs::remove_dir_all(root);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Words, and what their refusal has to say.
type Bad = (&'static [&'static str], &'static str);

const BAD_WORDS: [Bad; 26] = [
    (&["calibrate", "--friction", "coulom"], "--friction"),
    (&["calibrate", "--noise", "ar(0)"], "--noise"),
    (&["calibrate", "--noise", "ar(2)"], "regular grid"),
    (&["calibrate", "--backend", "nuts2"], "mh"),
    (&["calibrate", "--backend", "map"], "no draws, which a calib"),
    (&["calibrate", "--backend", "quadrature"], "use mh, random-walk"),
    (&["compare", "--backend", "mh", "--model", "x"], "use smc, importa"),
    (&["calibrate", "--chains", "0"], "1"),
    (&["bench", "--noise", "infer"], "--noise \"ar(1)\""),
    (
        &["compare", "--model", "voellmy, infer", "--model", "none, iid"],
        "name it, as in",
    ),
    (&["calibrate", "--draws=-3"], "draws"),
    (&["calibrate", "--seed", "x"], "seed"),
    (&["calibrate", "--draws", "90000000"], "fewer --draws"),
    (&["compare", "--model", "voellmy, iid"], "two models"),
    (&["compare", "--model", "voellmy", "--model", "coulomb, iid"], "comma"),
    (&["simulate", "--set", "nu=1"], "nu"),
    (&["simulate", "--set", "mu"], "NAME=VALUE"),
    (&["simulate", "--set", "mu=NaN"], "finite"),
    (&["diagnose", "--odds", "surgee=3"], "none, unknown, turb"),
    (&["diagnose", "--out", "Cargo.toml"], "Cargo.toml is a file"),
    (&["challenge", "--out", "Cargo.toml/sub"], "Cargo.toml is a file"),
    (&["challenge", "--errors", "reel"], "simple or real"),
    (&["diagnose", "--rate", "0"], "more than 0"),
    (&["calibrate", "--rate", "5", "--thin", "x"], "average or pick"),
    (&["calibrate", "--thin", "pick"], "--rate"),
    (&["fly"], "fly"),
];

/// Those of values that are there and cannot be.
const BAD_VALUES: [Bad; 11] = [
    (
        &["simulate", "--set", "mu=-1"],
        "--set \"mu=-1\": mu is -1; expected 0 or more, as its prior",
    ),
    (&["simulate", "--set", "xi=0"], "these values have no motion (mu = "),
    (&["simulate", "--set=mu=0.2", "--set=mu=0.3"], "mu is set to 0.2 bef"),
    (
        &["compare", "--model", "voellmy, iid", "--model", "coulom, iid"],
        "--model \"coulom, iid\": ",
    ),
    (
        &["compare", "--model", "voellmy, iid", "--model", "coulomb, idd"],
        "--model \"coulomb, idd\": ",
    ),
    (&["calibrate", "--seed", "-1"], "from 0 to 18446744073709551615"),
    (&["calibrate", "--rate", "-1"], "more than 0"),
    (&["calibrate", "--chains", "-1"], "from 1 to"),
    (&["calibrate", "--warmup", "-1"], "from 0 to"),
    (&["reproduce", "--samples", "-1"], "from 0 to"),
    (&["diagnose", "--odds", "-1"], "expected NAME=ODDS"),
];

#[test]
fn bad_arguments_end_in_exit_code_2() {
    for (arguments, part) in BAD_WORDS.into_iter().chain(BAD_VALUES) {
        let output = couloir(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = said(&output);
        assert!(said.contains(part), "{said}");
        // In one style, whoever refuses; the commands may be a list.
        assert!(said.starts_with("couloir: "), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(!said.contains("to pass"), "{said}");
    }
}

/// The good event with mechanisms, and with other lines below its priors.
fn corrected(name: &str, mechanisms: &str, priors: &str) -> PathBuf {
    let list = format!("noise = \"iid\"\nmechanisms = [{mechanisms}]");
    let event = crate::cases::EVENT.replacen("noise = \"iid\"", &list, 1);
    with_event(name, &(event + priors + "\n"))
}

/// The good data under another event.toml.
fn with_event(name: &str, event: &str) -> PathBuf {
    let folder = fresh(name);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("event.toml"), event).unwrap();
    std::fs::write(folder.join("track.csv"), crate::cases::TRACK).unwrap();
    std::fs::write(folder.join("recording.csv"), crate::cases::RECORDING)
        .unwrap();
    folder
}

#[test]
fn mechanisms_that_are_none_are_refused() {
    let wrong = [
        ("\"friction-pach\"", "", "friction-patch"),
        ("\"turbulent-drag\"", "", "already have"),
        ("\"curvature\"", "", "nothing to act on"),
        ("\"surge\", \"surge\"", "", "twice"),
        ("\"friction-step\", \"friction-step(time)\"", "", "twice"),
        ("\"surge\"", "\"surge.drag\" = \"Normal(0, 1)\"", "surge.force"),
    ];
    for (mechanisms, priors, part) in wrong {
        let folder = corrected("no-mechanism", mechanisms, priors);
        let output = couloir(&["calibrate", &folder.to_string_lossy()]);
        let text = said(&output);
        assert_eq!(output.status.code(), Some(2), "{mechanisms}: {text}");
        assert_eq!(text.lines().count(), 1, "{text}");
        assert!(text.contains(part), "{text}");
        assert!(text.contains("event.toml"), "{text}");
    }
}

#[test]
fn a_corrected_event_runs() {
    let folder = corrected(
        "corrected",
        "\"friction-patch\"",
        "\"friction-patch.delta_mu\" = \"Normal(0, 0.1)\"",
    );
    let event = folder.to_string_lossy();
    let mut arguments = vec!["calibrate", &event, "--json"];
    arguments.extend(QUICK);
    let output = couloir(&arguments);
    assert!(output.status.success(), "{}", said(&output));
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    assert_eq!(json["model"]["mechanisms"][0], "friction-patch");
    assert!(json["parameters"]["friction-patch.delta_mu"]["sd"].is_f64());
    let model = |model| {
        let mut all = vec!["compare", &event, "--json", "--model", model];
        all.extend(["--model", "coulomb, iid, none"]);
        all.extend(QUICK);
        let output = couloir(&all);
        assert!(output.status.success(), "{}", said(&output));
        serde_json::from_str::<Value>(&printed(&output)).unwrap()
    };
    let json = model("coulomb, iid");
    assert_eq!(json["models"][0]["mechanisms"][0], "friction-patch");
    assert!(json["models"][1]["mechanisms"].is_null());
    let with = ["from=0", "length=11", "delta_mu=0.4"]
        .map(|set| format!("friction-patch.{set}"));
    let mut ends = Vec::new();
    for delta in ["friction-patch.delta_mu=0", &with[2]] {
        let sets = [&with[0], &with[1], delta, "mu=0.3", "xi=1000"];
        let mut all = vec!["simulate", &event, "--json"];
        sets.iter().for_each(|set| all.extend(["--set", set]));
        let output = couloir(&all);
        assert!(output.status.success(), "{}", said(&output));
        let json: Value = serde_json::from_str(&printed(&output)).unwrap();
        ends.push(json["velocity"][3].as_f64().unwrap());
    }
    assert!(ends[1] < ends[0] - 1.0, "{ends:?}");
}

/// A slope on which a drag was left out: Coulomb friction and r u^2, with
/// errors of 0.05 m/s that come round again (synthetic).
fn dragged(name: &str) -> PathBuf {
    let folder = fresh(name);
    std::fs::create_dir_all(folder.join("event")).unwrap();
    let event = "name = \"Dragged (synthetic)\"\n[track] # a slope\n\
        slope = 30.0\nlength = 900.0\n[recording]\n\
        file = \"../values.csv\" # by radar\nquantity = \"velocity\"\n\
        [priors]\nmu = \"Gamma(9, 0.03)\"\nxi = \"Gamma(2.5, 400)\"\n";
    std::fs::write(folder.join("event/event.toml"), event).unwrap();
    // du/dt = a - c u^2 from rest: u = sqrt(a/c) tanh(sqrt(a c) t).
    let (a, c) = (9.81 * (0.5 - 0.25 * 0.75_f64.sqrt()), 0.005_f64);
    let mut values = "t,velocity\n".to_owned();
    for i in 1..=40 {
        let (t, phase) = (0.4 * f64::from(i), 2.4 * f64::from(i));
        let u = (a / c).sqrt() * ((a * c).sqrt() * t).tanh();
        values += &format!("{t:.1},{:.3}\n", u + 0.07 * phase.sin());
    }
    std::fs::write(folder.join("values.csv"), values).unwrap();
    folder
}

/// A run by the backend that sees several modes, without warnings.
fn converged(json: &Value) {
    assert_eq!(json["backend"], "laplace-mixture");
    assert!(json["backend_why"].as_str().unwrap().contains("several modes"));
    assert!(json["warnings"].as_array().unwrap().is_empty(), "{json}");
}

/// Where nothing is added, the events of the diagnosis before go.
fn goes(event: &str, out: &str) {
    let arguments = ["diagnose", event, "--odds", "none=1e30", "--out", out];
    let output = couloir(&arguments);
    assert!(output.status.success(), "{}", said(&output));
    assert!(printed(&output).contains("draws.csv, pictures/\n"));
    assert!(!Path::new(out).join("corrected").exists());
}

#[test]
fn a_diagnosis_writes_an_event_that_runs() {
    let folder = dragged("diagnosis");
    let (event, out) = (folder.join("event"), folder.join("out"));
    let path = out.join("corrected");
    let [event, out] = [&event, &out].map(|path| path.to_str().unwrap());
    let arguments = ["diagnose", event, "--friction", "coulomb", "--out", out];
    let output = couloir(&arguments);
    assert!(output.status.success(), "{}", said(&output));
    assert!(printed(&output).contains("draws.csv, pictures/, corrected/"));
    let read = |name: &str| {
        std::fs::read_to_string(Path::new(out).join(name)).unwrap()
    };
    let json: Value = serde_json::from_str(&read("diagnosis.json")).unwrap();
    assert_eq!(json["selected"][0], "turbulent-drag", "{}", json["selected"]);
    let draws = read("draws.csv");
    assert!(draws.starts_with("chain,"), "{}", &draws[..40]);
    let head = draws.lines().next().unwrap();
    assert!(head.contains("turbulent-drag.drag") && head.contains("mu"));
    let text = read("corrected/event.toml");
    for kept in ["[track] # a slope", "# by radar", "mu = \"Gamma(9, 0.03)\""]
    {
        assert!(text.contains(kept), "{text}");
    }
    // Coulomb's law has no xi.
    assert!(!text.contains("xi"), "{text}");
    let mut arguments = vec!["calibrate", path.to_str().unwrap(), "--json"];
    arguments.extend(QUICK);
    let output = couloir(&arguments);
    assert!(output.status.success(), "{}", said(&output));
    let again: Value = serde_json::from_str(&printed(&output)).unwrap();
    assert_eq!(again["model"]["friction"], "coulomb");
    assert_eq!(again["model"]["mechanisms"][0], "turbulent-drag");
    converged(&again);
    // The same posterior from another backend: within a third of its sd.
    let of = |json: &Value, what: &str| {
        json["parameters"]["turbulent-drag.drag"][what].as_f64().unwrap()
    };
    let apart = of(&again, "mean") - of(&json, "mean");
    assert!(apart.abs() < of(&json, "sd") / 3.0, "{apart}");
    goes(event, out);
}

#[test]
fn a_prior_of_no_parameter_is_refused_unless_the_law_was_changed() {
    let event = crate::cases::EVENT.to_owned() + "zeta = \"Gamma(9, 0.03)\"\n";
    let folder = with_event("unused-prior", &event);
    let output = couloir(&["calibrate", &folder.to_string_lossy()]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    let said = said(&output);
    assert!(said.contains("event.toml:24: priors.zeta: "), "{said}");
    assert!(said.contains("(manual: formats.md)"), "{said}");
}

#[test]
fn a_calibration_writes_what_the_formats_say() {
    let out = fresh("calibration");
    let mut arguments =
        vec!["calibrate", REFERENCE, "--out", out.to_str().unwrap()];
    arguments.extend(QUICK);
    let output = couloir(&arguments);
    assert!(output.status.success(), "{}", said(&output));
    let read = |name| std::fs::read_to_string(out.join(name)).unwrap();
    let json: Value = serde_json::from_str(&read("calibration.json")).unwrap();
    assert_eq!(json["schema"], 1);
    assert_eq!(json["model"]["friction"], "voellmy");
    assert_eq!(json["model"]["noise"], "ar(1)");
    assert_eq!(json["backend"], "mh");
    for name in ["mu", "xi", "phi", "sigma2"] {
        let parameter = &json["parameters"][name];
        for key in [
            "map",
            "mean",
            "sd",
            "q025",
            "q05",
            "q50",
            "q95",
            "q975",
            "rhat",
            "ess_bulk",
            "ess_tail",
            "mcse_mean",
        ] {
            assert!(parameter[key].is_number(), "{name}.{key}");
        }
        assert!(parameter["unit"].is_string());
    }
    assert!(json["log_evidence"]["value"].is_number());
    for key in ["ljung_box_p", "shapiro_wilk_p", "coverage90", "rmse"] {
        assert!(json["checks"][key].is_number(), "checks.{key}");
    }
    assert_eq!(read("draws.csv").lines().count(), 1 + 2 * 500);
    let page = read("report.html");
    assert!(page.contains("<svg") && page.contains("Lautaret-like"));
    let names: Vec<_> = std::fs::read_dir(&out).unwrap().collect();
    // And couloir.sha256, which says that these are its own.
    assert_eq!(names.len(), 4, "{names:?}");
}

#[test]
fn a_run_that_should_not_be_used_says_so_by_its_exit_code_where_asked() {
    let out = fresh("strict");
    let short = ["--draws", "20", "--warmup", "20", "--json"];
    let run = |more: &[&str]| {
        let all = [&["calibrate", REFERENCE], &short[..], more].concat();
        couloir(&all)
    };
    let strict = run(&["--strict", "--out", out.to_str().unwrap()]);
    assert_eq!(strict.status.code(), Some(4), "{}", said(&strict));
    assert!(said(&strict).contains("not to be used: the chains have"));
    // What was found is told and written all the same.
    let json: Value = serde_json::from_str(&printed(&strict)).unwrap();
    let warning = json["warnings"][0].as_str().unwrap();
    assert!(warning.contains("R-hat"), "{warning}");
    let written =
        std::fs::read_to_string(out.join("calibration.json")).unwrap();
    assert_eq!(written, printed(&strict));
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("have not agreed"));
    assert!(run(&[]).status.success());
    let fine = couloir(&["calibrate", REFERENCE, "--strict"]);
    assert!(fine.status.success(), "{}", said(&fine));
    assert!(!printed(&fine).contains("Warning"), "{}", printed(&fine));
}

/// The reference without its noise and the priors of that.
fn without_noise(name: &str) -> PathBuf {
    let folder = fresh(name);
    std::fs::create_dir_all(&folder).unwrap();
    let read = |name: &str| {
        std::fs::read_to_string(Path::new(REFERENCE).join(name)).unwrap()
    };
    for name in ["track.csv", "recording.csv"] {
        std::fs::write(folder.join(name), read(name)).unwrap();
    }
    let event = read("event.toml");
    let (event, _) = event.split_once("phi =").unwrap();
    let event = event.replace("noise = \"ar(1)\"", "noise = \"infer\"");
    std::fs::write(folder.join("event.toml"), event).unwrap();
    folder
}

#[test]
fn a_noise_that_is_inferred_is_averaged_over() {
    let folder = without_noise("inferred");
    let run = |more: &[&str]| -> Value {
        let all = ["calibrate", folder.to_str().unwrap(), "--json"];
        let output = couloir(&[&all[..], more].concat());
        assert!(output.status.success(), "{}", said(&output));
        serde_json::from_str(&printed(&output)).unwrap()
    };
    let json = run(&[]);
    assert_eq!(json["model"]["noise"], "infer");
    converged(&json);
    let noises = json["noise"].as_array().unwrap();
    assert!(noises.len() > 1, "{noises:?}");
    // Bayes' rule, from the evidence of each by itself; each parameter costs e
    // beforehand, and all have the same but for those of the noise.
    let (mut told, mut squares) = (Vec::new(), 0.0);
    for noise in noises {
        let name = noise["name"].as_str().unwrap();
        let backend = ["--backend", "laplace-mixture"];
        let alone = run(&[&["--noise", name][..], &backend].concat());
        let of = |json: &Value, key: &str| json[key].as_f64().unwrap();
        let mu = &alone["parameters"]["mu"];
        let parameters = alone["parameters"].as_object().unwrap().len();
        let log = of(&alone["log_evidence"], "value") - parameters as f64;
        squares += of(&alone["log_evidence"], "se").powi(2);
        told.push((of(noise, "probability"), log, of(mu, "mean")));
    }
    let top = told.iter().map(|t| t.1).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = told.iter().map(|t| (t.1 - top).exp()).sum();
    // An error of a log evidence shifts a probability by a quarter of it at the
    // most; four of them, of either run, for each has seeds of its own.
    let most = (2.0 * squares).sqrt();
    let mut mean = 0.0;
    for (probability, log, mu) in told {
        let expected = (log - top).exp() / total;
        let off = (probability - expected).abs();
        assert!(off < most && most < 0.2, "{expected} {off} {most}");
        mean += expected * mu;
    }
    let mu = &json["parameters"]["mu"];
    let apart = mu["mean"].as_f64().unwrap() - mean;
    assert!(apart.abs() < 0.1 * mu["sd"].as_f64().unwrap(), "{apart}");
    let said = printed(&couloir(&["calibrate", folder.to_str().unwrap()]));
    assert!(said.contains("No noise was named"), "{said}");
}

#[test]
fn the_law_is_told_with_the_rest_of_the_physics_open() {
    // mu was 0.25, with a drag.
    let folder = dragged("rest").join("event");
    let law = |friction: &str| -> Value {
        let event = folder.to_str().unwrap();
        let output = couloir(&[
            "calibrate",
            event,
            "--friction",
            friction,
            "--rest",
            "--json",
        ]);
        assert!(output.status.success(), "{}", said(&output));
        let json: Value = serde_json::from_str(&printed(&output)).unwrap();
        json["law"].clone()
    };
    let holds = |json: &Value| {
        let of = |key: &str| json["mu"][key].as_f64().unwrap();
        (of("q05")..of("q95")).contains(&0.25)
    };
    let without_drag = law("coulomb");
    assert_eq!(without_drag["use"], "with_free_form_force");
    assert!(!holds(&without_drag["as_it_was"]), "{without_drag}");
    assert!(holds(&without_drag["with_free_form_force"]), "{without_drag}");
    let with_drag = law("voellmy");
    assert_eq!(with_drag["use"], "as_it_was", "{with_drag}");
    assert!(holds(&with_drag["as_it_was"]), "{with_drag}");
    assert!(with_drag["as_it_was"]["xi"].is_object());
}

#[test]
fn a_diagnosis_prefers_no_noise_where_none_is_named() {
    let folder = dragged("no-noise").join("event");
    let arguments = ["--friction", "coulomb", "--noise", "infer", "--json"];
    let event = folder.to_str().unwrap();
    let output = couloir(&[&["diagnose", event][..], &arguments].concat());
    assert!(output.status.success(), "{}", said(&output));
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    assert_eq!(json["baseline"]["noise_inferred"], true);
    assert_eq!(json["selected"][0], "turbulent-drag");
    // The likeliest, and the one that the corrected event names.
    assert_eq!(json["selected_noise"], json["noise"][0]["name"]);
    assert_eq!(json["corrected"]["noise"], json["selected_noise"]);
}

#[test]
fn the_same_seed_prints_the_same_on_one_thread_and_two() {
    let run = |threads: &str| {
        let mut arguments = vec!["calibrate", REFERENCE, "--json"];
        arguments.extend(QUICK);
        let output = Command::new(env!("CARGO_BIN_EXE_couloir"))
            .args(arguments)
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        printed(&output)
    };
    assert_eq!(run("1"), run("2"));
}

#[test]
fn the_first_command_fits_80_columns() {
    let output = couloir(&["calibrate", "--draws", "1000"]);
    assert!(output.status.success(), "{}", said(&output));
    let text = printed(&output);
    assert!(text.contains("mu") && text.contains("recording"));
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
}

/// What every result says of where it comes from.
fn has_its_origin(json: &Value, command: &str, seed: Option<u64>) {
    let program = json["program"].as_str().unwrap();
    assert!(program.starts_with("couloir "), "{program}");
    let typed = json["command"].as_str().unwrap();
    assert!(typed.starts_with(&format!("couloir {command}")), "{typed}");
    assert_eq!(json["seed"].as_u64(), seed, "{command}");
}

/// The same of what was read.
fn has_its_inputs(json: &Value) {
    let sum = json["inputs"]["event.toml"].as_str().unwrap();
    assert_eq!(sum.len(), 64, "{sum}");
}

#[test]
fn a_challenge_and_a_study_say_where_they_come_from() {
    let out = fresh("origin");
    let folder = out.to_str().unwrap();
    let challenge = ["challenge", "--cases", "1", "--quick", "--seed", "3"];
    for (words, seed) in
        [(&challenge[..], 3), (&["reproduce", "--samples", "1"], 1)]
    {
        let words = [words, &["--json", "--out", folder]].concat();
        let output = couloir(&words);
        assert!(output.status.success(), "{}", said(&output));
        let json: Value = serde_json::from_str(&printed(&output)).unwrap();
        has_its_origin(&json, words[0], Some(seed));
        let page = match words[0] {
            "reproduce" => "reproduction.html",
            _ => "challenge.html",
        };
        let page = std::fs::read_to_string(out.join(page)).unwrap();
        assert!(page.contains("<dt>program</dt>"), "{}", words[0]);
        let command = format!("<dd>couloir {}", words[0]);
        assert!(page.contains(&command), "{command}");
    }
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_recording_that_is_given_twice_is_told() {
    let folder = with_event("twice", crate::cases::EVENT);
    let again = with_event("twice-again", crate::cases::EVENT);
    let [one, two] = [&folder, &again].map(|f| f.to_str().unwrap());
    let output = couloir(&["diagnose", one, two, "--quick", "--json"]);
    assert!(output.status.success(), "{}", said(&output));
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    for key in ["warnings", "words"] {
        let told = json[key].to_string();
        assert!(told.contains("have the same recording"), "{told}");
    }
}

#[test]
fn one_value_says_nothing_of_what_is_missing() {
    let folder = with_recording("one-value", "t,velocity\n2,5\n");
    let words = ["diagnose", folder.to_str().unwrap(), "--quick", "--json"];
    let output = couloir(&words);
    assert!(output.status.success(), "{}", said(&output));
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    let told = [&json["words"], &json["warnings"]].map(Value::to_string);
    assert!(!told[0].contains("Nothing is missing"), "{}", told[0]);
    assert!(told[0].contains("1 value for 3 unknowns"), "{}", told[0]);
    assert!(
        told[1].contains("tell nothing of what is missing"),
        "{}",
        told[1]
    );
}

#[test]
fn models_are_compared_by_their_evidence() {
    let output = couloir(&[
        "compare",
        REFERENCE,
        "--model",
        "voellmy, iid",
        "--model",
        "voellmy, ar(1)",
        "--json",
    ]);
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    has_its_origin(&json, "compare", Some(1));
    has_its_inputs(&json);
    assert!(json["models"][1]["priors"]["phi"].is_string(), "{json}");
    let factor = &json["models"][1]["log10_bayes_factor"];
    let error = factor["value"].as_f64().unwrap() - 1.161;
    // The quadrature's figure; five standard errors of this run.
    assert!(error.abs() < 5.0 * factor["se"].as_f64().unwrap(), "{factor}");
}

#[test]
fn models_are_compared_by_their_predictions() {
    let arguments = [
        "compare",
        REFERENCE,
        "--model",
        "voellmy, iid",
        "--model",
        "voellmy, ar(1)",
        "--draws",
        "125",
        "--lfo",
        "--lfo-from",
        "12",
    ];
    let text = printed(&couloir(&arguments));
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    for part in ["one left out", "one ahead", "k > 0.7", "--lfo asks"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let output = couloir(&[&arguments[..], &["--json"]].concat());
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    for (key, values) in [("loo", 21), ("lfo", 9)] {
        let parts: Vec<_> = (0..2).map(|i| &json["models"][i][key]).collect();
        assert_eq!(parts[0]["values"], values);
        let of =
            |i: usize, what: &str| parts[i][what]["value"].as_f64().unwrap();
        let apart = of(0, "elpd") - of(1, "elpd");
        let told = of(0, "difference") - of(1, "difference");
        assert!((apart - told).abs() < 1e-9, "{apart} {told}");
    }
    assert_eq!(json["models"][0]["lfo"]["from"], 12);
    let late = couloir(&[&arguments[..10], &["21"]].concat());
    assert_eq!(late.status.code(), Some(2));
    assert!(said(&late).contains("nothing to predict"), "{}", said(&late));
}

#[test]
fn a_simulation_has_the_values_it_was_given() {
    let output = couloir(&[
        "simulate",
        REFERENCE,
        "--set",
        "mu=0.32",
        "--set",
        "xi=495.73",
        "--json",
    ]);
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    assert_eq!(json["parameters"]["mu"], 0.32);
    // No random draw, and no seed.
    has_its_origin(&json, "simulate", None);
    has_its_inputs(&json);
    assert!(json["priors"]["mu"].is_string(), "{json}");
    // The speed at t = 10 s by a Runge-Kutta solution on the smooth track;
    // pieces of 1.4 m differ from it by some mm/s.
    let speed = json["velocity"][10].as_f64().unwrap();
    assert!((speed - 21.163_185).abs() < 0.02, "{speed}");
}

#[test]
fn values_without_a_motion_are_refused() {
    let folder = with_event("no-motion", crate::cases::EVENT);
    let event = folder.to_str().unwrap();
    let output = couloir(&["simulate", event, "--set", "xi=0"]);
    let refusal = said(&output);
    assert_eq!(output.status.code(), Some(2), "{refusal}");
    assert!(refusal.contains("no finite numbers"), "{refusal}");
    assert!(output.stdout.is_empty());
    // To stay is a motion, too.
    let output = couloir(&["simulate", event, "--set", "mu=5"]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(printed(&output).contains("stays where it is released"));
    // Without friction it moves as well.
    let output = couloir(&["simulate", event, "--set", "mu=0"]);
    assert!(output.status.success(), "{}", said(&output));
    // Numbers of many digits stay on their lines.
    let output = couloir(&["simulate", event, "--set", "xi=1e14"]);
    let text = printed(&output);
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn a_new_event_calibrates_as_it_is() {
    let folder = fresh("new");
    let path = folder.to_str().unwrap();
    assert!(couloir(&["new", path]).status.success());
    let again = couloir(&["new", path]);
    assert_eq!(again.status.code(), Some(2), "{}", said(&again));
    let mut arguments = vec!["calibrate", path];
    arguments.extend(QUICK);
    let output = couloir(&arguments);
    assert!(output.status.success(), "{}", said(&output));
}

#[test]
fn every_backend_is_benchmarked() {
    let mut arguments = vec!["bench", REFERENCE, "--json"];
    arguments.extend(QUICK);
    let output = couloir(&arguments);
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    has_its_origin(&json, "bench", Some(1));
    has_its_inputs(&json);
    assert!(json["priors"]["mu"].is_string(), "{json}");
    let backends = json["backends"].as_array().unwrap();
    assert_eq!(backends.len(), couloir::infer::BACKENDS.len());
    for backend in backends {
        assert!(backend["simulations"].as_u64().unwrap() > 0, "{backend}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_that_cannot_be_written_is_not_the_inputs_fault() {
    // A place where nobody can make a folder.
    let mut arguments = vec!["calibrate", REFERENCE, "--out", "/proc/couloir"];
    arguments.extend(QUICK);
    let output = couloir(&arguments);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    // Before the work: nothing was begun, and nothing is answered.
    let text = said(&output);
    assert_eq!((text.lines().count(), output.stdout.len()), (1, 0), "{text}");
    for part in ["--out: /proc/couloir: the folder", "give another folder"] {
        assert!(text.contains(part), "{text}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_answer_is_told_although_it_cannot_be_written() {
    let out = fresh("full");
    // No file may be longer than some KB: what is looked at before is empty.
    let script = "trap '' XFSZ; ulimit -f 4; exec \"$@\"";
    let output = Command::new("bash")
        .args(["-c", script, "bash", env!("CARGO_BIN_EXE_couloir")])
        .args(["calibrate", REFERENCE, "--json", "--out"])
        .arg(&out)
        .args(QUICK)
        .output()
        .unwrap();
    let text = said(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    let last = text.lines().last().unwrap();
    assert!(last.contains("the file could not be written"), "{text}");
    let json: Value = serde_json::from_str(&printed(&output)).unwrap();
    assert!(json["parameters"]["mu"]["mean"].is_number());
    let left = std::fs::read_dir(&out).map_or(0, Iterator::count);
    assert_eq!(left, 0);
}

#[cfg(target_os = "linux")]
#[test]
fn an_answer_that_cannot_be_printed_is_an_error_unless_nobody_reads_on() {
    use std::process::Stdio;
    let couloir = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_couloir"));
        command.args(["simulate", REFERENCE, "--json"]);
        command
    };
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let output = couloir().stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = said(&output);
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.contains("could not be printed"), "{text}");
    // A pipe whose other end is closed.
    let mut child = couloir()
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(said(&output), "");
}

/// All files below a folder, by their names in it.
fn files_below(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        match entry.path().is_dir() {
            false => found.push(name),
            true => {
                let below = files_below(&entry.path()).into_iter();
                found.extend(below.map(|inner| format!("{name}/{inner}")));
            }
        }
    }
    found.sort();
    found
}

#[test]
fn a_run_owns_its_output_folder() {
    let folder = fresh("owned");
    let out = folder.to_str().unwrap();
    let run = |verb: &str| couloir(&[verb, "--out", out]);
    let diagnosed = run("diagnose");
    assert!(diagnosed.status.success(), "{}", said(&diagnosed));
    assert!(folder.join("corrected/event.toml").is_file());
    let corrected = folder.join("corrected");
    let corrected = corrected.to_str().unwrap();
    // It reads what it would replace.
    let read = couloir(&["simulate", corrected, "--out", out]);
    assert_eq!(read.status.code(), Some(2));
    assert!(said(&read).contains("put its results in its place"));
    let simulated = run("simulate");
    assert!(simulated.status.success(), "{}", said(&simulated));
    let files = ["couloir.sha256", "simulation.csv", "simulation.json"];
    assert_eq!(files_below(&folder), files);
    // What is not couloir's stays, and stops what would replace it.
    std::fs::write(folder.join("report.html"), "mine").unwrap();
    let refused = run("calibrate");
    let text = said(&refused);
    assert_eq!(refused.status.code(), Some(2), "{text}");
    assert_eq!((text.lines().count(), refused.stdout.len()), (1, 0), "{text}");
    for part in ["report.html: couloir did not write it", "another --out"] {
        assert!(text.contains(part), "{text}");
    }
    let mine = std::fs::read_to_string(folder.join("report.html")).unwrap();
    assert_eq!((mine.as_str(), files_below(&folder).len()), ("mine", 4));
}

/// What a run says of an event, as words and as JSON.
fn told_of(folder: &Path) -> (String, Value) {
    let event = folder.to_str().unwrap();
    let words = couloir(&["simulate", event]);
    assert!(words.status.success(), "{}", said(&words));
    let json = couloir(&["simulate", event, "--json"]);
    let words = printed(&words);
    let words: Vec<_> = words.split_whitespace().collect();
    let json = serde_json::from_str(&printed(&json)).unwrap();
    (words.join(" "), json)
}

#[test]
fn a_depth_that_nobody_gave_is_told_where_the_law_needs_one() {
    let without = crate::cases::EVENT.replacen("[flow]\ndepth = 1.5\n", "", 1);
    let told = |name: &str, event: &str| told_of(&with_event(name, event));
    let (words, json) = told("no-depth", &without);
    let note = json["notes"][0].as_str().unwrap();
    assert!(note.contains("no flow depth, which voellmy friction"), "{note}");
    assert!(note.contains("xi stands for the product xi h"), "{note}");
    assert!(words.contains(note), "{words}");
    let dry = without.replacen("voellmy", "coulomb", 1);
    for (name, event) in
        [("dry", dry.as_str()), ("depth", crate::cases::EVENT)]
    {
        let (_, json) = told(name, event);
        assert_eq!(json["notes"].as_array().unwrap().len(), 0, "{json}");
    }
}

/// The good event with another recording.
fn with_recording(name: &str, recording: &str) -> PathBuf {
    let folder = with_event(name, crate::cases::EVENT);
    std::fs::write(folder.join("recording.csv"), recording).unwrap();
    folder
}

#[test]
fn columns_that_nobody_asked_for_are_passed_over() {
    let rows = "hdop,velocity,note,t\n1,2.5,a,1\n2,5,b,2\n1,7.4,,3\n";
    let (_, json) = told_of(&with_recording("columns", rows));
    let note = json["notes"][0].as_str().unwrap();
    assert!(note.ends_with("recording.csv: \"hdop\", \"note\"."), "{note}");
    let (_, plain) = told_of(&with_event("plain", crate::cases::EVENT));
    assert_eq!(json["velocity"], plain["velocity"]);
}

#[test]
fn what_could_be_true_is_warned_of() {
    let rows = |row: fn(f64) -> (f64, f64)| {
        let rows = (1..=12).map(|i| row(f64::from(i)));
        let rows = rows.map(|(t, v)| format!("{t},{v}\n"));
        "t,velocity\n".to_owned() + &rows.collect::<String>()
    };
    let warned = [
        // 5 m/s2 on a slope that gives 5.9 at the most; 18 in km/h.
        ("km-h", rows(|i| (0.3 * i, 5.4 * i)), "if these are km/h, divide"),
        ("late", rows(|i| (30.0 + i, i)), "subtract 31 from all times"),
        (
            "below",
            rows(|i| (i, i * (12.5 - i) / 5.0 - 3.0 * f64::from(i == 12.0))),
            "goes down to velocity = -1.8",
        ),
    ];
    for (name, recording, part) in warned {
        let (words, json) = told_of(&with_recording(name, &recording));
        let all = json["warnings"].as_array().unwrap();
        assert_eq!(all.len(), 1, "{name}: {all:?}");
        let warning = all[0].as_str().unwrap();
        assert!(warning.contains(part), "{warning}");
        assert!(warning.contains("event.toml: the "), "{warning}");
        assert!(
            words.contains(&format!("Warning: {}", all[0].as_str().unwrap()))
        );
    }
    let (_, json) = told_of(&with_event("undoubted", crate::cases::EVENT));
    assert_eq!(json["warnings"].as_array().unwrap().len(), 0, "{json}");
}

#[test]
fn units_that_could_be_true_are_warned_of() {
    let good = crate::cases::EVENT;
    let places = good.replacen("\"velocity\"", "\"position\"", 1);
    let deep = good.replacen("depth = 1.5", "depth = 150", 1);
    let speeds = crate::cases::RECORDING;
    let warned = [
        ("deep", &*deep, speeds, "centimetres, write depth = 1.5"),
        (
            "at-once",
            good,
            "t,velocity\n1,20\n2,20.5\n3,21\n",
            "begins with 20 m/s at t = 1, and by then gravity gives",
        ),
        (
            "kilometres",
            &*places,
            "t,position\n5,0.02\n10,0.07\n15,0.15\n",
            "if these are kilometres, multiply them by 1000",
        ),
        (
            "unsure",
            good,
            "t,velocity,sigma\n1,2.5,100\n2,5,100\n3,7.4,100\n",
            "has 100 m/s for the usual standard error",
        ),
    ];
    for (name, event, recording, part) in warned {
        let folder = with_event(name, event);
        std::fs::write(folder.join("recording.csv"), recording).unwrap();
        let (words, json) = told_of(&folder);
        let all = json["warnings"].as_array().unwrap();
        assert_eq!(all.len(), 1, "{name}: {all:?}");
        assert!(words.contains(part), "{name}: {words}");
        assert!(all[0].as_str().unwrap().contains(part), "{name}: {all:?}");
    }
    let (_, json) = told_of(&with_event("no-doubt", good));
    assert_eq!(json["warnings"].as_array().unwrap().len(), 0, "{json}");
}

#[test]
fn draws_are_as_many_as_were_asked_for_whatever_keeps_them() {
    for backend in ["mh", "smc", "bridge"] {
        let out = fresh("draws");
        let mut arguments = vec!["calibrate", "--backend", backend, "--out"];
        arguments.push(out.to_str().unwrap());
        arguments.extend(["--draws", "300", "--warmup", "300"]);
        let output = couloir(&arguments);
        assert!(output.status.success(), "{}", said(&output));
        let draws = std::fs::read_to_string(out.join("draws.csv")).unwrap();
        assert_eq!(draws.lines().count(), 1 + 4 * 300, "{backend}");
    }
}

#[test]
fn a_challenge_says_before_how_long_it_will_take() {
    let power = ["challenge", "--cases", "1", "--power", "cohesion"];
    // Stopped once it has said so: the cases themselves take minutes.
    let mut child = Command::new(env!("CARGO_BIN_EXE_couloir"))
        .args(power)
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = std::io::BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    std::io::BufRead::read_line(&mut said, &mut line).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(line.contains("15 cases to diagnose on"), "{line}");
    assert!(line.contains(": about "), "{line}");
}

#[test]
fn a_thinned_recording_says_so() {
    let run = |how: &[&str]| {
        let all = [&["calibrate", "--json"], how, &QUICK[..]].concat();
        let output = couloir(&all);
        assert!(output.status.success(), "{}", said(&output));
        let document: Value = serde_json::from_str(&printed(&output)).unwrap();
        document["notes"].to_string()
    };
    assert_eq!(run(&[]), "[]");
    // 69 speeds, about one a second at uneven times.
    let means = run(&["--rate", "0.5"]);
    assert!(means.contains("from 69 values"), "{means}");
    assert!(means.contains("to 35: each is the mean of 1 to 2"), "{means}");
    let picked = run(&["--rate", "0.25", "--thin", "pick"]);
    assert!(picked.contains("to 18: of each 4 the last"), "{picked}");
    assert!(run(&["--rate", "7"]).contains("left as it is"));
}
