//! The thresholds of the engine, each with its reason.
//!
//! docs/record/thresholds.md has what others do, and docs/engine.md a study of
//! six events that they are held against:
//! `cargo run --release --example 13_evidence_repeats` makes it again.

/// How the Laplace mixture searches, learns, and is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Schedule {
    /// How many of the held places, none next to another, are climbed further
    /// after one step each has said what they promise.
    pub(crate) promising: usize,
    /// From how many of these a climb of all coordinates starts, at the most;
    /// it is a quarter of all places, or eight. Most end soon at a peak that
    /// is known.
    pub(crate) climbed: usize,
    /// How many places beside those that hold most are looked at, at the most.
    pub(crate) surveyed: usize,
    /// From how many of the highest peaks profiles are made, and how far below
    /// the highest these may be, in ln.
    pub(crate) profiled: usize,
    pub(crate) profiled_below: f64,
    /// Components that hold so much less than the best, in ln, are left to the
    /// prior's share: e^-10 of the posterior.
    pub(crate) negligible: f64,
    /// The most components.
    pub(crate) components: usize,
    /// Draws of the first rounds, some fifty for each coordinate, and how many
    /// such rounds there are: they reweight components.
    pub(crate) learning_draws: usize,
    pub(crate) reweighting_rounds: u64,
    /// Draws of the later rounds, which add components and judge whether the
    /// proposal is good, and the most rounds in all.
    pub(crate) judging_draws: usize,
    pub(crate) rounds: u64,
    /// Before which round a good proposal still gets components where single
    /// draws weigh much: not where the density is rough.
    pub(crate) mended_until: u64,
    /// The effective share of draws at which a proposal is good, with a Pareto
    /// tail index below 0.7: above it the mean of the weights has no variance
    /// worth the name (Vehtari et al. 2024).
    pub(crate) good_share: f64,
    /// The share at which it is good with an index below 1: of few draws the
    /// index scatters by 0.2.
    pub(crate) ample_share: f64,
    /// How often fresh draws are made, when the first say that a weight is
    /// missed which those before did not.
    pub(crate) estimates: u64,
    /// How often a sharp estimate whose weights would have to be warned of mends
    /// its proposal and is made again, from fresh draws.
    pub(crate) mendings: u64,
    /// How many draws are moved on to look for places that the proposal misses.
    pub(crate) moved: usize,
    /// By these draws, an effective share at which nothing was missed, whatever
    /// the share by the proposal's own draws is.
    pub(crate) reached_share: f64,
    /// The standard error of ln evidence that the final draws are made for.
    pub(crate) error: f64,
    /// The fewest and the most final draws.
    pub(crate) final_draws: (usize, usize),
    /// Particles of tempering, where learning does not do.
    pub(crate) particles: usize,
}

impl Schedule {
    /// A quick search: it says whether a thorough one is worth it, or begins
    /// where one has led.
    pub(crate) fn quick() -> Self {
        Self {
            promising: 16,
            surveyed: 48,
            climbed: 6,
            profiled: 1,
            components: 60,
            ..Self::default()
        }
    }

    /// How many draws a round has.
    pub(crate) fn draws(&self, round: u64) -> usize {
        if round < self.reweighting_rounds {
            self.learning_draws
        } else {
            self.judging_draws
        }
    }

    /// Whether fresh draws of such an effective share and tail index make an
    /// estimate: half of what judging asks for, since they were not chosen.
    pub(crate) fn does(&self, (share, tail): (f64, f64)) -> bool {
        self.is_good((2.0 * share, tail.min(tail - 0.1)))
    }

    /// Whether weights of such an effective share and tail index are good.
    pub(crate) fn is_good(&self, (share, tail): (f64, f64)) -> bool {
        (share > self.good_share && tail < 0.7)
            || (share > self.ample_share.max(self.good_share) && tail < 1.0)
    }
}

impl Default for Schedule {
    fn default() -> Self {
        Self {
            promising: 80,
            surveyed: 200,
            climbed: 40,
            profiled: 4,
            profiled_below: 4.0,
            negligible: 10.0,
            components: 100,
            learning_draws: 600,
            reweighting_rounds: 2,
            judging_draws: 2000,
            rounds: 7,
            mended_until: 0,
            good_share: 0.03,
            ample_share: 0.1,
            estimates: 2,
            mendings: 3,
            moved: 400,
            reached_share: 0.05,
            error: 0.045,
            final_draws: (1000, 16_000),
            particles: 800,
        }
    }
}
