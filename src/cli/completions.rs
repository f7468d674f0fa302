//! `couloir completions`: what a shell completes the command with.

use clap::Args;
use clap_complete::{Shell, generate};

use super::answer::Answer;
use crate::error::{Error, Result};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The shell; its own manual says where the script goes
    shell: Shell,
}

impl Arguments {
    /// The script for a command.
    pub(super) fn run(&self, mut command: clap::Command) -> Result<Answer> {
        let (mut script, name) = (Vec::new(), command.get_name().to_owned());
        generate(self.shell, &mut command, name, &mut script);
        String::from_utf8(script).map(Answer::from).map_err(|error| {
            Error::system(format!("the script is no text: {error}"))
        })
    }
}
