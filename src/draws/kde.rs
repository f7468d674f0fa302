//! Smooth densities of draws, for figures of marginals.

use std::f64::consts::PI;

use super::quantile::{quantile, sorted};
use super::spectrum::variance;

/// How far the Gaussian kernel reaches, in bandwidths; what lies beyond is
/// 2e-9 of its mass.
const REACH: f64 = 6.0;

/// Bins to a bandwidth. Linear binning changes a density by about
/// f'' (h / 10)^2 / 6, a three hundredth of the kernel's own bias.
const FINENESS: f64 = 10.0;

/// The most bins, which bounds the work for draws with far outliers.
const MOST_BINS: usize = 1 << 18;

/// Where a parameter can lie, in its own unit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Support {
    /// The lower bound, where there is one.
    pub lower: Option<f64>,
    /// The upper bound, where there is one.
    pub upper: Option<f64>,
}

impl Support {
    fn contains(&self, x: f64) -> bool {
        self.lower.is_none_or(|bound| x >= bound)
            && self.upper.is_none_or(|bound| x <= bound)
    }
}

/// A density on an even grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Density {
    /// Where the density is known, rising, in the parameter's unit.
    pub grid: Vec<f64>,
    /// The density there, per unit of the parameter.
    pub density: Vec<f64>,
    /// The standard deviation of the kernel, in the parameter's unit.
    pub bandwidth: f64,
}

/// The density of draws on `points` even points from three bandwidths below
/// the least draw to three above the greatest, cut at the bounds.
///
/// The kernel has the [`bandwidth`] of the draws and is reflected at bounds,
/// so that the mass within them is 1. Draws fall into bins first: the cost is
/// linear in their number.
///
/// Nothing below two points, for draws outside the support, and where there
/// is no bandwidth.
///
/// ```
/// use couloir::draws::{Support, density};
/// let draws: Vec<f64> = (0..200).map(|i| (i as f64 + 0.5) / 200.0).collect();
/// let unit = Support { lower: Some(0.0), upper: Some(1.0) };
/// let found = density(&draws, unit, 5).expect("a spread of draws");
/// assert_eq!((found.grid[0], found.grid[4]), (0.0, 1.0));
/// assert!(found.density.iter().all(|d| (d - 1.0).abs() < 0.02));
/// ```
pub fn density(
    draws: &[f64],
    support: Support,
    points: usize,
) -> Option<Density> {
    let draws = sorted(draws.to_vec());
    let bandwidth = bandwidth_of_sorted(&draws)?;
    let least = draws.first()? - 3.0 * bandwidth;
    let greatest = draws.last()? + 3.0 * bandwidth;
    let from = support.lower.map_or(least, |bound| least.max(bound));
    let to = support.upper.map_or(greatest, |bound| greatest.min(bound));
    if points < 2 {
        return None;
    }
    let at = |i: usize| {
        let share = i as f64 / (points - 1) as f64;
        (1.0 - share) * from + share * to
    };
    let grid: Vec<f64> = (0..points).map(at).collect();
    let density = density_at(&draws, support, bandwidth, &grid)?;
    Some(Density { grid, density, bandwidth })
}

/// The density of draws at the points of `grid`, with a kernel of given
/// standard deviation; 0 outside the support.
///
/// Nothing for no draws, non-finite ones or ones outside the support, and for
/// a bandwidth that is not positive and finite.
fn density_at(
    draws: &[f64],
    support: Support,
    bandwidth: f64,
    grid: &[f64],
) -> Option<Vec<f64>> {
    let proper = |x: &f64| x.is_finite() && support.contains(*x);
    let usable = bandwidth > 0.0 && bandwidth.is_finite();
    if !usable || !draws.iter().all(proper) {
        return None;
    }
    let bins = Bins::new(draws, bandwidth / FINENESS, MOST_BINS)?;
    let of = |x: &f64| {
        if !support.contains(*x) {
            return 0.0;
        }
        let image = |bound: Option<f64>| {
            bound.map_or(0.0, |b| bins.smooth(2.0 * b - x, bandwidth))
        };
        bins.smooth(*x, bandwidth)
            + image(support.lower)
            + image(support.upper)
    };
    Some(grid.iter().map(of).collect())
}

