//! Imports: recorded logs against events that were prepared from them by
//! hand, and small synthetic logs of every form.

#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use couloir::import::{Imported, Options, Particle, import, import_all};

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

/// Numbers as a file has them.
fn doubles(all: &[f64]) -> Vec<u8> {
    all.iter().copied().flat_map(f64::to_le_bytes).collect()
}

/// The same incline as a GeoTIFF of double precision, written byte by byte:
/// the corner in the north-west, and the code of the projection.
fn geotiff(path: &Path, (west, north): (f64, f64), epsg: u16) {
    let slope = 30.0_f64.to_radians().tan();
    let row = |row: i32| {
        let z = 900.0 + slope * (500.0 - 10.0 * f64::from(row));
        doubles(&[z; 21])
    };
    let cells: Vec<u8> = (0..101).flat_map(row).collect();
    let keys = [1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, epsg];
    let parts = [
        cells.clone(),
        doubles(&[10.0, 10.0, 0.0]),
        doubles(&[0.0, 0.0, 0.0, west, north, 0.0]),
        keys.into_iter().flat_map(u16::to_le_bytes).collect(),
    ];
    // Behind the header of eight bytes: the parts, then the directory.
    let length = |part: &Vec<u8>| u32::try_from(part.len()).unwrap();
    let at = |i: usize| 8 + parts[..i].iter().map(length).sum::<u32>();
    // Tag, type (3 short, 4 long, 12 double), how many, the value or where.
    let entries: [(u16, u16, u32, u32); 13] = [
        (256, 4, 1, 21),
        (257, 4, 1, 101),
        (258, 3, 1, 64),
        (259, 3, 1, 1),
        (262, 3, 1, 1),
        (273, 4, 1, at(0)),
        (277, 3, 1, 1),
        (278, 4, 1, 101),
        (279, 4, 1, length(&cells)),
        (339, 3, 1, 3),
        (33550, 12, 3, at(1)),
        (33922, 12, 6, at(2)),
        (34735, 3, 12, at(3)),
    ];
    let directory = at(4).to_le_bytes();
    let mut file = [&b"II*\0"[..], &directory, &parts.concat()].concat();
    file.extend(13_u16.to_le_bytes());
    file.extend(entries.into_iter().flat_map(entry));
    file.extend([0; 4]);
    fs::write(path, file).unwrap();
}

/// An entry of a directory of a TIFF.
fn entry((tag, kind, count, value): (u16, u16, u32, u32)) -> Vec<u8> {
    let [tag, kind] = [tag, kind].map(u16::to_le_bytes);
    let [count, value] = [count, value].map(u32::to_le_bytes);
    [&tag[..], &kind, &count, &value].concat()
}

#[test]
fn a_geotiff_is_the_same_ground_and_names_its_projection() {
    let folder = fresh("geotiff");
    let (asc, tif) = (terrain(&folder), folder.join("dem.tif"));
    // The grid's first cell has its middle at 400, 500.
    geotiff(&tif, (395.0, 505.0), 32632);
    let text = synthetic("t,x,y,z,v", |t, x, _, v| {
        format!("{t:.1},503,{:.4},2000,{v:.4}", -x)
    });
    let on = |dem: &PathBuf| {
        imported("same-ground", &text, |options| {
            options.terrain = Some(dem.clone());
        })
    };
    // The ASCII grid has a row without data at y = -120 and four decimals.
    let (asc, tif) = (rows(&on(&asc).track), rows(&on(&tif).track));
    assert_eq!(asc.len(), tif.len());
    for (a, b) in asc.iter().zip(&tif) {
        assert!(a.0 == b.0 && (a.1 - b.1).abs() < 2e-3, "{a:?} {b:?}");
    }
}

