//! What a run writes for other programs, read back and compared with what is
//! known otherwise.

#![allow(clippy::unwrap_used, reason = "a test fails by it")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use couloir::draws::{Draws, quantile};
use couloir::export::{InferenceData, Scope, gather, of_draws};
use couloir::prelude::*;
use serde_json::Value;

model! {
    /// Values about a centre: everything is known in closed form.
    struct Mean { seen: Vec<f64> }
    centre ~ Normal(0.0, 1.0);
    likelihood { seen ~ Normal(centre, 1.0); }
}

const SEEN: [f64; 4] = [0.3, -0.2, 0.9, 0.1];

fn log_normal(x: f64, mean: f64) -> f64 {
    -0.5 * (x - mean).powi(2) - 0.5 * std::f64::consts::TAU.ln()
}

/// Draws of one parameter, chain by chain.
fn draws(chains: &[Vec<f64>]) -> Draws {
    let name = || vec!["centre".to_owned()];
    let mut draws = Draws::new(name(), vec!["1".to_owned()]).unwrap();
    for chain in chains {
        draws.push_chain(chain.clone(), Some(0.3)).unwrap();
    }
    draws
}

fn reals<'a>(data: &'a InferenceData, group: &str, name: &str) -> &'a [f64] {
    data.variable(group, name).unwrap().values.reals()
}

#[test]
fn densities_are_those_in_closed_form() {
    let model = Mean::new(SEEN.to_vec());
    let posterior = Posterior::new(&model).unwrap();
    let draws = draws(&[vec![0.0, 0.5], vec![-1.0, 2.0]]);
    let data =
        gather(&posterior, &draws, &Scope::default(), Seed::new(1)).unwrap();
    let likely = reals(&data, "log_likelihood", "value");
    let logs = reals(&data, "sample_stats", "lp");
    for (i, row) in draws.rows().enumerate() {
        let mut sum = log_normal(row[0], 0.0);
        for (j, x) in SEEN.iter().enumerate() {
            let expected = log_normal(*x, row[0]);
            sum += expected;
            // A handful of roundings.
            assert!((likely[4 * i + j] - expected).abs() < 1e-13);
        }
        assert!((logs[i] - sum).abs() < 1e-12);
    }
    assert_eq!(reals(&data, "observed_data", "value"), SEEN);
    assert_eq!(reals(&data, "sample_stats", "acceptance_rate"), [0.3, 0.3]);
    assert_eq!(reals(&data, "posterior", "centre"), [0.0, 0.5, -1.0, 2.0]);
}

#[test]
fn predictions_scatter_as_the_model_says() {
    let model = Mean::new(SEEN.to_vec());
    let posterior = Posterior::new(&model).unwrap();
    let draws = draws(&[vec![0.7; 2000]]);
    let mut scope = Scope::default();
    scope.prior_draws = 8000;
    let data = gather(&posterior, &draws, &scope, Seed::new(2)).unwrap();
    // Given the centre N(0.7, 1); before that N(0, 2). The standard error of
    // a median of n normal values is 1.25 sd / sqrt(n), of the 84 % quantile
    // 1.5 sd / sqrt(n); five of them are allowed.
    let cases = [
        ("posterior_predictive", 0.7, 1.0),
        ("prior_predictive", 0.0, 2.0_f64.sqrt()),
    ];
    for (group, mean, sd) in cases {
        let mut values = reals(&data, group, "value").to_vec();
        values.sort_by(f64::total_cmp);
        // The four values of a draw share its centre.
        let error = sd / (values.len() as f64 / 4.0).sqrt();
        let median = quantile(&values, 0.5) - mean;
        let spread = quantile(&values, 0.841_344_7) - mean - sd;
        assert!(median.abs() < 6.3 * error, "{group} {median}");
        assert!(spread.abs() < 7.5 * error, "{group} {spread}");
    }
    let prior = data.variable("prior", "centre").unwrap();
    assert_eq!(prior.shape, [1, 8000]);
}

