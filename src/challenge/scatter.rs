//! What the errors of a recording are like, and which noises have that
//! character.

/// Which errors the cases are drawn with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Errors {
    /// Independent and normal, as the event's file says, but where an effect
    /// is one on the errors.
    #[default]
    Simple,
    /// As real sensors have them: smooth, drifting, correlated, with
    /// outliers or growing, and the event's file says `ar(1)` of all.
    Real,
}

impl Errors {
    /// What each is called.
    pub const NAMES: [&str; 2] = ["simple", "real"];

    /// The one of a name.
    ///
    /// ```
    /// use couloir::challenge::Errors;
    /// assert_eq!(Errors::named("real"), Some(Errors::Real));
    /// assert_eq!(Errors::named("reel"), None);
    /// ```
    pub fn named(name: &str) -> Option<Self> {
        let all = [Self::Simple, Self::Real];
        Self::NAMES.iter().position(|n| *n == name).map(|i| all[i])
    }
}

/// What the errors of a recording are like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scatter {
    /// Independent, normal, and of one size.
    Independent,
    /// Each takes over a part of the one before.
    Remembering,
    /// A Matern process, with some independent errors.
    Smooth,
    /// A Matern process and a slow one of Ornstein and Uhlenbeck.
    Drifting,
    /// A process of Ornstein and Uhlenbeck, with independent errors.
    Correlated,
    /// Independent, and large ones more common than a normal law has them.
    Tailed,
    /// Independent, and larger in a part of the recording.
    Growing,
}

impl Scatter {
    pub(super) const ALL: [Self; 7] = [
        Self::Independent,
        Self::Remembering,
        Self::Smooth,
        Self::Drifting,
        Self::Correlated,
        Self::Tailed,
        Self::Growing,
    ];

    /// Those of [`Errors::Real`], as often each.
    pub(super) const REAL: [Self; 5] = [
        Self::Smooth,
        Self::Drifting,
        Self::Correlated,
        Self::Tailed,
        Self::Growing,
    ];

    /// Its name in `challenge.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Remembering => "remembering",
            Self::Smooth => "smooth",
            Self::Drifting => "smooth with drift",
            Self::Correlated => "correlated",
            Self::Tailed => "tails",
            Self::Growing => "growing",
        }
    }

    /// That of the errors which an effect on them makes of independent ones.
    pub(super) fn of_effect(effect: &str) -> Self {
        match effect {
            "ar1" => Self::Remembering,
            "heavy-tails" => Self::Tailed,
            "unequal-variance" => Self::Growing,
            _ => Self::Independent,
        }
    }

    /// Whether a noise, as event files name it, has this character.
    ///
    /// A noise is right where it has what makes the errors what they are,
    /// even if it has more: what it has beside that may be nearly nothing,
    /// and a fit with a superfluous part is as good. A process at work must
    /// be the right one, since a smooth process and a rough one tell apart a
    /// mismatch in different ways; only where every error takes over a part
    /// of the one before is any memory right, since steps as long as these
    /// hardly tell one from another.
    ///
    /// ```
    /// use couloir::challenge::Scatter;
    /// assert!(Scatter::Smooth.is_named_by("matern32 + white + tails"));
    /// assert!(!Scatter::Smooth.is_named_by("matern32 + ou"));
    /// assert!(Scatter::Correlated.is_named_by("ar(1) + white"));
    /// assert!(!Scatter::Correlated.is_named_by("ar(1)"));
    /// ```
    pub fn is_named_by(self, noise: &str) -> bool {
        let has = Parts::of(noise);
        match self {
            Self::Independent => {
                !(has.smooth || has.rough || has.tails || has.growth)
            }
            Self::Remembering => has.smooth || has.rough,
            Self::Smooth => has.smooth && !has.rough,
            Self::Drifting => has.smooth && has.rough,
            Self::Correlated => has.rough && has.white && !has.smooth,
            Self::Tailed => has.tails,
            Self::Growing => has.growth,
        }
    }
}

/// Which parts a noise has.
#[derive(Debug, Clone, Copy)]
struct Parts {
    smooth: bool,
    rough: bool,
    white: bool,
    tails: bool,
    growth: bool,
}

impl Parts {
    fn of(noise: &str) -> Self {
        let is = |names: &[&str]| {
            noise.split('+').any(|block| {
                let name = block.split('(').next().unwrap_or("").trim();
                names.contains(&name)
            })
        };
        Self {
            smooth: is(&["matern32"]),
            rough: is(&["ou", "ar"]),
            white: is(&["white"]),
            tails: is(&["tails", "student"]),
            growth: is(&["growth"]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_character_is_named_by_its_own_noise() {
        let named = [
            ("iid", Scatter::Independent),
            ("matern32 + white", Scatter::Smooth),
            ("matern32 + ou", Scatter::Drifting),
            ("ou + white", Scatter::Correlated),
            ("white + tails", Scatter::Tailed),
            ("white + growth", Scatter::Growing),
        ];
        for (noise, own) in named {
            for (_, other) in named {
                assert_eq!(other.is_named_by(noise), other == own, "{noise}");
            }
        }
        assert!(Scatter::Remembering.is_named_by("ar(1)"));
        assert!(!Scatter::Remembering.is_named_by("white + tails"));
        assert!(Scatter::Tailed.is_named_by("student"));
        assert!(!Scatter::Tailed.is_named_by(""));
    }
}
