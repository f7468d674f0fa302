//! How many cases a study has, and how long they will take: said before the
//! work, and again once some of them are done.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use super::progress::Told;
use crate::infer::Progress;

/// Progress of cases that take about as long as each other.
#[derive(Debug)]
pub(super) struct Pace<'t> {
    told: &'t Told,
    begun: Instant,
    cases: u64,
    /// Of which an earlier run has answered so many.
    kept: u64,
    done: AtomicU64,
    /// After how many cases the time is told as it was measured.
    measured_at: u64,
}

impl<'t> Pace<'t> {
    /// Says what there is to do of some cases, of which an earlier run has kept
    /// so many, at so many seconds a case on one processor.
    pub(super) fn begun(
        cases: usize,
        kept: usize,
        each: f64,
        told: &'t Told,
    ) -> Self {
        let threads = rayon::current_num_threads();
        let left = cases.saturating_sub(kept);
        let seconds = each * left.div_ceil(threads) as f64;
        told.say(&format!(
            "{} to diagnose on {}, at about {each:.0} s each on one that is \
             free: about {}",
            plural(left, "case"),
            plural(threads, "processor"),
            duration(seconds)
        ));
        Self {
            told,
            begun: Instant::now(),
            cases: cases as u64,
            kept: kept as u64,
            done: AtomicU64::new(0),
            measured_at: (kept + 2 * threads) as u64,
        }
    }
}

impl Progress for Pace<'_> {
    fn begin(&self, what: &str, steps: Option<u64>) {
        self.told.begin(what, steps);
    }

    fn advance(&self, steps: u64) {
        self.told.advance(steps);
        let done = self.done.fetch_add(steps, Ordering::Relaxed) + steps;
        // A terminal has a bar, which says so all along.
        if done != self.measured_at || self.told.is_bar() || done >= self.cases
        {
            return;
        }
        let spent = self.begun.elapsed().as_secs_f64();
        let left =
            spent / (done - self.kept) as f64 * (self.cases - done) as f64;
        self.told.say(&format!(
            "{done} of {} done in {}: about {} more",
            plural(self.cases as usize, "case"),
            duration(spent),
            duration(left)
        ));
    }
}

fn plural(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A time in the unit that people would say it in.
pub(super) fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{s:.0} s"),
        s if s < 5400.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_said_as_people_say_them() {
        assert_eq!(duration(12.4), "12 s");
        assert_eq!(duration(1290.0), "22 min");
        assert_eq!(duration(9000.0), "2.5 h");
        assert_eq!(plural(1, "case"), "1 case");
    }
}
