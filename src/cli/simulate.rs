//! `couloir simulate`: the motion with given parameter values.

use clap::Args;
use serde_json::{Map, Value, json};

use super::answer::{Answer, pretty, wrapped};
use super::made::{Files, Made};
use super::results::Output;
use super::said::Said;
use super::study::Read;
use super::{Subject, width};
use crate::error::{Error, Result, Stop};
use crate::export::InferenceData;
use crate::model::Assembled;
use crate::physics::State;
use crate::physics::friction::Laws;
use crate::prior::{AnyPrior, Prior};
use crate::report::Origin;
use crate::scalar::{Plain, Real};
use crate::spelling::quoted;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    subject: Subject,
    /// A parameter's value, such as mu=0.3; give it as often as needed; the
    /// others stand at the middle of their priors
    #[arg(long = "set", value_name = "NAME=VALUE")]
    values: Vec<String>,
    #[command(flatten)]
    output: Output,
}

/// What a simulation writes.
const FILES: [&str; 2] = ["simulation.csv", "simulation.json"];

/// A motion at moments, and when and where it ends.
struct Motion {
    times: Vec<f64>,
    states: Vec<State<Plain>>,
    rest: Option<(f64, f64)>,
}

/// A simulation with what it is of.
struct Found {
    model: Assembled,
    values: Vec<f64>,
    motion: Motion,
    origin: Origin,
    said: Said,
}

impl Arguments {
    pub(super) fn run(&self, laws: &Laws, typed: &str) -> Result<Answer> {
        let results = self.output.ready(&FILES, self.subject.paths())?;
        let found = self.found(laws, typed)?;
        let document = pretty(&found.document());
        let wrote = results.write(|| Ok(files(&found.motion, &document)));
        let text = match self.output.json {
            true => document,
            false => found.tell() + &found.said.lines(),
        };
        Ok(Answer::from(text).after(wrote))
    }

    /// The same without a folder or a terminal.
    pub(super) fn made(&self, laws: &Laws, typed: &str) -> Result<Made> {
        let found = self.found(laws, typed)?;
        let files = files(&found.motion, &pretty(&found.document()));
        let reads = self.subject.paths().to_vec();
        Ok(Made { files, reads, data: Ok(InferenceData::default()) })
    }

    /// The motion with the parameters' values.
    fn found(&self, laws: &Laws, typed: &str) -> Result<Found> {
        let Read { model, said, .. } = self.subject.read(laws)?;
        let origin = self.subject.origin(typed)?;
        let values = self.values(&model)?;
        let times = times(&model);
        let no_flow = |stop| match stop {
            Stop::Reject(reason) => Error::input(format!(
                "these values have no flow: {reason}; change --set"
            )),
            Stop::Fail(error) => error,
        };
        let states = model.motion(&values, &times).map_err(no_flow)?;
        let rest = model.rest(&values).map_err(no_flow)?;
        let rest = rest.map(|r| (r.time.value(), r.distance.value()));
        let motion = Motion { times, states, rest };
        let found = Found { model, values, motion, origin, said };
        match found.motion.why_none() {
            None => Ok(found),
            Some(why) => Err(Error::input(format!(
                "these values have no motion ({}): {why}; expected values \
                 with one: give others with --set",
                found.values_told()
            ))),
        }
    }

    /// The parameters' values: those set, the prior's middle for the rest.
    fn values(&self, model: &Assembled) -> Result<Vec<f64>> {
        let known: Vec<_> = model.priors().collect();
        let mut set: Vec<Option<f64>> = vec![None; known.len()];
        for text in &self.values {
            let wrong = |what: String| {
                Error::input(format!("--set {}: {what}", quoted(text)))
            };
            let (place, value) = assigned(text, &known).map_err(wrong)?;
            if let Some(before) = set[place].replace(value) {
                return Err(wrong(format!(
                    "{} is set to {before} before; expected each parameter \
                     once: drop one of them",
                    known[place].0
                )));
            }
        }
        let mut values = Vec::with_capacity(known.len());
        for (i, (set, (name, _))) in set.iter().zip(&known).enumerate() {
            let value = set.or_else(|| model.middle(&values));
            if value.is_none() && model.is_of_motion(i) {
                return Err(Error::input(format!(
                    "{name} has a flat prior and no middle; give it with \
                     --set {name}=.."
                )));
            }
            values.push(value.unwrap_or(0.0));
        }
        Ok(values)
    }
}

/// The place of the parameter that a text such as `mu=0.3` sets, and its
/// value, which its prior has to allow: an end of it does.
fn assigned(
    text: &str,
    known: &[(&str, &AnyPrior)],
) -> Result<(usize, f64), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    let place = known.iter().position(|(n, _)| *n == name.trim());
    let place = place.ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        format!(
            "the model has no parameter {}; expected one of {}",
            quoted(name.trim()),
            names.join(", ")
        )
    })?;
    let value = value.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    let value = value.ok_or("expected a finite number after =")?;
    let (name, prior) = known[place];
    let (low, high) = Prior::<Plain>::support(prior).ends();
    if (low..=high).contains(&value) {
        return Ok((place, value));
    }
    let allowed = match (low.is_finite(), high.is_finite()) {
        (true, true) => format!("from {low} to {high}"),
        (true, false) => format!("{low} or more"),
        _ => format!("{high} or less"),
    };
    Err(format!(
        "{name} is {value}; expected {allowed}, as its prior {prior} has it: \
         set another value, or give the event another prior"
    ))
}