#[test]
fn more_numbers_than_allowed_are_thinned_by_whole_draws() {
    let model = Mean::new(SEEN.to_vec());
    let posterior = Posterior::new(&model).unwrap();
    let chain = |at: f64| (0..10).map(|i| at + f64::from(i)).collect();
    let draws = draws(&[chain(0.0), chain(100.0)]);
    let mut scope = Scope::default();
    // 2 chains of 10 draws of 4 values are 80: every third draw is left.
    scope.most_numbers = 32;
    let data = gather(&posterior, &draws, &scope, Seed::new(3)).unwrap();
    let likely = data.variable("log_likelihood", "value").unwrap();
    assert_eq!(likely.shape, [2, 4, 4]);
    let kept = &data.variable("log_likelihood", "draw").unwrap().values;
    let expected = couloir::export::Values::Whole(vec![0, 3, 6, 9]);
    assert_eq!(*kept, expected);
    let last = likely.values.reals()[7 * 4];
    assert!((last - log_normal(SEEN[0], 109.0)).abs() < 1e-9);
    assert_eq!(data.variable("posterior", "centre").unwrap().shape, [2, 10]);
    assert_eq!(data.left_out.unwrap().draws, 8);
}

#[test]
fn a_parameter_is_not_called_as_a_dimension() {
    let names = || vec!["draw".to_owned()];
    let mut draws = Draws::new(names(), names()).unwrap();
    assert!(of_draws(&draws, &[]).unwrap_err().is_inference());
    draws.push_chain(vec![1.0], None).unwrap();
    let error = of_draws(&draws, &[]).unwrap_err();
    assert!(error.is_input() && error.to_string().contains("write csv"));
}

#[test]
fn a_draw_that_the_model_rejects_makes_the_data_impossible() {
    let track = couloir::physics::Track::incline(35.0, 500.0).unwrap();
    let series = Series::velocity(vec![1.0, 2.0], vec![3.1, 6.6]).unwrap();
    let event = Event::on(track).velocity(series).build().unwrap();
    let model = Dry::new(event);
    let posterior = Posterior::new(&model).unwrap();
    let name = |n: &str| n.to_owned();
    let names = vec![name("mu"), name("sigma2")];
    let units = vec![name("1"), name("m2/s2")];
    let mut draws = Draws::new(names, units).unwrap();
    draws.push_chain(vec![0.3, 1.0, -1.0, 1.0], None).unwrap();
    let data =
        gather(&posterior, &draws, &Scope::default(), Seed::new(4)).unwrap();
    let likely = reals(&data, "log_likelihood", "velocity");
    assert!(likely[..2].iter().all(|x| x.is_finite()));
    assert_eq!(likely[2..], [f64::NEG_INFINITY; 2]);
    let seen = reals(&data, "posterior_predictive", "velocity");
    assert!(seen[0].is_finite() && seen[2].is_nan());
    assert_eq!(reals(&data, "observed_data", "time"), [1.0, 2.0]);
}

model! {
    struct Dry { event: Event }
    friction ~ Coulomb { mu: Gamma(9.0, 0.03) };
    errors ~ Iid { sigma2: InverseGamma(3.0, 1.0) };
    likelihood {
        let flow = event.slide(&friction)?;
        event.velocity ~ flow.velocity() + errors;
    }
}

fn couloir(folder: &Path, options: &[&str]) -> Output {
    let work = ["--draws", "500", "--warmup", "500", "--chains", "2"];
    run("calibrate", folder, &[&work, options].concat())
}

fn run(command: &str, folder: &Path, options: &[&str]) -> Output {
    const EVENT: &str =
        concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/voellmy-21");
    Command::new(env!("CARGO_BIN_EXE_couloir"))
        .args([command, EVENT, "--noise", "ar(2)"])
        .arg("--out")
        .arg(folder)
        .args(options)
        .output()
        .unwrap()
}

