//! From a state and its rates to the states at given times.

use std::cell::Cell;

use nalgebra::allocator::Allocator;
use nalgebra::{DVector, DefaultAllocator, Dim, OVector, SVector};
use ode_solvers::{Dopri5, OutputType, System};

use super::state::{Spread, gathered, write};
use crate::error::{Error, Stop};
use crate::scalar::{Kind, Real};

/// The states at `times`, in ascending order, of the system y' = rate(t, y)
/// that starts with a state at a time not after them; with the errors of
/// [`Solver::default`].
///
/// # Errors
/// [`Stop::Reject`] where the equations cannot be solved that far, and
/// [`Stop::Fail`] where the times are not in order.
///
/// ```
/// use couloir::ode;
/// use couloir::scalar::{Grad, Real};
/// // y' = -k y, y(0) = 1: y = exp(-k t), and dy/dk = -t y.
/// let k = Real::<Grad<1>>::variable(0.5, 0);
/// let start = (0.0, [Real::new(1.0)]);
/// let [[y]] = ode::solve(|_, [y]| [-k * y], start, &[2.0])?[..] else {
///     unreachable!("one time, one state")
/// };
/// let exact = (-1.0_f64).exp();
/// assert!((y.value() - exact).abs() < 1e-7);
/// assert!((y.partial(0) + 2.0 * exact).abs() < 1e-7);
/// # Ok::<(), couloir::error::Stop>(())
/// ```
pub fn solve<K: Kind, const N: usize>(
    rate: impl Fn(f64, [Real<K>; N]) -> [Real<K>; N],
    start: (f64, [Real<K>; N]),
    times: &[f64],
) -> Result<Vec<[Real<K>; N]>, Stop> {
    Solver::default().solve(rate, start, times)
}

/// How exactly a system is solved: in each step the error of a number y, or
/// of a derivative, may be `absolute + relative |y|`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solver {
    relative: f64,
    absolute: f64,
}

impl Default for Solver {
    /// 1e-8 of each number, and 1e-8.
    fn default() -> Self {
        Self { relative: 1e-8, absolute: 1e-8 }
    }
}

/// The most steps from one time to the next.
const MOST_STEPS: u32 = 10_000;

const UNSOLVED: Stop = Stop::Reject(
    "a system of differential equations could not be solved: its rates are \
     not finite, or it is too stiff",
);

impl Solver {
    /// With other errors, each above 0.
    ///
    /// # Errors
    /// Others.
    pub fn within(relative: f64, absolute: f64) -> Result<Self, Error> {
        for (name, value) in [("relative", relative), ("absolute", absolute)] {
            if !(value > 0.0 && value < 1.0) {
                return Err(Error::input(format!(
                    "the {name} error of a solver is {value}; expected a \
                     number between 0 and 1, such as 1e-8"
                )));
            }
        }
        Ok(Self { relative, absolute })
    }

    /// As [`solve`].
    ///
    /// # Errors
    /// As [`solve`].
    pub fn solve<K: Kind, const N: usize>(
        &self,
        rate: impl Fn(f64, [Real<K>; N]) -> [Real<K>; N],
        start: (f64, [Real<K>; N]),
        times: &[f64],
    ) -> Result<Vec<[Real<K>; N]>, Stop> {
        match K::DIRECTIONS {
            // Of so many numbers, known when compiled, none is on the heap.
            0 => self.walk(rate, start, times, SVector::<f64, N>::zeros()),
            n => {
                let state = DVector::zeros(N * (1 + n));
                self.walk(rate, start, times, state)
            }
        }
    }

    /// From time to time; the last argument is room for the state.
    fn walk<K: Kind, D: Dim, const N: usize>(
        &self,
        rate: impl Fn(f64, [Real<K>; N]) -> [Real<K>; N],
        (mut now, start): (f64, [Real<K>; N]),
        times: &[f64],
        mut state: OVector<f64, D>,
    ) -> Result<Vec<[Real<K>; N]>, Stop>
    where
        DefaultAllocator: Allocator<D>,
    {
        write(&start, state.as_mut_slice());
        let mut states = Vec::with_capacity(times.len());
        for (i, &time) in times.iter().enumerate() {
            if !(time >= now && time.is_finite()) {
                return Err(out_of_order(i, time, now));
            }
            if time > now {
                let failed = Cell::new(false);
                let right = Spread::<_, K, N>::new(&rate, &failed);
                state = self.step(right, (now, time), state)?;
                if failed.get() || !state.iter().all(|x| x.is_finite()) {
                    return Err(UNSOLVED);
                }
                now = time;
            }
            states.push(gathered(state.as_slice()));
        }
        Ok(states)
    }

    /// From one time to another. The factors are those that ode_solvers
    /// chooses by itself. Its Dop853, which would take fewer steps, has two
    /// stages at the beginning of a step that belong to its end (0.6.2), which
    /// spoils rates that depend on time.
    fn step<D: Dim>(
        &self,
        right: impl System<f64, OVector<f64, D>>,
        (from, to): (f64, f64),
        state: OVector<f64, D>,
    ) -> Result<OVector<f64, D>, Stop>
    where
        DefaultAllocator: Allocator<D>,
    {
        let mut steps = Dopri5::from_param(
            right,
            from,
            to,
            to - from,
            state,
            self.relative,
            self.absolute,
            0.9,
            0.04,
            0.2,
            10.0,
            to - from,
            0.0,
            MOST_STEPS,
            1000,
            OutputType::Sparse,
        );
        steps.integrate().map_err(|_| UNSOLVED)?;
        steps.y_out().last().cloned().ok_or(UNSOLVED)
    }
}

#[cold]
fn out_of_order(index: usize, time: f64, before: f64) -> Stop {
    Stop::Fail(Error::input(format!(
        "time {} of a system of differential equations is {time}, and the \
         one before it {before}; expected times in ascending order from the \
         start on",
        index + 1
    )))
}
