//! What a column of a log can be, in which units, and under which names
//! columns are known.

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Role {
    Time,
    Longitude,
    Latitude,
    X,
    Y,
    Along,
    Height,
    Speed,
    GroundSpeed,
    North,
    East,
    Down,
    Satellites,
    FixType,
}

/// What is said of a role.
struct Known {
    role: Role,
    /// Its name in `--columns`.
    name: &'static str,
    /// Names of columns without units, in small letters and digits alone, the
    /// better ones first.
    columns: &'static [&'static str],
    units: &'static [(&'static str, f64)],
}

const TIMES: &[(&str, f64)] = &[
    ("s", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("min", 60.0),
    ("h", 3600.0),
    ("hh:mm:ss", 1.0),
];
const ANGLES: &[(&str, f64)] = &[("deg", 1.0), ("1e-7deg", 1e-7)];
const LENGTHS: &[(&str, f64)] =
    &[("m", 1.0), ("mm", 1e-3), ("cm", 1e-2), ("km", 1e3), ("ft", 0.3048)];
const SPEEDS: &[(&str, f64)] = &[
    ("m/s", 1.0),
    ("mm/s", 1e-3),
    ("cm/s", 1e-2),
    ("km/h", 1.0 / 3.6),
    ("kn", 1852.0 / 3600.0),
    ("mph", 1609.344 / 3600.0),
];
const COUNTS: &[(&str, f64)] = &[("1", 1.0)];

const fn known(
    role: Role,
    name: &'static str,
    columns: &'static [&'static str],
    units: &'static [(&'static str, f64)],
) -> Known {
    Known { role, name, columns, units }
}

const ROLES: [Known; 14] = [
    known(
        Role::Time,
        "time",
        &[
            "itow",
            "time",
            "t",
            "timestamp",
            "datetime",
            "utc",
            "utctime",
            "gpstime",
            "gnsstime",
            "seconds",
        ],
        TIMES,
    ),
    known(
        Role::Longitude,
        "lon",
        &["longitude", "lon", "long", "lng"],
        ANGLES,
    ),
    known(Role::Latitude, "lat", &["latitude", "lat"], ANGLES),
    known(Role::X, "x", &["x", "easting", "e"], LENGTHS),
    known(Role::Y, "y", &["y", "northing", "n"], LENGTHS),
    known(
        Role::Along,
        "along",
        &["along", "s", "distance", "chainage", "station"],
        LENGTHS,
    ),
    known(
        Role::Height,
        "height",
        &["height", "hmsl", "altitude", "alt", "elevation", "ele", "z", "h"],
        LENGTHS,
    ),
    known(
        Role::Speed,
        "speed",
        &["speed", "velocity", "v", "speed3d"],
        SPEEDS,
    ),
    known(
        Role::GroundSpeed,
        "ground-speed",
        &["gspeed", "groundspeed", "speed2d", "sog"],
        SPEEDS,
    ),
    known(Role::North, "vel-north", &["veln", "vn"], SPEEDS),
    known(Role::East, "vel-east", &["vele", "ve"], SPEEDS),
    known(Role::Down, "vel-down", &["veld", "vd"], SPEEDS),
    known(
        Role::Satellites,
        "satellites",
        &["numsv", "satellites", "sats", "numsat", "nsat"],
        COUNTS,
    ),
    known(Role::FixType, "fix", &["fixtype", "fix"], COUNTS),
];

impl Role {
    /// All of them.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        ROLES.iter().map(|known| known.role)
    }

    /// The names that `--columns` takes.
    pub(super) fn names() -> Vec<&'static str> {
        ROLES.iter().map(|known| known.name).collect()
    }

    pub(super) fn named(name: &str) -> Option<Self> {
        let mut found = ROLES.iter().filter(|known| known.name == name);
        found.next().map(|known| known.role)
    }

    fn known(self) -> &'static Known {
        // Every role has its row; the first stands in for the compiler.
        let mut found = ROLES.iter().filter(|known| known.role == self);
        found.next().unwrap_or(&ROLES[0])
    }

    pub(super) fn name(self) -> &'static str {
        self.known().name
    }

    /// The names under which its columns are known, the better ones first.
    pub(super) fn columns(self) -> &'static [&'static str] {
        self.known().columns
    }

    /// The units that its values may have; the first one is taken where none
    /// is named.
    pub(super) fn units(self) -> Vec<&'static str> {
        self.known().units.iter().map(|unit| unit.0).collect()
    }

    /// How many of the first unit one of this unit is.
    pub(super) fn factor(self, unit: &str) -> Option<f64> {
        let unit = unit.trim().replace([' ', '^', '*', '·'], "");
        let unit = match unit.as_str() {
            "mps" | "ms-1" | "m/sec" | "M/S" => "m/s",
            "kmh" | "kph" | "km/hr" | "kmh-1" | "KM/H" => "km/h",
            "°" | "degrees" | "deg." => "deg",
            "sec" | "seconds" => "s",
            "knots" | "kt" => "kn",
            "µs" => "us",
            "hh:mm" | "UTC" | "utc" => "hh:mm:ss",
            other => other,
        };
        let known = self.known().units;
        if known == COUNTS {
            // Whatever a header says there: fixType[0-5].
            return Some(1.0);
        }
        let mut units = known.iter();
        units.find(|known| known.0 == unit).map(|known| known.1)
    }

    /// Those of which a log needs one kind only.
    pub(super) fn rivals(self) -> &'static [Self] {
        match self {
            Self::Speed
            | Self::GroundSpeed
            | Self::North
            | Self::East
            | Self::Down => &[
                Self::Speed,
                Self::GroundSpeed,
                Self::North,
                Self::East,
                Self::Down,
            ],
            Self::Longitude
            | Self::Latitude
            | Self::X
            | Self::Y
            | Self::Along => &[
                Self::Longitude,
                Self::Latitude,
                Self::X,
                Self::Y,
                Self::Along,
            ],
            _ => &[],
        }
    }
}