/// The bandwidth of Sheather & Jones (1991), "A reliable data-based bandwidth
/// selection method for kernel density estimation", JRSS B 53(3), in its
/// direct plug-in form (Wand & Jones 1995).
///
/// It estimates the roughness of the density instead of taking the normal
/// distribution's and so copes with skew and with several modes. The scale
/// that starts it is the lesser of standard deviation and interquartile range
/// over 1.349. Where the roughness comes out as not positive (few draws, most
/// of them tied) Silverman's 0.9 scale n^(-1/5) takes its place.
///
/// Draws are taken as independent; correlated ones are smoothed a little
/// less than their effective number asks for.
///
/// Nothing below two draws, for constants and for non-finite draws.
pub fn bandwidth(draws: &[f64]) -> Option<f64> {
    bandwidth_of_sorted(&sorted(draws.to_vec()))
}

/// The same of draws in rising order.
fn bandwidth_of_sorted(draws: &[f64]) -> Option<f64> {
    if !draws.iter().all(|x| x.is_finite()) {
        return None;
    }
    let range = draws.last()? - draws.first()?;
    let n = draws.len() as f64;
    let sd = variance(draws).sqrt();
    let middle = (quantile(draws, 0.75) - quantile(draws, 0.25)) / 1.349;
    let scale = if middle > 0.0 { sd.min(middle) } else { sd };
    let silverman = 0.9 * scale * n.powf(-0.2);
    let proper = range > 0.0 && silverman > 0.0 && silverman.is_finite();
    if !proper {
        return None;
    }
    let plugged_in = plug_in(draws, scale).filter(|h| h.is_finite());
    Some(plugged_in.unwrap_or(silverman))
}

/// Two stages: the bandwidth best for the sixth-order functional of a normal
/// density, with it the functional, from that the bandwidth best for the
/// fourth-order one, and from that the bandwidth itself.
fn plug_in(draws: &[f64], scale: f64) -> Option<f64> {
    let n = draws.len() as f64;
    let first =
        scale * (32.0 * 30.0 / (105.0 * 2.0_f64.sqrt() * n)).powf(1.0 / 9.0);
    // The second pilot is of the first's order, or half of it for several
    // modes, so these bins are fine enough for both.
    let bins = Bins::new(draws, first / 50.0, 1 << 16)?;
    let sixth = |t: f64| ((t - 15.0) * t + 45.0) * t - 15.0;
    let fourth = |t: f64| (t - 6.0) * t + 3.0;
    let third = -bins.functional(first, 7, sixth);
    let second = (6.0 / ((2.0 * PI).sqrt() * third * n)).powf(1.0 / 7.0);
    let roughness = bins.functional(second, 5, fourth);
    let bandwidth = (1.0 / (2.0 * PI.sqrt() * n * roughness)).powf(0.2);
    (third > 0.0 && roughness > 0.0).then_some(bandwidth)
}

/// Draws as masses on even points, each split between its two neighbours.
struct Bins {
    from: f64,
    width: f64,
    /// In units of draws.
    masses: Vec<f64>,
    draws: f64,
}

impl Bins {
    /// Bins of at most `width`, unless more than `most` would be needed.
    fn new(draws: &[f64], width: f64, most: usize) -> Option<Self> {
        let from = draws.iter().copied().reduce(f64::min)?;
        let to = draws.iter().copied().reduce(f64::max)?;
        let cells = ((to - from) / width).ceil().clamp(1.0, most as f64);
        let width = if to > from { (to - from) / cells } else { width };
        if !(width > 0.0 && width.is_finite()) {
            return None;
        }
        let cells = cells as usize;
        let mut masses = vec![0.0; cells + 1];
        for x in draws {
            let place = (x - from) / width;
            let cell = (place as usize).min(cells - 1);
            let share = (place - cell as f64).clamp(0.0, 1.0);
            masses[cell] += 1.0 - share;
            masses[cell + 1] += share;
        }
        Some(Self { from, width, masses, draws: draws.len() as f64 })
    }

