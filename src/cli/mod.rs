//! The command `couloir`: parse, call the library, print.
//!
//! Nothing below this folder prints. A user's own binary offers its own laws
//! through [`main_with`].

mod answer;
mod bench;
mod calibrate;
mod challenge;
mod compare;
mod diagnose;
mod new;
mod predictive;
mod progress;
mod reproduce;
mod simulate;
mod study;
mod thin;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};

use self::answer::Answer;
use self::thin::Thin;
use crate::error::{Error, Result};
use crate::infer::{Effort, backend};
use crate::physics::friction::Laws;

/// Calibrates avalanche friction laws from recordings, in a Bayesian way.
#[derive(Debug, Parser)]
#[command(name = "couloir", version, about, max_term_width = 80)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Calibrate a friction law from a recording
    Calibrate(calibrate::Arguments),
    /// Compare models by their evidence and by how well they predict
    Compare(compare::Arguments),
    /// Find where recording and model differ and what was left out
    Diagnose(diagnose::Arguments),
    /// Run the motion with given parameter values
    Simulate(simulate::Arguments),
    /// Write a commented event to start from
    New(new::Arguments),
    /// Run every backend on an event, side by side
    Bench(bench::Arguments),
    /// Diagnose events that hide one effect each, and score the answers
    Challenge(challenge::Arguments),
    /// Compute the study of Heredia et al. (2020) again
    Reproduce(reproduce::Arguments),
}

/// Which event, and what to change of its model.
#[derive(Debug, Clone, Args)]
struct Subject {
    /// Event folder, or its event.toml; a passenger car coasting uphill, a
    /// real recording, where none is given
    event: Option<PathBuf>,
    /// Friction law instead of the event's
    #[arg(long, value_name = "LAW")]
    friction: Option<String>,
    /// Noise instead of the event's: iid, ar(k), student, or one or a sum of
    /// white, ou, matern32, ar(k), tails, growth, such as "matern32 + white";
    /// or infer, for `calibrate` and `diagnose`: whichever is likely
    #[arg(long, value_name = "NOISE")]
    noise: Option<String>,
    /// How the command thins its recording.
    #[arg(skip)]
    thin: Thin,
}

/// How much work to do, and from which seed.
#[derive(Debug, Args)]
struct Work {
    /// Independent chains
    #[arg(long, default_value_t = 4, value_parser = at_least_one)]
    chains: usize,
    /// Draws kept of each chain
    #[arg(long, default_value_t = 10_000, value_parser = at_least_one)]
    draws: usize,
    /// Steps before those, for tuning
    #[arg(long, default_value_t = 5_000)]
    warmup: usize,
    /// Seed of every random draw
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Work {
    fn effort(&self) -> Result<Effort> {
        if self.chains.saturating_mul(self.draws) > MOST_DRAWS {
            return Err(Error::input(format!(
                "{} chains of {} draws are more than {MOST_DRAWS} in all, \
                 which memory is kept to; ask for fewer --draws",
                self.chains, self.draws
            )));
        }
        let (chains, draws, warmup) = (self.chains, self.draws, self.warmup);
        Ok(Effort { chains, draws, warmup })
    }
}

/// The most draws of all chains together: 32 MB for each parameter.
const MOST_DRAWS: usize = 4_000_000;

/// A folder that results can go to, looked at before the work and not after.
fn folder(text: &str) -> std::result::Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let there = path.ancestors().find(|path| path.exists());
    match there {
        Some(there) if !there.is_dir() => Err(format!(
            "{} is a file; expected a folder, or a name that is free: give \
             another, or move the file away",
            there.display()
        )),
        _ => Ok(path),
    }
}

/// Where results go.
#[derive(Debug, Args)]
struct Output {
    /// Folder to write the results to
    #[arg(long, value_name = "DIR", value_parser = folder)]
    out: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

/// The most of anything that is counted on the command line: beyond it a run
/// would not end, or not fit in memory.
const MOST: usize = 100_000_000;

fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n @ 1..=MOST) => Ok(n),
        _ => Err(format!("expected a whole number from 1 to {MOST}")),
    }
}

