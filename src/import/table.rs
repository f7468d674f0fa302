//! A log as a table of text: u-blox logs, and any CSV whose columns are
//! known or named.

use std::io::Read as _;
use std::path::Path;

use csv::{ByteRecord, StringRecord};

use super::clock::{DAY, Moment, moment};
use super::columns::{Column, Columns, Found};
use super::log::{Fix, Frame, Log, SpeedKind};
use super::role::Role;
use crate::error::{Error, Result};
use crate::io::{FASTEST, MOST_ROWS, is_mark, may_be_mark, place, quoted};

/// Rows that may be passed over before the file is refused: a share of them,
/// and a number.
const MOST_ODD: (f64, usize) = (0.1, 10);

/// The parts of a velocity.
const WHOLE: [Role; 3] = [Role::North, Role::East, Role::Down];

/// How many of so many rows may be passed over.
pub(super) fn most_odd(count: usize) -> usize {
    MOST_ODD.1.max((MOST_ODD.0 * count as f64) as usize)
}

/// A table being read.
struct Reader<'r> {
    path: &'r Path,
    separator: u8,
    found: Found,
    kind: SpeedKind,
    frame: Frame,
}

/// What a table is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    /// One sensor.
    Sensor,
    /// The points of a front: those of one time are one place, their mean
    /// (Heredia et al. 2020, equation 12).
    Front,
}

/// What was read and what was passed over.
#[derive(Default)]
struct Rows {
    fixes: Vec<Fix>,
    begin: Option<Moment>,
    /// Without a time, a place, or a fix of satellites.
    empty: usize,
    /// Not after the row before.
    back: Vec<u64>,
    /// How many rows the last place is the mean of, and the most of any.
    points: usize,
    most_points: usize,
}

/// Reads a table with a header.
pub(super) fn read(
    text: &str,
    path: &Path,
    columns: &Columns,
    of: Of,
) -> Result<Log> {
    let separator = separator(text);
    let mut source = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes().chain(&b"\n"[..]));
    let mut bytes = ByteRecord::new();
    let mut reader: Option<Reader<'_>> = None;
    let mut rows = Rows::default();
    while source.read_byte_record(&mut bytes).unwrap_or(false) {
        // Every line ends in a line feed: the reader stands behind it.
        let line = source.position().line() - 1;
        let record = StringRecord::from_byte_record_lossy(bytes.clone());
        if record.iter().any(|cell| cell.contains('\n')) {
            return Err(at(
                path,
                line,
                "a quotation mark is not closed on its line; expected each \
                 row on one: close the mark, or drop it",
            ));
        }
        match &reader {
            None => {
                let new = Reader::new(path, separator, columns, &record, of);
                reader = Some(new.map_err(|what| at(path, line, &what))?);
            }
            Some(reader) => reader.take(&record, line, &mut rows)?,
        }
    }
    match reader {
        Some(reader) => reader.finish(rows),
        None => Err(Error::input(format!(
            "{}: is empty; expected a header and rows of times and places",
            place(path)
        ))),
    }
}

fn at(path: &Path, line: u64, what: &str) -> Error {
    Error::input(what).within(format_args!("{}:{line}", place(path)))
}

/// Whether a number stands for "not measured". Speeds are not below 0, so
/// that any such mark is one; what has a sign may be as large in small units.
fn is_for_none(role: Role, value: f64, factor: f64) -> bool {
    match role {
        Role::Speed | Role::GroundSpeed => {
            is_mark(value) || (may_be_mark(value) && value * factor > FASTEST)
        }
        Role::Height | Role::North | Role::East | Role::Down => {
            is_mark(value * factor)
        }
        _ => false,
    }
}

/// Refuses a header that has a column twice of those that are read: which of
/// the two is meant, nobody said.
fn once_each(found: &Found, header: &[&str]) -> Result<(), String> {
    let twice = found.values().find(|column| {
        let own = header.get(column.at);
        header.iter().filter(|cell| own == Some(*cell)).count() > 1
    });
    match twice {
        None => Ok(()),
        Some(column) => Err(format!(
            "the header is {}, which has {} twice; expected each column that \
             is read once: drop or rename one",
            quoted(&header.join(",")),
            quoted(header[column.at])
        )),
    }
}

