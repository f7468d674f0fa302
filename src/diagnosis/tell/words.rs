//! A diagnosis in sentences that a snow scientist can check.

use crate::diagnosis::tell::gain::{ahead, better, correlated, rest};
use crate::diagnosis::tell::law::law;
use crate::diagnosis::tell::moment::place_or_moment;
use crate::diagnosis::tell::noise::noise;
use crate::diagnosis::tell::phrases::{
    all_called, amounts, called, event, friction, interval, is_corrected,
    is_unsure, joined, judged, log10, model, of_baseline, own_name,
    probability, range, recorded_in, stretch, with_unit,
};
use crate::diagnosis::tell::signs::either_sign;
use crate::diagnosis::tell::weak::{disagreement, withheld};
use crate::diagnosis::{
    Baseline, BeforeAfter, Diagnosis, Hypothesis, Judged, Mismatch,
    ParameterSummary, Rival, Verdict,
};
use crate::mechanism::Family;
use crate::report::digits::{beside, p_value, per_cent, short, significant};
use crate::report::text::{capital, plain, unit};

/// The level of the residual tests.
const LEVEL: f64 = 0.05;
/// How many times the instrument's error the errors may have.
const BEYOND_INSTRUMENT: f64 = 3.0;
/// The same for the innovations: an AR(1) with a correlation of 0.97.
const BEYOND_INNOVATIONS: f64 = 4.0;
/// From this probability on, a rival is worth its name.
const RIVAL: f64 = 0.01;
/// How many stretches, and how many parts of one, are told.
const TOLD: usize = 2;

/// The diagnosis in five to fourteen plain sentences.
///
/// ```
/// use couloir::diagnosis::{Diagnosis, in_words};
/// let words = in_words(&Diagnosis::default());
/// assert!(words[0].starts_with("Nothing is missing"));
/// ```
pub fn in_words(d: &Diagnosis) -> Vec<String> {
    let mut said = vec![verdict(d)];
    said.extend(d.quick.then(quick));
    if d.verdict == Verdict::Adequate {
        said.extend(fit_as_it_is(d));
        said.push(residuals(&d.baseline));
        said.extend(nearest(d));
        said.extend(noise(d));
        said.push(silence());
        said.extend(law(d));
    } else {
        said.extend(d.mismatch.iter().take(TOLD).map(|m| difference(d, m)));
        if d.verdict == Verdict::Errors {
            said.extend(withheld(d));
        } else {
            said.push(explanation(d));
        }
        said.extend(noise(d));
        said.extend(sizes(d));
        said.extend(either_sign(d));
        if is_corrected(d) {
            said.push(better(d));
            said.extend(ahead(d));
            said.extend(correlated(d));
            said.extend(disagreement(d));
            said.extend(rest(d));
        } else {
            said.push(uncorrected(d));
            said.push(residuals(&d.baseline));
        }
        said.extend(law(d));
        said.extend(place_or_moment(d));
        said.extend(ambiguity(d));
    }
    said.extend(trap(d));
    said.extend(d.notes.iter().cloned());
    said.extend(warnings(d));
    said
}

fn quick() -> String {
    "This is a quick look, to be confirmed without --quick: it had one noise, \
     one mechanism at a time, and rough evidences."
        .to_owned()
}

fn verdict(d: &Diagnosis) -> String {
    let (model, event) = (model(&d.baseline), event(d));
    match d.verdict {
        Verdict::Adequate => adequate(d, &model, &event),
        Verdict::MissingPhysics if d.withheld.is_some() => {
            format!("Physics may be missing: {model} may not explain {event}.")
        }
        Verdict::MissingPhysics => {
            format!("Physics is missing: {model} does not explain {event}.")
        }
        Verdict::Measurement => format!(
            "No force is missing from {model}: the {} of {event} {} as the \
             model has it.",
            if of_start(d) { "start" } else { "measurement" },
            if d.withheld.is_some() { "may not be" } else { "is not" }
        ),
        Verdict::Errors => format!(
            "No force is {}missing from {}: the errors of {event} {} {} ones.",
            surely(d),
            friction(&d.baseline),
            if d.withheld.is_some() { "may not be" } else { "are not" },
            plain(&d.baseline.noise)
        ),
        Verdict::Unexplained => format!(
            "Something is missing that no mechanism of the catalogue \
             describes: {model} does not explain {event}."
        ),
    }
}