fn backend_name(text: &str) -> Result<String, String> {
    match backend(text, &Effort::default()) {
        Ok(_) => Ok(text.to_owned()),
        Err(error) => Err(error.to_string()),
    }
}

/// Runs the command with the built-in laws.
pub fn main() -> ExitCode {
    main_with(&Laws::default())
}

/// Runs the command with laws of one's own beside the built-in ones.
///
/// ```no_run
/// use couloir::physics::friction::Laws;
/// fn main() -> std::process::ExitCode {
///     couloir::cli::main_with(&Laws::default())
/// }
/// ```
pub fn main_with(laws: &Laws) -> ExitCode {
    let matches = with_laws(Cli::command(), laws).get_matches();
    let cli = match Cli::from_arg_matches(&matches) {
        Ok(cli) => cli,
        Err(error) => error.exit(),
    };
    match cli.command.run(laws) {
        Ok(answer) => end(&answer),
        Err(error) => {
            complain(&error.to_string());
            ExitCode::from(if error.is_input() { 2 } else { 1 })
        }
    }
}

impl Command {
    fn run(&self, laws: &Laws) -> Result<Answer> {
        match self {
            Self::Calibrate(arguments) => arguments.run(laws),
            Self::Compare(arguments) => arguments.run(laws).map(Answer::from),
            Self::Diagnose(arguments) => arguments.run(laws),
            Self::Challenge(arguments) => arguments.run().map(Answer::from),
            Self::Simulate(arguments) => arguments.run(laws).map(Answer::from),
            Self::New(arguments) => arguments.run().map(Answer::from),
            Self::Bench(arguments) => arguments.run(laws).map(Answer::from),
            Self::Reproduce(arguments) => arguments.run().map(Answer::from),
        }
    }
}

/// The exit code of a result that should not be used.
const NOT_TO_BE_USED: u8 = 4;

/// Prints an answer; the exit code says whether it may be used.
fn end(answer: &Answer) -> ExitCode {
    let printed = print(&answer.text);
    let Some(why) = &answer.refused else { return printed };
    complain(&format!("--strict: not to be used: {why}"));
    ExitCode::from(NOT_TO_BE_USED)
}

/// Lists the laws in the help of every `--friction`, a user's own included.
fn with_laws(command: clap::Command, laws: &Laws) -> clap::Command {
    let names: Vec<&str> = laws.iter().map(|law| law.name()).collect();
    let help = format!(
        "Friction law instead of the event's: none, or one or a sum of {}, \
         such as \"coulomb + turbulent\"",
        names.join(", ")
    );
    command.mut_subcommands(|subcommand| {
        let takes_one =
            subcommand.get_arguments().any(|a| a.get_id() == "friction");
        if !takes_one {
            return subcommand;
        }
        subcommand.mut_arg("friction", |a| a.help(&help))
    })
}

/// Prints a result. A reader that has gone away (`| head`) is no error.
#[allow(clippy::print_stdout)]
fn print(text: &str) -> ExitCode {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => {
            ExitCode::SUCCESS
        }
        Err(_) => ExitCode::FAILURE,
    }
}

#[allow(clippy::print_stderr)]
fn complain(message: &str) {
    eprintln!("couloir: {message}");
}

/// Where the results are, at the end of what is printed: nothing where no
/// folder was asked for.
fn written(folder: Option<&Path>, files: &[&str]) -> String {
    let Some(folder) = folder else { return String::new() };
    let (head, files) =
        (format!("Written to {}:", folder.display()), files.join(", "));
    let both = head.chars().count() + 1 + files.chars().count();
    let between = if both > width() { "\n  " } else { " " };
    format!("\n{head}{between}{files}\n")
}

/// The width to print to: that of the terminal, 80 at the most.
fn width() -> usize {
    let columns = console_columns().unwrap_or(80);
    columns.clamp(44, 80)
}

fn console_columns() -> Option<usize> {
    std::env::var("COLUMNS").ok()?.parse().ok()
}

/// Progress as a plain line.
#[allow(clippy::print_stderr)]
fn complain_plainly(what: &str) {
    eprintln!("couloir: {what} ...");
}