    /// The kernel density at `x`.
    fn smooth(&self, x: f64, bandwidth: f64) -> f64 {
        let place = (x - self.from) / self.width;
        let reach = REACH * bandwidth / self.width;
        let first = (place - reach).ceil().max(0.0) as usize;
        let end = (place + reach).floor() + 1.0;
        let end = (end.max(0.0) as usize).min(self.masses.len());
        let near = self.masses.get(first..end).unwrap_or(&[]);
        let kernel = |(i, mass): (usize, &f64)| {
            let t = ((first + i) as f64 - place) * self.width / bandwidth;
            mass * (-0.5 * t * t).exp()
        };
        let sum: f64 = near.iter().enumerate().map(kernel).sum();
        sum / (self.draws * bandwidth * (2.0 * PI).sqrt())
    }

    /// The mean over pairs of draws of a derivative of the kernel of standard
    /// deviation `g`: `hermite` gives its polynomial as a function of the
    /// squared distance, `order` the power of `g`.
    fn functional(
        &self,
        g: f64,
        order: i32,
        hermite: impl Fn(f64) -> f64,
    ) -> f64 {
        // Derivatives reach further than the kernel; at 9 they are 1e-13.
        let reach = (9.0 * g / self.width) as usize;
        let reach = reach.min(self.masses.len() - 1);
        let pairs = |lag: usize| {
            let shifted = &self.masses[lag..];
            self.masses.iter().zip(shifted).map(|(a, b)| a * b).sum::<f64>()
        };
        let weight = |lag: usize| {
            let t = lag as f64 * self.width / g;
            hermite(t * t) * (-0.5 * t * t).exp()
        };
        let apart: f64 = (1..=reach).map(|l| pairs(l) * weight(l)).sum();
        let together = pairs(0) * weight(0);
        let count = self.draws * (self.draws - 1.0);
        (together + 2.0 * apart) / (count * g.powi(order) * (2.0 * PI).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::sample;
    use statrs::distribution::{Continuous, ContinuousCDF, Exp, Normal};

    /// Velocities of 82 galaxies in 1000 km/s (Roeder 1990, JASA 85).
    const GALAXIES: [f64; 82] = [
        9.172, 9.350, 9.483, 9.558, 9.775, 10.227, 10.406, 16.084, 16.170,
        18.419, 18.552, 18.600, 18.927, 19.052, 19.070, 19.330, 19.343,
        19.349, 19.440, 19.473, 19.529, 19.541, 19.547, 19.663, 19.846,
        19.856, 19.863, 19.914, 19.918, 19.973, 19.989, 20.166, 20.175,
        20.179, 20.196, 20.215, 20.221, 20.415, 20.629, 20.795, 20.821,
        20.846, 20.875, 20.986, 21.137, 21.492, 21.701, 21.814, 21.921,
        21.960, 22.185, 22.209, 22.242, 22.249, 22.314, 22.374, 22.495,
        22.746, 22.747, 22.888, 22.914, 23.206, 23.241, 23.263, 23.484,
        23.538, 23.542, 23.666, 23.706, 23.711, 24.129, 24.285, 24.289,
        24.366, 24.717, 24.990, 25.633, 26.960, 26.995, 32.065, 32.789,
        34.279,
    ];

    const NO_BOUND: Support = Support { lower: None, upper: None };

    /// The `n` mid-quantiles of a distribution.
    fn quantiles(n: usize, law: &impl ContinuousCDF<f64, f64>) -> Vec<f64> {
        let at = |i| law.inverse_cdf((i as f64 + 0.5) / n as f64);
        (0..n).map(at).collect()
    }

    /// The integral of a density by the trapezoidal rule.
    fn mass(found: &Density) -> f64 {
        let step = found.grid[1] - found.grid[0];
        let ends = found.density[0] + found.density.last().unwrap();
        (found.density.iter().sum::<f64>() - 0.5 * ends) * step
    }

    #[test]
    fn bandwidth_agrees_with_the_double_sum() {
        // The defining sums over all pairs, by numpy 2.4.6. Binning at a
        // fiftieth of the pilot bandwidth costs a few 1e-4.
        let found = bandwidth(&GALAXIES).unwrap();
        sample::close(found, 0.8112607664436916, 1e-3);
    }

    #[test]
    fn bandwidth_of_a_normal_is_the_best_one() {
        // (4 / 3n)^(1/5) sigma minimises the mean integrated squared error
        // in the limit; the plug-in is within some percent at this n.
        let n = 20_000;
        let draws = quantiles(n, &Normal::standard());
        let best = (4.0 / (3.0 * n as f64)).powf(0.2);
        sample::close(bandwidth(&draws).unwrap(), best, 0.05);
    }

    #[test]
    fn smoothing_a_normal_adds_variances() {
        let law = Normal::standard();
        let draws = quantiles(20_000, &law);
        let found = density(&draws, NO_BOUND, 201).unwrap();
        let wide = Normal::new(0.0, 1.0_f64.hypot(found.bandwidth)).unwrap();
        for (x, d) in found.grid.iter().zip(&found.density) {
            // Quantiles represent the tails to 1 / n, bins the rest.
            assert!((d - wide.pdf(*x)).abs() < 2e-4, "{x} {d}");
        }
        assert!((mass(&found) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn bins_agree_with_the_sum_over_draws() {
        let grid = [9.0, 15.5, 20.0, 21.3, 40.0];
        let found = density_at(&GALAXIES, NO_BOUND, 0.8, &grid).unwrap();
        for (x, d) in grid.iter().zip(found) {
            let kernel = Normal::new(*x, 0.8).unwrap();
            let sum: f64 = GALAXIES.iter().map(|g| kernel.pdf(*g)).sum();
            // Linear binning at h / 10: see FINENESS.
            assert!((d - sum / 82.0).abs() < 2e-4, "{x} {d}");
        }
    }

    #[test]
    fn reflection_keeps_the_edge_and_the_mass() {
        let draws = quantiles(5_000, &Exp::new(1.0).unwrap());
        let positive = Support { lower: Some(0.0), upper: None };
        let found = density(&draws, positive, 400).unwrap();
        assert_eq!(found.grid[0], 0.0);
        // At the bound a reflected kernel has bias f' h sqrt(2 / pi).
        let bias = found.bandwidth * (2.0 / PI).sqrt();
        assert!((found.density[0] - (1.0 - bias)).abs() < 0.02);
        assert!((mass(&found) - 1.0).abs() < 2e-3);
        let open = density_at(&draws, NO_BOUND, 0.1, &[0.0]).unwrap();
        let closed = density_at(&draws, positive, 0.1, &[0.0, -0.1]).unwrap();
        sample::close(closed[0], 2.0 * open[0], 1e-12);
        assert_eq!(closed[1], 0.0);
    }

    #[test]
    fn outliers_and_ties_do_no_harm() {
        let mut draws = quantiles(1_000, &Normal::standard());
        draws.push(1e12);
        let found = bandwidth(&draws).unwrap();
        assert!(found > 0.0 && found.is_finite());
        assert!(density(&draws, NO_BOUND, 50).is_some());
        let mut tied = vec![1.0; 100];
        tied.push(2.0);
        assert!(bandwidth(&tied).is_some_and(|h| h > 0.0));
        assert!(bandwidth(&[1.0, 2.0]).is_some_and(|h| h > 0.0));
    }

    #[test]
    fn no_figure_is_none() {
        let bad = [&[][..], &[1.0], &[2.0; 9], &[1.0, f64::NAN, 2.0]];
        for draws in bad {
            assert!(bandwidth(draws).is_none());
            assert!(density(draws, NO_BOUND, 10).is_none());
        }
        assert!(bandwidth(&[f64::MAX, -f64::MAX]).is_none());
        assert!(density(&GALAXIES, NO_BOUND, 1).is_none());
        let below = Support { lower: Some(10.0), upper: None };
        assert!(density(&GALAXIES, below, 10).is_none());
        for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(density_at(&GALAXIES, NO_BOUND, width, &[1.0]).is_none());
        }
        assert!(density_at(&[], NO_BOUND, 1.0, &[1.0]).is_none());
        assert!(density_at(&[3.0], NO_BOUND, 1.0, &[f64::NAN]).is_some());
    }
}
