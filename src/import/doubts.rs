//! What there is to doubt about an import.

use super::case::Case;
use super::log::SpeedKind;
use super::phase::SILENT;
use crate::draws::median;

/// A pause of so many times the usual step is a gap.
const GAP: f64 = 3.5;

/// Fewer satellites than this give poor positions.
const FEW: f64 = 6.0;

/// Further than this from a given path is far \[m\].
const FAR: f64 = 20.0;

/// Distances by speeds and by positions may differ by this share.
const WAY: f64 = 0.05;

/// Speeds by positions and by the receiver may differ by this share of the
/// top speed, in the median of the faster half.
const SPEED: f64 = 0.1;

/// The log's heights may wander by this against the terrain \[m\].
const WANDER: f64 = 10.0;

/// All doubts, in sentences.
pub(super) fn doubts(case: &Case) -> Vec<String> {
    let mut all = case.moving.log.doubts.clone();
    let more = [
        ends(case),
        rival(case),
        gaps(case),
        silence(case),
        satellites(case),
        far(case),
        way(case),
        receiver(case),
        kind(case),
        heights(case),
        holes(case),
        climbs(case),
        start(case),
        clock(case),
    ];
    all.extend(more.into_iter().flatten());
    all
}

/// A log that begins or ends in the motion.
fn ends(case: &Case) -> Option<String> {
    let last = case.moving.log.fixes.len() - 1;
    // The speed of a front at its first row is not a mean over the next.
    let speed = |i: usize| match (i, case.recorded.first()) {
        (0, Some(speed)) if case.moving.log.is_front() => *speed,
        _ => case.moving.speeds[i],
    };
    let fast = |i: usize| speed(i) > case.threshold.max(0.5);
    let begins = case.moving.phase.first == 0 && fast(0);
    let stops = case.moving.phase.last == last && fast(last);
    let end = match (begins, stops) {
        (true, true) => "begins and ends",
        (true, false) => "begins",
        (false, true) => "ends",
        (false, false) => return None,
    };
    Some(format!(
        "The {} {end} in the motion: a part of it is missing.",
        case.moving.log.word()
    ))
}

/// Another stretch that was faster.
fn rival(case: &Case) -> Option<String> {
    let top = |from: usize, to: usize| {
        case.moving.speeds[from..=to].iter().copied().fold(0.0, f64::max)
    };
    let own = top(case.moving.phase.first, case.moving.phase.last);
    let others = case.moving.others.iter().map(|p| (top(p.first, p.last), p));
    let (speed, other) = others.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let time = |i: usize| case.moving.log.fixes[i].time;
    (speed > own).then(|| {
        format!(
            "A shorter stretch was faster: {speed:.1} m/s against {own:.1}, \
             from {:.1} to {:.1} s after the log's first row. If that is the \
             avalanche, take it with --from and --to.",
            time(other.first),
            time(other.last)
        )
    })
}

fn gaps(case: &Case) -> Option<String> {
    let times = case.moving.times();
    let steps: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
    let usual = median(&steps);
    let long: Vec<usize> =
        (0..steps.len()).filter(|i| steps[*i] > GAP * usual).collect();
    let longest =
        *long.iter().max_by(|a, b| steps[**a].total_cmp(&steps[**b]))?;
    Some(format!(
        "Gaps in the {}: {}; the longest is {:.2} s from t = {:.2} s, where \
         rows are {usual:.2} s apart otherwise.",
        case.moving.log.word(),
        long.len(),
        steps[longest],
        times[longest]
    ))
}

/// A log that says nothing for long, before or after what is taken.
fn silence(case: &Case) -> Option<String> {
    let fixes = &case.moving.log.fixes;
    let phase = case.moving.phase;
    let step = |i: &usize| fixes[i + 1].time - fixes[*i].time;
    let outside =
        (0..fixes.len() - 1).filter(|i| *i < phase.first || *i >= phase.last);
    let at = outside.max_by(|a, b| step(a).total_cmp(&step(b)))?;
    let long = step(&at);
    let bounds = match (at + 1 == phase.first, at == phase.last) {
        (true, _) => "; what is taken begins behind that",
        (_, true) => "; what is taken ends before that",
        _ => "",
    };
    (long > SILENT).then(|| {
        format!(
            "The {} says nothing for {long:.1} s, from {:.1} s after its first \
             row on{bounds}. If the mass moved then, a part of its motion is \
             missing.",
            case.moving.log.word(),
            fixes[at].time
        )
    })
}

fn satellites(case: &Case) -> Option<String> {
    let counts: Vec<f64> =
        case.moving.rows().iter().filter_map(|fix| fix.satellites).collect();
    let few = counts.iter().filter(|count| **count < FEW).count();
    let least = counts.iter().copied().fold(f64::INFINITY, f64::min);
    (few > 0).then(|| {
        format!(
            "Rows with fewer than {FEW} satellites: {few} of {}, the least \
             {least}.",
            counts.len()
        )
    })
}

fn far(case: &Case) -> Option<String> {
    let off = case.beside.iter().map(|b| b.off);
    let far = off.clone().filter(|off| *off > FAR).count();
    let most = off.fold(0.0, f64::max);
    (case.is_given && far > 0).then(|| {
        format!(
            "Positions more than {FAR} m from the path: {far} of {}, the \
             furthest {most:.0} m. The track is the path's, which may not be \
             where the sensor went.",
            case.beside.len()
        )
    })
}

