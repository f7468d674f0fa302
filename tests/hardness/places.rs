//! What an event folder may point to: files elsewhere are read and not told,
//! and what is no file is refused before it is opened.

#![cfg(unix)]

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use super::command::{EVENT, RECORDING, TRACK, couloir, event, fresh, told};

const SECRET: &str = "hunter2:x:0:0:a secret:/root:/bin/bash\n";

/// The longest that a refusal may take, the program's start included.
const AT_ONCE: Duration = Duration::from_secs(10);

/// What `calibrate` and a sweep say of an event that they refuse, with
/// nothing of the secret.
fn refused(folder: &Path, part: &str) {
    let begun = Instant::now();
    let output = couloir(&["calibrate", "--quick", folder.to_str().unwrap()]);
    let text = told(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains(part), "{part}: {text}");
    assert!(!text.contains("hunter2") && !text.contains("secret:/"), "{text}");
    let out = folder.with_extension("swept");
    let words = ["sweep", "--verb=calibrate", "-q", "--out"];
    let paths = [out.to_str().unwrap(), folder.to_str().unwrap()];
    let output = couloir(&[&words[..], &paths].concat());
    assert_eq!(output.status.code(), Some(3), "{}", told(&output));
    for name in ["sweep.json", "sweep.csv"] {
        let text = fs::read_to_string(out.join(name)).unwrap();
        assert!(!text.contains("hunter2"), "{text}");
    }
    assert!(begun.elapsed() < AT_ONCE, "{:?}", begun.elapsed());
    fs::remove_dir_all(&out).unwrap();
}

/// An event whose track is what a name says.
fn tracked(folder: &Path, name: &str) {
    let name = format!("file = \"{name}\"");
    event(folder, &EVENT.replace("file = \"track.csv\"", &name));
}

#[test]
fn what_is_elsewhere_is_read_and_not_told() {
    let base = fresh("places-elsewhere");
    let folder = base.join("event");
    fs::create_dir_all(&base).unwrap();
    let secret = base.join("secret");
    fs::write(&secret, SECRET).unwrap();
    tracked(&folder, "../secret");
    refused(&folder, "secret:1: is not as expected");
    tracked(&folder, secret.to_str().unwrap());
    refused(&folder, "secret:1: is not as expected");
    event(&folder, EVENT);
    fs::remove_file(folder.join("track.csv")).unwrap();
    symlink("../secret", folder.join("track.csv")).unwrap();
    refused(&folder, "track.csv:1: is not as expected");
    event(&folder, EVENT);
    fs::remove_file(folder.join("event.toml")).unwrap();
    symlink("../secret", folder.join("event.toml")).unwrap();
    refused(&folder, "event.toml:1: is not TOML");
    // Terrain that events share.
    fs::remove_file(folder.join("event.toml")).unwrap();
    fs::write(base.join("shared.csv"), TRACK).unwrap();
    tracked(&folder, "../shared.csv");
    let output = couloir(&["simulate", folder.to_str().unwrap()]);
    assert!(output.status.success(), "{}", told(&output));
    fs::remove_dir_all(&base).unwrap();
}

#[test]
fn what_is_no_file_is_refused_at_once() {
    let folder = fresh("places-no-file");
    for name in ["/dev/zero", "/dev/stdin", "/dev/tty", "/dev/random"] {
        tracked(&folder, name);
        if Path::new(name).exists() {
            refused(&folder, "is not a regular file");
        }
    }
    tracked(&folder, "pipe");
    let made = Command::new("mkfifo").arg(folder.join("pipe")).status();
    assert!(made.unwrap().success());
    refused(&folder, "is not a regular file");
    tracked(&folder, "..");
    refused(&folder, "is a folder");
    symlink("loop", folder.join("loop")).unwrap();
    tracked(&folder, "loop");
    refused(&folder, "could not be read");
    symlink("nowhere", folder.join("dangling")).unwrap();
    tracked(&folder, "dangling");
    refused(&folder, "does not exist");
    tracked(&folder, "track.csv/x");
    refused(&folder, "a part of the path is a file");
    fs::remove_dir_all(&folder).unwrap();
    // A folder whose event.toml is a pipe.
    event(&folder, EVENT);
    fs::remove_file(folder.join("event.toml")).unwrap();
    let pipe = folder.join("event.toml");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let output = couloir(&["simulate", folder.to_str().unwrap()]);
    assert!(told(&output).contains("is not a regular file"));
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn files_without_an_end_are_refused_at_once() {
    let folder = fresh("places-endless");
    event(&folder, EVENT);
    let sparse = File::create(folder.join("track.csv")).unwrap();
    sparse.set_len(1 << 40).unwrap();
    refused(&folder, "has more than 134217728 bytes");
    event(&folder, EVENT);
    let sparse = File::create(folder.join("event.toml")).unwrap();
    sparse.set_len(1 << 40).unwrap();
    refused(&folder, "has more than 1048576 bytes");
    // What a system makes up has no size, and may wait for what is to come.
    tracked(&folder, "/proc/self/mountinfo");
    if Path::new("/proc/self/mountinfo").exists() {
        refused(&folder, "mountinfo: is not as expected");
    }
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn results_are_not_written_through_what_stands_there() {
    let base = fresh("places-results");
    let (source, out) = (base.join("event"), base.join("out"));
    event(&source, EVENT);
    fs::create_dir_all(&out).unwrap();
    let kept = base.join("kept");
    fs::write(&kept, RECORDING).unwrap();
    let run = || {
        let words = ["calibrate", "--quick", "-q", "--out"];
        let paths = [out.to_str().unwrap(), source.to_str().unwrap()];
        couloir(&[&words[..], &paths].concat())
    };
    for name in ["report.html", "couloir.sha256"] {
        let way = out.join(name);
        let made = Command::new("mkfifo").arg(&way).status().unwrap();
        assert!(made.success());
        assert_eq!(run().status.code(), Some(2), "{name}");
        fs::remove_file(&way).unwrap();
        symlink("/dev/zero", &way).unwrap();
        assert_eq!(run().status.code(), Some(2), "{name}");
        fs::remove_file(&way).unwrap();
        symlink("../kept", &way).unwrap();
        assert_eq!(run().status.code(), Some(2), "{name}");
        fs::remove_file(&way).unwrap();
    }
    assert_eq!(fs::read_to_string(&kept).unwrap(), RECORDING);
    assert!(run().status.success());
    // Journals that are pipes are none.
    let swept = base.join("swept");
    fs::create_dir_all(swept.join("results")).unwrap();
    let pipe = swept.join("results/x.jsonl");
    assert!(Command::new("mkfifo").arg(pipe).status().unwrap().success());
    let words = ["sweep", "--verb=calibrate", "-q", "--out"];
    let paths = [swept.to_str().unwrap(), source.to_str().unwrap()];
    let quick = ["--", "--quick"];
    let output = couloir(&[&words[..], &paths, &quick].concat());
    assert_eq!(output.status.code(), Some(0), "{}", told(&output));
    fs::remove_dir_all(&base).unwrap();
}