/// The separator that the first line has most of.
fn separator(text: &str) -> u8 {
    let first = text.lines().find(|line| !line.trim().is_empty());
    let first = first.unwrap_or_default();
    let count = |c: &u8| first.bytes().filter(|b| b == c).count();
    let all = [b'\t', b';', b','];
    all.into_iter().max_by_key(count).unwrap_or(b',')
}

/// What the speeds are, and the columns of which they are made.
fn kind(found: &Found) -> (SpeedKind, &'static [Role]) {
    let has = |roles: &[Role]| roles.iter().all(|r| found.contains_key(r));
    if has(&WHOLE) {
        (SpeedKind::Whole, &WHOLE)
    } else if has(&[Role::Speed]) {
        (SpeedKind::Along, &[Role::Speed])
    } else if has(&[Role::GroundSpeed]) {
        (SpeedKind::Ground, &[Role::GroundSpeed])
    } else if has(&WHOLE[..2]) {
        (SpeedKind::Ground, &WHOLE[..2])
    } else {
        (SpeedKind::Positions, &[])
    }
}

/// What the places are, and the columns of which they are made.
fn frame(found: &Found, of: Of) -> Option<(Frame, &'static [Role])> {
    const ALL: [(Frame, &[Role]); 3] = [
        (Frame::Degrees, &[Role::Longitude, Role::Latitude]),
        (Frame::Metres, &[Role::X, Role::Y]),
        (Frame::Along, &[Role::Along]),
    ];
    // A distance alone is a place of a front, along the path that it has.
    let known = if of == Of::Front { &ALL[..] } else { &ALL[..2] };
    let has = |roles: &[Role]| roles.iter().all(|r| found.contains_key(r));
    known.iter().copied().find(|(_, roles)| has(roles))
}

impl Rows {
    /// Takes another point of the last place's time into the mean.
    fn join(&mut self, new: Fix) {
        let Some(last) = self.fixes.last_mut() else { return };
        self.points += 1;
        self.most_points = self.most_points.max(self.points);
        let share = 1.0 / self.points as f64;
        let mean = |old: f64, new: f64| old + share * (new - old);
        last.place.0 = mean(last.place.0, new.place.0);
        last.place.1 = mean(last.place.1, new.place.1);
        last.height = last.height.zip(new.height).map(|(a, b)| mean(a, b));
    }
}

impl<'r> Reader<'r> {
    fn new(
        path: &'r Path,
        separator: u8,
        columns: &Columns,
        header: &StringRecord,
        of: Of,
    ) -> Result<Self, String> {
        let header: Vec<&str> = header.iter().collect();
        let found = columns.find(&header)?;
        let has = |roles: &[Role]| roles.iter().all(|r| found.contains_key(r));
        let frame = frame(&found, of);
        let (Some((frame, of_place)), true) = (frame, has(&[Role::Time]))
        else {
            let lacks = if has(&[Role::Time]) { "places" } else { "times" };
            let or = match of {
                Of::Sensor => "",
                Of::Front => ", or s (along the path)",
            };
            return Err(format!(
                "the header is {}, in which no column is known for {lacks}; \
                 expected columns for time, and for lon and lat or x and y\
                 {or}: name them, as in --columns time=UTC,lon=X,lat=Y",
                quoted(&header.join(","))
            ));
        };
        let (kind, of_speed) = match of {
            Of::Sensor => kind(&found),
            Of::Front => (SpeedKind::Front, &[][..]),
        };
        // Of speeds and of places only those that are used stay.
        let mut found = found;
        let rivals = [Role::Speed.rivals(), Role::X.rivals()].concat();
        let used = [of_speed, of_place].concat();
        found.retain(|role, _| !rivals.contains(role) || used.contains(role));
        once_each(&found, &header)?;
        Ok(Self { path, separator, found, kind, frame })
    }

