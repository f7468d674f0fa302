//! `couloir new`: a commented event to start from.

use std::path::PathBuf;

use clap::Args;

use super::answer::quoted_word;
use crate::error::Result;
use crate::io::{new_event, place};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The folder to write to; made if it is not there
    folder: PathBuf,
}

impl Arguments {
    pub(super) fn run(&self) -> Result<String> {
        let mut text = String::new();
        for path in new_event(&self.folder)? {
            text.push_str(&format!("wrote {}\n", place(&path)));
        }
        text.push_str(&format!(
            "\nThe numbers are synthetic. Put your own in, then:\n\n    \
             couloir calibrate {}\n",
            quoted_word(&self.folder.to_string_lossy())
        ));
        Ok(text)
    }
}