fn adequate(d: &Diagnosis, model: &str, event: &str) -> String {
    if let Some(few) = d.too_few() {
        return format!(
            "Whether anything is missing from {model} cannot be told: {event} \
             has {few}."
        );
    }
    let sure = of_baseline(d).map_or(String::new(), |p| {
        format!(" (probability {})", probability(p))
    });
    format!(
        "Nothing is {}missing: {model} explains {event} as well as anything \
         in the catalogue{sure}.",
        surely(d)
    )
}

/// A word where nothing in particular is missing, but perhaps something is.
fn surely(d: &Diagnosis) -> &'static str {
    if is_unsure(d) { "sure to be " } else { "" }
}

/// Whether it is the start rather than the measurement that is off.
fn of_start(d: &Diagnosis) -> bool {
    let best = d.selected.first().and_then(|name| judged(d, name));
    best.or(d.mechanisms.first())
        .is_some_and(|m| m.kind == Hypothesis::Mechanism(Family::Start))
}

/// Where simulation and recording differ, as a force.
fn difference(d: &Diagnosis, m: &Mismatch) -> String {
    let sense = if m.specific_force > 0.0 { "less" } else { "more" };
    let law = friction(&d.baseline);
    format!(
        "{} the mass is braked by {} m/s²{} {sense} than {law} gives{}{}.",
        capital(&stretch(m)),
        size(m),
        force_interval(m),
        as_if(m),
        parts(m),
    )
}

/// The force with as many digits as its interval has.
fn size(m: &Mismatch) -> String {
    let size = m.specific_force.abs();
    let width = m.specific_force_q95 - m.specific_force_q05;
    match width.is_finite() {
        true => beside(size, width / WIDTH_OF_90),
        false => short(size, 2),
    }
}

/// How many sd the 90 % interval of a normal distribution is wide.
const WIDTH_OF_90: f64 = 3.3;

fn force_interval(m: &Mismatch) -> String {
    let (low, high) = (m.specific_force_q05, m.specific_force_q95);
    if !(low.is_finite() && high.is_finite()) {
        return String::new();
    }
    // ParameterSummary as a size in the stated direction.
    let (low, high) =
        if m.specific_force > 0.0 { (low, high) } else { (-high, -low) };
    let sd = (high - low) / WIDTH_OF_90;
    format!(" (90 % interval {} to {})", beside(low, sd), beside(high, sd))
}

fn as_if(m: &Mismatch) -> String {
    if !m.delta_mu.is_finite() {
        return String::new();
    }
    let sense = if m.delta_mu < 0.0 { "lower" } else { "higher" };
    let size = short(m.delta_mu.abs(), 2);
    format!(", as if mu were {size} {sense} there")
}

/// The runs of one sign, where the stretch has several.
fn parts(m: &Mismatch) -> String {
    if m.parts.len() < 2 {
        return String::new();
    }
    let unit = m.axis.unit();
    let told: Vec<String> = m
        .parts
        .iter()
        .take(2 * TOLD)
        .map(|(from, to, force)| {
            let sense = if *force > 0.0 { "less" } else { "more" };
            let size = short(force.abs(), 2);
            format!("{size} {sense} from {}", range(*from, *to, unit))
        })
        .collect();
    let more = match m.parts.len() {
        n if n > told.len() => format!(", and {} more", n - told.len()),
        _ => String::new(),
    };
    format!(" (by part: {}{more})", told.join(", "))
}

