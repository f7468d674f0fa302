//! Writing a folder of files so that none is ever half written.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::words::place;
use crate::error::{Error, Result};

/// A file under its temporary name, removed unless it gets its own.
#[derive(Debug)]
pub(super) struct Draft {
    temporary: PathBuf,
    target: PathBuf,
}

impl Drop for Draft {
    fn drop(&mut self) {
        // After the renaming there is nothing to remove, and before it
        // another error is under way already.
        let _ = fs::remove_file(&self.temporary);
    }
}

/// Writes what is in a file.
pub(crate) type Content<'a> =
    dyn Fn(&mut (dyn Write + Send)) -> io::Result<()> + 'a;

/// Writes files, by name, into a folder. It is created where it is not there,
/// as are the folders that names have before them. Each is written under
/// another name first and renamed once all are complete; files of the same
/// names are replaced, others stay.
///
/// # Errors
/// A system error that names the file and the machine's reason. Files whose
/// turn to be renamed had not come are then left as they were.
pub fn write_all<N: AsRef<Path>, B: AsRef<[u8]>>(
    folder: &Path,
    files: &[(N, B)],
) -> Result<()> {
    let draft = |(name, bytes): &(N, B)| {
        draft(folder.join(name), &|file| file.write_all(bytes.as_ref()))
    };
    put_in_place(&files.iter().map(draft).collect::<Result<Vec<_>>>()?)
}

/// A file under its temporary name, complete, and the SHA-256 of it.
#[cfg(feature = "cli")]
pub(super) fn summed_draft(
    target: PathBuf,
    content: &Content<'_>,
) -> Result<(Draft, String)> {
    let draft = draft(target, content)?;
    let sum = File::open(&draft.temporary).and_then(super::inputs::sha256_of);
    match sum {
        Ok(sum) => Ok((draft, sum)),
        Err(error) => {
            Err(failed(&draft.target, "the file could not be read", &error))
        }
    }
}

/// Gives them their own names.
pub(super) fn put_in_place(drafts: &[Draft]) -> Result<()> {
    for Draft { temporary, target } in drafts {
        fs::rename(temporary, target).map_err(|error| {
            failed(target, "the file could not be put in place", &error)
        })?;
    }
    Ok(())
}

/// Finds out whether a folder can be made and written, by doing so; nothing of
/// it stays.
#[cfg(feature = "cli")]
pub(super) fn try_folder(folder: &Path) -> Result<()> {
    let new: Vec<&Path> =
        folder.ancestors().take_while(|path| !path.exists()).collect();
    let tried = draft(folder.join("couloir"), &|_| Ok(())).map(drop);
    for made in new {
        // What could not be made is not there to be removed.
        let _ = fs::remove_dir(made);
    }
    tried.map_err(|error| {
        Error::system(format!(
            "{error}; results could not be written there: give another \
             folder, or change its permissions"
        ))
    })
}

fn draft(target: PathBuf, content: &Content<'_>) -> Result<Draft> {
    let folder = target.parent().unwrap_or(Path::new(""));
    fs::create_dir_all(folder).map_err(|error| {
        failed(folder, "the folder could not be created", &error)
    })?;
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let hidden = format!(".{name}.{}.tmp", std::process::id());
    let draft = Draft { temporary: folder.join(hidden), target };
    // What an earlier process of this number left, or a link that somebody
    // put there, is not written through.
    let _ = fs::remove_file(&draft.temporary);
    let written = File::create_new(&draft.temporary).and_then(|file| {
        let mut file = BufWriter::new(file);
        content(&mut file)?;
        file.into_inner()?.sync_all()
    });
    match written {
        Ok(()) => Ok(draft),
        Err(error) => {
            Err(failed(&draft.target, "the file could not be written", &error))
        }
    }
}

fn failed(path: &Path, what: &str, error: &std::io::Error) -> Error {
    Error::system(format!("{}: {what}: {error}", place(path)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn fresh(name: &str) -> PathBuf {
        let id = std::process::id();
        let folder =
            std::env::temp_dir().join(format!("couloir-write-{name}-{id}"));
        let _ = fs::remove_dir_all(&folder);
        folder
    }

    #[test]
    fn files_are_written_and_others_stay() {
        let folder = fresh("stay").join("deep/er");
        write_all(&folder, &[("a", "1"), ("b", "2")]).unwrap();
        write_all(&folder, &[("a", "3")]).unwrap();
        assert_eq!(names(&folder), ["a", "b"]);
        assert_eq!(fs::read_to_string(folder.join("a")).unwrap(), "3");
        write_all(&folder, &[("again/c", "4")]).unwrap();
        assert_eq!(names(&folder), ["a", "again", "b"]);
        assert_eq!(fs::read_to_string(folder.join("again/c")).unwrap(), "4");
        fs::remove_dir_all(fresh("stay")).unwrap_or_default();
    }

    #[test]
    fn an_error_leaves_no_temporaries() {
        let folder = fresh("error");
        fs::create_dir_all(folder.join("b")).unwrap();
        let files = [("b", "2"), ("a", "1")];
        let error = write_all(&folder, &files).unwrap_err();
        assert!(!error.is_input() && !error.is_inference());
        assert!(error.to_string().contains("b: the file could not be put"));
        assert_eq!(names(&folder), ["b"]);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_file_in_the_way_is_an_error() {
        let folder = fresh("way");
        fs::write(&folder, "x").unwrap();
        assert!(write_all(&folder, &[("a", "1")]).is_err());
        assert_eq!(fs::read_to_string(&folder).unwrap(), "x");
        fs::remove_file(&folder).unwrap();
    }
}
