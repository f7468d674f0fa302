//! `couloir man`: the manual pages of the command and of what it does.

use std::path::PathBuf;

use clap::Args;
use clap_mangen::Man;

use super::answer::Answer;
use super::results::folder;
use crate::error::{Error, Result};
use crate::io::{place, write_all};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder to write all pages to, such as ~/.local/share/man/man1; the
    /// first page is printed where none is given
    #[arg(long, value_name = "DIR", value_parser = folder)]
    out: Option<PathBuf>,
}

impl Arguments {
    pub(super) fn run(&self, mut command: clap::Command) -> Result<Answer> {
        command.build();
        let Some(folder) = &self.out else {
            return page(&command).map(|(_, text)| Answer::from(text));
        };
        let described = command.get_subcommands().filter(|c| !is_help(c));
        let all = [&command].into_iter().chain(described);
        let pages = all.map(page).collect::<Result<Vec<_>>>()?;
        write_all(folder, &pages).map_err(|error| error.within("--out"))?;
        let names: Vec<&str> =
            pages.iter().map(|(name, _)| name.as_str()).collect();
        let (names, folder) = (names.join(", "), place(folder));
        Ok(format!("Written to {folder}: {names}\n").into())
    }
}

fn is_help(command: &clap::Command) -> bool {
    command.get_name() == "help"
}

/// The name of a page and its text, as troff.
fn page(command: &clap::Command) -> Result<(String, String)> {
    let told = |error: &dyn std::fmt::Display| {
        Error::system(format!("a manual page could not be made: {error}"))
    };
    let man = Man::new(command.clone());
    let mut text = Vec::new();
    man.render(&mut text).map_err(|error| told(&error))?;
    let text = String::from_utf8(text).map_err(|error| told(&error))?;
    Ok((man.get_filename(), text))
}
