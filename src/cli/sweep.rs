//! `couloir sweep`: one command for many events, each of them once.

use std::collections::{BTreeMap, HashSet};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::error::ErrorKind;
use clap::{Args, ValueEnum};
use serde_json::Value;

use super::answer::{Answer, wrapped};
use super::at_least_one;
use super::engine::Engine;
use super::made::{document, event, refusal};
use super::pace::duration;
use super::progress::Told;
use super::results::{Results, folder};
use crate::error::{Error, Result};
use crate::infer::Progress as _;
use crate::io::place;
use crate::parallel;
use crate::physics::friction::Laws;
#[cfg(feature = "export")]
use crate::sweep::write_parquet;
use crate::sweep::{
    Index, Listed, Outcome, Plan, Ran, Row, Rows, Shard, Summary, Task, cores,
    listed, page, run, summed, without_path, write_csv, write_json,
};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The events: a folder that holds event folders, a pattern in quotes
    /// such as "survey/*", or a CSV file with a column event, whose other
    /// columns are options of that name for each
    list: PathBuf,
    /// Folder of the results; the same again goes on where a run was stopped
    #[arg(long, value_name = "DIR", value_parser = folder)]
    out: PathBuf,
    /// What to do with each event
    #[arg(long, value_enum, default_value = "diagnose")]
    verb: Verb,
    /// How many events at a time; as many as there are processors where not
    /// given
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    jobs: Option<usize>,
    /// Try again what failed
    #[arg(long)]
    retry: bool,
    /// Do part I of N of the list alone, for a scheduler's array of jobs; run
    /// once more without it for the summary
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Hand the list to a scheduler instead, in shards: writes the script of
    /// an array of jobs to DIR/engine/sweep.sh, and submits it
    #[arg(long, value_enum, conflicts_with_all = ["shard", "json"])]
    engine: Option<Engine>,
    /// How many shards the scheduler gets; where not given as many as there
    /// can be of 100 events or more
    #[arg(long, value_name = "N", requires = "engine",
          value_parser = at_least_one)]
    shards: Option<usize>,
    /// Print sweep.json instead of the table
    #[arg(long)]
    json: bool,
    /// Options of the command that is run for each event, such as --quick
    #[arg(last = true, value_name = "OPTIONS")]
    options: Vec<OsString>,
}

/// A command that is run for each event.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Verb {
    Diagnose,
    Calibrate,
    Compare,
}

impl Verb {
    fn name(self) -> &'static str {
        match self {
            Self::Diagnose => "diagnose",
            Self::Calibrate => "calibrate",
            Self::Compare => "compare",
        }
    }
}

/// Options that say where results go, which a sweep says itself.
const REFUSED: [&str; 5] =
    ["--out", "--json", "--strict", "--format", "--figures"];

/// How many events a shard has at the least, where nobody says: a task of a
/// scheduler costs about as much as part of an event, and is to be spent on
/// many.
const SHARD: usize = 100;

/// What the summary writes.
const FILES: &[&str] = &[
    "sweep.html",
    "sweep.json",
    "sweep.csv",
    #[cfg(feature = "export")]
    "sweep.parquet",
];

/// Members of a result that are of its run, or as long as all others: they
/// are had again by the command itself.
const DROPPED: [&str; 10] = [
    "command",
    "corrected",
    "forces",
    "inputs",
    "program",
    "rest",
    "seconds",
    "separating",
    "words",
    "backend_why",
];

/// What is kept of each mechanism.
const KEPT: [&str; 4] = ["name", "kind", "log10_bayes_factor", "probability"];

/// How often a run without a bar says how far it is.
const EVERY: Duration = Duration::from_secs(30);

/// The tasks of a list, and why an event of it has none, by its place.
struct Planned {
    list: Vec<Listed>,
    shard: Shard,
    tasks: Vec<Task>,
    unread: BTreeMap<usize, String>,
}

/// What would be refused of some options, and of what kind that is.
type Refusing<'a> = dyn Fn(&[OsString]) -> Option<(ErrorKind, Error)> + 'a;