/// The way by the speeds against that by the positions.
fn way(case: &Case) -> Option<String> {
    let (times, speeds) = (case.moving.times(), &case.recorded);
    let steps = times.windows(2).zip(speeds.windows(2));
    let by_speeds: f64 =
        steps.map(|(t, v)| 0.5 * (v[0] + v[1]) * (t[1] - t[0])).sum();
    let (first, end) = case.ends();
    let by_track = case.ground.along(first, end);
    let differ = (by_speeds - by_track).abs() > WAY * by_track;
    (differ && !is_by_positions(case)).then(|| {
        format!(
            "By its speeds the sensor went {by_speeds:.0} m along the slope, \
             by its positions on the track {by_track:.0} m: {:.0} % apart.",
            100.0 * (by_speeds / by_track - 1.0).abs()
        )
    })
}

/// Whether the speeds are made of the positions.
fn is_by_positions(case: &Case) -> bool {
    let kind = case.moving.log.kind;
    matches!(kind, SpeedKind::Positions | SpeedKind::Front)
}

/// The receiver's speeds against those of its positions, where it is fast.
fn receiver(case: &Case) -> Option<String> {
    if is_by_positions(case) {
        return None;
    }
    let level =
        &case.moving.level[case.moving.phase.first..=case.moving.phase.last];
    let by_positions = level
        .iter()
        .zip(case.distances())
        .map(|(speed, x)| speed / case.ground.cosine(x));
    let both: Vec<(f64, f64)> =
        case.recorded.iter().copied().zip(by_positions).collect();
    let half = median(&case.recorded);
    let top = case.recorded.iter().copied().fold(0.0, f64::max);
    let fast =
        both.iter().filter(|(own, other)| *own >= half && other.is_finite());
    let apart: Vec<f64> = fast.map(|(own, other)| other - own).collect();
    if apart.is_empty() {
        return None;
    }
    let size: Vec<f64> = apart.iter().map(|d| d.abs()).collect();
    (median(&size) > SPEED * top).then(|| {
        format!(
            "Speeds by positions differ from the receiver's by {:.1} m/s \
             (median of the faster half; {:+.1} m/s with its sign).",
            median(&size),
            median(&apart)
        )
    })
}

fn kind(case: &Case) -> Option<String> {
    match case.moving.log.kind {
        SpeedKind::Whole | SpeedKind::Along => None,
        SpeedKind::Ground => Some(
            "The receiver's speed over ground knows nothing of the slope: \
             the slope of the track is used, and its errors are in the \
             speeds."
                .to_owned(),
        ),
        SpeedKind::Positions => Some(
            "Speeds by positions are means over about a second: peaks are \
             lower, and errors are correlated."
                .to_owned(),
        ),
        SpeedKind::Front => Some(
            "Mean speeds between positions share a position with the one \
             before and the one behind: where the errors of positions are \
             independent, those of such speeds are correlated by -1/2. \
             Distances are taken for that; speeds need a noise that knows it."
                .to_owned(),
        ),
    }
}

/// The log's heights against the terrain, or by themselves.
fn heights(case: &Case) -> Option<String> {
    if case.terrain.is_none() && case.moving.log.is_front() {
        return Some(
            "The elevations are the front's, which is the top of the flow \
             and not the ground. A terrain model is better."
                .to_owned(),
        );
    }
    if case.terrain.is_none() {
        return Some(
            "The elevations are the log's: a receiver's heights err by \
             metres to tens of metres, and its slopes with them. A terrain \
             model is better."
                .to_owned(),
        );
    }
    let over = case.heights_over_terrain();
    if over.is_empty() {
        return None;
    }
    let low = over.iter().copied().fold(f64::INFINITY, f64::min);
    let high = over.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (high - low > WANDER).then(|| {
        format!(
            "The {}'s heights are {low:.0} to {high:.0} m over the terrain \
             model, which a constant offset (an ellipsoid's height) does not \
             explain; they are not used.",
            case.moving.log.word()
        )
    })
}

/// Places of the recording without an elevation.
fn holes(case: &Case) -> Option<String> {
    let all = case.terrain.as_ref()?;
    let none = all.iter().filter(|z| z.is_none()).count();
    (none > 0).then(|| {
        format!(
            "Positions with no elevation in the terrain model: {none} of {}; \
             between places that have one the track is linear.",
            all.len()
        )
    })
}

/// A track that ends higher than it begins.
fn climbs(case: &Case) -> Option<String> {
    let (first, end) = case.ends();
    let drop = case.ground.at(first)? - case.ground.at(end)?;
    (drop <= 0.0).then(|| {
        format!(
            "The recording ends {:.1} m higher than it begins: is this the \
             avalanche? --from and --to take another part.",
            -drop
        )
    })
}

/// How a front starts, and what it is.
fn start(case: &Case) -> Option<String> {
    let speed = case.recorded.first()?;
    case.moving.log.is_front().then(|| {
        format!(
            "A front is not the mass centre that the model moves, and its \
             points at the sides are to be left out. All distances are from \
             its first position, whose error they share. The speed there, \
             {speed:.2} m/s, is by the first three distances: write 0 in \
             event.toml if the mass was released then."
        )
    })
}

/// Recordings of one avalanche without a clock that they share.
fn clock(case: &Case) -> Option<String> {
    (case.several && case.start.is_none()).then(|| {
        "By their clocks the recordings do not move at one time: each event \
         has a clock of its own. If they are of one avalanche, write the \
         moments of their t = 0 as event.start."
            .to_owned()
    })
}
