//! Tells the crate its version together with the commit it was built from,
//! `0.1.0 (1a2b3c4)`, and whether the sources had been changed since.

use std::env;
use std::fs;
use std::process::Command;

fn main() {
    for source in ["src", "macros/src", "build.rs", "Cargo.toml"] {
        println!("cargo::rerun-if-changed={source}");
    }
    let version = env::var("CARGO_PKG_VERSION").unwrap_or_default();
    let told = match of_repository().or_else(of_package) {
        Some(commit) => format!("{version} ({commit})"),
        None => version,
    };
    println!("cargo::rustc-env=COULOIR_VERSION={told}");
}

/// In a checkout of couloir itself, not in one of a program that depends on
/// it.
fn of_repository() -> Option<String> {
    fs::metadata(".git").ok()?;
    let commit = git(&["rev-parse", "--short=9", "HEAD"])?;
    let changed = git(&["status", "--porcelain", "--", "src", "macros/src"])?;
    let more = if changed.is_empty() { "" } else { ", changed" };
    Some(format!("{commit}{more}"))
}

fn git(arguments: &[&str]) -> Option<String> {
    let found = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(found.stdout).ok()?;
    found.status.success().then(|| text.trim().to_owned())
}

/// In a package, where `cargo package` has noted it.
fn of_package() -> Option<String> {
    let noted = fs::read_to_string(".cargo_vcs_info.json").ok()?;
    let (_, rest) = noted.split_once("\"sha1\": \"")?;
    rest.get(..9).map(str::to_owned)
}
