//! The folder of a run's results, which the run owns: what an earlier run
//! wrote there goes, and what anybody else wrote stays.
//!
//! A list of checksums beside the results says what couloir wrote. A file that
//! is not on it, or is no longer as it was written, is somebody else's: it is
//! neither replaced nor removed.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fs;
use std::io::Write;
use std::path::{Component, Path, PathBuf};

use super::inputs::{read_for, sha256};
use super::words::place;
use super::write::{
    Content, put_in_place, summed_draft, try_folder, write_all,
};
use crate::error::{Error, Result};

/// What the list is called; `sha256sum --check` reads it.
const LIST: &str = "couloir.sha256";

/// How the list begins.
const HEAD: &str = "# Written by couloir; its next run with this --out \
                    replaces these files.";

/// Checksums by the names of files. While files are being replaced a name has
/// two, the old one and the new.
type Listed = BTreeMap<String, BTreeSet<String>>;

/// Looks, before the work, at the folder that results are to go to: whether it
/// can be made and written, and whether what is there may be replaced. Nothing
/// of it stays. `names` are those of the results, with `/` behind the name of
/// a folder; `events` are what the run reads, with the files that they name.
///
/// # Errors
/// An input error where a file is in the way that couloir did not write, or
/// that the run reads; a system error where the machine refuses.
pub(crate) fn prepare_run(
    folder: &Path,
    names: &[&str],
    events: &[PathBuf],
) -> Result<()> {
    try_folder(folder)?;
    let listed = read_list(folder)?;
    let names = names.iter().map(|name| (*name).to_owned());
    refuse_foreign(folder, names, &listed)?;
    refuse_read(folder, events, &listed)
}

