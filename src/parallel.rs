//! Work on all cores, in order.
//!
//! rayon shares the work out, and is asked for it in one place: of each use of
//! its iterators the compiler makes some forty functions, a tenth of the
//! library.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::error::Result;

/// What comes of each item, in their order.
pub(crate) fn map<S: Send, T: Send>(
    items: impl IntoIterator<Item = S>,
    work: impl Fn(S) -> T + Sync,
) -> Vec<T> {
    let slot = |item| Mutex::new((Some(item), None));
    let slots: Vec<_> = items.into_iter().map(slot).collect();
    on_all_cores(slots.len(), &|i| {
        let mut slot = slots[i].lock().unwrap_or_else(PoisonError::into_inner);
        slot.1 = slot.0.take().map(&work);
    });
    let done = slots.into_iter().map(Mutex::into_inner);
    done.filter_map(|slot| slot.unwrap_or_else(PoisonError::into_inner).1)
        .collect()
}

/// The same of work that can fail. What has not begun when one fails is left.
///
/// # Errors
/// The failure of the first item that failed.
pub(crate) fn try_map<S: Send, T: Send>(
    items: impl IntoIterator<Item = S>,
    work: impl Fn(S) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    let failed = AtomicBool::new(false);
    let done = map(items, |item| {
        let done = (!failed.load(Relaxed)).then(|| work(item))?;
        if done.is_err() {
            failed.store(true, Relaxed);
        }
        Some(done)
    });
    done.into_iter().flatten().collect()
}

fn on_all_cores(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(work);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    #[test]
    fn the_order_is_that_of_the_items() {
        let squares = map(0..1000_u64, |i| i * i);
        assert!(squares.iter().zip(0..).all(|(square, i)| *square == i * i));
        assert_eq!(squares.len(), 1000);
    }

    #[test]
    fn items_may_be_changed_in_place_and_work_within_work() {
        let mut rows = vec![vec![1.0; 50]; 40];
        map(&mut rows, |row| map(row, |value| *value += 1.0));
        assert!(rows.concat().iter().all(|value| *value == 2.0));
    }

    #[test]
    fn a_failure_is_told_and_ends_the_work() {
        let begun = Mutex::new(0);
        let found = try_map(0..100_000, |i| {
            *begun.lock().unwrap() += 1;
            if i < 50_000 { Ok(i) } else { Err(Error::input("too large")) }
        });
        assert_eq!(found.unwrap_err().to_string(), "too large");
        assert!(*begun.lock().unwrap() < 100_000);
        assert_eq!(try_map(0..3, Ok).unwrap(), [0, 1, 2]);
    }
}
