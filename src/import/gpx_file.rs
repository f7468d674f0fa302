//! A log as GPX: the points of its longest track.

use std::path::Path;

use super::clock::{Moment, moment};
use super::log::{Fix, Frame, Log, SpeedKind};
use super::table::most_odd;
use crate::error::{Error, Result};
use crate::io::{MOST_ROWS, place, quoted};

/// Reads the track with the most points.
pub(super) fn read(text: &str, path: &Path) -> Result<Log> {
    let wrong = |what: String| Error::input(what).within(place(path));
    let all = gpx::read(text.as_bytes()).map_err(|error| {
        wrong(format!(
            "is no GPX that can be read ({}); expected GPX 1.0 or 1.1: export \
             it again",
            quoted(&error.to_string())
        ))
    })?;
    let points = |track: &gpx::Track| -> usize {
        track.segments.iter().map(|segment| segment.points.len()).sum()
    };
    let Some(track) = all.tracks.iter().max_by_key(|track| points(track))
    else {
        return Err(wrong(
            "has no track; expected one with times: a route has none, take \
             what the receiver recorded"
                .to_owned(),
        ));
    };
    let points: Vec<_> =
        track.segments.iter().flat_map(|segment| &segment.points).collect();
    if points.len() > MOST_ROWS {
        return Err(wrong(format!(
            "has more than {MOST_ROWS} points; expected at most as many: cut \
             it to the part that matters"
        )));
    }
    let dated: Vec<_> =
        points.iter().map(|point| time(point).map(|m| (m, *point))).collect();
    let Some((begin, _)) = dated.iter().flatten().next().copied() else {
        return Err(wrong(
            "no point has a time; expected a recorded track: export it with \
             its times"
                .to_owned(),
        ));
    };
    let log = log_of(&dated, begin, path, all.tracks.len());
    in_order(log, points.len()).map_err(wrong)
}

/// Refuses a track of which more points than a few do not go on in time.
fn in_order(log: Log, points: usize) -> Result<Log, String> {
    let (lost, most) = (points - log.fixes.len(), most_odd(points));
    match lost > most {
        false => Ok(log),
        true => Err(format!(
            "{lost} of {points} points have no time after that of the point \
             before; expected {most} at the most: are its segments in order? \
             Sort it by time, or cut it to the part that matters"
        )),
    }
}

fn time(point: &gpx::Waypoint) -> Option<Moment> {
    let text = point.time.as_ref()?.format().ok()?;
    moment(&text, 1.0)
}

/// The points that are later than the one before.
fn fixes(
    points: &[Option<(Moment, &gpx::Waypoint)>],
    begin: Moment,
) -> Vec<Fix> {
    let has_speed = points.iter().flatten().all(|p| p.1.speed.is_some());
    let mut fixes: Vec<Fix> = Vec::new();
    for (number, point) in (1..).zip(points) {
        let Some((moment, point)) = point else { continue };
        let time = moment.seconds - begin.seconds;
        if fixes.last().is_some_and(|last| time <= last.time) {
            continue;
        }
        let finite = |x: &f64| x.is_finite();
        fixes.push(Fix {
            row: number,
            time,
            place: (point.point().x(), point.point().y()),
            height: point.elevation.filter(finite),
            speed: point.speed.filter(|_| has_speed).filter(finite),
            satellites: point.sat.map(|count| count as f64),
        });
    }
    fixes
}

fn log_of(
    points: &[Option<(Moment, &gpx::Waypoint)>],
    begin: Moment,
    path: &Path,
    tracks: usize,
) -> Log {
    let fixes = fixes(points, begin);
    let lost = points.len() - fixes.len();
    let kind = match fixes.iter().all(|fix| fix.speed.is_some()) {
        true => SpeedKind::Ground,
        false => SpeedKind::Positions,
    };
    let said = vec![format!(
        "Read {} points of {}, the longest of {tracks} tracks.",
        fixes.len(),
        place(path)
    )];
    let lost = (lost > 0).then(|| {
        format!(
            "Points passed over for want of a time after that of the point \
             before: {lost}."
        )
    });
    let doubts = lost.into_iter().collect();
    let path = path.to_owned();
    Log {
        path,
        fixes,
        frame: Frame::Degrees,
        kind,
        begin,
        is_simulated: false,
        said,
        doubts,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_points_of_a_track_are_read() {
        let text = r#"<?xml version="1.0"?>
<gpx version="1.1" creator="a test" xmlns="http://www.topografix.com/GPX/1/1">
<trk><trkseg>
<trkpt lat="47.0" lon="11.0"><ele>2000.5</ele>
<time>2022-02-22T07:00:00Z</time><sat>9</sat></trkpt>
<trkpt lat="47.1" lon="11.1"><time>2022-02-22T07:00:00.5Z</time></trkpt>
</trkseg></trk></gpx>"#;
        let log = read(text, Path::new("a.gpx")).unwrap();
        assert_eq!(log.fixes.len(), 2);
        assert_eq!(log.fixes[0].place, (11.0, 47.0));
        assert_eq!(log.fixes[0].height, Some(2000.5));
        assert_eq!(log.fixes[0].satellites, Some(9.0));
        assert!((log.fixes[1].time - 0.5).abs() < 1e-6);
        assert_eq!(log.kind, SpeedKind::Positions);
        assert_eq!(log.moment("--to", "07:00:03").unwrap(), 3.0);
    }

    #[test]
    fn segments_in_the_wrong_order_are_refused() {
        let point = |second: u32| {
            format!(
                "<trkpt lat=\"47.0\" lon=\"11.0\">\
                 <time>2022-02-22T07:00:{second:02}Z</time></trkpt>"
            )
        };
        let points = |range: std::ops::Range<u32>| -> String {
            range.map(point).collect()
        };
        let text = format!(
            "<gpx version=\"1.1\" creator=\"x\" \
             xmlns=\"http://www.topografix.com/GPX/1/1\"><trk><trkseg>{}\
             </trkseg><trkseg>{}</trkseg></trk></gpx>",
            points(30..60),
            points(0..30)
        );
        let error = read(&text, Path::new("a.gpx")).unwrap_err().to_string();
        assert!(error.contains("30 of 60 points have no time"), "{error}");
    }

    #[test]
    fn what_is_no_track_is_refused() {
        let bare = r#"<gpx version="1.1" creator="x"
            xmlns="http://www.topografix.com/GPX/1/1">"#;
        for text in [
            String::new(),
            "t,lon,lat".to_owned(),
            format!("{bare}</gpx>"),
            format!(
                "{bare}<trk><trkseg><trkpt lat=\"1\" lon=\"2\"></trkpt>\
                 </trkseg></trk></gpx>"
            ),
        ] {
            let error = read(&text, Path::new("a.gpx")).unwrap_err();
            assert!(error.to_string().starts_with("a.gpx: "), "{error}");
        }
    }
}