/// On the central meridian of a zone of UTM: 500 km east, and north the
/// length of the meridian to 45 degrees, 4984944.378 m, times 0.9996.
#[test]
fn the_projection_of_a_geotiff_is_taken_and_doubted() {
    let tif = fresh("projected").join("dem.tif");
    geotiff(&tif, (499_900.0, 4_983_455.4), 32632);
    // One degree of latitude at 45 N is 111 132 m on the ellipsoid.
    let text = synthetic("t,lon,lat,v", |t, x, _, v| {
        format!("{t:.1},9,{:.8},{v:.4}", 45.0 - x / 111_132.0)
    });
    let with = |crs: Option<&str>| {
        let mut options = Options::new("");
        options.crs = crs.map(str::to_owned);
        options.terrain = Some(tif.clone());
        let log = tif.with_file_name("log.csv");
        fs::write(&log, &text).unwrap();
        options.logs = vec![log];
        import(&options)
    };
    let found = with(None).unwrap();
    let told = found.told();
    assert!(told.contains("brought to EPSG:32632"), "{told}");
    assert!(told.contains("that the terrain model names"), "{told}");
    assert!(error(&found) < 1e-3);
    // The slope, but for UTM's metres, which are 0.9996 of those.
    let track = rows(&found.track);
    let slope = (track[0].1 - track[20].1) / (track[20].0 - track[0].0);
    assert!((slope - 30.0_f64.to_radians().tan()).abs() < 1e-3, "{slope}");
    // The same projection in other words is none to doubt; ETRS89 is the same
    // here to a millimetre, and its neighbour's zone is 6 degrees off.
    let other = with(Some("EPSG:25832")).unwrap();
    assert!(!other.told().contains("says that it is on"), "{}", other.told());
    // The zone's own projection but for an origin 30 m further west.
    let shifted = "+proj=tmerc +lat_0=0 +lon_0=9 +k=0.9996 +x_0=500030 \
                   +ellps=WGS84 +towgs84=0,0,0,0,0,0,0";
    let told = with(Some(shifted)).unwrap().told();
    assert!(told.contains("it is on EPSG:32632"), "{told}");
    assert!(told.contains("is 30 m apart"), "{told}");
    geotiff(&tif, (499_900.0, 4_983_455.4), 5514);
    let error = with(None).unwrap_err().to_string();
    assert!(error.contains("is on EPSG:5514; expected one of"), "{error}");
    assert!(error.contains("PROJ string with --crs"), "{error}");
}

/// The front of a mass with 3 m/s2 along an incline of 30 degrees from rest,
/// a position each second, to the millimetre.
fn front(header: &str, row: impl Fn(f64, f64) -> String) -> String {
    let rows = (0..=12).map(|i| {
        let t = f64::from(i);
        row(t, 1.5 * t * t)
    });
    format!("{header}\n{}", rows.collect::<String>())
}

/// Distances and mean speeds of the recording of a front.
fn of_front(found: &Imported) -> Vec<[f64; 3]> {
    let number = |cell: &str| cell.parse::<f64>().unwrap();
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(number).collect();
        [cells[0], cells[1], cells[2]]
    };
    found.recording.lines().skip(1).map(row).collect()
}