/// What explains it, with how sure that is, and the rival.
fn explanation(d: &Diagnosis) -> String {
    if d.verdict == Verdict::Unexplained {
        return unexplained(d);
    }
    let found: Vec<&Judged> =
        d.selected.iter().filter_map(|name| judged(d, name)).collect();
    let what = capital(&all_called(d, &d.selected, "together with"));
    match found[..] {
        [] if d.selected.is_empty() => withheld(d).unwrap_or_else(|| {
            "No single mechanism stands out as its explanation.".to_owned()
        }),
        [best] if d.selected.len() == 1 => format!(
            "{what} {} this (probability {}){}.",
            if best.noun.plural { "explain" } else { "explains" },
            probability(best.probability),
            rival(d)
        ),
        _ => format!(
            "{what} explain this{}; alone, {}.",
            instead(d),
            probabilities(&found)
        ),
    }
}

/// `friction-step has the probability 0.60, surge 0.02 and cohesion < 0.001`.
fn probabilities(found: &[&Judged]) -> String {
    let each = found.iter().enumerate().map(|(i, m)| {
        let has = if i == 0 { "has the probability " } else { "" };
        format!("{} {has}{}", m.name, probability(m.probability))
    });
    joined(&each.collect::<Vec<_>>(), "and")
}

/// What would do nearly as well as one of several selected.
fn instead(d: &Diagnosis) -> String {
    // Of those that differ by one term.
    let gives_up = |rival: &Rival| {
        let mut gone =
            d.selected.iter().filter(|name| !rival.names.contains(name));
        let first = gone.next();
        first.filter(|_| gone.next().is_none())
    };
    let Some(given_up) = d.rivals.iter().find_map(gives_up) else {
        return String::new();
    };
    let mut named: Vec<String> = Vec::new();
    let alike = |rival: &&Rival| gives_up(rival) == Some(given_up);
    for name in d.rivals.iter().filter(alike).flat_map(|r| &r.names) {
        if !d.selected.contains(name) && !named.contains(name) {
            named.push(name.clone());
        }
    }
    named.truncate(TOLD);
    format!(
        ", and with {} instead of {} nearly as well",
        all_called(d, &named, "or"),
        all_called(d, std::slice::from_ref(given_up), "and"),
    )
}

fn unexplained(d: &Diagnosis) -> String {
    let force = d.mechanisms.iter().find(|m| m.kind == Hypothesis::Unknown);
    let sure = force.map_or(String::new(), |m| {
        format!(" (probability {})", probability(m.probability))
    });
    let named = |m: &&Judged| matches!(m.kind, Hypothesis::Mechanism(_));
    let near = match d.mechanisms.iter().find(named) {
        Some(m) => format!(
            "; of the named ones {} comes nearest ({})",
            called(m),
            probability(m.probability)
        ),
        None => String::new(),
    };
    let together = d.rivals.first().map_or(String::new(), |rival| {
        format!(
            "; {} together do about as well",
            all_called(d, &rival.names, "and")
        )
    });
    format!(
        "A force of free form explains this better than any named \
         mechanism{sure}{near}{together}."
    )
}

/// The most probable of what was not selected, where it is no far cry.
pub(super) fn single_rival(d: &Diagnosis) -> Option<&Judged> {
    let other = |m: &&Judged| !d.selected.contains(&m.name);
    d.mechanisms.iter().find(other).filter(|m| m.probability >= RIVAL)
}

fn rival(d: &Diagnosis) -> String {
    match single_rival(d) {
        Some(m) => format!(
            "; {} is the rival ({})",
            called(m),
            probability(m.probability)
        ),
        None => "; no rival comes near".to_owned(),
    }
}

