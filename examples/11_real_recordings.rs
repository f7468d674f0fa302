//! A study of several recordings of one kind: each diagnosed, thinned, and
//! under other priors of the noise; each predicted from the others; all
//! together. Arguments: event folders. Without any, the built-in recording.
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use couloir::diagnosis::{
    Diagnosis, Hypothesis, Options, Sharing, Together, diagnose,
    diagnose_together, fit, in_words,
};
use couloir::infer::LaplaceMixture;
use couloir::io::{self, EventFile};
use couloir::mechanism::{Family, catalogue::find};
use couloir::model::Assembled;
use couloir::prelude::*;
use couloir::prior::AnyPrior;

/// Values a second; the first stands for all of them.
const RATES: [f64; 4] = [f64::INFINITY, 5.0, 2.0, 1.0];
/// Other priors of the noise: ten times the variance, and less correlation.
const NOISES: [(&str, &str); 2] =
    [("sigma2", "InverseGamma(2, 1)"), ("phi", "Beta(2, 2)")];
/// At which rate priors, predictions and all together are studied.
const RATE: f64 = 2.0;

/// A file's model, of so many values a second, with priors of one's own.
fn model(path: &Path, rate: f64, own: &[(&str, &str)]) -> Result<Assembled> {
    let file: EventFile = io::load(path, &Laws::default())?;
    let series = file.event.recordings().next();
    let series = series.ok_or_else(|| Error::input("no recording"))?;
    let times = series.times();
    let step = (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64;
    let every = (1.0 / (rate * step)).round().max(1.0) as usize;
    let of = |all: &[f64]| -> Vec<f64> {
        all.iter().skip(every - 1).step_by(every).copied().collect()
    };
    let thin = Series::velocity(of(times), of(series.values()))?;
    let mut priors: BTreeMap<String, AnyPrior> = file.priors;
    for (name, prior) in own {
        priors.insert((*name).to_owned(), AnyPrior::parse(prior)?);
    }
    let event = file.event.with_recording(thin)?;
    Assembled::new(event, file.friction, file.noise, &priors)
}

/// One line of a Markdown table.
fn row(what: &str, d: &Diagnosis) {
    let i = d.improvement;
    let physics = |name: &str| {
        let mut added = d
            .mechanisms
            .iter()
            .filter(|m| m.kind == Hypothesis::Mechanism(Family::Physics));
        added
            .any(|m| d.selected.contains(&m.name) && name.starts_with(&m.name))
    };
    let size = d.parameters.iter().find(|p| physics(&p.name));
    let size = size.map_or(String::new(), |p| {
        format!("{} {:.2} ({:.2} to {:.2})", p.name, p.q50, p.q05, p.q95)
    });
    println!(
        "| {what} | {} | {} | {} | {size} | {:.1} | {:.2} to {:.2} | {:.2} to \
         {:.2} | {:.2} to {:.2} | {:.1} to {:.1} |",
        d.verdict.name(),
        d.selected.join(", "),
        d.group.join(", "),
        i.log10_bayes_factor,
        i.rmse.before,
        i.rmse.after,
        i.least_squares.before,
        i.least_squares.after,
        i.stationary_sd.before,
        i.stationary_sd.after,
        i.heldout_rmse.before,
        i.heldout_rmse.after,
    );
}

fn head() {
    println!(
        "\n| | verdict | added | cannot be told apart | size | log10 BF | \
         RMSE | least squares | AR(1) sd | last 30 % |\n\
         |---|---|---|---|---|---|---|---|---|---|"
    );
}

fn alone(path: &Path) -> Result<()> {
    let one = |what: &str, rate, own: &[(&str, &str)]| -> Result<()> {
        let model = model(path, rate, own)?;
        let options = Options::of(&model, 1);
        row(what, &diagnose(&model, model.event(), &options, &Quiet)?);
        Ok(())
    };
    println!("\n{}", path.display());
    head();
    for rate in RATES {
        one(&format!("at most {rate} a second"), rate, &[])?;
    }
    for noise in NOISES {
        one(&format!("{} ~ {}", noise.0, noise.1), RATE, &[noise])?;
    }
    Ok(())
}

/// The RMSE of an event as the others predict it: their one law, with a
/// mechanism or without.
fn predicted(paths: &[PathBuf], left: usize, name: &str) -> Result<f64> {
    let others = paths.iter().enumerate().filter(|(i, _)| *i != left);
    let models = others.map(|(_, path)| model(path, RATE, &[]));
    let together = Together::with_one_law(models.collect::<Result<_>>()?)?;
    let extent = together.extent();
    let found = match name {
        "" => None,
        name => Some(find(name, &extent, &[])?),
    };
    let added: Vec<_> = found.as_deref().into_iter().collect();
    let known =
        fit(&together, &added, &LaplaceMixture::default(), Seed::new(1))?;
    let count = added.iter().map(|m| m.unknowns().len()).sum::<usize>();
    let unseen = model(&paths[left], RATE, &[])?;
    let laws = unseen.friction_dimension();
    let rest = unseen.priors().count() - laws;
    let again = found.into_iter().collect();
    let unseen = unseen.with_mechanisms(again, &BTreeMap::new())?;
    let series = unseen.event().recordings().next();
    let series = series.ok_or_else(|| Error::input("no recording"))?;
    let mut mean = vec![0.0; series.len()];
    let rows = known.draws.thinned(400);
    for row in &rows {
        // Of the event itself only the law counts: its errors do not.
        let mut own = row[..count + laws].to_vec();
        own.extend(vec![0.5; rest]);
        let states = unseen.motion(&own, series.times());
        let states = states.map_err(|_| Error::inference("no flow"))?;
        for (sum, state) in mean.iter_mut().zip(states) {
            *sum += state.speed.value() / rows.len() as f64;
        }
    }
    let off = mean.iter().zip(series.values()).map(|(p, v)| (p - v).powi(2));
    Ok((off.sum::<f64>() / mean.len() as f64).sqrt())
}

fn together(paths: &[PathBuf]) -> Result<()> {
    let names = ["", "friction-hardening", "friction-step(time)"];
    println!("\n| predicted from the others, RMSE | {} |", names.join(" | "));
    println!("|---|---|---|---|");
    for (left, path) in paths.iter().enumerate() {
        let errors = names.map(|name| predicted(paths, left, name));
        let [none, hardening, step] = errors;
        let (none, hardening, step) = (none?, hardening?, step?);
        let path = path.display();
        println!("| {path} | {none:.2} | {hardening:.2} | {step:.2} |");
    }
    head();
    for sharing in [Sharing::Shared, Sharing::Pooled] {
        let models = paths.iter().map(|path| model(path, RATE, &[]));
        let all = Together::new(models.collect::<Result<_>>()?)?;
        let options = Options::of_all(&all, 1);
        let found = diagnose_together(&all, sharing, &options, &Quiet)?;
        row(&format!("all, {sharing:?}"), &found);
        println!("\n{}\n", in_words(&found).join("\n"));
    }
    Ok(())
}

fn main() -> Result<()> {
    let paths: Vec<PathBuf> =
        std::env::args_os().skip(1).map(PathBuf::from).collect();
    if paths.is_empty() {
        println!("No event folders given: a car that coasts uphill.\n");
        let file = io::coastdown(&Laws::default())?;
        let law = Laws::default().parse("coulomb")?;
        let model = Assembled::new(file.event, law, file.noise, &file.priors)?;
        let options = Options::of(&model, 1);
        let found = diagnose(&model, model.event(), &options, &Quiet)?;
        println!("{}", in_words(&found).join("\n"));
        return Ok(());
    }
    paths.iter().try_for_each(|path| alone(path))?;
    if paths.len() > 1 { together(&paths) } else { Ok(()) }
}
