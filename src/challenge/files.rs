//! A case as the files of an event folder: what a user would have, and no
//! word of what is hidden.

use std::fmt::Write;

use super::ground::Ground;
use super::motion::Law;

/// What the files say.
pub(super) struct Sheet<'a> {
    pub(super) name: &'a str,
    /// The surveyed track.
    pub(super) ground: &'a Ground,
    /// Where the mass is said to start \[m, horizontally\].
    pub(super) release: f64,
    /// \[m\].
    pub(super) depth: f64,
    pub(super) law: &'a Law,
    /// \[s\].
    pub(super) times: &'a [f64],
    /// Speeds \[m/s\].
    pub(super) values: &'a [f64],
    /// Whether the errors are real ones.
    pub(super) is_real: bool,
}

impl Sheet<'_> {
    /// The files by name.
    pub(super) fn files(&self) -> Vec<(&'static str, String)> {
        vec![
            ("event.toml", self.event()),
            ("track.csv", self.track()),
            ("recording.csv", self.recording()),
        ]
    }

    /// The prior of sigma2 has 90 % of its mass between 0.15 and 0.53 m/s:
    /// a user knows the instrument to a factor of two. Of real errors, which
    /// depend on one another, what is fresh in each is not known beforehand.
    fn event(&self) -> String {
        let Self { name, release, depth, .. } = self;
        let (friction, xi) = match self.law {
            Law::Coulomb { .. } => ("coulomb", ""),
            Law::Voellmy { .. } => {
                ("voellmy", "xi = \"LogNormal(6.9, 0.7)\"\n")
            }
        };
        let (noise, sigma2) = if self.is_real {
            ("ar(1)", "")
        } else {
            ("iid", "sigma2 = \"InverseGamma(2, 0.1)\"\n")
        };
        format!(
            "name = \"{name}\"\n\n\
             [track]\nfile = \"track.csv\"\n\n\
             [release]\nx = {release:.1}\nvelocity = 0.0\n\n\
             [flow]\ndepth = {depth:.2}\n\n\
             [recording]\nfile = \"recording.csv\"\n\
             quantity = \"velocity\"\nwindow = 0.0\n\n\
             [model]\nfriction = \"{friction}\"\nnoise = \"{noise}\"\n\n\
             [priors]\nmu = \"Gamma(9, 0.03)\"\n{xi}{sigma2}"
        )
    }

    fn track(&self) -> String {
        table("x,z", &self.ground.x, &self.ground.z)
    }

    fn recording(&self) -> String {
        table("t,velocity", self.times, self.values)
    }
}

fn table(header: &str, first: &[f64], second: &[f64]) -> String {
    let mut text = format!("{header}\n");
    for (a, b) in first.iter().zip(second) {
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{a:.2},{b:.3}");
    }
    text
}
