//! Words that the command does not take, told as every other error is.

use clap::CommandFactory as _;
use clap::error::ErrorKind;

use crate::error::Error;

/// What was wrong with the words, on one line and without advice for a
/// terminal.
pub(super) fn refused(error: &clap::Error) -> Error {
    if error.kind() == ErrorKind::DisplayHelp {
        return Error::input("--help is for the command; expected a command");
    }
    let text = error.to_string();
    let parts = text.split("\n\n").filter(|part| {
        !part.starts_with("Usage:") && !part.starts_with("For more")
    });
    // How a terminal would pass a word on is no advice here.
    let said = parts.map(str::trim).filter(|p| !p.starts_with("tip: to pass"));
    let one_line =
        |part: &str| part.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    let said: Vec<String> = said.map(one_line).collect();
    let mut said = said.join("; ");
    if error.kind() == ErrorKind::InvalidSubcommand {
        let all = super::Cli::command();
        let names: Vec<&str> =
            all.get_subcommands().map(|verb| verb.get_name()).collect();
        said += &format!("; expected one of {}", names.join(", "));
    }
    Error::input(said.strip_prefix("error: ").unwrap_or(&said))
}
