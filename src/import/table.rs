//! A log as a table of text: u-blox logs, and any CSV whose columns are
//! known or named.

use std::io::Read as _;
use std::path::Path;

use csv::{ByteRecord, StringRecord};

use super::clock::{DAY, Moment, moment};
use super::columns::{Column, Columns, Found};
use super::log::{Fix, Log, SpeedKind};
use super::role::Role;
use crate::error::{Error, Result};
use crate::io::{MOST_ROWS, place, quoted};

/// Rows that may be passed over before the file is refused: a share of them,
/// and a number.
const MOST_ODD: (f64, usize) = (0.1, 10);

/// The parts of a velocity.
const WHOLE: [Role; 3] = [Role::North, Role::East, Role::Down];

/// A table being read.
struct Reader<'r> {
    path: &'r Path,
    separator: u8,
    found: Found,
    kind: SpeedKind,
    is_geographic: bool,
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
}

/// Reads a table with a header.
pub(super) fn read(text: &str, path: &Path, columns: &Columns) -> Result<Log> {
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
        match &reader {
            None => {
                let new = Reader::new(path, separator, columns, &record);
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

impl<'r> Reader<'r> {
    fn new(
        path: &'r Path,
        separator: u8,
        columns: &Columns,
        header: &StringRecord,
    ) -> Result<Self, String> {
        let header: Vec<&str> = header.iter().collect();
        let found = columns.find(&header)?;
        let has = |roles: &[Role]| roles.iter().all(|r| found.contains_key(r));
        let is_geographic = has(&[Role::Longitude, Role::Latitude]);
        let is_placed = is_geographic || has(&[Role::X, Role::Y]);
        if !(has(&[Role::Time]) && is_placed) {
            let lacks = if has(&[Role::Time]) { "places" } else { "times" };
            return Err(format!(
                "the header is {}, in which no column is known for {lacks}; \
                 expected columns for time, and for lon and lat or x and y: \
                 name them, as in --columns time=UTC,lon=X,lat=Y",
                quoted(&header.join(","))
            ));
        }
        let (kind, of_speed) = kind(&found);
        // Of speeds only those that are used stay.
        let rivals = Role::Speed.rivals();
        let mut found = found;
        found.retain(|role, _| {
            !rivals.contains(role) || of_speed.contains(role)
        });
        Ok(Self { path, separator, found, kind, is_geographic })
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
        if last.is_some_and(|last| time <= last) {
            rows.back.push(line);
            return Ok(());
        }
        (fix.time, fix.row) = (time, line);
        rows.fixes.push(fix);
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
        let (across, up) = match self.is_geographic {
            true => (number(Role::Longitude)?, number(Role::Latitude)?),
            false => (number(Role::X)?, number(Role::Y)?),
        };
        let (Some(x), Some(y)) = (across, up) else { return Ok(None) };
        let is_lost = number(Role::FixType)?.is_some_and(|fix| fix < 2.0);
        if is_lost || (x == 0.0 && y == 0.0) {
            return Ok(None);
        }
        if self.is_geographic && !(x.abs() <= 180.0 && y.abs() < 90.0) {
            return Err(format!(
                "the place is {x}, {y}; expected a longitude and a latitude \
                 in degrees: are these metres, or is the unit another? name \
                 columns and units with --columns"
            ));
        }
        let speed = self.speed(record)?;
        if speed.is_none() && self.kind != SpeedKind::Positions {
            return Ok(None);
        }
        let height = number(Role::Height)?;
        let satellites = number(Role::Satellites)?;
        let place = (x, y);
        let (row, time) = (0, 0.0);
        Ok(Some(Fix { row, time, place, height, speed, satellites }))
    }

    fn speed(&self, record: &StringRecord) -> Result<Option<f64>, String> {
        let number = |role| self.number(record, role);
        let (north, east) = (number(Role::North)?, number(Role::East)?);
        let level = north.zip(east).map(|(n, e)| n.hypot(e));
        Ok(match self.kind {
            SpeedKind::Positions => None,
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
        let most = MOST_ODD.1.max((MOST_ODD.0 * count as f64) as usize);
        if let Some(first) = rows.back.first()
            && rows.back.len() > most
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
        let (said, doubts) = (self.said(count), Self::doubts(&rows));
        let Self { is_geographic, kind, .. } = self;
        let fixes = rows.fixes;
        Ok(Log { fixes, is_geographic, kind, begin, said, doubts })
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
        read(text, Path::new("log.csv"), &columns)
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
    fn a_bad_cell_is_named_by_its_line() {
        for (text, part) in [
            ("", "log.csv: is empty"),
            ("t,lon\n1,2\n", "log.csv:1: the header is"),
            ("t,lon,lat\n", "no row has a time"),
            ("t,lon,lat\n\n1,x,2\n", "log.csv:3: \"lon\" is \"x\""),
            ("t,lon,lat\nnoon,1,2\n", "log.csv:2: \"t\" is \"noon\""),
            ("t,lon,lat\n1,79400,5\n", "log.csv:2: the place is 79400, 5"),
            ("t,lon,lat,v\n1,2,3,inf\n", "\"v\" is \"inf\""),
        ] {
            let error = log(text, "").unwrap_err();
            assert!(error.is_input());
            assert!(error.to_string().contains(part), "{error}");
        }
    }
}
