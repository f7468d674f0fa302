//! The thresholds of the engine, each with its reason.
//!
//! docs/engine.md has the study over many events that they come from:
//! `cargo run --release --example 12_engine` makes it again.

/// How the Laplace mixture searches, learns, and is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Schedule {
    /// How many of the held places are climbed further, after one step each
    /// has said what they promise. A prior wide in two edges has about a dozen
    /// modes that count.
    pub(crate) promising: usize,
    /// From how many of these a climb of all coordinates starts.
    pub(crate) climbed: usize,
    /// Components that hold so much less than the best, in ln, are left to the
    /// prior's share: e^-10 of the posterior.
    pub(crate) negligible: f64,
    /// The most components.
    pub(crate) components: usize,
    /// Draws of a round of learning: some fifty for each coordinate.
    pub(crate) learning_draws: usize,
    /// Rounds of learning: the first ones reweight components, the later ones
    /// add some.
    pub(crate) reweighting_rounds: u64,
    /// The most rounds in all.
    pub(crate) rounds: u64,
    /// The effective share of draws at which a proposal is good, with a Pareto
    /// tail index below `tail`.
    pub(crate) good_share: f64,
    /// A tail index above which the mean of the weights has no variance worth
    /// the name (Vehtari et al. 2024: 0.7).
    pub(crate) tail: f64,
    /// How many draws are moved on to look for places that the proposal misses.
    pub(crate) moved: usize,
    /// By these draws, the effective share below which a place was missed:
    /// half of `good_share`, for a mean of few weights scatters.
    pub(crate) reached_share: f64,
    /// The standard error of ln evidence that the final draws are made for.
    pub(crate) error: f64,
    /// The fewest and the most final draws.
    pub(crate) final_draws: (usize, usize),
    /// Particles of tempering, where learning does not do.
    pub(crate) particles: usize,
}

impl Default for Schedule {
    fn default() -> Self {
        Self {
            promising: 40,
            climbed: 10,
            negligible: 10.0,
            components: 120,
            learning_draws: 500,
            reweighting_rounds: 2,
            rounds: 6,
            good_share: 0.1,
            tail: 0.7,
            moved: 200,
            reached_share: 0.05,
            error: 0.04,
            final_draws: (1000, 6000),
            particles: 1000,
        }
    }
}
