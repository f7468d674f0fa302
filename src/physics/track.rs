//! The terrain along the flow line, as a chain of pieces of constant slope.

use super::depth::DepthRows;
use crate::error::{Error, Result};
use crate::physics::GRAVITY;

/// Half the width \[m\] of the window in which curvature is fitted: wide
/// enough that the millimetres of a terrain model on 2 m points do not show,
/// narrow enough for the bends that matter to a flow tens of metres long.
const CURVATURE_WINDOW: f64 = 10.0;

/// A piece of the track: constant slope from `start` over `length`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Distance along the slope at its beginning \[m\].
    pub start: f64,
    /// Length along the slope \[m\]; infinite for the last one.
    pub length: f64,
    /// g sin(theta) \[m/s2\], positive downhill.
    pub pull: f64,
    /// g cos(theta) \[m/s2\], the normal load of a unit mass.
    pub load: f64,
    /// -d theta/ds \[1/m\] of the smoothed angle: positive where the track
    /// flattens out and presses back.
    pub curvature: f64,
}

/// What the pieces are made of, each number in a row of its own, for work on
/// several pieces at once.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Columns {
    pull: Vec<f64>,
    load: Vec<f64>,
    length: Vec<f64>,
}

impl Columns {
    fn of(pieces: &[Piece]) -> Self {
        Self {
            pull: pieces.iter().map(|p| p.pull).collect(),
            load: pieces.iter().map(|p| p.load).collect(),
            length: pieces.iter().map(|p| p.length).collect(),
        }
    }

    /// Pull, load and length of the eight pieces from `first` on; `None`
    /// where there are not as many before the endless one.
    #[inline]
    pub(super) fn eight(&self, first: usize) -> Option<[[f64; 8]; 3]> {
        if first + 8 >= self.length.len() {
            return None;
        }
        let rows = [&self.pull, &self.load, &self.length];
        let [pull, load, length] = rows.map(|row| row[first..].first_chunk());
        Some([*pull?, *load?, *length?])
    }
}

/// Places on a track nearer than this are the same \[m\].
const SAME: f64 = 1e-6;

/// The terrain along the flow line.
///
/// Beyond its last point the track goes on at its last slope, so that a
/// parameter value under which the mass runs further still has a flow.
///
/// ```
/// use couloir::physics::Track;
/// let track = Track::from_points(&[0.0, 30.0, 70.0], &[100.0, 60.0, 60.0])?;
/// assert_eq!(track.length(), 90.0);
/// assert_eq!(track.distance_at(30.0)?, 50.0);
/// assert_eq!(track.position(70.0), (50.0, 60.0));
/// # Ok::<(), couloir::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    pieces: Vec<Piece>,
    columns: Columns,
    x: Vec<f64>,
    z: Vec<f64>,
    origin: f64,
    /// The flow depth on each piece \[m\]; none where it is the same on all.
    depths: Vec<f64>,
}

impl Track {
    /// From points: horizontal distance \[m\], strictly increasing, and
    /// elevation \[m\].
    ///
    /// # Errors
    /// Fewer than two points, unequal numbers of them, a number that is not
    /// finite, or a distance that does not increase.
    pub fn from_points(x: &[f64], z: &[f64]) -> Result<Self> {
        check_points(x, z)?;
        let mut start = 0.0;
        let mut pieces = Vec::with_capacity(x.len());
        for (x, z) in x.windows(2).zip(z.windows(2)) {
            let (run, drop) = (x[1] - x[0], z[0] - z[1]);
            let length = run.hypot(drop);
            pieces.push(Piece {
                start,
                length,
                pull: GRAVITY * drop / length,
                load: GRAVITY * run / length,
                curvature: 0.0,
            });
            start += length;
        }
        set_curvature(&mut pieces);
        let mut track =
            Self { pieces, x: x.to_vec(), z: z.to_vec(), ..Self::bare() };
        track.extend();
        Ok(track)
    }