    /// Takes a row, where it has what is needed.
    fn take(
        &self,
        record: &StringRecord,
        line: u64,
        rows: &mut Rows,
    ) -> Result<()> {
        let wrong = |what: String| at(self.path, line, &what);
        if rows.fixes.len() == MOST_ROWS {
            return Err(wrong(format!(
                "there are more than {MOST_ROWS} rows; expected at most as \
                 many: cut the log to the part that matters"
            )));
        }
        let Some(moment) = self.moment(record).map_err(wrong)? else {
            rows.empty += 1;
            return Ok(());
        };
        let Some(mut fix) = self.fix(record).map_err(wrong)? else {
            rows.empty += 1;
            return Ok(());
        };
        let begin = *rows.begin.get_or_insert(moment);
        let last = rows.fixes.last().map(|fix| fix.time);
        let mut time = moment.seconds - begin.seconds;
        // A clock without a date begins again at midnight.
        if last.is_some_and(|last| time < last - 0.5 * DAY) {
            time += DAY;
        }
        if last == Some(time) && self.kind == SpeedKind::Front {
            rows.join(fix);
            return Ok(());
        }
        if last.is_some_and(|last| time <= last) {
            rows.back.push(line);
            return Ok(());
        }
        (fix.time, fix.row) = (time, line);
        rows.fixes.push(fix);
        rows.points = 1;
        Ok(())
    }

    fn moment(&self, record: &StringRecord) -> Result<Option<Moment>, String> {
        let Some(column) = self.found.get(&Role::Time) else {
            return Ok(None);
        };
        let cell = self.cell(record, column);
        if cell.is_empty() {
            return Ok(None);
        }
        let cell = self.with_point(cell);
        moment(&cell, column.factor).map(Some).ok_or_else(|| {
            format!(
                "{} is {}; expected a time, in {} or as 07:51:22.5 or \
                 2022-02-22T07:51:22.5Z: mend the cell, or drop the row",
                quoted(&column.name),
                quoted(&cell),
                column.unit
            )
        })
    }

    /// The row but for its time; nothing where it has no place, or the
    /// receiver says that it had no satellites.
    fn fix(&self, record: &StringRecord) -> Result<Option<Fix>, String> {
        let number = |role| self.number(record, role);
        let (across, up) = match self.frame {
            Frame::Degrees => {
                (number(Role::Longitude)?, number(Role::Latitude)?)
            }
            Frame::Metres => (number(Role::X)?, number(Role::Y)?),
            Frame::Along => (number(Role::Along)?, Some(0.0)),
        };
        let (Some(x), Some(y)) = (across, up) else { return Ok(None) };
        let is_lost =
            number(Role::FixType)?.is_some_and(|fix| self.is_lost(fix));
        // What a receiver writes before it knows where it is; on a grid of
        // metres it is a place as any other.
        let is_nowhere = self.kind != SpeedKind::Front
            && self.frame == Frame::Degrees
            && (x, y) == (0.0, 0.0);
        if is_lost || is_nowhere {
            return Ok(None);
        }
        let is_geographic = self.frame == Frame::Degrees;
        if is_geographic && !(x.abs() <= 180.0 && y.abs() < 90.0) {
            return Err(format!(
                "the place is {x}, {y}; expected a longitude and a latitude \
                 in degrees: are these metres, or is the unit another? name \
                 columns and units with --columns"
            ));
        }
        let speed = self.speed(record)?;
        let has_speeds =
            !matches!(self.kind, SpeedKind::Positions | SpeedKind::Front);
        if speed.is_none() && has_speeds {
            return Ok(None);
        }
        let height = number(Role::Height)?;
        let satellites = number(Role::Satellites)?;
        let place = (x, y);
        let (row, time) = (0, 0.0);
        Ok(Some(Fix { row, time, place, height, speed, satellites }))
    }

    /// Whether a kind of fix is none: of u-blox's `fixType` 1 is dead reckoning
    /// alone, of NMEA's `fix` it is the plain one.
    fn is_lost(&self, fix: f64) -> bool {
        let of_ublox = self.found.get(&Role::FixType).is_some_and(|column| {
            column.name.to_lowercase().contains("fixtype")
        });
        fix < if of_ublox { 2.0 } else { 1.0 }
    }

    fn speed(&self, record: &StringRecord) -> Result<Option<f64>, String> {
        let number = |role| self.number(record, role);
        let (north, east) = (number(Role::North)?, number(Role::East)?);
        let level = north.zip(east).map(|(n, e)| n.hypot(e));
        Ok(match self.kind {
            SpeedKind::Positions | SpeedKind::Front => None,
            SpeedKind::Along => number(Role::Speed)?,
            SpeedKind::Ground => number(Role::GroundSpeed)?.or(level),
            SpeedKind::Whole => {
                let both = level.zip(number(Role::Down)?);
                both.map(|(level, down)| level.hypot(down))
            }
        })
    }