fn fresh(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).join("export");
    let folder = root.join(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn formats_are_written_as_asked_and_those_of_an_earlier_run_go() {
    let folder = fresh("formats");
    let output = couloir(&folder, &["--format", "latex"]);
    assert!(output.status.success(), "{}", said(&output));
    let there = |name: &str| folder.join(name).exists();
    assert!(there("table.tex") && !there("draws.csv"));
    let output = couloir(&folder, &[]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(!there("table.tex") && there("draws.csv"));
    assert!(there("calibration.json") && there("report.html"));
}

#[test]
fn a_diagnosis_is_written_in_the_formats_asked_for() {
    let folder = fresh("diagnosis");
    let asked = ["--quick", "--figures", "--format", "csv,latex"];
    let output = run("diagnose", &folder, &asked);
    assert!(output.status.success(), "{}", said(&output));
    let read =
        |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let json: Value = serde_json::from_str(&read("diagnosis.json")).unwrap();
    let named = json["parameters"].as_object().unwrap();
    let (draws, table) = (read("draws.csv"), read("table.tex"));
    let header = draws.lines().next().unwrap();
    assert!(named.contains_key("mu"), "{named:?}");
    for name in named.keys() {
        assert!(header.split(',').any(|column| column == name), "{header}");
    }
    assert_eq!(
        table.matches(r" \\").count(),
        1 + header.split(',').count() - 2
    );
    let picture = |name: &str| folder.join("pictures").join(name).exists();
    assert!(picture("recording-0.svg"));
    assert_eq!(picture("recording-0.png"), cfg!(feature = "export"));
}

#[test]
fn every_picture_of_a_calibration_is_a_file() {
    let folder = fresh("figures");
    let output = couloir(&folder, &["--figures"]);
    assert!(output.status.success(), "{}", said(&output));
    let page = std::fs::read_to_string(folder.join("report.html")).unwrap();
    let ids = page.split("<figure id=\"").skip(1);
    let ids: Vec<_> = ids.map(|s| s.split('"').next().unwrap()).collect();
    assert_eq!(ids.len(), 8, "{ids:?}");
    for name in ids {
        let file = |end: &str| {
            let path = folder.join("pictures").join(name);
            std::fs::read(path.with_extension(end)).ok()
        };
        let svg = file("svg").unwrap();
        assert!(svg.starts_with(b"<svg xmlns="));
        let drawn = file("png").is_some_and(|b| b.starts_with(b"\x89PNG"));
        assert_eq!(drawn, cfg!(feature = "export"), "{name}");
    }
    let output = couloir(&folder, &[]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(!folder.join("pictures").exists());
}

#[test]
fn formats_that_cannot_be_written_are_refused() {
    let folder = fresh("refused");
    let output = couloir(&folder, &["--format", "csv,hdf5"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("csv, latex"), "{}", said(&output));
    assert!(!folder.exists());
    if cfg!(not(feature = "export")) {
        let output = couloir(&folder, &["--format", "zarr"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(said(&output).contains("--features export"));
    }
}

#[cfg(feature = "export")]
mod read_back {
    use std::sync::Arc;

    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;
    use serde_json::Value;
    use zarrs::array::{Array, ArrayError};
    use zarrs::storage::store::MemoryStore;
    use zarrs::storage::{Bytes, StoreKey, WritableStorageTraits};

    use super::*;

    /// The files in a folder, with `/` between the parts of their names.
    fn files(folder: &Path, before: &str, found: &mut Vec<(String, PathBuf)>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap();
            let name = entry.file_name().into_string().unwrap();
            match entry.path() {
                path if path.is_dir() => {
                    files(&path, &format!("{before}{name}/"), found);
                }
                path => found.push((format!("{before}{name}"), path)),
            }
        }
    }

    /// What a folder holds, as a store of the crate zarrs.
    fn store(folder: &Path) -> Arc<MemoryStore> {
        let store = MemoryStore::new();
        let mut found = Vec::new();
        files(folder, "", &mut found);
        for (name, path) in found {
            let bytes = Bytes::from(std::fs::read(path).unwrap());
            store.set(&StoreKey::new(name).unwrap(), bytes).unwrap();
        }
        Arc::new(store)
    }

    fn values(store: &Arc<MemoryStore>, path: &str) -> Vec<f64> {
        let array = Array::open(store.clone(), path).unwrap();
        let read: Result<Vec<f64>, ArrayError> =
            array.retrieve_array_subset(&array.subset_all());
        read.unwrap()
    }

    fn dimensions(store: &Arc<MemoryStore>, path: &str) -> (Vec<u64>, Value) {
        let array = Array::open(store.clone(), path).unwrap();
        let names = array.attributes()["_ARRAY_DIMENSIONS"].clone();
        (array.shape().to_vec(), names)
    }

    /// The draws of a run as its CSV has them, by column.
    fn columns(folder: &Path) -> Vec<(String, Vec<f64>)> {
        let mut csv =
            csv::Reader::from_path(folder.join("draws.csv")).unwrap();
        let names: Vec<String> =
            csv.headers().unwrap().iter().map(str::to_owned).collect();
        let rows: Vec<Vec<f64>> =
            csv.deserialize().map(Result::unwrap).collect();
        let column = |i: usize| rows.iter().map(|row| row[i]).collect();
        let named = names.into_iter().enumerate();
        named.map(|(i, name)| (name, column(i))).collect()
    }

    #[test]
    fn zarr_holds_what_the_run_found() {
        let folder = fresh("zarr");
        let output = couloir(&folder, &["--format", "csv,zarr"]);
        assert!(output.status.success(), "{}", said(&output));
        let store = store(&folder.join("draws.zarr"));
        let columns = columns(&folder);
        let of = |name: &str| &columns.iter().find(|c| c.0 == name).unwrap().1;
        for name in ["mu", "xi", "sigma2"] {
            let path = format!("/posterior/{name}");
            assert_eq!(&values(&store, &path), of(name));
        }
        let pairs = of("phi[1]").iter().zip(of("phi[2]"));
        let both: Vec<f64> = pairs.flat_map(|(a, b)| [*a, *b]).collect();
        assert_eq!(values(&store, "/posterior/phi"), both);
        let (shape, names) = dimensions(&store, "/posterior/phi");
        assert_eq!(shape, [2, 500, 2]);
        assert_eq!(names, serde_json::json!(["chain", "draw", "phi_dim_0"]));
        let (shape, names) = dimensions(&store, "/log_likelihood/velocity");
        assert_eq!(shape, [2, 500, 21]);
        assert_eq!(names, serde_json::json!(["chain", "draw", "time"]));
        let times: Vec<f64> = (1..=21).map(f64::from).collect();
        assert_eq!(values(&store, "/observed_data/time"), times);
        assert_eq!(
            values(&store, "/observed_data/velocity")[0],
            6.562114818590
        );
        let text = std::fs::read(folder.join("calibration.json")).unwrap();
        let json: Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(json["loo"]["pareto_k"].as_array().unwrap().len(), 21);
        assert_eq!(json["loo"]["draws"], 1000);
    }

    #[test]
    fn metadata_stand_in_one_file_too() {
        let folder = fresh("metadata");
        let output = couloir(&folder, &["--format", "zarr"]);
        assert!(output.status.success(), "{}", said(&output));
        let folder = folder.join("draws.zarr");
        let text = std::fs::read(folder.join(".zmetadata")).unwrap();
        let all: Value = serde_json::from_slice(&text).unwrap();
        let mut found = Vec::new();
        files(&folder, "", &mut found);
        let mut count = 0;
        for (name, path) in found {
            let last = name.rsplit('/').next().unwrap();
            if last.starts_with(".z") && last != ".zmetadata" {
                let text = std::fs::read(path).unwrap();
                let own: Value = serde_json::from_slice(&text).unwrap();
                assert_eq!(all["metadata"][&name], own, "{name}");
                count += 1;
            }
        }
        assert_eq!(all["metadata"].as_object().unwrap().len(), count);
    }

    #[test]
    fn a_zarr_of_an_earlier_run_goes_and_what_others_put_there_stays() {
        let folder = fresh("owned");
        let output = couloir(&folder, &["--format", "zarr"]);
        assert!(output.status.success(), "{}", said(&output));
        assert!(couloir(&folder, &["--format", "zarr"]).status.success());
        let mine = folder.join("draws.zarr/posterior/mine.txt");
        std::fs::write(&mine, "mine").unwrap();
        let output = couloir(&folder, &["--format", "zarr"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(said(&output).contains("mine.txt"), "{}", said(&output));
        assert_eq!(std::fs::read_to_string(&mine).unwrap(), "mine");
        std::fs::remove_file(&mine).unwrap();
        assert!(couloir(&folder, &["--format", "csv"]).status.success());
        assert!(!folder.join("draws.zarr").exists());
    }

    #[test]
    fn parquet_holds_the_rows_of_the_csv() {
        let folder = fresh("parquet");
        let output = couloir(&folder, &["--format", "csv,parquet"]);
        assert!(output.status.success(), "{}", said(&output));
        let columns = columns(&folder);
        let file = std::fs::File::open(folder.join("draws.parquet")).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let about = reader.metadata().file_metadata();
        let known = about.key_value_metadata().unwrap();
        let unit = known.iter().find(|entry| entry.key == "units:xi").unwrap();
        assert_eq!(unit.value.as_deref(), Some("m/s2"));
        let mut count = 0;
        for (i, row) in reader.get_row_iter(None).unwrap().enumerate() {
            let row = row.unwrap();
            for ((name, found), (own, values)) in
                row.get_column_iter().zip(&columns)
            {
                let found = match found {
                    Field::Long(x) => *x as f64,
                    Field::Double(x) => *x,
                    other => panic!("{other:?}"),
                };
                assert_eq!((name, found), (own, values[i]));
            }
            count += 1;
        }
        assert_eq!(count, 1000);
    }
}