    /// A constant slope: angle \[degrees\], positive downhill, 90 for free
    /// fall, and its length \[m\].
    ///
    /// # Errors
    /// An angle outside -90..=90 or a length that is not positive and finite.
    pub fn incline(degrees: f64, length: f64) -> Result<Self> {
        if !(-90.0..=90.0).contains(&degrees) {
            return Err(Error::input(format!(
                "the slope is {degrees}; expected an angle in degrees from \
                 -90 (straight up) to 90 (free fall)"
            )));
        }
        if !(length > 0.0 && length.is_finite()) {
            return Err(Error::input(format!(
                "the track's length is {length}; expected metres, more than 0"
            )));
        }
        let (sin, cos) = degrees.to_radians().sin_cos();
        // cos 90 degrees comes out as 6e-17: a wall carries no load at all.
        let cos = if cos.abs() < 1e-15 { 0.0 } else { cos };
        let piece = Piece {
            start: 0.0,
            length,
            pull: GRAVITY * sin,
            load: GRAVITY * cos,
            curvature: 0.0,
        };
        let mut track = Self {
            pieces: vec![piece],
            x: vec![0.0, length * cos],
            z: vec![length * sin, 0.0],
            ..Self::bare()
        };
        track.extend();
        Ok(track)
    }

    /// The same track with its first point at `origin` \[m\] on an axis that
    /// several events share.
    #[must_use]
    pub fn with_origin(mut self, origin: f64) -> Self {
        self.origin = origin;
        self
    }

    /// Where its first point lies on the shared axis \[m\].
    pub fn origin(&self) -> f64 {
        self.origin
    }

    /// All pieces; the last one is the endless extension.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The length of the surveyed part along the slope \[m\].
    #[expect(clippy::misnamed_getters, reason = "the last piece is beyond")]
    pub fn length(&self) -> f64 {
        self.pieces[self.pieces.len() - 1].start
    }

    /// The surveyed points: horizontal distances and elevations \[m\].
    pub fn points(&self) -> (&[f64], &[f64]) {
        (&self.x, &self.z)
    }

    /// The piece that holds the distance `s` along the slope \[m\].
    pub fn piece_at(&self, s: f64) -> usize {
        self.pieces.partition_point(|p| p.start <= s).saturating_sub(1)
    }

    /// The slope angle at `s` \[radians\], positive downhill.
    pub fn angle(&self, s: f64) -> f64 {
        let piece = &self.pieces[self.piece_at(s)];
        piece.pull.atan2(piece.load)
    }

    /// -d theta/ds at `s` \[1/m\], of the smoothed angle.
    pub fn curvature(&self, s: f64) -> f64 {
        self.pieces[self.piece_at(s)].curvature
    }

    /// The distance along the slope \[m\] at the horizontal distance `x`.
    ///
    /// # Errors
    /// `x` outside the surveyed track, or anything but its beginning on a
    /// vertical one, where x says nothing.
    pub fn distance_at(&self, x: f64) -> Result<f64> {
        let (first, last) = (self.x[0], self.x[self.x.len() - 1]);
        if x == first {
            return Ok(0.0);
        }
        if !(first..=last).contains(&x) {
            return Err(Error::input(format!(
                "x = {x} lies outside the track, which goes from {first} to \
                 {last}"
            )));
        }
        let i = self.x.partition_point(|&p| p <= x).min(self.x.len() - 1) - 1;
        let piece = &self.pieces[i];
        Ok(piece.start + (x - self.x[i]) * GRAVITY / piece.load)
    }

    /// Horizontal distance and elevation \[m\] at `s` along the slope.
    pub fn position(&self, s: f64) -> (f64, f64) {
        let i = self.piece_at(s);
        let piece = &self.pieces[i];
        let along = (s - piece.start) / GRAVITY;
        (self.x[i] + along * piece.load, self.z[i] - along * piece.pull)
    }

