//! The command `couloir`: parse, call the library, print.
//!
//! Nothing below this folder prints. A user's own binary offers its own laws
//! through [`main_with`].

mod answer;
mod bench;
mod calibrate;
mod challenge;
mod compare;
mod completions;
mod diagnose;
mod engine;
mod examples;
mod figures;
mod format;
#[cfg(feature = "import")]
mod import;
mod made;
mod man;
mod new;
mod pace;
mod population;
mod predictive;
mod progress;
mod refused;
mod reproduce;
mod results;
mod resumed;
mod said;
mod screen;
mod simulate;
mod study;
mod sweep;
mod thin;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};

use self::answer::{Answer, typed};
use self::progress::Told;
use self::screen::{complain, print, width};
use self::thin::Thin;
use crate::error::{Error, Result};
use crate::infer::{BACKENDS, Backend, Bridge, Effort, Gives, Smc, backend};
use crate::physics::friction::Laws;

pub use self::made::{Files, Made, made};

/// Calibrates avalanche friction laws from recordings, in a Bayesian way.
#[derive(Debug, Parser)]
#[command(
    name = "couloir",
    version = env!("COULOIR_VERSION"),
    about,
    max_term_width = 80,
    after_help = examples::ALL
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Show no progress; errors and warnings are still shown
    #[arg(long, short, global = true, display_order = 900)]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Calibrate a friction law from a recording
    #[command(after_help = examples::CALIBRATE)]
    Calibrate(calibrate::Arguments),
    /// Compare models by their evidence and by how well they predict
    #[command(after_help = examples::COMPARE)]
    Compare(compare::Arguments),
    /// Find where recording and model differ and what was left out
    #[command(after_help = examples::DIAGNOSE)]
    Diagnose(diagnose::Arguments),
    /// Run the motion with given parameter values
    #[command(after_help = examples::SIMULATE)]
    Simulate(simulate::Arguments),
    /// Write a commented event to start from
    #[command(after_help = examples::NEW)]
    New(new::Arguments),
    /// Make an event of a GNSS log or a front, a terrain model and a path
    #[cfg(feature = "import")]
    #[command(after_help = examples::IMPORT)]
    Import(import::Arguments),
    /// Run every backend on an event, side by side
    #[command(after_help = examples::BENCH)]
    Bench(bench::Arguments),
    /// Diagnose, calibrate or compare each of many events, and go on after a
    /// stop
    #[command(after_help = examples::SWEEP)]
    Sweep(sweep::Arguments),
    /// Infer what the events of a sweep have in common
    #[command(after_help = examples::POPULATION)]
    Population(population::Arguments),
    /// Diagnose events that hide one effect each, and score the answers
    #[command(after_help = examples::CHALLENGE)]
    Challenge(challenge::Arguments),
    /// Compute the study of Heredia et al. (2020) again
    #[command(after_help = examples::REPRODUCE)]
    Reproduce(reproduce::Arguments),
    /// Print what a shell completes this command with
    #[command(after_help = examples::COMPLETIONS)]
    Completions(completions::Arguments),
    /// Print or write the manual pages
    #[command(after_help = examples::MAN)]
    Man(man::Arguments),
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
#[derive(Debug, Clone, Args)]
struct Work {
    /// Independent chains
    #[arg(long, default_value_t = 4, value_parser = at_least_one)]
    chains: usize,
    /// Draws kept of each chain, 10000 where not given; smc and bridge keep
    /// as many particles as all chains together draws, 500 for each where not
    /// given; importance and laplace-mixture weigh half as many
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    draws: Option<usize>,
    /// Steps before those, for tuning
    #[arg(long, default_value_t = 5_000, value_parser = whole)]
    warmup: usize,
    /// Seed of every random draw
    #[arg(long, default_value_t = 1, value_parser = seed)]
    seed: u64,
    /// Whether little has to do.
    #[arg(skip)]
    quick: bool,
}

/// How many draws of a chain, and steps before them, make a quick look.
const QUICK: [usize; 2] = [2_500, 1_000];

