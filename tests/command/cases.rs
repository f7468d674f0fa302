//! Malformed inputs, each with what its refusal has to say; for the library
//! and the command alike.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A good event.toml, which cases spoil.
pub(crate) const EVENT: &str = r#"name = "spoilt"

[track]
file = "track.csv"

[release]
x = 0.0
velocity = 0.0

[flow]
depth = 1.5

[recording]
file = "recording.csv"
quantity = "velocity"
window = 0.0

[model]
friction = "voellmy"
noise = "iid"

[priors]
mu = "Gamma(9, 0.03)"
"#;

/// A good track, 500 m long.
pub(crate) const TRACK: &str = "x,z\n0,300\n400,0\n";

/// A good recording.
pub(crate) const RECORDING: &str = "t,velocity\n1,2.5\n2,5\n3,7.4\n";

/// An input that has to be refused.
pub(crate) struct Case {
    /// Its name, also of its folder.
    pub(crate) name: &'static str,
    /// The files of the folder; a name that ends in `/` is a folder.
    pub(crate) files: Vec<(&'static str, Vec<u8>)>,
    /// What is loaded, from the folder; empty for the folder itself.
    pub(crate) ask: &'static str,
    /// What the message has to contain: the file with the line or key, what
    /// was found, the mend.
    pub(crate) expected: &'static [&'static str],
}

impl Case {
    /// Writes the files below `root`; returns the path to load.
    pub(crate) fn write(&self, root: &Path) -> io::Result<PathBuf> {
        let folder = root.join(self.name);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder)?;
        for (name, bytes) in &self.files {
            if name.ends_with('/') {
                fs::create_dir_all(folder.join(name))?;
            } else {
                fs::write(folder.join(name), bytes)?;
            }
        }
        Ok(if self.ask.is_empty() { folder } else { folder.join(self.ask) })
    }
}

type Expected = &'static [&'static str];

fn case(
    name: &'static str,
    [event, track, recording]: [&[u8]; 3],
    expected: Expected,
) -> Case {
    let files = vec![
        ("event.toml", event.to_vec()),
        ("track.csv", track.to_vec()),
        ("recording.csv", recording.to_vec()),
    ];
    Case { name, files, ask: "", expected }
}