    /// The same track with a flow depth over horizontal distance, cut into
    /// pieces on which it is nearly constant. Where the track goes on beyond
    /// its last point, the depth there holds.
    ///
    /// # Errors
    /// A vertical track, on which horizontal distance says nothing.
    pub(crate) fn with_depths(&self, rows: &DepthRows) -> Result<Self> {
        let last = self.x.len() - 1;
        if self.x[last] <= self.x[0] {
            return Err(Error::input(
                "the track is vertical, and a flow depth over x says nothing \
                 there; give the depth over t, or one number",
            ));
        }
        let cuts = rows.cuts();
        let mut track = Self { origin: self.origin, ..Self::bare() };
        for (i, piece) in self.pieces[..last].iter().enumerate() {
            let (from, to) = (self.x[i], self.x[i + 1]);
            track.cut(piece, [from, self.z[i]], to, &cuts, rows);
        }
        track.x.push(self.x[last]);
        track.z.push(self.z[last]);
        track.depths.push(rows.at(self.x[last]));
        track.extend();
        Ok(track)
    }

    /// Appends a piece from a point to a horizontal distance, in parts that
    /// end at the cuts.
    fn cut(
        &mut self,
        piece: &Piece,
        [mut from, mut z]: [f64; 2],
        to: f64,
        cuts: &[f64],
        rows: &DepthRows,
    ) {
        let first = cuts.partition_point(|cut| *cut <= from);
        let inner = cuts[first..].iter().take_while(|cut| **cut < to - SAME);
        let mut start = piece.start;
        for &next in inner.chain([&to]) {
            if next - from < SAME && next < to {
                continue;
            }
            let length = (next - from) * GRAVITY / piece.load;
            // The last part ends where the piece does, to the last digit.
            let left = piece.start + piece.length - start;
            let length = if next < to { length } else { left };
            self.pieces.push(Piece { start, length, ..*piece });
            self.depths.push(rows.mean(from, next));
            self.x.push(from);
            self.z.push(z);
            z -= length * piece.pull / GRAVITY;
            (start, from) = (start + length, next);
        }
    }

    /// Whether the flow depth differs from piece to piece.
    pub(super) fn has_depths(&self) -> bool {
        !self.depths.is_empty()
    }

    /// The flow depth on a piece \[m\], where it differs from piece to piece.
    pub(super) fn depth_on(&self, index: usize) -> Option<f64> {
        self.depths.get(index).copied()
    }

    fn extend(&mut self) {
        let last = self.pieces[self.pieces.len() - 1];
        self.pieces.push(Piece {
            start: last.start + last.length,
            length: f64::INFINITY,
            curvature: 0.0,
            ..last
        });
        self.columns = Columns::of(&self.pieces);
    }

    /// Of no pieces and no points yet.
    fn bare() -> Self {
        let columns = Columns::default();
        let (pieces, x, z) = (Vec::new(), Vec::new(), Vec::new());
        Self { pieces, columns, x, z, origin: 0.0, depths: Vec::new() }
    }

    /// The pieces' numbers, side by side.
    pub(super) fn columns(&self) -> &Columns {
        &self.columns
    }
}

fn check_points(x: &[f64], z: &[f64]) -> Result<()> {
    if x.len() != z.len() || x.len() < 2 {
        return Err(Error::input(format!(
            "a track needs at least two points with x and z each; found {} \
             and {}",
            x.len(),
            z.len()
        )));
    }
    for (i, (x, z)) in x.iter().zip(z).enumerate() {
        if !x.is_finite() || !z.is_finite() {
            return Err(Error::input(format!(
                "point {} of the track is ({x}, {z}); expected finite metres",
                i + 1
            )));
        }
    }
    match x.windows(2).position(|w| w[1] <= w[0]) {
        Some(i) => Err(Error::input(format!(
            "the track goes back: point {} has x = {} after x = {}; x has to \
             increase from point to point",
            i + 2,
            x[i + 1],
            x[i]
        ))),
        None => Ok(()),
    }
}