/// How large the selected mechanisms are.
fn sizes(d: &Diagnosis) -> Option<String> {
    let of = |name: &String| -> Option<String> {
        let amounts = amounts(d, name);
        let clauses: Vec<String> =
            amounts.iter().take(4).map(|p| amount(p, name)).collect();
        (!clauses.is_empty())
            .then(|| format!("{}: {}", plain(name), clauses.join(", ")))
    };
    let told: Vec<String> = d.selected.iter().filter_map(of).collect();
    (!told.is_empty()).then(|| {
        format!("In figures, with 90 % intervals, {}.", told.join("; "))
    })
}

/// `delta_mu = 0.14 (0.11 to 0.17)`.
fn amount(p: &ParameterSummary, mechanism: &str) -> String {
    let middle = with_unit(&beside(p.q50, p.sd), &p.unit);
    let name = plain(own_name(p, mechanism));
    format!("{name} = {middle} ({})", interval(p))
}

/// How the model fits that nothing was added to.
fn uncorrected(d: &Diagnosis) -> String {
    let rmse = significant(d.baseline.rmse, 2);
    format!(
        "Nothing is added to the model; its root mean square error is {}.",
        with_unit(&rmse, recorded_in(d))
    )
}

/// What the recording cannot tell apart, and what would.
fn ambiguity(d: &Diagnosis) -> Option<String> {
    let separating = d.separating.as_deref().map(plain);
    if d.group.len() < 2 {
        return separating;
    }
    let group = all_called(d, &d.group, "and");
    let then = separating.map_or(String::new(), |s| format!(" {s}"));
    let these = match d.pictured.len() {
        0 | 1 => "This recording",
        _ => "These recordings",
    };
    Some(format!("{these} cannot tell {group} apart.{then}"))
}

/// Whether correlated noise passes for what is missing.
fn trap(d: &Diagnosis) -> Option<String> {
    let b = &d.baseline;
    let (sd, beside, times) = swallowed(b)?;
    let units = recorded_in(d);
    let sd = with_unit(&significant(sd, 2), units);
    let end = match d.verdict {
        Verdict::Adequate | Verdict::Errors => {
            "noise of that size may have swallowed a mismatch, so this \
             verdict is weak"
        }
        _ => {
            "the correlated noise had swallowed the mismatch, and the fit \
             looked acceptable"
        }
    };
    let stands_in = match b.infers_noise {
        true => ", which stands in for a noise that was not named,",
        false => "",
    };
    Some(format!(
        "Beware: under {}{stands_in} the errors have a standard deviation of \
         {sd}, {} times {beside}: {end}.",
        plain(&b.noise),
        significant(times, 2)
    ))
}

/// The errors' sd where it is far above what it should be, the words for
/// that, and how many times above.
fn swallowed(b: &Baseline) -> Option<(f64, &'static str, f64)> {
    let sd = b.stationary_sd.filter(|sd| sd.is_finite())?;
    let over = |by: Option<f64>, most: f64| {
        let times = sd / by.filter(|x| *x > 0.0)?;
        (times > most).then_some(times)
    };
    let instrument = over(b.instrument, BEYOND_INSTRUMENT)
        .map(|times| (sd, "the instrument's error", times));
    instrument.or_else(|| {
        over(b.innovation_sd, BEYOND_INNOVATIONS)
            .map(|times| (sd, "that of their innovations", times))
    })
}

fn fit_as_it_is(d: &Diagnosis) -> Option<String> {
    let b = &d.baseline;
    if !b.rmse.is_finite() {
        return None;
    }
    let units = recorded_in(d);
    let rmse = with_unit(&significant(b.rmse, 2), units);
    let instrument =
        b.instrument.filter(|x| x.is_finite()).map_or(String::new(), |x| {
            let error = with_unit(&significant(x, 2), units);
            format!("; the instrument's own error is {error}")
        });
    Some(format!(
        "It misses the recorded values by {rmse} (root mean \
         square){instrument}."
    ))
}