/// Writes the results of a run into a folder, in place of all that an earlier
/// one wrote there. The new files are complete before an old one goes.
///
/// # Errors
/// As [`prepare_run`]. The list still names all that is couloir's then.
pub(crate) fn write_run<N: AsRef<Path>, B: AsRef<[u8]>>(
    folder: &Path,
    files: &[(N, B)],
) -> Result<()> {
    let contents: Vec<_> = files
        .iter()
        .map(|(name, bytes)| {
            let bytes = bytes.as_ref();
            let write = |file: &mut (dyn Write + Send)| file.write_all(bytes);
            (name.as_ref(), write)
        })
        .collect();
    let contents: Vec<(&Path, &Content<'_>)> = contents
        .iter()
        .map(|(name, write)| (*name, write as &Content<'_>))
        .collect();
    write_run_of(folder, &contents)
}

/// The same of files that are written as they are made.
///
/// # Errors
/// As [`write_run`], and those of a file's making.
pub(crate) fn write_run_of(
    folder: &Path,
    files: &[(&Path, &Content<'_>)],
) -> Result<()> {
    let old = read_list(folder)?;
    let names = files.iter().map(|(name, _)| listed_name(name));
    refuse_foreign(folder, names.clone(), &old)?;
    let drafts = files
        .iter()
        .map(|(name, content)| summed_draft(folder.join(name), content))
        .collect::<Result<Vec<_>>>()?;
    let (drafts, sums): (Vec<_>, Vec<_>) = drafts.into_iter().unzip();
    let sums = sums.into_iter().map(|sum| BTreeSet::from([sum]));
    let new: Listed = names.zip(sums).collect();
    let mut both = old.clone();
    for (name, sums) in &new {
        both.entry(name.clone()).or_default().extend(sums.iter().cloned());
    }
    write_list(folder, &both)?;
    put_in_place(&drafts)?;
    for name in old.keys().filter(|name| !new.contains_key(*name)) {
        remove(folder, name)?;
    }
    write_list(folder, &new)
}

/// A name in the list: its parts with `/` between, on every system.
fn listed_name(name: &Path) -> String {
    let parts = name.components().map(|part| part.as_os_str());
    let parts: Vec<_> = parts.map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

fn write_list(folder: &Path, listed: &Listed) -> Result<()> {
    let mut text = format!("{HEAD}\n");
    for (name, sums) in listed {
        for sum in sums {
            text.push_str(&format!("{sum}  {name}\n"));
        }
    }
    write_all(folder, &[(LIST, text)])
}

/// What couloir wrote into a folder; nothing where there is no list.
fn read_list(folder: &Path) -> Result<Listed> {
    let path = folder.join(LIST);
    if path.symlink_metadata().is_err() {
        return Ok(Listed::new());
    }
    // A pipe would keep a reader waiting.
    let text = match path.is_file() {
        true => fs::read_to_string(&path).unwrap_or_default(),
        false => return Err(in_the_way(&path)),
    };
    let mut lines = text.lines();
    let known = lines.next() == Some(HEAD);
    let mut listed = Listed::new();
    for line in lines {
        match line.split_once("  ").filter(|(_, name)| stays_inside(name)) {
            Some((sum, name)) if known => {
                let sums = listed.entry(name.to_owned()).or_default();
                sums.insert(sum.to_owned());
            }
            _ => return Err(in_the_way(&path)),
        }
    }
    if known { Ok(listed) } else { Err(in_the_way(&path)) }
}

/// Whether a name leads to no place outside its folder.
fn stays_inside(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    !name.is_empty() && parts.all(|part| matches!(part, Component::Normal(_)))
}

/// Refuses where a file under one of the names, or one that is on the list,
/// is not as couloir wrote it.
fn refuse_foreign(
    folder: &Path,
    names: impl Iterator<Item = String>,
    listed: &Listed,
) -> Result<()> {
    for name in names.chain(listed.keys().cloned()) {
        let path = folder.join(&name);
        match name.ends_with('/') && path.is_dir() {
            true => refuse_foreign_within(&path, &name, listed)?,
            false => refuse_other(&path, &name, listed)?,
        }
    }
    Ok(())
}

fn refuse_foreign_within(
    folder: &Path,
    name: &str,
    listed: &Listed,
) -> Result<()> {
    let unread = |_| in_the_way(folder);
    for entry in fs::read_dir(folder).map_err(unread)? {
        let entry = entry.map_err(unread)?;
        let path = entry.path();
        let name = format!("{name}{}", entry.file_name().to_string_lossy());
        match entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            true => {
                refuse_foreign_within(&path, &format!("{name}/"), listed)?;
            }
            false => refuse_other(&path, &name, listed)?,
        }
    }
    Ok(())
}

/// Refuses what is there under this name and is not as couloir wrote it.
fn refuse_other(path: &Path, name: &str, listed: &Listed) -> Result<()> {
    if path.symlink_metadata().is_err() {
        return Ok(());
    }
    let about = path.metadata().ok().filter(fs::Metadata::is_file);
    let about = about.ok_or_else(|| in_the_way(path))?;
    // A file that is empty holds nothing to lose: a shell makes one of
    // `--json > DIR/diagnosis.json` before the run begins.
    if about.len() == 0 {
        return Ok(());
    }
    let Some(known) = listed.get(name) else { return Err(in_the_way(path)) };
    match fs::read(path) {
        Ok(bytes) if known.contains(&sha256(&bytes)) => Ok(()),
        _ => Err(in_the_way(path)),
    }
}

fn in_the_way(path: &Path) -> Error {
    Error::input(format!(
        "{}: couloir did not write it, or it was changed since, and results \
         would take its place; expected a new folder, or one that holds an \
         earlier run as it was written: give another --out, or move it away",
        place(path)
    ))
}

/// Refuses to replace what the run reads: events with the files that they name,
/// or files.
fn refuse_read(
    folder: &Path,
    events: &[PathBuf],
    listed: &Listed,
) -> Result<()> {
    let written = listed.keys().filter_map(|name| {
        canonical(&folder.join(name)).ok().map(|path| (path, name))
    });
    let written: HashMap<PathBuf, &String> = written.collect();
    if written.is_empty() {
        return Ok(());
    }
    for event in events {
        // Its own error is told where it is read.
        let read = read_for(event).unwrap_or_default();
        let mut read = read.iter().filter_map(|path| canonical(path).ok());
        if let Some(name) = read.find_map(|path| written.get(&path)) {
            return Err(Error::input(format!(
                "{}: an earlier run wrote this file, and this run would read \
                 it and put its results in its place: give another --out",
                place(&folder.join(name))
            )));
        }
    }
    Ok(())
}

fn canonical(path: &Path) -> Result<PathBuf> {
    path.canonicalize().map_err(|e| Error::system(e.to_string()))
}

/// Removes a file of an earlier run, and the folders that it leaves empty.
fn remove(folder: &Path, name: &str) -> Result<()> {
    let path = folder.join(name);
    match fs::remove_file(&path) {
        // It may be gone, or may never have been: its name is too long.
        Err(error) if path.symlink_metadata().is_ok() => {
            return Err(Error::system(format!(
                "{}: an earlier run's file could not be removed: {error}",
                place(&path)
            )));
        }
        _ => {}
    }
    let parents = Path::new(name).ancestors().skip(1);
    for parent in parents.filter(|p| !p.as_os_str().is_empty()) {
        // What is not empty holds something that is not ours.
        let _ = fs::remove_dir(folder.join(parent));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fresh(name: &str) -> PathBuf {
        let id = std::process::id();
        let folder =
            std::env::temp_dir().join(format!("couloir-run-{name}-{id}"));
        let _ = fs::remove_dir_all(&folder);
        folder
    }

    fn files(names: &[&'static str]) -> Vec<(&'static str, String)> {
        names.iter().map(|name| (*name, format!("of {name}"))).collect()
    }

    fn there(folder: &Path, names: &[&str]) -> Vec<bool> {
        names.iter().map(|name| folder.join(name).exists()).collect()
    }

    #[test]
    fn a_run_replaces_the_one_before_it_and_nothing_else() {
        let folder = fresh("replaces");
        let first = ["a.json", "pictures/1.svg", "corrected/x/event.toml"];
        write_run(&folder, &files(&first)).unwrap();
        fs::write(folder.join("mine.txt"), "mine").unwrap();
        fs::write(folder.join("pictures/mine.svg"), "mine").unwrap();
        write_run(&folder, &files(&["a.json", "b.csv"])).unwrap();
        let names = ["a.json", "b.csv", "pictures/1.svg", "corrected"];
        assert_eq!(there(&folder, &names), [true, true, false, false]);
        let mine = there(&folder, &["mine.txt", "pictures/mine.svg"]);
        assert_eq!(mine, [true, true]);
        let list = fs::read_to_string(folder.join(LIST)).unwrap();
        assert_eq!(list.lines().count(), 3, "{list}");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn what_couloir_did_not_write_is_refused_and_stays() {
        let folder = fresh("foreign");
        let names = ["report.html", "pictures/"];
        for foreign in ["report.html", "pictures/deep/1.svg"] {
            let path = folder.join(foreign);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, "mine").unwrap();
            let error = prepare_run(&folder, &names, &[]).unwrap_err();
            assert!(error.is_input());
            let text = error.to_string();
            assert!(text.contains(foreign) && text.contains("--out"));
            fs::remove_file(&path).unwrap();
        }
        prepare_run(&folder, &names, &[]).unwrap();
        fs::write(folder.join("report.html"), "mine").unwrap();
        assert!(write_run(&folder, &files(&["report.html"])).is_err());
        let kept = fs::read_to_string(folder.join("report.html")).unwrap();
        assert_eq!(kept, "mine");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn an_edited_result_is_nobodys_to_replace() {
        let folder = fresh("edited");
        write_run(&folder, &files(&["corrected/event.toml"])).unwrap();
        prepare_run(&folder, &["a.json"], &[]).unwrap();
        let event = folder.join("corrected/event.toml");
        // By itself, and by an event elsewhere that names it.
        let other = fresh("reads");
        fs::create_dir_all(&other).unwrap();
        let text = format!("[track]\nfile = {:?}\n", event.display());
        fs::write(other.join("event.toml"), text).unwrap();
        for reads in [event.clone(), other.clone()] {
            let read = prepare_run(&folder, &["a.json"], &[reads]);
            let said = read.unwrap_err().to_string();
            assert!(said.contains("give another --out"), "{said}");
        }
        fs::remove_dir_all(&other).unwrap();
        fs::write(&event, "edited").unwrap();
        assert!(prepare_run(&folder, &["a.json"], &[]).is_err());
        assert!(write_run(&folder, &files(&["a.json"])).is_err());
        assert_eq!(fs::read_to_string(&event).unwrap(), "edited");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_list_never_leads_out_of_its_folder() {
        let folder = fresh("list");
        fs::create_dir_all(folder.join("out")).unwrap();
        fs::write(folder.join("kept"), "x").unwrap();
        let (out, sum) = (folder.join("out"), sha256(b"x"));
        let absolute = folder.join("kept").display().to_string();
        for name in ["../kept", &absolute, ""] {
            let list = format!("{HEAD}\n{sum}  {name}\n");
            fs::write(out.join(LIST), list).unwrap();
            assert!(write_run(&out, &files(&["a"])).is_err());
        }
        for foreign in ["", "no list\n"] {
            fs::write(out.join(LIST), foreign).unwrap();
            assert!(prepare_run(&out, &["a"], &[]).is_err());
        }
        assert!(folder.join("kept").exists() && !out.join("a").exists());
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_look_leaves_nothing() {
        let folder = fresh("look");
        prepare_run(&folder.join("deep/er"), &["a"], &[]).unwrap();
        assert!(!folder.exists());
    }
}