impl Arguments {
    pub(super) fn run(&self, laws: &Laws, told: &Told) -> Result<Answer> {
        self.refuse_options()?;
        let list = listed(&self.list)?;
        let events: Vec<PathBuf> =
            list.iter().map(|one| one.event.clone()).collect();
        let results = Results::ready(Some(&self.out), FILES, &events)?;
        self.refuse_for_all(laws, &list)?;
        if let Some(engine) = self.engine {
            let most = (list.len() / SHARD).max(1);
            let shards = self.shards.unwrap_or(most);
            let words = self.words_of_a_shard()?;
            return engine.submit(&self.out, &words, shards).map(Answer::from);
        }
        let planned = self.planned(list);
        let ran = self.ran(&planned, laws, told)?;
        if self.shard.is_some() {
            return Ok(of_shard(&ran, &planned));
        }
        self.concluded(&planned, &results)
    }

    /// Does what is not done yet.
    fn ran(&self, planned: &Planned, laws: &Laws, told: &Told) -> Result<Ran> {
        let plan = Plan {
            folder: &self.out,
            jobs: self.jobs.map_or_else(cores, Ok)?,
            retry: self.retry,
            shard: planned.shard,
            list: &planned.list,
        };
        let verb = self.verb.name();
        let work = |task: &Task| {
            let words = task.words(verb, &self.options, &planned.list);
            let event = &planned.list[task.at].event;
            match document(laws, &words) {
                Ok(result) => Ok(shortened(result)),
                Err(error) => {
                    Err(Error::input(without_path(&error.to_string(), event)))
                }
            }
        };
        let begun = Instant::now();
        let mut teller = Teller { told, begun, said: begun, advanced: None };
        let ran =
            run(&planned.tasks, &plan, &work, &mut |ran| teller.hear(ran))?;
        told.finish();
        Ok(ran)
    }

    /// What came of all events, of the journals.
    fn concluded(
        &self,
        planned: &Planned,
        results: &Results<'_>,
    ) -> Result<Answer> {
        let index = Index::of(&self.out)?;
        let rows = |each: &mut dyn FnMut(&Row) -> std::io::Result<()>| {
            planned.rows(&index, each)
        };
        let summary = summed(self.verb.name(), &rows)?;
        let html = page(&summary, &rows)?;
        let wrote = results.write_made(&[
            (Path::new("sweep.html"), &|f| f.write_all(html.as_bytes())),
            (Path::new("sweep.json"), &|f| write_json(&summary, &rows, f)),
            (Path::new("sweep.csv"), &|f| write_csv(&summary, &rows, f)),
            #[cfg(feature = "export")]
            (Path::new("sweep.parquet"), &|f| {
                write_parquet(&summary, &rows, f)
            }),
        ]);
        let text = match self.json {
            true => json_of(&summary, &rows)?,
            false => {
                let width = super::width();
                let failures = summary.told_failures();
                let failures = failures.iter().map(|f| wrapped(f, width));
                let failures = failures.map(|f| format!("\n{f}"));
                summary.table()
                    + &failures.collect::<String>()
                    + &results.told(&wrote, FILES, width)
            }
        };
        Ok(with_failures(text, summary.failed()).after(wrote))
    }

    /// The words of a shard's command, but for which shard it is: those before
    /// it, and those behind.
    fn words_of_a_shard(&self) -> Result<[Vec<OsString>; 2]> {
        let absolute = |path: &Path| {
            std::path::absolute(path).map(PathBuf::into_os_string).map_err(
                |error| Error::system(format!("{}: {error}", place(path))),
            )
        };
        let verb = format!("--verb={}", self.verb.name()).into();
        let mut before = vec!["sweep".into(), "--quiet".into(), verb];
        before.extend(["--out".into(), absolute(&self.out)?]);
        if let Some(jobs) = self.jobs {
            before.push(format!("--jobs={jobs}").into());
        }
        before.extend(self.retry.then(|| "--retry".into()));
        let mut behind = vec![absolute(&self.list)?, "--".into()];
        behind.extend(self.options.iter().cloned());
        Ok([before, behind])
    }