#[test]
fn a_front_is_its_distances_along_the_slope() {
    let folder = fresh("front");
    let (dem, path) = (folder.join("dem.tif"), folder.join("path.geojson"));
    geotiff(&dem, (395.0, 505.0), 32632);
    let line = r#"{"type":"LineString","coordinates":[[500,50],[500,-450]]}"#;
    fs::write(&path, line).unwrap();
    let cosine = 30.0_f64.to_radians().cos();
    // Three points each time, whose mean is on the path.
    let points = front("t,x,y,z", |t, s| {
        let y = -cosine * s;
        [-20.0, 5.0, 15.0]
            .map(|x| format!("{t},{:.4},{y:.4},2000\n", 500.0 + x))
            .concat()
    });
    // The path begins 50 m before the front.
    let along = front("t,s", |t, s| format!("{t},{:.4}\n", 50.0 + cosine * s));
    for (name, text) in [("points", points), ("along", along)] {
        let file = folder.join(format!("{name}.csv"));
        fs::write(&file, text).unwrap();
        let mut options = Options::of_logs::<PathBuf>([]);
        options.front = Some(file);
        options.terrain = Some(dem.clone());
        options.path = Some(path.clone());
        let found = import(&options).unwrap();
        let rows = of_front(&found);
        assert_eq!(rows.len(), 12, "{name}");
        // Written to 1 mm, from places to 0.1 mm on a track to 1 mm.
        for [t, position, speed] in rows {
            let (s, v) = (1.5 * t * t, 3.0 * (t - 0.5));
            assert!((position - s).abs() < 2e-3, "{name} {t}: {position}");
            assert!((speed - v).abs() < 2e-3, "{name} {t}: {speed}");
        }
        for part in ["quantity = \"position\"", "# window = 1\n"] {
            assert!(found.event.contains(part), "{}", found.event);
        }
        assert!(found.event.contains("velocity = 0.000"), "{}", found.event);
        let told = found.told();
        assert!(told.contains("correlated by -1/2"), "{told}");
        assert!(told.contains("front ends in the motion"), "{told}");
        assert_eq!(told.contains("up to 3, are one place"), name == "points");
    }
}

/// The log of a sensor so many metres further down, whose clock is so many
/// seconds later.
fn sensor(below: f64, later: f64) -> String {
    synthetic("t,x,y,v", |t, x, _, v| {
        format!("{:.1},503,{:.4},{v:.4}", t + later, -x - below)
    })
}

/// Two sensors, and a front that begins 20 m above the first, all on one path.
fn three(name: &str, later: f64) -> Options {
    let folder = fresh(name);
    let file = |name: &str, text: &str| {
        let file = folder.join(name);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, text).unwrap();
        file
    };
    // Two files of one name in two folders.
    let mut options = Options::of_logs([
        file("a/gps.csv", &sensor(0.0, 0.0)),
        file("b/gps.csv", &sensor(40.0, later)),
    ]);
    let moving = front("t,x,y", |t, s| {
        format!("{},500,{:.4}\n", t + 12.0, 20.0 - 0.866 * s)
    });
    let line = r#"{"type":"LineString","coordinates":[[500,50],[500,-450]]}"#;
    options.front = Some(file("front.csv", &moving));
    options.path = Some(file("path.geojson", line));
    let dem = folder.join("dem.tif");
    geotiff(&dem, (395.0, 505.0), 32632);
    options.terrain = Some(dem);
    options
}

/// The number of a key in an event.toml.
fn number(one: &Imported, key: &str) -> f64 {
    let mut lines = one.event.lines();
    let line = lines.find(|line| line.starts_with(key)).unwrap();
    let value = line.split('=').nth(1).unwrap();
    value.split('#').next().unwrap().trim().parse().unwrap()
}

#[test]
fn two_sensors_and_a_front_share_path_track_and_clock() {
    let options = three("several", 4.0);
    let all = import_all(&options).unwrap();
    let folders: Vec<_> = all.iter().map(|one| one.folder.as_str()).collect();
    assert_eq!(folders, ["gps", "gps-2", "front"]);
    assert!(all.iter().all(|one| one.track == all[0].track));
    // The front is first up the path, and the sensors 20 and 60 m further
    // down, to the millimetre that the files are written to.
    let places = all.iter().map(|one| number(one, "x = "));
    for (place, known) in places.zip([20.0, 60.0, 0.0]) {
        assert!((place - known).abs() < 2e-3, "{place} {known}");
    }
    // The row before the threshold is passed: at 10, 14 and 12 s of the clock.
    let starts = all.iter().map(|one| number(one, "start = "));
    for (start, known) in starts.zip([0.0, 4.0, 2.0]) {
        assert!((start - known).abs() < 1e-6, "{start} {known}");
    }
    let error = import(&options).unwrap_err().to_string();
    assert!(error.contains("there are 3 recordings; expected one"), "{error}");
}

