//! `couloir simulate`: the motion with given parameter values.

use clap::Args;
use serde_json::json;

use super::Subject;
use super::answer::{Answer, pretty};
use super::made::{Files, Made};
use super::results::Output;
use super::said::Said;
use super::study::Read;
use crate::error::{Error, Result, Stop};
use crate::export::InferenceData;
use crate::model::Assembled;
use crate::physics::State;
use crate::physics::friction::Laws;
use crate::scalar::Plain;
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
    said: Said,
}

impl Arguments {
    pub(super) fn run(&self, laws: &Laws) -> Result<Answer> {
        let results = self.output.ready(&FILES, self.subject.paths())?;
        let Found { model, values, motion, said } = self.found(laws)?;
        let mut document = document(&model, &values, &motion);
        said.write_to(&mut document);
        let document = pretty(&document);
        let wrote = results.write(|| Ok(files(&motion, &document)));
        let text = match self.output.json {
            true => document,
            false => tell(&model, &values, &motion) + &said.lines(),
        };
        Ok(Answer::from(text).after(wrote))
    }

    /// The same without a folder or a terminal.
    pub(super) fn made(&self, laws: &Laws) -> Result<Made> {
        let Found { model, values, motion, said } = self.found(laws)?;
        let mut document = document(&model, &values, &motion);
        said.write_to(&mut document);
        let files = files(&motion, &pretty(&document));
        Ok(Made { files, data: Ok(InferenceData::default()) })
    }

    /// The motion with the parameters' values.
    fn found(&self, laws: &Laws) -> Result<Found> {
        let Read { model, said, .. } = self.subject.read(laws)?;
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
        Ok(Found { model, values, motion, said })
    }

    /// The parameters' values: those set, the prior's middle for the rest.
    fn values(&self, model: &Assembled) -> Result<Vec<f64>> {
        let names: Vec<&str> = model.priors().map(|(name, _)| name).collect();
        let mut set: Vec<Option<f64>> = vec![None; names.len()];
        for text in &self.values {
            let (name, value) = text.split_once('=').ok_or_else(|| {
                Error::input(format!(
                    "--set {}: expected NAME=VALUE",
                    quoted(text)
                ))
            })?;
            let place = names.iter().position(|n| *n == name.trim());
            let Some(place) = place else {
                return Err(Error::input(format!(
                    "--set {}: the model has no parameter {}; it has {}",
                    quoted(text),
                    quoted(name.trim()),
                    names.join(", ")
                )));
            };
            let value = value.trim().parse::<f64>().ok();
            set[place] = value.filter(|v| v.is_finite());
            if set[place].is_none() {
                return Err(Error::input(format!(
                    "--set {}: expected a finite number after =",
                    quoted(text)
                )));
            }
        }
        let mut values = Vec::with_capacity(names.len());
        for (i, (set, name)) in set.iter().zip(&names).enumerate() {
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

fn document(
    model: &Assembled,
    values: &[f64],
    Motion { times, states, rest }: &Motion,
) -> serde_json::Value {
    let parameters: serde_json::Map<String, serde_json::Value> = model
        .priors()
        .zip(values)
        .enumerate()
        .filter(|(i, _)| model.is_of_motion(*i))
        .map(|(_, ((name, _), value))| (name.to_owned(), json!(value)))
        .collect();
    let column = |f: fn(&State<Plain>) -> f64| -> Vec<f64> {
        states.iter().map(f).collect()
    };
    json!({
        "schema": 1,
        "event": model.event().name(),
        "model": {"friction": model.friction()},
        "parameters": parameters,
        "t": times,
        "velocity": column(|s| s.speed.value()),
        "distance": column(|s| s.distance.value()),
        "acceleration": column(|s| s.acceleration.value()),
        "rest": rest.map(|(t, s)| json!({"t": t, "distance": s})),
    })
}

/// How many rows the terminal shows.
const ROWS: usize = 40;

fn tell(
    model: &Assembled,
    values: &[f64],
    Motion { times, states, rest }: &Motion,
) -> String {
    let set: Vec<String> = model
        .priors()
        .zip(values)
        .enumerate()
        .filter(|(i, _)| model.is_of_motion(*i))
        .map(|(_, ((name, _), value))| format!("{name} = {value:.6}"))
        .collect();
    let mut text = format!("{}: {}\n", model.friction(), set.join(", "));
    text.push_str(&format!(
        "\n{:>9} {:>11} {:>12} {:>14}\n{:>9} {:>11} {:>12} {:>14}\n",
        "time", "speed", "distance", "acceleration", "s", "m/s", "m", "m/s2"
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
    text.push_str(&match rest {
        Some((t, s)) => {
            format!("\nThe mass comes to rest at {t:.2} s, {s:.1} m.\n")
        }
        None => "\nThe mass never comes to rest: the last slope of the track \
                 is steeper than friction can hold.\n"
            .to_owned(),
    });
    text
}
