//! Schedulers that a sweep can be handed to: an array of jobs, of which each
//! does a shard.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

use clap::ValueEnum;

use super::answer::{quoted_word, wrapped};
use super::width;
use crate::error::{Error, Result};
use crate::io::{place, write_all};

/// A scheduler.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Engine {
    /// Slurm, by `sbatch`
    Slurm,
    /// HyperQueue, by `hq submit`
    Hq,
}

/// Where the script is within a sweep's folder. Schedulers write what jobs
/// print beside it.
const SCRIPT: &str = "engine/sweep.sh";

impl Engine {
    /// Writes the script and submits it; what there is to tell.
    pub(super) fn submit(
        self,
        out: &Path,
        words: &[Vec<OsString>; 2],
        shards: usize,
    ) -> Result<String> {
        let program = std::env::current_exe()
            .map_err(|error| Error::system(error.to_string()))?;
        let text = script(self, program.as_os_str(), words, shards);
        write_all(out, &[(SCRIPT, text)])?;
        let path = out.join(SCRIPT);
        let folder = out.join("engine");
        let mut command = self.command(shards);
        let told = run(command.current_dir(&folder), &path)?;
        let text = format!(
            "Submitted {shards} shards by {}: {}. When they have ended, run \
             the same without --engine for the summary.",
            place(&path),
            told.trim()
        );
        Ok(wrapped(&text, width()))
    }

    fn command(self, shards: usize) -> Command {
        let array = format!("--array=1-{shards}");
        let (program, words) = match self {
            Self::Slurm => ("sbatch", [&*array, "sweep.sh"].to_vec()),
            Self::Hq => ("hq", ["submit", &array, "sh", "sweep.sh"].to_vec()),
        };
        let mut command = Command::new(program);
        command.args(words);
        command
    }

    /// Where a job reads its number.
    fn number(self) -> &'static str {
        match self {
            Self::Slurm => "$SLURM_ARRAY_TASK_ID",
            Self::Hq => "$HQ_TASK_ID",
        }
    }
}

/// What a job of the array does.
fn script(
    engine: Engine,
    program: &std::ffi::OsStr,
    [before, behind]: &[Vec<OsString>; 2],
    shards: usize,
) -> String {
    let quoted = |words: &[OsString]| {
        let words = words.iter().map(|w| quoted_word(&w.to_string_lossy()));
        words.collect::<Vec<_>>().join(" ")
    };
    let number = engine.number();
    // 3 says that events failed, which the summary tells: no failed job.
    format!(
        "#!/bin/sh\n{} {} --shard \"{number}/{shards}\" {}\n\
         code=$?\n[ $code -eq 3 ] && code=0\nexit $code\n",
        quoted_word(&program.to_string_lossy()),
        quoted(before),
        quoted(behind)
    )
}

/// Runs a scheduler's command; what it says.
fn run(command: &mut Command, script: &Path) -> Result<String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let words: Vec<_> =
        command.get_args().map(|w| w.to_string_lossy()).collect();
    let by_hand = format!("{name} {}", words.join(" "));
    let failed = |why: &str| {
        Error::system(format!(
            "{name}: {why}; {} is written: run `{by_hand}` in its folder \
             where {name} is, or leave --engine away",
            place(script)
        ))
    };
    let output =
        command.output().map_err(|error| failed(&error.to_string()))?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        false => Err(failed(String::from_utf8_lossy(&output.stderr).trim())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_runs_what_it_says() {
        let words = [vec!["sweep".into()], vec!["it's; \"$HOME\"".into()]];
        let text = script(Engine::Slurm, "echo".as_ref(), &words, 7);
        let output = Command::new("sh")
            .args(["-c", &text])
            .env("SLURM_ARRAY_TASK_ID", "3")
            .output()
            .unwrap();
        let printed = String::from_utf8(output.stdout).unwrap();
        assert_eq!(printed, "sweep --shard 3/7 it's; \"$HOME\"\n");
    }

    #[test]
    fn events_that_failed_are_no_failed_job() {
        for (code, ends) in [("3", 0), ("2", 2), ("0", 0)] {
            let words =
                [vec!["-c".into(), format!("exit {code}").into()], Vec::new()];
            let text = script(Engine::Hq, "sh".as_ref(), &words, 1);
            let status = Command::new("sh").args(["-c", &text]).status();
            assert_eq!(status.unwrap().code(), Some(ends));
        }
    }
}