fn residuals(b: &Baseline) -> String {
    let tests = [
        ("Ljung-Box", b.ljung_box_p),
        ("Shapiro-Wilk", b.shapiro_wilk_p),
        ("largest residual", b.predictive_p),
    ];
    let known: Vec<_> =
        tests.into_iter().filter(|(_, p)| p.is_finite()).collect();
    if known.is_empty() {
        return "Its residuals were not tested.".to_owned();
    }
    let figures: Vec<String> = known
        .iter()
        .map(|(name, p)| match p_value(*p) {
            p if p.starts_with('<') => format!("{name} p {p}"),
            p => format!("{name} p = {p}"),
        })
        .collect();
    let objects = known.iter().any(|(_, p)| *p < LEVEL);
    let verdict = if objects { "object" } else { "do not object" };
    format!("Tests of its residuals {verdict} ({}).", figures.join(", "))
}

/// What would come next, where nothing is missing.
fn nearest(d: &Diagnosis) -> Option<String> {
    let others =
        || d.mechanisms.iter().filter(|m| m.kind != Hypothesis::Baseline);
    let m = others().next()?;
    let all = others().map(|m| m.probability).sum();
    let together = match is_unsure(d) {
        true => format!(" together of probability {},", probability(all)),
        false => String::new(),
    };
    Some(format!(
        "Of {} things that could be missing,{together} the most probable is \
         {} (probability {}, log10 Bayes factor {}).",
        others().count(),
        called(m),
        probability(m.probability),
        log10(m.log10_bayes_factor).replace('-', "−")
    ))
}

fn silence() -> String {
    "This says that the recording does not show anything more, not that \
     nothing more is there: an effect too small for this noise stays unseen. \
     A second recording, or one with smaller errors, would show more."
        .to_owned()
}

fn warnings(d: &Diagnosis) -> Option<String> {
    let first = plain(d.warnings.first()?.trim_end_matches('.'));
    Some(match d.warnings.len() {
        1 => format!("Warning: {first}."),
        n => format!("{n} warnings, of which the first: {first}."),
    })
}

/// A line of the before-and-after table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Row {
    /// What is compared.
    pub(crate) what: String,
    /// Of the model as it was.
    pub(crate) before: String,
    /// Of the corrected one.
    pub(crate) after: String,
}

/// Before and after, line by line.
pub(crate) fn before_and_after(d: &Diagnosis) -> Vec<Row> {
    let i = &d.improvement;
    let units = match unit(recorded_in(d)).as_str() {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let row = |what: String, pair: BeforeAfter, say: fn(f64) -> String| Row {
        what,
        before: say(pair.before),
        after: say(pair.after),
    };
    let evidence = BeforeAfter { before: 0.0, after: i.log10_bayes_factor };
    let two: fn(f64) -> String = |x| significant(x, 3);
    let rmse = BeforeAfter {
        before: finite(i.rmse.before, d.baseline.rmse, is_corrected(d)),
        after: i.rmse.after,
    };
    let one: fn(f64) -> String = |x| match x {
        x if x.is_finite() => format!("{x:.1}"),
        x => significant(x, 2),
    };
    let mut rows = vec![
        row("log10 Bayes factor".to_owned(), evidence, log10),
        row(format!("RMSE{units}"), rmse, two),
        row(format!("RMSE, least squares{units}"), i.least_squares, two),
        row(format!("RMSE, last 30 %{units}"), i.heldout_rmse, two),
        row("elpd (PSIS-LOO)".to_owned(), i.elpd, one),
        row("values in the 90 % band".to_owned(), i.coverage90, per_cent),
        row("Ljung-Box p".to_owned(), i.ljung_box_p, p_value),
    ];
    if i.stationary_sd.before.is_finite() {
        rows.push(row(
            format!("sd of the errors{units}"),
            i.stationary_sd,
            two,
        ));
    }
    rows
}

/// The baseline's own figure, where nothing was corrected.
fn finite(compared: f64, own: f64, corrected: bool) -> f64 {
    if corrected { compared } else { own }
}
