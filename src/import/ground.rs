//! The track that an event has: horizontal distance and elevation, smoothed,
//! and gone on with beyond its end.

use super::smooth::{between, fit};

/// How far the track goes beyond the last place of the recording \[m\], for
/// parameter values under which the mass runs further.
pub(super) const BEYOND: f64 = 100.0;

/// How far, at the most, along a path that goes on \[m\].
const FURTHEST: f64 = 2000.0;

/// The stretch whose mean slope goes on beyond the last known elevation \[m\].
pub(super) const ENDING: f64 = 50.0;

/// A track.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ground {
    /// Horizontal distance from where the recording begins \[m\].
    pub(super) x: Vec<f64>,
    /// Elevation \[m\].
    pub(super) z: Vec<f64>,
    /// What it was smoothed from, over the same distance.
    pub(super) samples: Vec<(f64, f64)>,
    /// Up to where elevations are known, if it goes on beyond \[m\].
    pub(super) known_to: Option<f64>,
}

/// How far apart the points of a track are \[m\].
pub(super) fn spacing(smooth: f64) -> f64 {
    (0.25 * smooth).clamp(1.0, 10.0)
}

/// The track from samples of elevation along a line, which do not fall back.
/// `begin` and `end` are where the recording begins and ends along it.
/// Nothing where the samples are fewer than two points of a track.
pub(super) fn track(
    samples: &[(f64, f64)],
    begin: f64,
    end: f64,
    smooth: f64,
) -> Option<Ground> {
    let (from, to) = (samples.first()?.0, samples.last()?.0);
    let begin_is_known = from - spacing(smooth) <= begin && begin < to;
    let to = to.min(end + FURTHEST);
    if !begin_is_known || to.is_nan() {
        return None;
    }
    let step = spacing(smooth);
    let count = ((to - begin) / step + 1e-9) as usize;
    let mut x: Vec<f64> = (0..=count).map(|i| step * i as f64).collect();
    let at = |x: &f64| {
        let fitted = fit(samples, begin + x, 0.5 * smooth);
        fitted.map_or_else(|| between(samples, begin + x), |f| Some(f.value))
    };
    let mut z: Vec<f64> = x.iter().map(at).collect::<Option<_>>()?;
    if x.len() < 2 {
        return None;
    }
    let known = x[count];
    let wanted = ((end - begin + BEYOND) / step).ceil() * step;
    let known_to = (wanted > known).then_some(known);
    if known_to.is_some() {
        let back = (ENDING / step).ceil() as usize;
        let back = back.clamp(1, count);
        let slope =
            (z[count] - z[count - back]) / (x[count] - x[count - back]);
        x.push(wanted);
        z.push(z[count] + slope * (wanted - known));
    }
    let samples = samples.iter().map(|s| (s.0 - begin, s.1)).collect();
    Some(Ground { x, z, samples, known_to })
}

impl Ground {
    /// The cosine of the slope at a distance.
    pub(super) fn cosine(&self, x: f64) -> f64 {
        let above = self.x.partition_point(|at| *at <= x);
        let above = above.clamp(1, self.x.len() - 1);
        let run = self.x[above] - self.x[above - 1];
        run / run.hypot(self.z[above] - self.z[above - 1])
    }

    /// The elevation at a distance \[m\].
    pub(super) fn at(&self, x: f64) -> Option<f64> {
        let points: Vec<_> =
            self.x.iter().copied().zip(self.z.iter().copied()).collect();
        between(&points, x)
    }

    /// The length along the slope between two distances \[m\].
    pub(super) fn along(&self, from: f64, to: f64) -> f64 {
        let points = self.x.windows(2).zip(self.z.windows(2));
        let lengths = points.map(|(x, z)| {
            let run = x[1].min(to) - x[0].max(from);
            run.max(0.0) * 1.0_f64.hypot((z[1] - z[0]) / (x[1] - x[0]))
        });
        lengths.sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_track_goes_on_at_its_last_slope() {
        let samples: Vec<_> = (0..=200)
            .map(|i| (f64::from(i), 500.0 - 0.5 * f64::from(i)))
            .collect();
        let ground = track(&samples, 20.0, 180.0, 20.0).unwrap();
        assert_eq!((ground.x[0], ground.known_to), (0.0, Some(180.0)));
        assert_eq!(ground.x.last(), Some(&260.0));
        for (x, z) in ground.x.iter().zip(&ground.z) {
            assert!((z - (490.0 - 0.5 * x)).abs() < 1e-9, "{x} {z}");
        }
        assert!((ground.cosine(50.0) - 1.0 / 1.25_f64.sqrt()).abs() < 1e-9);
        let length = ground.along(10.0, 30.0);
        assert!((length - 20.0 * 1.25_f64.sqrt()).abs() < 1e-9);
        // A path that is known further goes on by itself.
        let ground = track(&samples, 20.0, 60.0, 0.0).unwrap();
        assert_eq!((ground.known_to, ground.x.len()), (None, 181));
        assert_eq!(track(&samples, 300.0, 310.0, 20.0), None);
        assert_eq!(track(&samples[..1], 0.0, 10.0, 20.0), None);
        assert_eq!(track(&[], 0.0, 10.0, 20.0), None);
    }
}
