//! Where the results of a run go: looked at before the work, written after it.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::error::Result;
use crate::io::{Content, place, prepare_run, write_run, write_run_of};

/// A folder that results can go to, looked at before the work and not after.
pub(super) fn folder(text: &str) -> std::result::Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let there = path.ancestors().find(|path| path.exists());
    match there {
        Some(there) if !there.is_dir() => Err(format!(
            "{} is a file; expected a folder, or a name that is free: give \
             another, or move the file away",
            place(there)
        )),
        _ => Ok(path),
    }
}

/// Where results go.
#[derive(Debug, Args)]
pub(super) struct Output {
    /// Folder to write the results to
    #[arg(long, value_name = "DIR", value_parser = folder)]
    pub(super) out: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(super) json: bool,
}

impl Output {
    /// The folder of the results, looked at before the work.
    pub(super) fn ready(
        &self,
        names: &[&str],
        events: &[PathBuf],
    ) -> Result<Results<'_>> {
        Results::ready(self.out.as_deref(), names, events)
    }
}

/// The folder of `--out`, where there is one.
#[derive(Debug)]
pub(super) struct Results<'a> {
    folder: Option<&'a Path>,
}

impl<'a> Results<'a> {
    /// Refuses, before the work, a folder that results could not go to.
    /// `names` are those of the results, with `/` behind the name of a
    /// folder; `events` are what the run reads.
    pub(super) fn ready(
        folder: Option<&'a Path>,
        names: &[&str],
        events: &[PathBuf],
    ) -> Result<Self> {
        if let Some(folder) = folder {
            prepare_run(folder, names, events)
                .map_err(|error| error.within("--out"))?;
        }
        Ok(Self { folder })
    }

    /// Writes the files, where there is a folder for them. An error is to be
    /// told behind the answer, which would be lost otherwise.
    pub(super) fn write<N: AsRef<Path>, B: AsRef<[u8]>>(
        &self,
        files: impl FnOnce() -> Result<Vec<(N, B)>>,
    ) -> Result<()> {
        match self.folder {
            None => Ok(()),
            Some(folder) => files()
                .and_then(|files| write_run(folder, &files))
                .map_err(|error| error.within("--out")),
        }
    }

    /// The same of files that are written as they are made.
    pub(super) fn write_made(
        &self,
        files: &[(&Path, &Content<'_>)],
    ) -> Result<()> {
        let Some(folder) = self.folder else { return Ok(()) };
        write_run_of(folder, files).map_err(|error| error.within("--out"))
    }

    /// Where the results are, at the end of what is printed: nothing where no
    /// folder was asked for, or they could not be written.
    pub(super) fn told(
        &self,
        wrote: &Result<()>,
        files: &[&str],
        width: usize,
    ) -> String {
        let Some(folder) = self.folder.filter(|_| wrote.is_ok()) else {
            return String::new();
        };
        let (head, files) =
            (format!("Written to {}:", place(folder)), files.join(", "));
        let both = head.chars().count() + 1 + files.chars().count();
        let between = if both > width { "\n  " } else { " " };
        format!("\n{head}{between}{files}\n")
    }
}
