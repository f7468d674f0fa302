//! The files of the event: event.toml, track.csv, recording.csv.

use toml_edit::value;

use super::case::Case;
use super::front::even_step;
use super::log::SpeedKind;

/// The event.toml, each number with where it comes from.
pub(super) fn toml(case: &Case) -> String {
    let name = value(case.name.as_str()).to_string();
    let velocity = case.recorded.first().copied().unwrap_or(0.0);
    let word = case.moving.log.word();
    let terrain = match case.terrain.is_some() {
        true => "of the terrain model".to_owned(),
        false => format!("of the {word}"),
    };
    let path = match case.is_given {
        true => "along the path given".to_owned(),
        false => format!("along the {word}'s positions"),
    };
    format!(
        "# Written by `couloir import`; import.txt says what was done, and \
         what is\n# doubted. All quantities are SI.\n{}\
         name = {}\n\n{}\
         [track]\n\
         file = \"track.csv\"               # x: horizontal distance [m],\n\
         {SPACE}# {path};\n\
         {SPACE}# z: elevation {terrain} [m]\n\n\
         [release]\n\
         x = {:<29}# where the recording begins [m]\n\
         velocity = {:<22}# the {word}'s speed at t = 0 [m/s],\n\
         {SPACE}# {:.2} s after its first row\n\n\
         [flow]\n\
         depth = 1.0                      # not measured: with 1, xi stands \
         for xi h [m]\n\n{}\n{MODEL}",
        match case.moving.log.is_simulated {
            true => "# Synthetic data: simulated, not measured.\n",
            false => "",
        },
        name.trim(),
        clock(case),
        place(case.ends().0),
        format!("{velocity:.3}"),
        case.moving.begin(),
        recorded(case)
    )
}

/// A place to the millimetre; the first of a track to none.
fn place(x: f64) -> String {
    if x == 0.0 { "0.0".to_owned() } else { format!("{x:.3}") }
}

/// When t = 0 is, where several recordings share a clock.
fn clock(case: &Case) -> String {
    let start = |start: f64| {
        format!(
            "[event]\nstart = {:<25}# t = 0 on the clock that the recordings\n\
             {SPACE}# share, from the first of them on [s]\n\n",
            place(start)
        )
    };
    case.start.map(start).unwrap_or_default()
}

/// What was recorded.
fn recorded(case: &Case) -> String {
    let speeds = match case.moving.log.kind {
        _ if case.moving.log.is_front() => return of_front(case),
        _ if case.moving.log.is_simulated => "the simulation's own",
        SpeedKind::Whole | SpeedKind::Along => "the receiver's own",
        SpeedKind::Ground => "the receiver's over ground, by the slope",
        SpeedKind::Positions => "by positions",
        SpeedKind::Front => return of_front(case),
    };
    format!(
        "[recording]\n\
         file = \"recording.csv\"           # t [s] and velocity [m/s],\n\
         {SPACE}# {speeds}\n\
         quantity = \"velocity\"\n\
         window = 0.0                     # the values are taken as of the \
         moment\n"
    )
}

/// Distances, and how to take the speeds instead.
fn of_front(case: &Case) -> String {
    let speeds = match even_step(&case.moving.times()) {
        None => String::new(),
        Some(step) => format!(
            "# Or the mean speeds of equation 13 of Heredia et al. (2020), \
             whose errors are\n# correlated:\n\
             # quantity = \"velocity\"\n\
             # window = {step}\n"
        ),
    };
    format!(
        "[recording]\n\
         file = \"recording.csv\"           # t [s] and position [m]: \
         distances along\n\
         {SPACE}# the slope since t = 0\n\
         quantity = \"position\"\n{speeds}"
    )
}

/// Up to where comments stand.
const SPACE: &str = "                                 ";

/// What the import does not know: law and priors as in a new event. The noise
/// is left open, since a sensor's errors are rarely independent, and only some
/// noises take uneven times.
const MODEL: &str = "\
[model]
friction = \"voellmy\"             # not from the files: the usual law
noise = \"infer\"                  # whichever noise is likely; faster by far:
                                 # \"iid\", or \"ar(1)\" for errors that are
                                 # correlated

[priors]                         # not from the files: those of `couloir new`
mu = \"Gamma(9, 0.03)\"
xi = \"Gamma(2.5, 400)\"
";

/// The track.csv: horizontal distance and elevation \[m\].
pub(super) fn track(case: &Case) -> String {
    let rows = case.ground.x.iter().zip(&case.ground.z);
    let rows = rows.map(|(x, z)| format!("{x:.2},{z:.3}\n"));
    format!("x,z\n{}", rows.collect::<String>())
}

/// The recording.csv: time since the first row taken \[s\], and speed \[m/s\];
/// of a front the distance \[m\], and beside it the mean speed where times are
/// even. The first row is the release.
pub(super) fn recording(case: &Case) -> String {
    let times = case.moving.times();
    let rows = times.iter().zip(&case.recorded).skip(1);
    if !case.moving.log.is_front() {
        let rows = rows.map(|(t, v)| format!("{t:.3},{v:.3}\n"));
        return format!("t,velocity\n{}", rows.collect::<String>());
    }
    let is_even = even_step(&times).is_some();
    let way = case.travelled();
    let rows = rows.zip(way.iter().skip(1));
    let rows = rows.map(|((t, v), s)| match is_even {
        true => format!("{t:.3},{s:.3},{v:.3}\n"),
        false => format!("{t:.3},{s:.3}\n"),
    });
    let more = if is_even { ",velocity" } else { "" };
    format!("t,position{more}\n{}", rows.collect::<String>())
}