#[test]
fn recordings_without_a_common_moment_have_their_own_clocks() {
    let all = import_all(&three("apart", 4000.0)).unwrap();
    assert!(all.iter().all(|one| !one.event.contains("[event]")));
    let told = |one: &Imported| one.told().contains("a clock of its own");
    assert!(all.iter().all(told));
}

#[test]
fn the_command_writes_a_folder_for_each_recording() {
    let folder = fresh("folders");
    let text = synthetic("t,x,y,z,v", |t, x, way, v| {
        let (y, z) = (-x, 900.0 - 0.5 * way);
        format!("{t:.1},500,{y:.4},{z:.4},{v:.4}")
    });
    let names = ["one.csv", "two.csv"].map(|name| folder.join(name));
    names.iter().for_each(|name| fs::write(name, &text).unwrap());
    let [one, two] = names.map(|name| name.to_string_lossy().into_owned());
    let out = folder.join("events");
    let write = ["import", &one, &two, "--out", &out.to_string_lossy()];
    for _ in 0..2 {
        let output = couloir(&write);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{said}");
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(said.contains("two --one-law"), "{said}");
    }
    for name in ["one", "two"] {
        let file = out.join(name).join("event.toml");
        assert!(file.is_file(), "{name}");
        let event = file.to_string_lossy().into_owned();
        let set = ["--set", "mu=0.3", "--set", "xi=1000"];
        let output = couloir(&[&["simulate", &event][..], &set].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{said}");
    }
    // Somebody's file in one of the folders is not replaced.
    fs::write(out.join("two/note.txt"), "mine").unwrap();
    assert_eq!(couloir(&write).status.code(), Some(2));
}

#[test]
fn a_front_that_does_not_fit_is_refused_with_a_mend() {
    let folder = fresh("front-refused");
    let file = |name: &str, text: &str| {
        let file = folder.join(name);
        fs::write(&file, text).unwrap();
        file.to_string_lossy().into_owned()
    };
    let along = front("t,s", |t, s| format!("{t},{s:.3}\n"));
    let along = file("along.csv", &along);
    let line = r#"{"type":"LineString","coordinates":[[500,50],[500,0]]}"#;
    let path = file("path.geojson", line);
    let none = file("none.csv", "t,u\n0,1\n");
    let bad = file("bad.csv", "t,s\n0,1\n1,far\n");
    let log = file("log.csv", "t,x,y,v\n0,1,1,1\n");
    let broken = file("dem.tif", "ncols 3");
    let cases: [(&[&str], &str); 7] = [
        (&["--front", &along], "along.csv: has distances along a path"),
        (&["--front", &along, "--path", &path], "csv:8: the distance along"),
        (&["--front", &none], "none.csv:1: the header is"),
        (&["--front", &bad], "bad.csv:3: \"s\" is \"far\""),
        (&[&log, &log, "--name", "both"], "--name: is given"),
        (&[&log, "--terrain", &broken], "dem.tif: is no GeoTIFF"),
        (&[], "there is no recording; expected a log, a front"),
    ];
    for (arguments, part) in cases {
        let out = folder.join("out");
        let out = ["--out", &*out.to_string_lossy()].map(str::to_owned);
        let out: Vec<&str> = out.iter().map(String::as_str).collect();
        let output = couloir(&[&["import"], arguments, &out].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(part), "{part}: {said}");
        assert!(!folder.join("out").exists(), "{arguments:?}");
    }
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
    let cases: [(&[&str], &str); 14] = [
        (&["--from", "30", "--to", "20"], "expected a beginning before the e"),
        (&["--smooth", "-1"], "--smooth: found -1"),
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
        let is_asked = more.contains(&"--from");
        assert!(!(is_asked && said.contains("--threshold")), "{said}");
        assert!(!out.exists(), "{more:?}");
    }
}

#[test]
fn a_log_that_says_nothing_for_long_is_doubted() {
    let text = synthetic("t,x,y,z,v", |t, x, way, v| {
        // Of a log of one run, what comes later is another 100 s later.
        let later = if t > 25.0 { 100.0 } else { 0.0 };
        let z = 900.0 - 0.5 * way;
        format!("{:.1},500,{:.4},{z:.4},{v:.4}", t + later, -x)
    });
    let found = imported("silent", &text, |_| {});
    let doubts = found.doubts.join(" ");
    assert!(doubts.contains("says nothing for 100."), "{doubts}");
    assert!(doubts.contains("ends before that"), "{doubts}");
    let whole = synthetic("t,x,y,z,v", |t, x, way, v| {
        format!("{t:.1},500,{:.4},{:.4},{v:.4}", -x, 900.0 - 0.5 * way)
    });
    let doubts = imported("speaking", &whole, |_| {}).doubts.join(" ");
    assert!(!doubts.contains("says nothing"), "{doubts}");
}

/// A project of AvaFrame in which particles of 1, 2 and 3 kg slide north on a
/// plane of 45 degrees, 10 m apart, from rest with 2 m/s^2 over ground; the
/// last leaves after 5 s.
fn avaframe(folder: &Path) {
    let csv = folder.join("Outputs/com1DFA/particlesCSV");
    fs::create_dir_all(&csv).unwrap();
    fs::create_dir_all(folder.join("Inputs/LINES")).unwrap();
    for step in 0..12_u32 {
        let t = f64::from(step);
        let rows = (0..if step > 5 { 2 } else { 3_u32 }).map(|n| {
            let (y, speed) = (t * t + 10.0 * f64::from(n), 2.0 * t);
            let speed = speed * 2.0_f64.sqrt();
            let (z, mass) = (500.0 - y, n + 1);
            format!("50.0,{y},{z},{speed},{mass},{},{t}\n", n + 7)
        });
        let text: String = rows.collect();
        let text = format!("X,Y,Z,velocityMagnitude,m,ID,time\n{text}");
        let name = format!("particlesslide_1.csv.{step:04}");
        fs::write(csv.join(name), text).unwrap();
    }
    let row = |y: i32| format!("{0} {0} {0}\n", 500 - y);
    let rows: String = (0..=40).rev().map(|n| row(10 * n)).collect();
    let head = "ncols 3\nnrows 41\nxllcenter 0\nyllcenter 0\ncellsize 10\n";
    let head = head.replace("ncols 3", "ncols 11");
    let rows = rows.lines().map(|row| {
        let cell = row.split(' ').next().unwrap();
        format!("{}\n", [cell; 11].join(" "))
    });
    let text: String = std::iter::once(head).chain(rows).collect();
    fs::write(folder.join("Inputs/dem.asc"), text).unwrap();
}

#[test]
fn a_simulation_by_avaframe_is_read() {
    let folder = std::env::temp_dir().join("couloir-avaframe");
    let _ = fs::remove_dir_all(&folder);
    avaframe(&folder);
    let mut options = Options::of_logs::<PathBuf>([]);
    options.avaframe = Some(folder.clone());
    options.threshold = 0.5;
    let mean = import(&options).unwrap();
    assert!(mean.event.contains("name = \"slide_1-mean\""), "{}", mean.event);
    assert!(mean.event.contains("# Synthetic data"), "{}", mean.event);
    assert!(mean.said[0].contains("centre of mass"), "{:?}", mean.said);
    assert!(mean.doubts.iter().any(|d| d.contains("are 2 to 3")));
    // All have one speed along the slope.
    for (t, speed) in rows(&mean.recording) {
        let exact = 2.0 * (t + mean.begin) * 2.0_f64.sqrt();
        assert!((speed - exact).abs() < 1e-3, "{t}: {speed}");
    }
    // The terrain is a plane, whatever it is smoothed over.
    let track = rows(&mean.track);
    for pair in track.windows(2) {
        let slope = (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
        assert!((slope + 1.0).abs() < 1e-3, "{slope}");
    }
    options.particles = vec![Particle::Number(9), Particle::Mean];
    let both = import_all(&options).unwrap();
    assert_eq!(both[0].folder, "particle-9");
    assert!(both[0].doubts.iter().any(|d| d.contains("in 6 of 12 tables")));
    let path = folder.join("Inputs/path.geojson");
    let line = r#"{"type": "LineString", "coordinates":
        [[50, 0], [50, 390], [50.0, 400.0]]}"#;
    fs::write(&path, line).unwrap();
    options.path = Some(path);
    options.particles = vec![Particle::Front];
    let front = import(&options).unwrap();
    // 20 m ahead until it leaves: distances since the first row that moves.
    let (first, last) = (front.begin, 5.0);
    let at = |t: f64| 20.0 + t * t - first * first - 20.0;
    for (t, distance) in rows(&front.recording) {
        if first + t <= last {
            let exact = 2.0_f64.sqrt() * at(first + t);
            assert!((distance - exact).abs() < 0.01, "{t}: {distance}");
        }
    }
    fs::remove_dir_all(&folder).unwrap();
}

/// A table of particles, and what is said of it.
const TABLES: [(&str, &str); 9] = [
    ("", "expected the column X"),
    ("X,Y,Z,velocityMagnitude,time\n", "has no particle"),
    ("X,Y,Z,time\n1,2,3,3\n", "expected the column velocityMagnitude"),
    ("X,Y,Z,velocityMagnitude,time\n1,2,3,3,3\n", "has no column ID"),
    ("X,Y,Z,velocityMagnitude,time\n1,2,3,inf,3\n", "0003:2: column 4"),
    ("X,Y,Z,velocityMagnitude,time\n1,2,3\n", "is no table"),
    ("X,Y,Z,velocityMagnitude,m,time\n1,2,3,3,0,3\n", "mass is 0"),
    (
        "X,Y,Z,velocityMagnitude,ID,time\n1,2,3,3,1,3\n1,2,3,3,1,4\n",
        "expected a table of one time",
    ),
    ("X,Y,Z,velocityMagnitude,ID,time\n1,2,3,3,7,0\n", "after a table"),
];

#[test]
fn tables_of_particles_that_are_none_are_refused() {
    let folder = std::env::temp_dir().join("couloir-avaframe-tables");
    let _ = fs::remove_dir_all(&folder);
    avaframe(&folder);
    let mut options = Options::of_logs::<PathBuf>([]);
    options.avaframe = Some(folder.clone());
    options.particles = vec![Particle::Number(7)];
    let csv = folder.join("Outputs/com1DFA/particlesCSV");
    for (text, part) in TABLES {
        fs::write(csv.join("particlesslide_1.csv.0003"), text).unwrap();
        let error = import(&options).unwrap_err();
        let said = error.to_string();
        assert!(error.is_input() && said.contains(part), "{said}");
    }
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_avaframe_lacks_is_said() {
    let folder = std::env::temp_dir().join("couloir-avaframe-wrong");
    let _ = fs::remove_dir_all(&folder);
    let mut options = Options::of_logs::<PathBuf>([]);
    let refused = |options: &Options, part: &str| {
        let error = import(options).unwrap_err();
        let text = error.to_string();
        assert!(error.is_input() && text.contains(part), "{text}");
    };
    options.particles = vec![Particle::Front];
    refused(&options, "add --avaframe DIR");
    options.avaframe = Some(folder.clone());
    refused(&options, "writePartToCSV = True");
    avaframe(&folder);
    refused(&options, "there is no path");
    options.particles = vec![Particle::Number(3)];
    refused(&options, "has no particle of this number");
    options.simulation = Some("other".to_owned());
    refused(&options, "expected one of \"slide_1\"");
    options.simulation = None;
    options.particles.clear();
    let csv = folder.join("Outputs/com1DFA/particlesCSV");
    fs::write(csv.join("particlesother.csv.0000"), "").unwrap();
    refused(&options, "there are 2 simulations");
    fs::remove_file(csv.join("particlesother.csv.0000")).unwrap();
    fs::write(folder.join("Inputs/b.tif"), "").unwrap();
    refused(&options, "holds 2 terrain models");
    fs::remove_dir_all(&folder).unwrap();
}