impl Motion {
    /// Why it is no motion, where it is none.
    fn why_none(&self) -> Option<&'static str> {
        let numbers = self.states.iter().flat_map(|s| {
            [s.speed, s.distance, s.acceleration].map(Real::value)
        });
        let is_motion = numbers.into_iter().all(f64::is_finite);
        (!is_motion).then_some("its speeds are no finite numbers")
    }

    /// Whether the mass never starts.
    fn is_still(&self) -> bool {
        self.states.iter().all(|s| s.speed.value() == 0.0)
    }
}

fn files(motion: &Motion, document: &str) -> Files {
    let texts = [csv(motion), document.to_owned()].map(String::into_bytes);
    FILES.into_iter().map(Into::into).zip(texts).collect()
}

/// The recording's own times, with t = 0 before them.
fn times(model: &Assembled) -> Vec<f64> {
    let mut times = vec![0.0];
    for series in model.event().recordings() {
        times.extend(series.times().iter().filter(|t| **t > 0.0));
    }
    times
}

fn csv(Motion { times, states, .. }: &Motion) -> String {
    let mut text = String::from("t,velocity,distance,acceleration\n");
    for (t, s) in times.iter().zip(states) {
        text.push_str(&format!(
            "{t},{},{},{}\n",
            s.speed.value(),
            s.distance.value(),
            s.acceleration.value()
        ));
    }
    text
}

impl Found {
    /// The parameters that say how the mass moves, with their priors and
    /// values.
    fn parameters(&self) -> impl Iterator<Item = (&str, &AnyPrior, f64)> {
        let all = self.model.priors().zip(&self.values).enumerate();
        all.filter(|(i, _)| self.model.is_of_motion(*i))
            .map(|(_, ((name, prior), value))| (name, prior, *value))
    }

    /// The values of those.
    fn values_told(&self) -> String {
        let told = self.parameters();
        let told = told.map(|(name, _, value)| format!("{name} = {value:.6}"));
        told.collect::<Vec<_>>().join(", ")
    }

    fn document(&self) -> Value {
        let Motion { times, states, rest } = &self.motion;
        let values = self.parameters().map(|(n, _, v)| (n.into(), json!(v)));
        let values: Map<String, Value> = values.collect();
        let priors = self.parameters();
        let priors: Map<String, Value> =
            priors.map(|(n, p, _)| (n.into(), json!(p.to_string()))).collect();
        let column = |f: fn(&State<Plain>) -> f64| -> Vec<f64> {
            states.iter().map(f).collect()
        };
        let mut document = json!({
            "schema": 1,
            "event": self.model.event().name(),
            "model": {"friction": self.model.friction()},
            "parameters": values,
            "priors": priors,
            "t": times,
            "velocity": column(|s| s.speed.value()),
            "distance": column(|s| s.distance.value()),
            "acceleration": column(|s| s.acceleration.value()),
            "rest": rest.map(|(t, s)| json!({"t": t, "distance": s})),
        });
        self.origin.write_to(&mut document);
        self.said.write_to(&mut document);
        document
    }

    fn tell(&self) -> String {
        let Motion { times, states, rest } = &self.motion;
        let friction = self.model.friction();
        let head = format!("{friction}: {}", self.values_told());
        let mut text = wrapped(&head, width());
        text.push_str(&format!(
            "\n{:>9} {:>11} {:>12} {:>14}\n{:>9} {:>11} {:>12} {:>14}\n",
            "time",
            "speed",
            "distance",
            "acceleration",
            "s",
            "m/s",
            "m",
            "m/s2"
        ));
        let step = times.len().div_ceil(ROWS).max(1);
        for (t, s) in times.iter().zip(states).step_by(step) {
            text.push_str(&format!(
                "{t:9.2} {:11.3} {:12.2} {:14.4}\n",
                s.speed.value(),
                s.distance.value(),
                s.acceleration.value()
            ));
        }
        if step > 1 {
            text.push_str(&format!(
                "(one row in {step} of {}; --out writes them all)\n",
                times.len()
            ));
        }
        let end = match rest {
            _ if self.motion.is_still() => {
                "The mass stays where it is released: friction holds it."
                    .to_owned()
            }
            Some((t, s)) => {
                format!("The mass comes to rest at {t:.2} s, {s:.1} m.")
            }
            None => "The mass never comes to rest: the last slope of the \
                     track is steeper than friction can hold."
                .to_owned(),
        };
        text + "\n" + &wrapped(&end, width())
    }
}

/// How many rows the terminal shows.
const ROWS: usize = 40;