    fn refuse_options(&self) -> Result<()> {
        for option in &self.options {
            let text = option.to_string_lossy();
            let name = text.split('=').next().unwrap_or_default();
            if REFUSED.contains(&name) {
                return Err(said_itself(Path::new("behind --"), name));
            }
            if !text.starts_with('-') && self.is_alone(option) {
                return Err(Error::input(format!(
                    "{text:?} behind --: expected options of {}, with = \
                     before a value, such as --friction=coulomb",
                    self.verb.name()
                )));
            }
        }
        Ok(())
    }

    /// Refuses what would fail for every event, or every one with a value in a
    /// column: options that the command does not take, or has to have.
    fn refuse_for_all(&self, laws: &Laws, list: &[Listed]) -> Result<()> {
        let verb = self.verb.name();
        let refused = |own: &[OsString]| {
            let words = [&[verb.into()], &*self.options, own].concat();
            refusal(laws, &words)
        };
        // What it has to have, a column may give.
        if let Some((kind, error)) = refused(&[])
            && kind != ErrorKind::MissingRequiredArgument
        {
            return Err(Error::input(format!(
                "behind --: {error}; expected options of {verb}, which \
                 couloir {verb} --help lists"
            )));
        }
        let words = [&[verb.into()], &*self.options].concat();
        if let Some(event) = event(laws, &words) {
            return Err(Error::input(format!(
                "behind --: {} is taken for an event; expected options of \
                 {verb} alone, with = before a value, such as \
                 --friction=coulomb",
                place(&event)
            )));
        }
        self.refuse_columns(list, &refused)
    }