    fn cell<'c>(&self, record: &'c StringRecord, column: &Column) -> &'c str {
        record.get(column.at).unwrap_or_default()
    }

    /// A decimal comma as a point, where commas do not separate.
    fn with_point(&self, cell: &str) -> String {
        match self.separator {
            b',' => cell.to_owned(),
            _ => cell.replacen(',', ".", 1),
        }
    }

    /// The number of a role in the role's first unit; nothing where the cell
    /// is empty, or says that there is none.
    fn number(
        &self,
        record: &StringRecord,
        role: Role,
    ) -> Result<Option<f64>, String> {
        let Some(column) = self.found.get(&role) else { return Ok(None) };
        let cell = self.cell(record, column);
        if ["", "nan", "na", "n/a", "-", "null", "none"]
            .contains(&cell.to_ascii_lowercase().as_str())
        {
            return Ok(None);
        }
        match self.with_point(cell).parse::<f64>() {
            Ok(value) if is_for_none(role, value, column.factor) => {
                Err(format!(
                    "{} is {value}; expected a measured value [{}], and this \
                     is a mark for none: empty the cell, or drop the row",
                    quoted(&column.name),
                    column.unit
                ))
            }
            Ok(value) if value.abs() < 1e12 => Ok(Some(value * column.factor)),
            _ => Err(format!(
                "{} is {}; expected a finite number [{}]: mend the cell, or \
                 drop the row",
                quoted(&column.name),
                quoted(cell),
                column.unit
            )),
        }
    }

    fn finish(self, rows: Rows) -> Result<Log> {
        let (Some(begin), count) = (rows.begin, rows.fixes.len()) else {
            return Err(Error::input(format!(
                "{}: no row has a time and a place; expected rows of both: \
                 name the columns with --columns, or take another file",
                place(self.path)
            )));
        };
        if let Some(first) = rows.back.first()
            && rows.back.len() > most_odd(count)
        {
            return Err(at(
                self.path,
                *first,
                &format!(
                    "the time is not after that of the row before, and {} \
                     rows are so; expected a clock that goes forward: name \
                     another with --columns time=..",
                    rows.back.len()
                ),
            ));
        }
        let (mut said, doubts) = (self.said(count), Self::doubts(&rows));
        if rows.most_points > 1 {
            said.push(format!(
                "The points of one time, up to {}, are one place, their mean \
                 (Heredia et al. 2020, equation 12).",
                rows.most_points
            ));
        }
        let Self { frame, kind, .. } = self;
        let (path, fixes) = (self.path.to_owned(), rows.fixes);
        let is_simulated = false;
        Ok(Log { path, fixes, frame, kind, begin, is_simulated, said, doubts })
    }

    fn said(&self, count: usize) -> Vec<String> {
        let of = |column: &Column| {
            format!("{} [{}]", quoted(&column.name), column.unit)
        };
        let all: Vec<_> = self
            .found
            .iter()
            .map(|(role, column)| format!("{} = {}", role.name(), of(column)))
            .collect();
        let mut said = vec![format!(
            "Read {count} rows of {}: {}.",
            place(self.path),
            all.join(", ")
        )];
        let unknown: Vec<_> = self
            .found
            .iter()
            .filter(|(role, c)| !c.unit_is_known && role.units()[0] != "1")
            .map(|(_, column)| of(column))
            .collect();
        if !unknown.is_empty() {
            said.push(format!(
                "The header has no unit for {}; if that is not what they \
                 are, say so as in --columns speed=v:km/h.",
                unknown.join(", ")
            ));
        }
        said
    }

    fn doubts(rows: &Rows) -> Vec<String> {
        let mut doubts = Vec::new();
        if rows.empty > 0 {
            doubts.push(format!(
                "Rows passed over for want of a time, a place or a speed: {}.",
                rows.empty
            ));
        }
        if let Some(first) = rows.back.first() {
            doubts.push(format!(
                "Rows passed over because they are not later than the row \
                 before: {}, the first in line {first}.",
                rows.back.len()
            ));
        }
        doubts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(text: &str, columns: &str) -> Result<Log> {
        let columns = Columns::parse(columns)?;
        read(text, Path::new("log.csv"), &columns, Of::Sensor)
    }

    #[test]
    fn the_points_of_a_front_are_one_place_each_time() {
        let text = "t,x,y,z,v\n0,0,0,90,1\n0,4,2,94,1\n0,2,1,95,1\n\
                    1,5,5,80,1\n";
        let path = Path::new("front.csv");
        let front = read(text, path, &Columns::default(), Of::Front).unwrap();
        assert_eq!((front.fixes.len(), front.kind), (2, SpeedKind::Front));
        assert_eq!(front.fixes[0].place, (2.0, 1.0));
        assert_eq!(front.fixes[0].height, Some(93.0));
        assert_eq!(front.fixes[1].place, (5.0, 5.0));
        assert!(front.said[2].contains("up to 3"), "{:?}", front.said);
        assert!(!front.said[0].contains("\"v\""), "{:?}", front.said);
        // By a distance alone, where it is no sensor.
        let text = "t,s\n0,1\n1,3\n";
        let front = read(text, path, &Columns::default(), Of::Front).unwrap();
        assert_eq!(front.frame, Frame::Along);
        assert_eq!(front.fixes[1].place, (3.0, 0.0));
        let error = log(text, "").unwrap_err().to_string();
        assert!(error.contains("no column is known for places"), "{error}");
        let text = "t,u\n0,1\n1,3\n";
        let error = read(text, path, &Columns::default(), Of::Front);
        let error = error.unwrap_err().to_string();
        assert!(error.contains("or s (along the path)"), "{error}");
    }

    #[test]
    fn an_hour_is_that_of_the_log_on_the_day_nearest_to_it() {
        let text = "time,x,y\n2022-02-22T08:51:00+01:00,0,0\n\
                    2022-02-22T08:51:30+01:00,30,0\n";
        let dated = log(text, "").unwrap();
        assert_eq!(dated.fixes.len(), 2, "the origin of a grid is a place");
        let at = |text: &str| dated.moment("--to", text).unwrap();
        assert_eq!(at("08:51:10"), 10.0);
        assert_eq!(at("08:50:59"), -1.0);
        assert_eq!(at("2022-02-22T07:51:20Z"), 20.0);
        let plain = log("time,x,y\n08:51:00,0,0\n08:51:30,30,0\n", "");
        let error = plain.unwrap().moment("--to", "2022-02-22 08:51:10");
        let error = error.unwrap_err().to_string();
        assert!(error.contains("without a date"), "{error}");
    }

    #[test]
    fn what_would_be_lost_in_silence_is_refused() {
        let rows = "t,lon,lat,fix,note\n0,11.1,47.1,1,\n1,11.1,47.1,0,\n\
                    2,11.1,47.1,2,\n";
        // Of a plain fix 1 is one, of u-blox's it is none.
        assert_eq!(log(rows, "").unwrap().fixes.len(), 2);
        let ublox = rows.replace("fix", "fixType");
        assert_eq!(log(&ublox, "").unwrap().fixes.len(), 1);
        let open = rows.replace("47.1,0,", "47.1,0,\"rough");
        let error = log(&open, "").unwrap_err().to_string();
        assert!(error.contains("quotation mark is not closed"), "{error}");
        let text = "t,lon,lat,speed [furlong/h]\n0,11.1,47.1,1\n";
        let error = log(text, "").unwrap_err().to_string();
        assert!(error.contains("has the unit"), "{error}");
        let text = "t,lon,lat,speed [m s-1]\n0,11.1,47.1,1\n";
        assert_eq!(log(text, "").unwrap().fixes[0].speed, Some(1.0));
    }

    #[test]
    fn a_u_blox_log_has_its_speed_in_three_parts() {
        let text = "#iTow[ms],fixType[0-5],longitude[deg],latitude[deg],\
                    height[mm],velN[mm/s],velE[mm/s],velD[mm/s],gSpeed[mm/s],\
                    numSV[]#,height[m]\n\
                    1000,3,11.38,47.31,2303848,1000,2000,-2000,2236,11,2303\n\
                    1100,0,11.38,47.31,2303848,1000,2000,-2000,2236,11,2303\n\
                    1200,3,11.38,47.31,2303848,0,0,500,2236,11,2303\n";
        let log = log(text, "").unwrap();
        let fixes = &log.fixes;
        assert_eq!((fixes.len(), log.kind), (2, SpeedKind::Whole));
        assert!(!log.said[0].contains("gSpeed"), "{:?}", log.said);
        assert!((fixes[0].speed.unwrap() - 3.0).abs() < 1e-12);
        assert!((fixes[1].time - 0.2).abs() < 1e-12);
        assert_eq!(fixes[1].row, 4);
        assert_eq!(fixes[0].height, Some(2303.848));
        assert_eq!(fixes[0].satellites, Some(11.0));
        assert_eq!(log.doubts.len(), 1);
    }

    #[test]
    fn a_table_of_any_kind_is_read_by_names_and_units() {
        let text = "UTC;rechts;hoch;v_kmh\n07:00:00,5;1,5;2;36\n\
                    07:00:01,5;3;4;72\n";
        let log = log(text, "time=UTC,x=rechts,y=hoch,speed=v_kmh:km/h");
        let log = log.unwrap();
        assert_eq!(log.fixes[0].place, (1.5, 2.0));
        assert_eq!(log.fixes[1].time, 1.0);
        assert!((log.fixes[1].speed.unwrap() - 20.0).abs() < 1e-12);
        assert_eq!(log.moment("--from", "07:00:01.5").unwrap(), 1.0);
        assert_eq!(log.moment("--from", "3.5").unwrap(), 3.5);
    }

    #[test]
    fn midnight_and_steps_back_are_no_end() {
        let text = "time,lon,lat\n23:59:59,11,47\n00:00:01,11,47\n\
                    00:00:00,11,47\n00:00:02,11,47\n";
        let log = log(text, "").unwrap();
        let times: Vec<_> = log.fixes.iter().map(|fix| fix.time).collect();
        assert_eq!(times, [0.0, 2.0, 3.0]);
        assert!(log.doubts[0].contains("line 4"), "{:?}", log.doubts);
        assert_eq!(log.kind, SpeedKind::Positions);
    }

    #[test]
    fn what_is_like_a_mark_is_read_where_it_may_be_measured() {
        let text = "t,lon,lat,velN[mm/s],velE[mm/s],velD[mm/s],note,note\n\
                    1,2,3,-999,-9999,0,a,b\n";
        let speed = log(text, "").unwrap().fixes[0].speed.unwrap();
        assert!((speed - 0.999_f64.hypot(9.999)).abs() < 1e-9, "{speed}");
    }

    #[test]
    fn a_bad_cell_is_named_by_its_line() {
        for (text, part) in [
            ("", "log.csv: is empty"),
            ("t,lon\n1,2\n", "log.csv:1: the header is"),
            ("t,lon,lat\n", "no row has a time"),
            ("t,lon,lat\n\n1,x,2\n", "log.csv:3: \"lon\" is \"x\""),
            ("t,lon,lat\nnoon,1,2\n", "log.csv:2: \"t\" is \"noon\""),
            ("t,lon,lat\n1,79400,5\n", "log.csv:2: the place is 79400, 5"),
            ("t,lon,lat,v\n1,2,3,inf\n", "\"v\" is \"inf\""),
            (
                "t,lon,lat,v\n1,2,3,4\n2,2,3,-9999\n",
                "log.csv:3: \"v\" is -9999; expected a measured value [m/s], \
                 and this is a mark for none: empty the cell",
            ),
            ("t,lon,lat,v\n1,2,3,999\n", "csv:2: \"v\" is 999; expected"),
            ("t,lon,lat,z\n1,2,3,-999\n", "csv:2: \"z\" is -999; expected"),
            ("t,lon,lat,v,v\n1,2,3,4,5\n", "csv:1: the header is"),
            ("t,lon,lat,v,v\n1,2,3,4,5\n", "which has \"v\" twice"),
        ] {
            let error = log(text, "").unwrap_err();
            assert!(error.is_input());
            assert!(error.to_string().contains(part), "{error}");
        }
    }
}