/// A case by what of event.toml is replaced by what.
type Edit =
    (&'static str, &'static str, &'static str, &'static [&'static str]);

fn edited((name, from, to, expected): &Edit) -> Case {
    assert!(EVENT.contains(from), "{name}: {from} is not in the event");
    let event = EVENT.replacen(from, to, 1);
    let files = [event.as_bytes(), TRACK.as_bytes(), RECORDING.as_bytes()];
    case(name, files, expected)
}

fn tracked((name, track, expected): &(&'static str, &str, Expected)) -> Case {
    let files = [EVENT.as_bytes(), track.as_bytes(), RECORDING.as_bytes()];
    case(name, files, expected)
}

fn recorded((name, text, expected): &(&'static str, &str, Expected)) -> Case {
    let files = [EVENT.as_bytes(), TRACK.as_bytes(), text.as_bytes()];
    case(name, files, expected)
}

/// All of them.
pub(crate) fn all() -> Vec<Case> {
    let mut cases: Vec<Case> = SYNTAX
        .iter()
        .chain(GROUND)
        .chain(MEASURED)
        .chain(MODEL)
        .map(edited)
        .collect();
    cases.extend(TRACKS.iter().map(tracked));
    cases.extend(RECORDINGS.iter().map(recorded));
    cases.extend(MISFITS.iter().map(unfit));
    cases.extend(odd_recordings());
    cases.extend(odd_events());
    cases.extend(ASKED.iter().map(asked));
    cases
}

const SYNTAX: &[Edit] = &[
    (
        "toml-syntax",
        "depth = 1.5",
        "depth = = 1.5",
        &["event.toml:11: is not TOML", "depth = = 1.5"],
    ),
    (
        "toml-unclosed",
        "[flow]",
        "[flow",
        &["event.toml:10: is not TOML", "expected"],
    ),
    (
        "toml-duplicate-key",
        "x = 0.0",
        "x = 0.0\nx = 1.0",
        &["event.toml:8: is not TOML", "duplicate key"],
    ),
    (
        "toml-duplicate-section",
        "[flow]",
        "[track]",
        &["event.toml:10: is not TOML", "duplicate key"],
    ),
    (
        "toml-control-characters",
        "name = \"spoilt\"",
        "name = \"\u{1b}[2Jx\"",
        &["event.toml:1: is not TOML", "\\u{1b}"],
    ),
    (
        "unknown-section",
        "[flow]",
        "[flwo]",
        &["event.toml:10: flwo is not known", "did you mean \"flow\"?"],
    ),
    (
        "unknown-key-track",
        "file = \"track.csv\"",
        "fiel = \"track.csv\"",
        &["event.toml:4: track.fiel is not known", "did you mean \"file\"?"],
    ),
    (
        "unknown-key-release",
        "velocity = 0.0",
        "speed = 0.0",
        &["event.toml:8: release.speed is not known", "\"x\" or \"velocity\""],
    ),
    (
        "unknown-key-flow",
        "depth =",
        "height =",
        &["event.toml:11: flow.height is not known", "expected \"depth\""],
    ),
    (
        "unknown-key-recording",
        "quantity",
        "quantiy",
        &[
            "event.toml:15: recording.quantiy is not known",
            "did you mean \"quantity\"?",
        ],
    ),
    (
        "unknown-key-model",
        "noise =",
        "noises =",
        &[
            "event.toml:20: model.noises is not known",
            "did you mean \"noise\"?",
        ],
    ),
    (
        "unknown-key-escaped",
        "depth =",
        "\"de\\npth\" =",
        &[
            "event.toml:11: flow.\"de\\npth\" is not known",
            "did you mean \"depth\"?",
        ],
    ),
    (
        "name-is-a-number",
        "\"spoilt\"",
        "3",
        &["event.toml:1: name is the number 3", "expected a text in quotes"],
    ),
    (
        "name-with-a-line-separator",
        "\"spoilt\"",
        "\"a\\u2028b\"",
        &["event.toml:1: name is \"a\\u{2028}b\"", "expected one line"],
    ),
    (
        "name-of-two-lines",
        "\"spoilt\"",
        "\"a\\nb\"",
        &["event.toml:1: name is \"a\\nb\"", "expected one line"],
    ),
    (
        "section-is-a-number",
        "name = \"spoilt\"\n\n[track]\nfile = \"track.csv\"",
        "track = 3",
        &["event.toml:1: track is the number 3", "write [track]"],
    ),
    (
        "section-is-a-list",
        "[flow]",
        "[[flow]]",
        &["event.toml:10: flow is a list", "write [flow]"],
    ),
];

const GROUND: &[Edit] = &[
    (
        "track-missing",
        "[track]\nfile = \"track.csv\"",
        "",
        &[
            "event.toml: track.file is missing",
            "write a line [track]",
            "slope = DEGREES",
        ],
    ),
    (
        "track-empty",
        "file = \"track.csv\"\n\n[rel",
        "[rel",
        &["event.toml:3: track.file is missing", "below [track]"],
    ),
    (
        "track-both-forms",
        "file = \"track.csv\"",
        "file = \"track.csv\"\nslope = 30",
        &[
            "event.toml:4: track.file stands beside",
            "drop file, or slope and length",
        ],
    ),
    (
        "track-slope-alone",
        "file = \"track.csv\"",
        "slope = 30",
        &["event.toml:3: track.length is missing", "length = METRES"],
    ),
    (
        "track-length-alone",
        "file = \"track.csv\"",
        "length = 300",
        &["event.toml:3: track.slope is missing", "slope = DEGREES"],
    ),
    (
        "slope-120",
        "file = \"track.csv\"",
        "slope = 120\nlength = 300",
        &["event.toml:4: track.slope: the slope is 120", "from -90"],
    ),
    (
        "slope-in-radians",
        "file = \"track.csv\"",
        "slope = 0.44\nlength = 300",
        &[
            "event.toml:4: track.slope is 0.44; expected degrees",
            "are these radians? write slope = 25.2",
        ],
    ),
    (
        // The track is too short besides, and speeds in km/h would mend that.
        "slope-in-radians-on-a-short-track",
        "file = \"track.csv\"",
        "slope = 0.44\nlength = 9",
        &[
            "event.toml:4: track.slope is 0.44; expected degrees",
            "are these radians? write slope = 25.2",
        ],
    ),
    (
        "slope-in-radians-from-a-speed",
        "file = \"track.csv\"\n\n[release]\nx = 0.0\nvelocity = 0.0",
        "slope = 0.44\nlength = 9000\n\n[release]\nx = 0.0\nvelocity = 0.2",
        &["event.toml:4: track.slope is 0.44", "write slope = 25.2"],
    ),
    (
        "depth-in-millimetres",
        "1.5",
        "1500",
        &[
            "event.toml:11: flow.depth is 1500",
            "millimetres, write depth = 1.5",
        ],
    ),
    (
        "length-negative",
        "file = \"track.csv\"",
        "slope = 30\nlength = -1",
        &[
            "event.toml:5: track.length: the track's length is -1",
            "more than 0",
        ],
    ),
    (
        "slope-is-a-text",
        "file = \"track.csv\"",
        "slope = \"30\"\nlength = 300",
        &["event.toml:4: track.slope is the text \"30\"", "expected a number"],
    ),
    (
        "origin-infinite",
        "file = \"track.csv\"",
        "file = \"track.csv\"\norigin = inf",
        &["event.toml:5: track.origin is inf", "finite"],
    ),
    (
        "track-file-missing",
        "track.csv",
        "trakc.csv",
        &[
            "event.toml:4: track.file: ",
            "trakc.csv: does not exist",
            "check the path",
        ],
    ),
    (
        "track-file-is-a-folder",
        "track.csv",
        ".",
        &["event.toml:4: track.file: ", "is a folder; expected a file"],
    ),
    (
        "track-file-is-a-number",
        "\"track.csv\"",
        "7",
        &["event.toml:4: track.file is the number 7"],
    ),
    (
        "release-off-the-track",
        "x = 0.0",
        "x = 400.5",
        &[
            "event.toml:7: release.x: x = 400.5 lies outside the track",
            "from 0 to 400",
        ],
    ),
    (
        "release-x-nan",
        "x = 0.0",
        "x = nan",
        &["event.toml:7: release.x is NaN", "finite"],
    ),
    (
        "release-velocity-negative",
        "velocity = 0.0",
        "velocity = -2",
        &["event.toml:8: release.velocity is -2", "0 or more"],
    ),
    (
        "release-velocity-huge",
        "velocity = 0.0",
        "velocity = 1e400",
        &["event.toml:8: release.velocity is inf", "finite"],
    ),
    (
        "release-velocity-true",
        "velocity = 0.0",
        "velocity = true",
        &["event.toml:8: release.velocity is true", "expected a number"],
    ),
    (
        "depth-zero",
        "1.5",
        "0",
        &["event.toml:11: flow.depth is 0", "more than 0"],
    ),
    (
        "depth-nan",
        "1.5",
        "nan",
        &["event.toml:11: flow.depth is NaN", "finite"],
    ),
    (
        "depth-is-a-date",
        "1.5",
        "2022-02-22",
        &[
            "event.toml:11: flow.depth is the date 2022-02-22",
            "expected a number",
        ],
    ),
    (
        "depth-is-hexadecimal",
        "1.5",
        "0x10",
        &["event.toml:11: flow.depth is no decimal number"],
    ),
    (
        "depth-in-quotes",
        "1.5",
        "\"1.5\"",
        &["event.toml:11: flow.depth is the text \"1.5\"", "drop the quotes"],
    ),
    (
        "depth-file-missing",
        "1.5",
        "\"depth.csv\"",
        &["event.toml:11: flow.depth", "depth.csv: does not exist"],
    ),
    (
        "depth-file-is-a-track",
        "1.5",
        "\"track.csv\"",
        &["track.csv:1: the header is \"x,z\"", "\"t,depth\"", "[m]"],
    ),
    (
        "depth-enormous",
        "1.5",
        "1e300",
        &[
            "event.toml:11: flow.depth is 1e300",
            "expected a finite number in SI units",
        ],
    ),
    (
        "never-moves-flat",
        "file = \"track.csv\"",
        "slope = 0\nlength = 300",
        &[
            "event.toml:8: release.x: the mass never moves",
            "0.0 degrees",
            "give release.velocity",
        ],
    ),
    (
        "never-moves-uphill",
        "file = \"track.csv\"",
        "slope = -5\nlength = 300",
        &["event.toml:8: release.x: the mass never moves", "-5.0 degrees"],
    ),
];

const MEASURED: &[Edit] = &[
    (
        "recording-missing",
        "[recording]\nfile = \"recording.csv\"\nquantity = \"velocity\"\nwindow = 0.0",
        "",
        &[
            "event.toml: recording.quantity is missing",
            "write a line [recording]",
        ],
    ),
    (
        "recording-file-missing-key",
        "file = \"recording.csv\"\n",
        "",
        &[
            "event.toml:13: recording.file is missing",
            "file = \"recording.csv\" below [recording]",
        ],
    ),
    (
        "recording-file-missing",
        "recording.csv",
        "speeds.csv",
        &["event.toml:14: recording.file: ", "speeds.csv: does not exist"],
    ),
    (
        "recording-below-a-file",
        "recording.csv",
        "track.csv/r.csv",
        &["event.toml:14: recording.file: ", "a part of the path is a file"],
    ),
    (
        "quantity-missing",
        "quantity = \"velocity\"\n",
        "",
        &[
            "event.toml:13: recording.quantity is missing",
            "\"velocity\", \"position\" or \"acceleration\"",
        ],
    ),
    (
        "quantity-unknown",
        "\"velocity\"",
        "\"velocty\"",
        &[
            "event.toml:15: recording.quantity is \"velocty\"",
            "did you mean \"velocity\"?",
        ],
    ),
    (
        "quantity-strange",
        "\"velocity\"",
        "\"temperature\"",
        &[
            "event.toml:15: recording.quantity is \"temperature\"",
            "convert the recording",
        ],
    ),
    (
        "quantity-is-a-list",
        "\"velocity\"",
        "[\"velocity\"]",
        &["event.toml:15: recording.quantity is a list", "expected a text"],
    ),
    (
        "quantity-not-of-the-header",
        "\"velocity\"",
        "\"position\"",
        &[
            "recording.csv:1: the header is \"t,velocity\"",
            "expected \"t,position\"",
            "change recording.quantity, which is \"position\"",
        ],
    ),
    (
        "window-negative",
        "window = 0.0",
        "window = -1",
        &["event.toml:16: recording.window: the window is -1", "0 or more"],
    ),
    (
        "window-nan",
        "window = 0.0",
        "window = nan",
        &["event.toml:16: recording.window is NaN"],
    ),
];

const MODEL: &[Edit] = &[
    (
        "friction-unknown",
        "voellmy",
        "voelmy",
        &[
            "event.toml:19: model.friction: friction \"voelmy\" is not known",
            "coulomb",
            "; did you mean \"voellmy\"?",
        ],
    ),
    (
        "friction-open-sum",
        "voellmy",
        "coulomb +",
        &["event.toml:19: model.friction: friction \"\" is not known"],
    ),
    (
        "friction-twice",
        "voellmy",
        "coulomb + coulomb",
        &[
            "event.toml:19: model.friction: the sum",
            "\"coulomb\" twice",
            "drop one",
        ],
    ),
    (
        "friction-is-a-list",
        "\"voellmy\"",
        "[\"coulomb\"]",
        &["event.toml:19: model.friction is a list"],
    ),
    (
        "noise-unknown",
        "iid",
        "idd",
        &[
            "event.toml:20: model.noise: there is no noise \"idd\"",
            "did you mean \"iid\"?",
        ],
    ),
    (
        "noise-ar-0",
        "iid",
        "ar(0)",
        &[
            "event.toml:20: model.noise: the order of \"ar\"",
            "\"0\"",
            "from 1 to",
        ],
    ),
    (
        "noise-ar-huge",
        "iid",
        "ar(99999999999999999999)",
        &["event.toml:20: model.noise: the order of \"ar\""],
    ),
    (
        "noise-ar-open",
        "iid",
        "ar(2",
        &["event.toml:20: model.noise: ", "does not close"],
    ),
    (
        "noise-control",
        "iid",
        "i\\u0007d",
        &["event.toml:20: model.noise is \"i\\u{7}d\"", "control character"],
    ),
    (
        "mechanisms-a-text",
        "noise = \"iid\"",
        "mechanisms = \"surge\"",
        &["event.toml:20: model.mechanisms is the text \"surge\"", "a list"],
    ),
    (
        "prior-impossible",
        "Gamma(9, 0.03)",
        "Gamma(-1, 2)",
        &["event.toml:23: priors.mu: ", "Gamma(-1, 2)", "shape", "above 0"],
    ),
    (
        "prior-unknown",
        "Gamma(9, 0.03)",
        "Gama(9, 2)",
        &["event.toml:23: priors.mu: ", "did you mean \"Gamma\"?"],
    ),
    (
        "prior-arguments",
        "Gamma(9, 0.03)",
        "Gamma(9)",
        &["event.toml:23: priors.mu: ", "found 1 argument, expected 2"],
    ),
    (
        "prior-bounds",
        "Gamma(9, 0.03)",
        "Uniform(2, 1)",
        &[
            "event.toml:23: priors.mu: ",
            "high of Uniform(low, high) is 1",
            "above low = 2",
        ],
    ),
    (
        "prior-nan",
        "Gamma(9, 0.03)",
        "Normal(nan, 1)",
        &["event.toml:23: priors.mu: ", "NaN", "finite"],
    ),
    (
        "prior-a-number",
        "\"Gamma(9, 0.03)\"",
        "0.3",
        &[
            "event.toml:23: priors.mu is the number 0.3",
            "expected a distribution in quotes",
        ],
    ),
    (
        "prior-empty",
        "Gamma(9, 0.03)",
        "",
        &["event.toml:23: priors.mu: ", "expected a distribution"],
    ),
    (
        "prior-two-lines",
        "Gamma(9, 0.03)",
        "Gamma(9,\\n0.03)",
        &["event.toml:23: priors.mu is \"Gamma(9,\\n0.03)\"", "one line"],
    ),
    (
        "prior-of-no-name",
        "Gamma(9, 0.03)",
        "Truncated(1, 2)",
        &[
            "event.toml:23: priors.mu: ",
            "no distribution \"Truncated\". The distributions are Normal",
        ],
    ),
    (
        "prior-of-a-part",
        "mu = \"Gamma(9, 0.03)\"",
        "coulomb.mu = \"Gamma(9)\"",
        &["event.toml:23: coulomb.mu: ", "found 1 argument"],
    ),
];

const TRACKS: &[(&str, &str, Expected)] = &[
    ("track-empty-file", "", &["track.csv: is empty", "\"x,z\""]),
    ("track-blank-file", "\n\n", &["track.csv: is empty"]),
    ("track-header-only", "x,z\n", &["track.csv: has a header and no rows"]),
    (
        "track-one-point",
        "x,z\n0,300\n",
        &["track.csv: has one point only", "at least two"],
    ),
    (
        "track-no-header",
        "0,300\n400,0\n",
        &["track.csv:1: the header is \"0,300\"", "put the header above"],
    ),
    (
        "track-wrong-header",
        "distance,z\n0,300\n400,0\n",
        &["track.csv:1: the header is \"distance,z\"", "expected \"x,z\""],
    ),
    (
        "track-units-in-header",
        "x [m],z [m]\n0,300\n400,0\n",
        &[
            "track.csv:1: the header is \"x [m],z [m]\"",
            "units are not written there",
        ],
    ),
    (
        "track-column-twice",
        "x,z,y,z\n0,300,0,1\n400,0,0,1\n",
        &["track.csv:1: the header is \"x,z,y,z\"", "has \"z\" twice"],
    ),
    (
        "track-no-elevation",
        "x,z\n0,300\n200,-9999\n400,0\n",
        &["track.csv:3: z = -9999; expected metres", "drop the points"],
    ),
    (
        "track-semicolons",
        "x;z\n0;300\n400;0\n",
        &[
            "track.csv:1: the header is \"x;z\"",
            "separate the columns by commas",
        ],
    ),
    (
        "track-comment",
        "# a track\nx,z\n0,300\n400,0\n",
        &["track.csv:1: the header is \"# a track\""],
    ),
    (
        "track-goes-back",
        "x,z\n0,300\n200,200\n150,100\n400,0\n",
        &["track.csv:4: x = 150 follows x = 200", "sort the points"],
    ),
    (
        "track-repeated-x",
        "x,z\n0,300\n0,200\n400,0\n",
        &["track.csv:3: x = 0 follows x = 0", "drop repeated ones"],
    ),
    (
        "track-word",
        "x,z\n0,300\n100,n/a\n400,0\n",
        &["track.csv:3: z is \"n/a\"", "expected a number [m]"],
    ),
    (
        "track-nan",
        "x,z\n0,300\nNaN,200\n400,0\n",
        &["track.csv:3: x is \"NaN\"", "finite"],
    ),
    (
        "track-inf",
        "x,z\n0,300\n100,-inf\n400,0\n",
        &["track.csv:3: z is \"-inf\"", "finite"],
    ),
    (
        "track-overflow",
        "x,z\n0,300\n100,1e300\n400,0\n",
        &["track.csv:3: z is 1e300", "SI units"],
    ),
    (
        "track-short-row",
        "x,z\n0,300\n100\n400,0\n",
        &["track.csv:3: has 1 cell; expected 2"],
    ),
    (
        "track-decimal-comma",
        "x,z\n0,300\n100,5,250,5\n",
        &["track.csv:3: has 4 cells; expected 2", "decimals with a point"],
    ),
    (
        "track-comment-line",
        "x,z\n0,300\n# cliff\n400,0\n",
        &["track.csv:3: has 1 cell; expected 2"],
    ),
];

const RECORDINGS: &[(&str, &str, Expected)] = &[
    (
        "recording-empty-file",
        "",
        &["recording.csv: is empty", "\"t,velocity\""],
    ),
    (
        "recording-header-only",
        "t,velocity\r\n\r\n",
        &["recording.csv: has a header and no rows"],
    ),
    (
        "recording-no-header",
        "1,2.5\n2,5\n",
        &["recording.csv:1: the header is \"1,2.5\"", "put the header above"],
    ),
    (
        "recording-misspelt-header",
        "t,velocty\n1,2.5\n",
        &[
            "recording.csv:1: the header is \"t,velocty\"",
            "did you mean \"velocity\"?",
        ],
    ),
    (
        "recording-kmh",
        "t,velocity_kmh\n1,2.5\n",
        &[
            "recording.csv:1: the header is \"t,velocity_kmh\"",
            "the values are in s, m/s",
        ],
    ),
    (
        "recording-extra-column-short-row",
        "t,note,velocity\n1,a,2.5\n2,5\n",
        &["recording.csv:3: has 2 cells; expected 3, as in the header"],
    ),
    (
        "recording-extra-column-misspelt",
        "hdop,t,velocty\n1,1,2.5\n",
        &["recording.csv:1: the header is", "did you mean \"velocity\"?"],
    ),
    (
        "recording-mark",
        "t,velocity\n1,2.5\n2,-9999\n3,7\n",
        &[
            "recording.csv:3: velocity = -9999; expected a measured value",
            "drop the rows where nothing was measured",
        ],
    ),
    (
        "recording-mark-without-a-sign",
        "t,velocity\n1,2.5\n2,999\n3,7\n",
        &[
            "recording.csv:3: velocity = 999; expected a measured value",
            "drop the rows where nothing was measured",
        ],
    ),
    (
        "recording-one-far-above",
        "t,velocity\n1,2.5\n2,5\n3,400\n",
        &["recording.csv:4: velocity = 400", "drop the rows that are no"],
    ),
    (
        "recording-sigma-mark",
        "t,velocity,sigma\n1,2.5,0.1\n2,5,1e8\n",
        &["recording.csv:3: sigma = 100000000", "drop the column sigma"],
    ),
    (
        "recording-turned",
        "t,velocity\n1,-2.5\n2,-5\n3,-7\n",
        &[
            "recording.csv:2: velocity = -2.5; expected m/s down the track",
            "change the sign of all",
        ],
    ),
    (
        "recording-one-far-below",
        "t,velocity\n1,2.5\n2,-8\n3,7\n",
        &["recording.csv:3: velocity = -8", "drop the rows"],
    ),
    (
        "recording-in-km-h",
        "t,velocity\n1,90\n2,180\n3,200\n",
        &["recording.csv:3: velocity = 180", "km/h? divide all by 3.6"],
    ),
    (
        "recording-in-milliseconds",
        "t,velocity\n1000,2.5\n2000,5\n3000,7\n4000,9\n",
        &["recording.csv:5: t = 4000; expected seconds", "divide all by 1000"],
    ),
    (
        "recording-in-few-milliseconds",
        "t,velocity\n100,2.5\n200,5\n300,7\n",
        &[
            "event.toml:14: recording.file: ",
            "or are the times milliseconds? divide them by 1000",
        ],
    ),
    (
        "recording-of-the-day",
        "t,velocity\n43201,2.5\n43202,5\n43203,7\n",
        &["recording.csv:2: t = 43201", "seconds of the day", "subtract"],
    ),
    (
        "recording-never-moves",
        "t,velocity\n1,0\n2,0\n3,0\n",
        &["recording.csv:2: velocity = 0; expected a mass that moves"],
    ),
    (
        "recording-header-escapes",
        "t,\"velo'city\n1,2\n",
        &["recording.csv:1: the header is \"t,\\\"velo'city\""],
    ),
    (
        "recording-word",
        "t,velocity\n1,fast\n",
        &["recording.csv:2: velocity is \"fast\"", "expected a number [m/s]"],
    ),
    (
        "recording-empty-cell",
        "t,velocity\n1,2.5\n2,\n",
        &["recording.csv:3: velocity is empty", "drop the row"],
    ),
    (
        "recording-nan",
        "t,velocity\n1,2.5\n2,nan\n",
        &["recording.csv:3: velocity is \"nan\"", "finite"],
    ),
    (
        "recording-infinite-time",
        "t,velocity\n1,2.5\ninf,3\n",
        &["recording.csv:3: t is \"inf\"", "finite"],
    ),
    (
        "recording-unsorted",
        "t,velocity\n1,2.5\n3,7\n2,5\n",
        &["recording.csv:4: t = 2 follows t = 3", "sort the rows"],
    ),
    (
        "recording-repeated-time",
        "t,velocity\n1,2.5\n1,2.6\n",
        &["recording.csv:3: t = 1 follows t = 1", "drop repeated ones"],
    ),
    (
        "recording-negative-time",
        "t,velocity\n-1,0\n1,2.5\n",
        &["recording.csv:2: t = -1", "0 or more"],
    ),
    (
        "recording-negative-sigma",
        "t,velocity,sigma\n1,2.5,0.1\n2,5,-0.1\n",
        &["recording.csv:3: sigma = -0.1", "0 or more"],
    ),
    (
        "recording-sigma-nan",
        "t,velocity,sigma\n1,2.5,NaN\n",
        &["recording.csv:2: sigma is \"NaN\""],
    ),
    (
        "recording-short-row",
        "t,velocity,sigma\n1,2.5,0.1\n2,5\n",
        &["recording.csv:3: has 2 cells; expected 3"],
    ),
    (
        "recording-crlf-line",
        "t,velocity\r\n1,2.5\r\n\r\n2,x\r\n",
        &["recording.csv:4: velocity is \"x\""],
    ),
    (
        "recording-longer-than-track",
        "t,velocity\n1,2.5\n100,20\n",
        &[
            "event.toml:14: recording.file: ",
            "recording.csv: the recording covers",
            "the track has only 500.0 m",
        ],
    ),
    (
        "recording-long-cell",
        LONG_CELL,
        &["recording.csv:2: velocity is \"xxxx", "x\"...; expected a number"],
    ),
];

const LONG_CELL: &str = concat!(
    "t,velocity\n1,xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx",
    "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx\n",
);

/// What the event asks of a recording that cannot give it: what of event.toml
/// is replaced by what, and the recording.
type Misfit = (Edit, &'static str);

const MISFITS: &[Misfit] = &[
    (
        (
            "start-given-twice",
            "velocity = 0.0",
            "velocity = 2",
            &[
                "event.toml:14: recording.file: ",
                "a value at t = 0",
                "release.velocity = 2",
                "drop one of them",
            ],
        ),
        "t,velocity\n0,2\n1,4\n",
    ),
    (
        (
            "position-beyond-the-track",
            "\"velocity\"",
            "\"position\"",
            &[
                "event.toml:14: recording.file: ",
                "recording.csv: the recording covers 500.5 m",
                "extend the track",
            ],
        ),
        "t,position\n1,200\n2,500.5\n",
    ),
    (
        (
            "window-on-position",
            "\"velocity\"\nwindow = 0.0",
            "\"position\"\nwindow = 2",
            &["event.toml:16: recording.window: ", "positions", "window = 0"],
        ),
        "t,position\n1,200\n2,300\n",
    ),
    (
        (
            "acceleration-in-another-unit",
            "\"velocity\"",
            "\"acceleration\"",
            &[
                "recording.csv:2: acceleration = 98.1; expected m/s2",
                "are these cm/s2? divide all by 100",
            ],
        ),
        "t,acceleration\n1,98.1\n2,98.1\n3,98.1\n",
    ),
    (
        (
            "speed-in-km-h-on-a-slope-in-radians",
            "file = \"track.csv\"",
            "slope = 0.44\nlength = 4",
            &[
                "event.toml:15: recording.file: ",
                "are the speeds km/h? divide them by 3.6",
                "if these are radians, write slope = 25.2",
            ],
        ),
        "t,velocity\n0.1,3\n0.2,6\n0.3,9\n0.4,12\n0.5,15\n0.6,18\n",
    ),
    (
        (
            "ar-2-on-uneven-times",
            "iid",
            "ar(2)",
            &[
                "event.toml:20: model.noise: ar(2) needs times on a regular \
                 grid",
                "use ar(1), or iid",
            ],
        ),
        "t,velocity\n1.013,2\n1.738,4\n3.117,5\n3.339,6\n4.904,6\n",
    ),
];

fn unfit(((name, from, to, expected), recording): &Misfit) -> Case {
    let event = EVENT.replacen(from, to, 1);
    let files = [event.as_bytes(), TRACK.as_bytes(), recording.as_bytes()];
    case(name, files, expected)
}

/// Recordings whose bytes no editor would write.
const ODD_RECORDINGS: &[(&str, &[u8], Expected)] = &[
    (
        "recording-zeros",
        &[0; 300],
        &["recording.csv:1: the line has control characters"],
    ),
    (
        "recording-not-utf-8",
        b"t,velocity\n1,2\n2,5\xb1\n",
        &["recording.csv:3: the line is not UTF-8 text"],
    ),
    (
        "recording-utf-16",
        b"\xff\xfet\0,\0v\0\n\0",
        &["recording.csv:1: the line is not UTF-8 text"],
    ),
    (
        "recording-one-endless-line",
        &[b'7'; 100_000],
        &["recording.csv:1: the line is over 1000 bytes long"],
    ),
    (
        "recording-old-mac-lines",
        b"t,velocity\r1,2\r",
        &["recording.csv:1: the line has control characters", "\\r"],
    ),
];

/// These, and some that are written here.
fn odd_recordings() -> Vec<Case> {
    let rows: String = std::iter::once("t,velocity\n".to_owned())
        .chain((1..=1_000_001).map(|i| format!("{i},0\n")))
        .collect();
    let too_many: Expected = &[
        "recording.csv:1000002: there are more than 1000000 rows",
        "thin them out",
    ];
    let binary: Expected = &["recording.csv:1: the line", "UTF-8"];
    let garbage = garbage();
    let written = [
        ("too-many-rows", rows.as_bytes(), too_many),
        ("recording-binary", &garbage, binary),
    ];
    let all = written.iter().chain(ODD_RECORDINGS);
    all.map(|(name, recording, expected)| {
        let files = [EVENT.as_bytes(), TRACK.as_bytes(), recording];
        case(name, files, expected)
    })
    .collect()
}

/// No text at all.
fn garbage() -> Vec<u8> {
    (0..5000_u32).map(|i| (i * i % 251) as u8 | 0x80).collect()
}

/// Other files that are too large, or whose bytes no editor would write.
fn odd_events() -> Vec<Case> {
    let recording = RECORDING.as_bytes();
    let odd = |name, event: &[u8], expected| {
        case(name, [event, TRACK.as_bytes(), recording], expected)
    };
    let nested = [&b"a = "[..], &[b'['; 100_000][..]].concat();
    let comments = "# nothing\n".repeat(110_000) + EVENT;
    vec![
        case(
            "track-binary",
            [EVENT.as_bytes(), &garbage(), recording],
            &["track.csv:1: the line"],
        ),
        odd(
            "event-not-utf-8",
            b"name = \"a\"\n# \xff\n",
            &["event.toml:2: is not UTF-8 text"],
        ),
        odd("event-binary", &garbage(), &["event.toml:1: is not UTF-8 text"]),
        odd(
            "event-empty",
            b"",
            &["event.toml: track.file is missing", "write a line [track]"],
        ),
        odd(
            "event-too-large",
            comments.as_bytes(),
            &["event.toml: has more than 1048576 bytes"],
        ),
        odd("event-deeply-nested", &nested, &["event.toml:1: is not TOML"]),
    ]
}

/// What is asked for: name, what is loaded, the files there are, and what the
/// message has to contain.
type Asked = (
    &'static str,
    &'static str,
    &'static [(&'static str, &'static str)],
    Expected,
);

const ASKED: &[Asked] = &[
    (
        "no-such-folder",
        "nowhere",
        &[],
        &[
            "nowhere: does not exist",
            "expected an event folder",
            "couloir new",
        ],
    ),
    (
        "no-such-file",
        "nowhere/event.toml",
        &[],
        &["nowhere/event.toml: does not exist"],
    ),
    (
        "no-event-in-folder",
        "",
        &[("track.csv", TRACK)],
        &["no-event-in-folder: has no event.toml in it", "couloir new"],
    ),
    (
        "event-is-a-folder",
        "",
        &[("event.toml/", "")],
        &["event.toml: is a folder; expected a file"],
    ),
    (
        "data-file-for-event",
        "recording.csv",
        &[("recording.csv", RECORDING)],
        &["recording.csv: is a data file", "expected an event folder"],
    ),
    (
        "no-track-file",
        "",
        &[("event.toml", EVENT), ("recording.csv", RECORDING)],
        &["event.toml:4: track.file: ", "track.csv: does not exist"],
    ),
    (
        "no-recording-file",
        "",
        &[("event.toml", EVENT), ("track.csv", TRACK)],
        &["event.toml:14: recording.file: ", "recording.csv: does not exist"],
    ),
    (
        "recording-is-a-folder",
        "event.toml",
        &[("event.toml", EVENT), ("track.csv", TRACK), ("recording.csv/", "")],
        &["event.toml:14: recording.file: ", "recording.csv: is a folder"],
    ),
    ("newline-in-the-path", "a\nb", &[], &["a\\nb\": does not exist"]),
];

fn asked((name, ask, files, expected): &Asked) -> Case {
    let bytes =
        |(n, text): &(&'static str, &str)| (*n, text.as_bytes().to_vec());
    Case { name, files: files.iter().map(bytes).collect(), ask, expected }
}
