//! Imports: recorded logs against events that were prepared from them by
//! hand, and small synthetic logs of every form.

#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use couloir::import::{Imported, Options, import};

/// Says a line that is not held back for tests that pass.
fn say(text: &str) {
    std::io::stderr().write_all(text.as_bytes()).unwrap();
}

/// The AvaNodes recordings, where they are at hand.
fn avanodes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/recordings/avanodes");
    if folder.is_dir() {
        return Some(folder);
    }
    say(&format!("not run: there is no {}\n", folder.display()));
    None
}

/// A fresh folder of this name.
fn fresh(name: &str) -> PathBuf {
    let folder =
        Path::new(env!("CARGO_TARGET_TMPDIR")).join("import").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The rows of a CSV file of two columns.
fn rows(text: &str) -> Vec<(f64, f64)> {
    let row = |line: &str| {
        let (a, b) = line.split_once(',')?;
        Some((a.parse().ok()?, b.parse().ok()?))
    };
    text.lines().filter_map(row).collect()
}

/// The value between two rows.
fn between(rows: &[(f64, f64)], at: f64) -> Option<f64> {
    let pair = rows.windows(2).find(|r| r[0].0 <= at && at <= r[1].0)?;
    let share = (at - pair[0].0) / (pair[1].0 - pair[0].0);
    Some(pair[0].1 + share * (pair[1].1 - pair[0].1))
}

/// The shift of the first clock to the second \[s\] for which speeds differ
/// least, with how far they differ then at the most.
fn aligned(new: &[(f64, f64)], old: &[(f64, f64)]) -> (f64, f64, usize) {
    let differ = |shift: f64| {
        let both = old.iter().filter_map(|(t, v)| {
            let near = new.iter().find(|n| (n.0 + shift - t).abs() < 0.011)?;
            Some((near.1 - v).abs())
        });
        let all: Vec<f64> = both.collect();
        (all.iter().copied().fold(0.0, f64::max), all.len())
    };
    let shifts = (-50..=50).map(|i| 0.1 * f64::from(i));
    let enough = |all: &(f64, (f64, usize))| all.1.1 * 10 > old.len() * 9;
    let best = shifts.map(|s| (s, differ(s))).filter(enough);
    let best = best.min_by(|a, b| a.1.0.total_cmp(&b.1.0)).unwrap();
    (best.0, best.1.0, best.1.1)
}

fn recorded(folder: &Path, log: &str) -> Options {
    let mut options = Options::new(folder.join("raw").join(log));
    options.terrain = Some(folder.join("raw/dem_crop_5m_epsg31254.asc"));
    options.crs = Some("EPSG:31254".to_owned());
    options
}

const LOGS: [(&str, &str); 3] = [
    ("220222_C10_avalanche_GPS.txt", "220222-c10"),
    ("ava220123_C01.txt", "220123-c01"),
    ("ava230204_C07_gnss.txt", "230204-c07"),
];

#[test]
fn recorded_logs_agree_with_what_was_prepared_by_hand() {
    let Some(folder) = avanodes() else { return };
    for (log, event) in LOGS {
        let found = import(&recorded(&folder, log)).unwrap();
        let read = |name: &str| {
            rows(&fs::read_to_string(folder.join(event).join(name)).unwrap())
        };
        let old = read("recording.csv");
        let new = rows(&found.recording);
        let (shift, speed, count) = aligned(&new, &old);
        let track = rows(&found.track);
        // The prepared tracks are known up to 100 m before their ends.
        let old_track = read("track.csv");
        let known = old_track.last().unwrap().0 - 100.0;
        let apart = |from: f64, to: f64| {
            let part = old_track.iter().filter(|p| from <= p.0 && p.0 <= to);
            let differ = part
                .filter_map(|(x, z)| Some((between(&track, *x)? - z).abs()));
            differ.fold((0.0_f64, 0), |(most, n), d| (most.max(d), n + 1))
        };
        let (elevation, points) = apart(0.0, known);
        let (beyond, _) = apart(known, f64::INFINITY);
        say(&format!(
            "{event}: begins {shift:+.1} s apart; {count} of {} speeds differ \
             by {speed:.4} m/s at the most, {points} elevations by \
             {elevation:.2} m (beyond the recording {beyond:.2} m); {:.1} m \
             long, prepared {known} m\n",
            old.len(),
            found.length
        ));
        assert!(speed < 0.05 && count == old.len(), "{event}: {speed}");
        assert!(elevation < 1.0, "{event}: {elevation}");
        assert!(points >= 58, "{event}: {points}");
    }
}

#[test]
fn a_recorded_path_is_followed() {
    let Some(folder) = avanodes() else { return };
    let mut options = recorded(&folder, LOGS[0].0);
    options.path = Some(folder.join("raw/path_aimec.shp"));
    let found = import(&options).unwrap();
    let own = import(&recorded(&folder, LOGS[0].0)).unwrap();
    assert_eq!(found.recording, own.recording);
    assert!(
        found.told().contains("The path is the line of"),
        "{}",
        found.told()
    );
    // It goes on beyond the recording by itself.
    assert!(rows(&found.track).len() > rows(&own.track).len());
    assert!((found.length - own.length).abs() < 40.0, "{}", found.length);
}

/// A synthetic log: at rest, down an incline of 30 degrees to the south from
/// 47 N 11 E at up to 20 m/s, at rest again; 5 rows a second.
fn synthetic(
    header: &str,
    row: impl Fn(f64, f64, f64, f64) -> String,
) -> String {
    let mut text = format!("{header}\n");
    let mut way = 0.0;
    for i in 0..200 {
        let t = 0.2 * f64::from(i);
        let u = ((t - 10.0) / 20.0).clamp(0.0, 1.0);
        let speed = 20.0 * (std::f64::consts::PI * u).sin();
        way += 0.2 * speed;
        text.push_str(&row(t, way * 30.0_f64.to_radians().cos(), way, speed));
        text.push('\n');
    }
    text
}

/// Metres to the south as degrees of latitude at 47 N.
const DEGREE: f64 = 111_170.0;

fn imported(name: &str, text: &str, set: impl Fn(&mut Options)) -> Imported {
    let folder = fresh(name);
    let path = folder.join("log.csv");
    fs::write(&path, text).unwrap();
    let mut options = Options::new(path);
    set(&mut options);
    import(&options).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The greatest difference between speeds and those that were written.
fn error(found: &Imported) -> f64 {
    let begin = found.begin;
    let rows = rows(&found.recording);
    let differ = rows.iter().map(|(t, v)| {
        let u = ((begin + t - 10.0) / 20.0).clamp(0.0, 1.0);
        (v - 20.0 * (std::f64::consts::PI * u).sin()).abs()
    });
    differ.fold(0.0, f64::max)
}

#[test]
fn a_log_in_degrees_and_km_h_needs_nothing_else() {
    let text = synthetic("UTC;lon;lat;hoehe;v_kmh", |t, x, way, v| {
        let clock = format!("07:51:{:05.2}", t);
        format!(
            "{clock};11;{:.8};{:.3};{:.3}",
            47.0 - x / DEGREE,
            2000.0 - 0.5 * way,
            3.6 * v
        )
    });
    let columns = "time=UTC,height=hoehe,speed=v_kmh:km/h";
    let found = imported("degrees", &text, |options| {
        options.columns = Some(columns.to_owned());
    });
    assert!(error(&found) < 1e-3, "{}", error(&found));
    assert!((found.begin - 10.0).abs() < 0.21, "{}", found.begin);
    let slope = 30.0_f64.to_radians().tan();
    for pair in rows(&found.track).windows(2) {
        let own = (pair[0].1 - pair[1].1) / (pair[1].0 - pair[0].0);
        assert!((own - slope).abs() < 0.02, "{own}");
    }
    assert!(found.doubts.iter().any(|d| d.contains("elevations are the log")));
    let asked = imported("asked", &text, |options| {
        options.columns = Some(columns.to_owned());
        options.from = Some("07:51:12".to_owned());
        options.to = Some("20".to_owned());
    });
    assert!((asked.begin - 12.0).abs() < 1e-6);
    assert_eq!(rows(&asked.recording).last().unwrap().0, 8.0);
}

#[test]
fn speeds_come_from_positions_where_there_are_no_others() {
    let text = synthetic("t,x,y,z", |t, x, way, _| {
        format!("{t:.1},500,{:.4},{:.4}", -x, 900.0 - 0.5 * way)
    });
    let found = imported("positions", &text, |_| {});
    assert!(error(&found) < 0.4, "{}", error(&found));
    assert!(found.told().contains("worked out from its positions"));
    let text = synthetic("t,x,y,z,gSpeed[mm/s]", |t, x, way, v| {
        let level = 1000.0 * v * 30.0_f64.to_radians().cos();
        format!("{t:.1},500,{:.4},{:.4},{level:.1}", -x, 900.0 - 0.5 * way)
    });
    let found = imported("ground", &text, |_| {});
    assert!(error(&found) < 0.02, "{}", error(&found));
}

/// A terrain model of the same incline, with a hole.
fn terrain(folder: &Path) -> PathBuf {
    let slope = 30.0_f64.to_radians().tan();
    let mut text = String::from(
        "ncols 21\nnrows 101\nxllcenter 400\nyllcenter -500\ncellsize 10\n\
         NODATA_value -9999\n",
    );
    for row in 0..101 {
        let y = 500.0 - 10.0 * f64::from(row);
        let cells: Vec<String> = (0..21)
            .map(|_| match row == 62 {
                true => "-9999".to_owned(),
                false => format!("{:.4}", 900.0 + slope * y),
            })
            .collect();
        text.push_str(&format!("{}\n", cells.join(" ")));
    }
    let path = folder.join("dem.asc");
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn terrain_and_path_are_taken_where_given() {
    let folder = fresh("given");
    let dem = terrain(&folder);
    // Upwards, so that it has to be turned round.
    let path = folder.join("path.geojson");
    let line = r#"{"type":"LineString","coordinates":[[500,-450],[500,50]]}"#;
    fs::write(&path, line).unwrap();
    let text = synthetic("t,x,y,z,v", |t, x, _, v| {
        format!("{t:.1},503,{:.4},2000,{v:.4}", -x)
    });
    let found = imported("along", &text, |options| {
        options.terrain = Some(dem.clone());
        options.path = Some(path.clone());
    });
    assert!(error(&found) < 1e-3);
    let slope = 30.0_f64.to_radians().tan();
    for (x, z) in rows(&found.track) {
        assert!((z - (900.0 - slope * x)).abs() < 0.3, "{x} {z}");
    }
    let told = found.told();
    for part in ["turned round", "at the median 3.0 m away", "no elevation"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    assert!(found.picture.starts_with("<svg"));
}

fn couloir(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_couloir"))
        .args(arguments)
        .env("COLUMNS", "80")
        .output()
        .unwrap()
}

#[test]
fn the_command_writes_an_event_that_calibrates() {
    let folder = fresh("command");
    let log = folder.join("a \"name\" <b>.csv");
    let text = synthetic("t,x,y,z,v", |t, x, way, v| {
        // Errors that do not repeat soon, since none at all fit no model.
        let off = 0.3 * (7.3 * t * t).sin();
        let (y, z) = (-x, 900.0 - 0.5 * way);
        format!("{t:.1},500,{y:.4},{z:.4},{:.4}", (v + off).abs())
    });
    fs::write(&log, text).unwrap();
    let out = folder.join("event");
    let (log, out) = (log.to_string_lossy(), out.to_string_lossy());
    let output = couloir(&["import", &log, "--threshold", "1"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("Nothing was written"), "{text}");
    let write = ["import", &log, "--threshold", "1", "--out", &out];
    for _ in 0..2 {
        let output = couloir(&write);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{said}");
    }
    let svg = fs::read_to_string(Path::new(&*out).join("import.svg")).unwrap();
    assert!(svg.contains("&lt;b&gt;") && !svg.contains("<b>"));
    // The event leaves the noise open, which takes its time.
    let event = fs::read_to_string(Path::new(&*out).join("event.toml"));
    assert!(event.unwrap().contains("noise = \"infer\""));
    let quick = ["--noise", "ar(1)", "--backend", "mh", "--draws", "300"];
    let output = couloir(&[&["calibrate", &*out][..], &quick].concat());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    // What was changed by hand is not replaced.
    let event = Path::new(&*out).join("event.toml");
    let own = fs::read_to_string(&event).unwrap() + "# mine\n";
    fs::write(&event, &own).unwrap();
    assert_eq!(couloir(&write).status.code(), Some(2));
    assert_eq!(fs::read_to_string(&event).unwrap(), own);
}

#[test]
fn what_does_not_fit_is_refused_with_a_mend() {
    let folder = fresh("refused");
    let log = folder.join("log.csv");
    let text = synthetic("t,lon,lat,z,v", |t, x, way, v| {
        let z = 900.0 - 0.5 * way;
        format!("{t:.1},11,{:.8},{z:.3},{v:.3}", 47.0 - x / DEGREE)
    });
    fs::write(&log, text).unwrap();
    let dem = terrain(&folder).to_string_lossy().into_owned();
    let log = log.to_string_lossy().into_owned();
    let note = folder.join("path.doc").to_string_lossy().into_owned();
    let cases: [(&[&str], &str); 12] = [
        (&["--terrain", &dem], "--crs: is not given"),
        (&["--terrain", &dem, "--crs", "EPSG:31254"], "no elevation under"),
        (&["--crs", "EPSG:1"], "--crs: found \"EPSG:1\""),
        (&["--path", &note], "ends in \"doc\""),
        (&["--terrain", &log], "log.csv:1: found \"t,lon,lat,z,v\""),
        (&["--threshold", "50"], "its top speed is 20.00 m/s"),
        (&["--from", "39.9"], "expected at least 6"),
        (&["--from", "07:00:00"], "whose times are numbers"),
        (&["--smooth=-1"], "--smooth: found -1"),
        (&["--smooth", "nan"], "--smooth: found NaN"),
        (&["--columns", "speed=w"], "log.csv:1: the header is"),
        (&["--from", "2", "--to", "8"], "the positions never change"),
    ];
    for (more, part) in cases {
        let out = folder.join("out");
        let own = ["import", &log, "--out", &out.to_string_lossy()];
        let output = couloir(&[&own[..], more].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{more:?}: {said}");
        assert!(said.contains(part), "{part}: {said}");
        assert!(!out.exists(), "{more:?}");
    }
}