    /// The same of the options that a list has in columns.
    fn refuse_columns(
        &self,
        list: &[Listed],
        refused: &Refusing<'_>,
    ) -> Result<()> {
        let verb = self.verb.name();
        let mut known = HashSet::new();
        for (at, listed) in list.iter().enumerate() {
            let mut new = at == 0;
            for option in &listed.options {
                let option = option.to_string_lossy();
                let name = option.split('=').next().unwrap_or_default();
                if REFUSED.contains(&name) {
                    return Err(said_itself(&self.list, name));
                }
                new |= known.insert(name.to_owned());
            }
            if !new {
                continue;
            }
            match refused(&listed.options) {
                Some((ErrorKind::MissingRequiredArgument, error)) => {
                    return Err(error.within(place(&self.list)));
                }
                Some((ErrorKind::UnknownArgument, error)) => {
                    return Err(Error::input(format!(
                        "{}:1: a column is no option of {verb} ({error}); \
                         expected those that couloir {verb} --help lists: \
                         rename it, or drop it",
                        place(&self.list)
                    )));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Whether a word has no option before it that it could be the value of.
    fn is_alone(&self, word: &OsString) -> bool {
        let before = self.options.iter().take_while(|other| *other != word);
        let before = before.last().map(|word| word.to_string_lossy());
        before.is_none_or(|text| !text.starts_with('-') || text.contains('='))
    }

    /// The tasks of the events of a shard.
    fn planned(&self, list: Vec<Listed>) -> Planned {
        let shard = self.shard.unwrap_or(Shard::ALL);
        let (mut tasks, mut unread) = (Vec::new(), BTreeMap::new());
        let own = (0..list.len()).filter(|at| shard.takes(*at));
        let own = parallel::map(own, |at| {
            (at, Task::new(self.verb.name(), &self.options, &list, at))
        });
        for (at, task) in own {
            match task {
                Ok(task) => tasks.push(task),
                Err(error) => {
                    let event = &list[at].event;
                    let why = without_path(&error.to_string(), event);
                    unread.insert(at, why);
                }
            }
        }
        Planned { list, shard, tasks, unread }
    }
}

impl Planned {
    /// Every event in turn with what came of it, of the journals.
    fn rows(
        &self,
        index: &Index,
        each: &mut dyn FnMut(&Row) -> std::io::Result<()>,
    ) -> Result<()> {
        let mut tasks = self.tasks.iter();
        for (at, listed) in self.list.iter().enumerate() {
            let task = match self.unread.contains_key(&at) {
                true => None,
                false => tasks.next().map(|task| task.key),
            };
            let outcome = match (self.unread.get(&at), &task) {
                (Some(why), _) => Some(Outcome::Failed(why.clone())),
                (None, Some(key)) => index.outcome(key)?,
                (None, None) => None,
            };
            each(&Row { event: listed.name(), task, outcome })
                .map_err(|error| Error::system(error.to_string()))?;
        }
        Ok(())
    }
}

/// `sweep.json` as a text.
fn json_of(summary: &Summary, rows: Rows<'_>) -> Result<String> {
    let mut bytes = Vec::new();
    write_json(summary, rows, &mut bytes)
        .map_err(|error| Error::system(error.to_string()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn of_shard(ran: &Ran, planned: &Planned) -> Answer {
    let failed = ran.failed + planned.unread.len();
    let text = format!(
        "Shard {}: {} events, {} done before, {} done now, {failed} failed\n",
        planned.shard,
        planned.tasks.len() + planned.unread.len(),
        ran.before,
        ran.done
    );
    with_failures(text, failed)
}

/// An answer whose exit code tells that events failed.
fn with_failures(text: String, failed: usize) -> Answer {
    let mut answer = Answer::from(text);
    answer.incomplete = failed > 0;
    answer
}

/// The refusal of an option that a sweep gives itself.
fn said_itself(at: &Path, name: &str) -> Error {
    Error::input(format!(
        "{}: {name}: a sweep says itself where results go; leave it away",
        place(at)
    ))
}

/// The part of a result that a sweep keeps.
fn shortened(mut result: Value) -> Value {
    if let Some(members) = result.as_object_mut() {
        members.retain(|name, _| !DROPPED.contains(&name.as_str()));
    }
    let mechanisms =
        result.get_mut("mechanisms").and_then(Value::as_array_mut);
    for mechanism in mechanisms.into_iter().flatten() {
        if let Some(members) = mechanism.as_object_mut() {
            members.retain(|name, _| KEPT.contains(&name.as_str()));
        }
    }
    let models = result.get_mut("models").and_then(Value::as_array_mut);
    for model in models.into_iter().flatten() {
        if let Some(members) = model.as_object_mut() {
            members.remove("priors");
        }
    }
    result
}

/// Tells how far a sweep is.
struct Teller<'t> {
    told: &'t Told,
    begun: Instant,
    said: Instant,
    /// How many of those to do are done; nothing was told yet where `None`.
    advanced: Option<usize>,
}

impl Teller<'_> {
    /// Those done before are told of, and are no part of the progress: the
    /// time that is left follows from those done now.
    fn begin(&self, ran: &Ran) {
        let mut what = "Events".to_owned();
        for (count, told) in
            [(ran.before, "done before"), (ran.again, "the same as another")]
        {
            if count > 0 {
                what += &format!(", {count} {told}");
            }
        }
        match ran.to_do {
            0 => {}
            to_do if self.told.is_bar() => {
                self.told.begin(&what, Some(to_do as u64));
            }
            to_do => self.told.say(&format!("{what}: {to_do} to do ...")),
        }
    }

    fn hear(&mut self, ran: &Ran) {
        let now = ran.done + ran.failed;
        let Some(advanced) = self.advanced.replace(now) else {
            return self.begin(ran);
        };
        self.told.advance(now.saturating_sub(advanced) as u64);
        if self.told.is_bar() || now == 0 || self.said.elapsed() < EVERY {
            return;
        }
        self.said = Instant::now();
        let each = self.begun.elapsed().as_secs_f64() / now as f64;
        let left = each * ran.to_do.saturating_sub(now) as f64;
        self.told.say(&format!(
            "{now} of {} events, {} failed: about {} more",
            ran.to_do,
            ran.failed,
            duration(left)
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Origin;
    use serde_json::json;

    #[test]
    fn what_a_command_gives_again_is_not_kept() {
        let kept = json!({"seed": 1, "models": [{"noise": "iid"}]});
        let mut whole = kept.clone();
        whole["models"][0]["priors"] = json!({"mu": "Flat()"});
        let sums = [("event.toml".to_owned(), "0f".to_owned())];
        let command = "couloir compare".to_owned();
        Origin { command, inputs: sums.into() }.write_to(&mut whole);
        assert_ne!(whole, kept);
        assert_eq!(shortened(whole), kept);
    }
}
