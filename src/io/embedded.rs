//! A real recording that the program carries: a car coasting uphill.

use std::fmt::Write as _;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use super::event_file::{EventFile, parse_event};
use crate::error::Result;
use crate::physics::friction::Laws;

/// What messages and reports call the event's file.
pub(super) const PLACE: &str = "coastdown (built in)";

/// The event. By the report's drag coefficient the air takes 2.1e-4 u^2
/// \[m/s2\], so that xi h is g / 2.1e-4 = 4.7e4 m2/s2; the prior of xi has
/// its median at 2e4 and leaves a factor of seven either way.
pub(super) const EVENT: &str = r#"
# 69 measured speeds from the course report "MeEn 335 Car Coast Down",
# repository timothy-commins/system-dynamics-car-coasting-lab. The report
# gives: slope 1.03 degrees, mass 1910 kg, frontal area 2.15 m2, air density
# 1.06 kg/m3, head wind 3.1 m/s; its own fit: rolling resistance 0.0079, drag
# coefficient 0.348.
name = "Passenger car coasting uphill"

[track]
slope = -1.03
length = 4000.0

[release]
x = 0.0
velocity = 36.15

[flow]
depth = 1.0     # no flow depth here: xi stands for the product xi h

[recording]
file = "recording.csv"
quantity = "velocity"

[model]
friction = "coulomb + turbulent"
noise = "iid"

[priors]
mu = "Gamma(2, 0.02)"
xi = "LogNormal(9.9, 1)"
sigma2 = "InverseGamma(2, 0.02)"
"#;

/// Time [s] and speed [m/s] as measured.
const SPEEDS: [(f64, f64); 69] = [
    (0.99, 35.57),
    (1.994, 34.93),
    (2.976, 34.39),
    (3.974, 33.8),
    (4.973, 33.3),
    (5.976, 32.76),
    (6.985, 32.16),
    (7.985, 31.81),
    (8.984, 31.25),
    (9.988, 30.95),
    (11.0, 30.15),
    (11.989, 29.81),
    (12.984, 29.23),
    (13.993, 28.98),
    (14.984, 28.39),
    (15.983, 27.97),
    (16.987, 27.45),
    (17.987, 27.15),
    (18.991, 26.68),
    (19.982, 26.29),
    (20.995, 25.87),
    (21.993, 25.31),
    (22.995, 25.01),
    (23.993, 24.57),
    (24.99, 24.17),
    (25.995, 23.7),
    (26.982, 23.38),
    (27.99, 22.94),
    (28.991, 22.39),
    (30.004, 22.1),
    (30.985, 21.65),
    (31.986, 21.23),
    (32.995, 21.02),
    (33.997, 20.42),
    (34.989, 20.12),
    (35.988, 19.77),
    (36.983, 19.58),
    (37.997, 19.08),
    (38.981, 18.75),
    (39.986, 18.41),
    (40.993, 17.99),
    (41.982, 17.69),
    (42.977, 17.37),
    (43.988, 16.96),
    (45.0, 16.69),
    (45.979, 16.38),
    (46.988, 16.01),
    (47.998, 15.69),
    (48.975, 15.41),
    (49.984, 14.98),
    (50.978, 14.72),
    (51.996, 14.44),
    (52.989, 14.13),
    (54.001, 13.73),
    (54.987, 13.5),
    (55.984, 13.14),
    (56.997, 12.91),
    (57.999, 12.62),
    (58.996, 12.23),
    (59.998, 12.03),
    (60.985, 11.6),
    (61.983, 11.41),
    (62.979, 11.02),
    (63.985, 10.73),
    (64.995, 10.55),
    (65.977, 10.21),
    (66.985, 10.02),
    (68.017, 9.59),
    (69.015, 9.46),
];

/// The coast-down of a passenger car on a slope of 1.03 degrees uphill: 69
/// measured speeds, with rolling resistance and the drag of the air as
/// "coulomb + turbulent".
///
/// Source: the course report "MeEn 335 Car Coast Down", repository
/// timothy-commins/system-dynamics-car-coasting-lab.
///
/// ```
/// use couloir::physics::friction::Laws;
/// let file = couloir::io::coastdown(&Laws::default())?;
/// assert_eq!(file.event.velocity.len(), 69);
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// Laws among which there is no "coulomb" or no "turbulent".
pub fn coastdown(laws: &Laws) -> Result<EventFile> {
    let open = |name: &str| {
        let place = PathBuf::from(format!("{name} of {PLACE}"));
        Ok((Cursor::new(recording()), place))
    };
    parse_event(EVENT, Path::new(PLACE), open, laws)
}

/// The speeds as a data file has them.
pub(super) fn recording() -> String {
    let mut text = String::from("t,velocity\n");
    for (t, v) in SPEEDS {
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{t},{v}");
    }
    text
}