impl Work {
    /// The same, little where that has to do and nothing else was asked for.
    fn quickly(&self, quick: bool) -> Self {
        Self { quick, ..self.clone() }
    }

    fn effort(&self) -> Result<Effort> {
        let (chains, [few, little]) = (self.chains, QUICK);
        let (draws, warmup) = match self.quick {
            true => (few, self.warmup.min(little)),
            false => (Effort::new().draws, self.warmup),
        };
        let draws = self.draws.unwrap_or(draws);
        if chains.saturating_mul(draws) > MOST_DRAWS {
            return Err(Error::input(format!(
                "{chains} chains of {draws} draws are more than {MOST_DRAWS} \
                 in all, which memory is kept to; ask for fewer --draws"
            )));
        }
        Ok(Effort { chains, draws, warmup })
    }

    /// The backend of that name. What `--draws` asks for is what it keeps,
    /// of particles as of chains.
    fn backend(&self, name: &str) -> Result<Box<dyn Backend>> {
        let effort = self.effort()?;
        let asked = self.draws.map(|draws| self.chains * draws);
        let of = |particles| Smc { particles, ..Smc::default() };
        Ok(match (name, asked) {
            ("smc", Some(particles)) => Box::new(of(particles)),
            ("bridge", Some(particles)) => {
                let Bridge { draws, .. } = Bridge::of_effort(&effort);
                Box::new(Bridge { sampler: of(particles), draws })
            }
            _ => backend(name, &effort)?,
        })
    }
}

/// The most draws of all chains together: 32 MB for each parameter.
const MOST_DRAWS: usize = 4_000_000;

/// The most of anything that is counted on the command line: beyond it a run
/// would not end, or not fit in memory.
const MOST: usize = 100_000_000;

fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n @ 1..=MOST) => Ok(n),
        _ => Err(format!("expected a whole number from 1 to {MOST}")),
    }
}

fn whole(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n @ 0..=MOST) => Ok(n),
        _ => Err(format!("expected a whole number from 0 to {MOST}")),
    }
}

fn seed(text: &str) -> Result<u64, String> {
    let expected =
        |_| format!("expected a whole number from 0 to {}", u64::MAX);
    text.parse().map_err(expected)
}

