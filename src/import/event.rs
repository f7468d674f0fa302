//! The files of the event: event.toml, track.csv, recording.csv.

use toml_edit::value;

use super::case::Case;
use super::log::SpeedKind;

/// The event.toml, each number with where it comes from.
pub(super) fn toml(case: &Case) -> String {
    let name = value(case.name.as_str()).to_string();
    let velocity = case.recorded.first().copied().unwrap_or(0.0);
    let speeds = match case.log.kind {
        SpeedKind::Whole | SpeedKind::Along => "the receiver's own",
        SpeedKind::Ground => "the receiver's over ground, by the slope",
        SpeedKind::Positions => "by positions",
    };
    let terrain = match case.terrain.is_some() {
        true => "of the terrain model",
        false => "of the log",
    };
    let path = match case.is_given {
        true => "along the path given",
        false => "along the log's positions",
    };
    format!(
        "# Written by `couloir import`; import.txt says what was done, and \
         what is\n# doubted. All quantities are SI.\n\
         name = {}\n\n\
         [track]\n\
         file = \"track.csv\"               # x: horizontal distance [m],\n\
         {SPACE}# {path};\n\
         {SPACE}# z: elevation {terrain} [m]\n\n\
         [release]\n\
         x = 0.0                          # where the recording begins [m]\n\
         velocity = {:<22}# the log's speed at t = 0 [m/s], {:.2} s after\n\
         {SPACE}# its first row\n\n\
         [flow]\n\
         depth = 1.0                      # not measured: with 1, xi stands \
         for xi h [m]\n\n\
         [recording]\n\
         file = \"recording.csv\"           # t [s] and velocity [m/s], \
         {speeds}\n\
         quantity = \"velocity\"\n\
         window = 0.0                     # the values are taken as of the \
         moment\n\n{MODEL}",
        name.trim(),
        format!("{velocity:.3}"),
        case.begin()
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

/// The recording.csv: time since the first row taken \[s\], and speed \[m/s\].
/// The first row is the release.
pub(super) fn recording(case: &Case) -> String {
    let times = case.times();
    let rows = times.iter().zip(&case.recorded).skip(1);
    let rows = rows.map(|(t, v)| format!("{t:.3},{v:.3}\n"));
    format!("t,velocity\n{}", rows.collect::<String>())
}