/// Gives each piece -d theta/ds: the least-squares slope of the pieces'
/// angles, weighted by length, within [`CURVATURE_WINDOW`] of its middle (at
/// least one neighbour either side). Moments about the track's middle come
/// from running sums, so the cost is linear in the number of pieces.
fn set_curvature(pieces: &mut [Piece]) {
    let centre = pieces.last().map_or(0.0, |p| 0.5 * (p.start + p.length));
    let middle = |p: &Piece| p.start + 0.5 * p.length - centre;
    let mut sums = vec![[0.0; 5]];
    let mut total = [0.0; 5];
    for p in pieces.iter() {
        let (s, angle) = (middle(p), p.pull.atan2(p.load));
        let terms = [1.0, s, s * s, angle, s * angle];
        for (sum, term) in total.iter_mut().zip(terms) {
            *sum += p.length * term;
        }
        sums.push(total);
    }
    let middles: Vec<f64> = pieces.iter().map(middle).collect();
    let (mut low, mut high) = (0, 0);
    for i in 0..pieces.len() {
        while middles[low] < middles[i] - CURVATURE_WINDOW {
            low += 1;
        }
        while high < middles.len()
            && middles[high] <= middles[i] + CURVATURE_WINDOW
        {
            high += 1;
        }
        let from = low.min(i.saturating_sub(1));
        let to = high.max((i + 2).min(pieces.len()));
        let m: [f64; 5] = std::array::from_fn(|k| sums[to][k] - sums[from][k]);
        let spread = m[0] * m[2] - m[1] * m[1];
        let rise = m[0] * m[4] - m[1] * m[3];
        pieces[i].curvature = if to - from > 1 { -rise / spread } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_has_its_curvature_everywhere() {
        // A valley of radius 200 m on 2 m points, elevations rounded to the
        // millimetre as terrain models give them.
        let x: Vec<f64> = (0..80).map(|i| 2.0 * f64::from(i)).collect();
        let z: Vec<f64> = x
            .iter()
            .map(|x| {
                let depth = (200.0_f64.powi(2) - (x - 180.0).powi(2)).sqrt();
                ((300.0 - depth) * 1e3).round() / 1e3
            })
            .collect();
        let track = Track::from_points(&x, &z).unwrap();
        // Rounding moves an angle by 0.3 mrad; over 11 angles in 20 m the
        // fitted slope then errs by about 2e-5, 0.4 % of 1/200.
        for s in [0.3, 0.5, 0.7].map(|f| f * track.length()) {
            let error = track.curvature(s) - 1.0 / 200.0;
            assert!(error.abs() < 1e-4, "{s}: {error}");
        }
    }

    #[test]
    fn a_straight_track_has_no_curvature() {
        let x: Vec<f64> = (0..1000).map(|i| 2.0 * f64::from(i)).collect();
        let z: Vec<f64> = x.iter().map(|x| 2000.0 - 0.5 * x).collect();
        let track = Track::from_points(&x, &z).unwrap();
        assert!(track.pieces().iter().all(|p| p.curvature.abs() < 1e-9));
    }

    #[test]
    fn distance_and_position_are_inverse() {
        let x = [0.0, 10.0, 25.0, 45.0];
        let z = [20.0, 12.0, 8.0, 9.0];
        let track = Track::from_points(&x, &z).unwrap();
        for x in [0.0, 3.0, 10.0, 24.0, 45.0] {
            let s = track.distance_at(x).unwrap();
            assert!((track.position(s).0 - x).abs() < 1e-12);
        }
    }

    #[test]
    fn free_fall_carries_no_load() {
        let track = Track::incline(90.0, 60.0).unwrap();
        assert_eq!(track.pieces()[0].load, 0.0);
        assert_eq!(track.distance_at(0.0).unwrap(), 0.0);
    }
}