/// The name of a backend that gives what it is wanted for; `lacks` says what
/// others do not give.
fn backend_giving(
    name: &str,
    lacks: &str,
    enough: fn(Gives) -> bool,
) -> Result<String, String> {
    let able = BACKENDS.iter().filter(|entry| enough(entry.gives));
    let able: Vec<_> = able.map(|entry| entry.name).collect();
    if able.contains(&name) {
        return Ok(name.to_owned());
    }
    let able = able.join(", ");
    match BACKENDS.iter().any(|entry| entry.name == name) {
        true => Err(format!("it {lacks}; use {able}")),
        // Whether it was left out when the command was built is told there.
        false if name == "nuts" => {
            let built = backend(name, &Effort::default());
            built.map(|_| name.to_owned()).map_err(|e| e.to_string())
        }
        false => Err(format!("it is not known; expected one of {able}")),
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
    let words: Vec<_> = std::env::args_os().skip(1).collect();
    ExitCode::from(run(laws, &words))
}

/// Runs the command with these words behind its name, and returns its exit
/// code: for a program that carries the command.
///
/// ```no_run
/// use couloir::physics::friction::Laws;
/// let words = ["diagnose".into(), "--quick".into()];
/// let code = couloir::cli::run(&Laws::default(), &words);
/// assert_eq!(code, 0);
/// ```
pub fn run(laws: &Laws, words: &[OsString]) -> u8 {
    let cli = match parsed(laws, words) {
        Ok(cli) => cli,
        Err(error) => {
            // Help for want of a command is an error of its own kind.
            let helps = ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
            if error.use_stderr() && error.kind() != helps {
                return refuse(&refused::refused(&error));
            }
            // Where the terminal is gone, nobody is left to be told.
            let _ = error.print();
            return if error.use_stderr() { 2 } else { 0 };
        }
    };
    let told = Told::new(cli.quiet);
    match cli.command.run(laws, &told, &typed(words)) {
        Ok(answer) => end(&answer),
        Err(error) => refuse(&error),
    }
}

/// What the words ask for.
fn parsed(
    laws: &Laws,
    words: &[OsString],
) -> std::result::Result<Cli, clap::Error> {
    let name = OsString::from("couloir");
    let words = std::iter::once(&name).chain(words);
    let matches = command_of(laws).try_get_matches_from(words)?;
    Cli::from_arg_matches(&matches)
}

/// The same, where the last of an option that is given twice holds.
fn parsed_last(
    laws: &Laws,
    words: &[OsString],
) -> std::result::Result<Cli, clap::Error> {
    let name = OsString::from("couloir");
    let words = std::iter::once(&name).chain(words);
    let command = command_of(laws)
        .mut_subcommands(|subcommand| subcommand.args_override_self(true));
    let matches = command.try_get_matches_from(words)?;
    Cli::from_arg_matches(&matches)
}

/// Tells an error, with the manual's page that helps; the exit code says
/// whether the input is to be mended.
fn refuse(error: &Error) -> u8 {
    let page = error.page().map(|page| format!(" (manual: {page}.md)"));
    complain(&format!("{error}{}", page.unwrap_or_default()));
    if error.is_input() { 2 } else { 1 }
}

impl Command {
    fn run(&self, laws: &Laws, told: &Told, typed: &str) -> Result<Answer> {
        match self {
            Self::Calibrate(arguments) => arguments.run(laws, told, typed),
            Self::Compare(arguments) => arguments.run(laws, told, typed),
            Self::Diagnose(arguments) => arguments.run(laws, told, typed),
            Self::Sweep(arguments) => arguments.run(laws, told),
            Self::Population(arguments) => arguments.run(told),
            Self::Challenge(arguments) => arguments.run(told, typed),
            Self::Simulate(arguments) => arguments.run(laws, typed),
            Self::New(arguments) => arguments.run().map(Answer::from),
            #[cfg(feature = "import")]
            Self::Import(arguments) => arguments.run(),
            Self::Bench(arguments) => arguments.run(laws, told, typed),
            Self::Reproduce(arguments) => arguments.run(told, typed),
            Self::Completions(arguments) => arguments.run(command_of(laws)),
            Self::Man(arguments) => arguments.run(command_of(laws)),
        }
    }
}

/// The exit code of a sweep in which events failed.
const EVENTS_FAILED: u8 = 3;

/// The exit code of a result that should not be used.
const NOT_TO_BE_USED: u8 = 4;

/// Prints an answer; the exit code says whether it is all there, and may be
/// used.
fn end(answer: &Answer) -> u8 {
    let printed = print(&answer.text);
    if let Some(why) = &answer.refused {
        complain(&format!("--strict: not to be used: {why}"));
    }
    let failed = [printed.as_ref().err(), answer.failed.as_ref()];
    let failed = failed.into_iter().flatten();
    let failed = failed.fold(None, |_, error| Some(refuse(error)));
    failed.unwrap_or(match answer.refused {
        Some(_) => NOT_TO_BE_USED,
        None if answer.incomplete => EVENTS_FAILED,
        None => 0,
    })
}

/// The command, with the laws in the help of every `--friction`, a user's own
/// included. A number below 0 is a value as any other, which what takes it
/// refuses in its own words, and no option.
fn command_of(laws: &Laws) -> clap::Command {
    let names: Vec<&str> = laws.iter().map(|law| law.name()).collect();
    let help = format!(
        "Friction law instead of the event's: none, or one or a sum of {}, \
         such as \"coulomb + turbulent\"",
        names.join(", ")
    );
    Cli::command().mut_subcommands(|subcommand| {
        let subcommand = subcommand.mut_args(|a| {
            let is_valued = a.get_action().takes_values();
            let is_option = a.get_long().is_some();
            a.allow_negative_numbers(is_valued && is_option)
        });
        let takes_one =
            subcommand.get_arguments().any(|a| a.get_id() == "friction");
        if !takes_one {
            return subcommand;
        }
        subcommand.mut_arg("friction", |a| a.help(&help))
    })
}
