//! Data files: the points of a track, the values of a recording, flow depths.

use std::io::{ErrorKind, Read};
use std::path::Path;

use csv::StringRecord;

use super::lines::Lines;
use super::words::{admissible, either, nearest, place, quoted};
use crate::error::{Error, Result};
use crate::observe::{Quantity, Series};
use crate::physics::{Depth, DepthRows, Track};

/// The most rows that a data file may have.
pub const MOST_ROWS: usize = 1_000_000;

/// How many columns every data file has.
const NEEDED: usize = 2;

/// One row: as many numbers as the header has columns, then zeros.
type Row = [f64; 3];

/// A column: its name in the header and the unit of its values.
type Column = (&'static str, &'static str);

/// Reads a track, `x,z`: horizontal distance \[m\], increasing, and elevation
/// \[m\]. `path` is what messages call the source.
///
/// ```
/// use std::path::Path;
/// let text = "x,z\n0,2400\n30,2360\n";
/// let track =
///     couloir::io::read_track(text.as_bytes(), Path::new("track.csv"))?;
/// assert_eq!(track.length(), 50.0);
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// An input error that names the line: another header, a cell that is no
/// finite number, a distance that does not increase, fewer than two points,
/// more than [`MOST_ROWS`], or bytes that are no text.
pub fn read_track(source: impl Read, path: &Path) -> Result<Track> {
    let columns = [("x", "m"), ("z", "m")];
    let check = |before: Option<&Row>, row: &Row| match before {
        Some(before) if row[0] <= before[0] => Err(format!(
            "x = {} follows x = {}; expected horizontal distances that \
             increase: sort the points and drop repeated ones",
            row[0], before[0]
        )),
        _ => Ok(()),
    };
    let table = Table { path, columns: &columns, or: &[] };
    let (_, rows) = table.read(source, "write \"x,z\"", check)?;
    if rows.len() < 2 {
        return Err(Error::input(format!(
            "{}: has one point only; expected at least two: add the end of \
             the slope",
            place(path)
        )));
    }
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<_>>();
    Track::from_points(&column(0), &column(1))
        .map_err(|error| error.within(place(path)))
}

/// Reads a recording, `t,<quantity>` and, if known, `sigma`: time since the
/// release \[s\], increasing, the value and its standard error in the unit of
/// the quantity. `path` is what messages call the source.
///
/// # Errors
/// An input error that names the line: another header or quantity, a cell
/// that is no finite number, a time that is negative or does not increase, a
/// negative standard error, no row, more than [`MOST_ROWS`], or bytes that
/// are no text.
pub fn read_recording(
    source: impl Read,
    quantity: Quantity,
    path: &Path,
) -> Result<Series> {
    let unit = quantity.unit();
    let columns = [("t", "s"), (quantity.name(), unit), ("sigma", unit)];
    let mend = format!(
        "write \"t,{quantity}\" over times [s] and values [{unit}], or change \
         recording.quantity, which is \"{quantity}\""
    );
    let table = Table { path, columns: &columns, or: &[] };
    let (given, rows) = table.read(source, &mend, check_values)?;
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<_>>();
    let series =
        Series::new(quantity, column(0), column(1)).and_then(|series| {
            match given.len() {
                3 => series.with_standard_errors(column(2)),
                _ => Ok(series),
            }
        });
    series.map_err(|error| error.within(place(path)))
}

fn check_values(before: Option<&Row>, row: &Row) -> Result<(), String> {
    let [t, _, sigma] = *row;
    if t < 0.0 {
        return Err(format!(
            "t = {t}; expected seconds after the release, 0 or more: count \
             from the release, and drop what lies before"
        ));
    }
    if let Some([last, ..]) = before
        && t <= *last
    {
        return Err(format!(
            "t = {t} follows t = {last}; expected times that increase: sort \
             the rows and drop repeated ones"
        ));
    }
    if sigma < 0.0 {
        return Err(format!(
            "sigma = {sigma}; expected a standard error, 0 or more"
        ));
    }
    Ok(())
}

/// Reads flow depths, `x,depth` or `t,depth`: horizontal distance \[m\] or
/// time since the release \[s\], increasing, and the depth \[m\]. `path` is
/// what messages call the source.
///
/// ```
/// use std::path::Path;
/// use couloir::{io::read_depth, physics::Depth};
/// let text = "t,depth\n0,1.2\n20,2.4\n";
/// let depth = read_depth(text.as_bytes(), Path::new("depth.csv"))?;
/// let Depth::During(rows) = depth else { unreachable!() };
/// assert!((rows.at(10.0) - 1.8).abs() < 1e-12);
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// An input error that names the line: another header, a cell that is no
/// finite number, a place or a time that does not increase, a depth that is
/// not more than 0, no row, more than [`MOST_ROWS`], or bytes that are no
/// text.
pub fn read_depth(source: impl Read, path: &Path) -> Result<Depth> {
    let table = Table {
        path,
        columns: &[("x", "m"), ("depth", "m")],
        or: &[("t", "s"), ("depth", "m")],
    };
    let mend = "write \"x,depth\" over horizontal distances [m], or \
                \"t,depth\" over times [s], and depths [m]";
    let (given, rows) = table.read(source, mend, check_depths)?;
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<_>>();
    let rows = DepthRows::new(column(0), column(1))
        .map_err(|error| error.within(place(path)))?;
    Ok(match given[0].0 {
        "t" => Depth::During(rows),
        _ => Depth::Along(rows),
    })
}

fn check_depths(before: Option<&Row>, row: &Row) -> Result<(), String> {
    let [at, depth, _] = *row;
    if let Some([last, ..]) = before
        && at <= *last
    {
        return Err(format!(
            "{at} follows {last}; expected places or times that increase: \
             sort the rows and drop repeated ones"
        ));
    }
    if depth <= 0.0 {
        return Err(format!(
            "depth = {depth}; expected metres, more than 0: drop the row \
             where nothing was measured"
        ));
    }
    Ok(())
}

/// What a data file has to look like.
struct Table<'t> {
    path: &'t Path,
    /// The columns, of which those after [`NEEDED`] may be left out.
    columns: &'t [Column],
    /// Others that may be there instead, all of them.
    or: &'t [Column],
}

impl<'t> Table<'t> {
    /// The columns that the header has, and the rows.
    fn read(
        &self,
        source: impl Read,
        mend: &str,
        check: impl Fn(Option<&Row>, &Row) -> Result<(), String>,
    ) -> Result<(&'t [Column], Vec<Row>)> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .quoting(false)
            .trim(csv::Trim::All)
            .from_reader(Lines::new(source));
        let mut record = StringRecord::new();
        let mut rows: Vec<Row> = Vec::new();
        let mut given: &'t [Column] = &[];
        while reader
            .read_record(&mut record)
            .map_err(|error| self.broken(error))?
        {
            // Every line ends in one line feed: the reader stands behind it.
            let line = reader.position().line() - 1;
            let at = |message| self.at(line, message);
            if given.is_empty() {
                given = self.header(&record, mend).map_err(at)?;
                continue;
            }
            if rows.len() == MOST_ROWS {
                return Err(at(format!(
                    "there are more than {MOST_ROWS} rows; expected at most \
                     as many: thin them out"
                )));
            }
            let row = self.row(&record, given).map_err(at)?;
            check(rows.last(), &row).map_err(at)?;
            rows.push(row);
        }
        if rows.is_empty() {
            Err(self.empty(given.len()))
        } else {
            Ok((given, rows))
        }
    }

    /// The columns of a good header.
    fn header(
        &self,
        record: &StringRecord,
        mend: &str,
    ) -> Result<&'t [Column], String> {
        let found: Vec<_> = record.iter().map(bare).collect();
        let names: Vec<_> = self.columns.iter().map(|c| c.0).collect();
        if found.len() >= NEEDED && names.starts_with(&found) {
            return Ok(&self.columns[..found.len()]);
        }
        let other: Vec<_> = self.or.iter().map(|c| c.0).collect();
        if !other.is_empty() && found == other {
            return Ok(self.or);
        }
        let mut forms: Vec<_> =
            (NEEDED..=names.len()).map(|n| names[..n].join(",")).collect();
        if !other.is_empty() {
            forms.push(other.join(","));
        }
        let forms: Vec<_> = forms.iter().map(String::as_str).collect();
        let text = found.join(",");
        Err(format!(
            "the header is {}; expected {}: {}",
            quoted(&text),
            either(&forms),
            self.header_mend(&found, &names, mend)
        ))
    }

    /// What to do about a header that is not as it should be.
    fn header_mend(
        &self,
        found: &[&str],
        names: &[&str],
        mend: &str,
    ) -> String {
        if found.iter().all(|cell| cell.parse::<f64>().is_ok()) {
            return "put the header above the numbers".to_owned();
        }
        if found.iter().any(|cell| cell.contains([';', '\t'])) {
            return "separate the columns by commas, and write decimals with \
                    a point"
                .to_owned();
        }
        if found.iter().any(|cell| cell.contains(['[', '(', '_', '/'])) {
            let units: Vec<_> = self.columns.iter().map(|c| c.1).collect();
            return format!(
                "units are not written there, the values are in {}: convert \
                 them, and {mend}",
                units.join(", ")
            );
        }
        if found.len() > names.len() && found.starts_with(names) {
            return "drop the further columns".to_owned();
        }
        let strange = found.iter().find(|cell| !names.contains(cell));
        match strange.and_then(|cell| nearest(cell, names)) {
            Some(name) => format!("did you mean {name:?}? {mend}"),
            None => mend.to_owned(),
        }
    }

    fn row(
        &self,
        record: &StringRecord,
        given: &[Column],
    ) -> Result<Row, String> {
        if record.len() != given.len() {
            return Err(format!(
                "has {}; expected {}, as in the header: separate \
                 them by commas, and write decimals with a point",
                match record.len() {
                    1 => "1 cell".to_owned(),
                    count => format!("{count} cells"),
                },
                given.len()
            ));
        }
        let mut row = Row::default();
        for ((cell, value), (name, unit)) in
            record.iter().zip(&mut row).zip(given)
        {
            *value = number(bare(cell), unit)
                .map_err(|what| format!("{name} {what}"))?;
        }
        Ok(row)
    }

    fn at(&self, line: u64, message: String) -> Error {
        Error::input(message)
            .within(format_args!("{}:{line}", place(self.path)))
    }

    fn empty(&self, given: usize) -> Error {
        let names: Vec<_> = self.columns.iter().map(|c| c.0).collect();
        let header = names[..NEEDED].join(",");
        let found = match given {
            0 => "is empty",
            _ => "has a header and no rows",
        };
        Error::input(format!(
            "{}: {found}; expected the header {header:?} and rows of numbers \
             below it",
            place(self.path)
        ))
    }

    /// The error for a source that broke off.
    fn broken(&self, error: csv::Error) -> Error {
        let place = place(self.path);
        match error.into_kind() {
            csv::ErrorKind::Io(e) if e.kind() == ErrorKind::InvalidData => {
                Error::input(format!("{place}:{e}"))
            }
            csv::ErrorKind::Io(e) => Error::input(format!(
                "{place}: could not be read to its end ({e})"
            )),
            _ => Error::input(format!(
                "{place}: is no CSV table; expected rows of numbers"
            )),
        }
    }
}

/// A cell without the quotes that some programs put around every cell.
fn bare(cell: &str) -> &str {
    cell.strip_prefix('"')
        .and_then(|cell| cell.strip_suffix('"'))
        .map_or(cell, str::trim)
}

fn number(cell: &str, unit: &str) -> Result<f64, String> {
    if cell.is_empty() {
        return Err(format!(
            "is empty; expected a number [{unit}]: drop the row where nothing \
             was measured"
        ));
    }
    match cell.parse::<f64>() {
        Err(_) => Err(format!(
            "is {}; expected a number [{unit}], such as 12.5",
            quoted(cell)
        )),
        Ok(value) if !value.is_finite() => Err(format!(
            "is {}; expected a finite number [{unit}]: drop the row where \
             nothing was measured",
            quoted(cell)
        )),
        Ok(value) => admissible(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn speeds(text: &str) -> Result<Series> {
        let path = Path::new("r.csv");
        read_recording(text.as_bytes(), Quantity::Velocity, path)
    }

    #[test]
    fn harmless_variants_read_alike() {
        let plain = speeds("t,velocity\n1,2.5\n2,3\n").unwrap();
        for text in [
            "\u{feff}t,velocity\r\n1,2.5\r\n2,3\r\n\r\n\r\n",
            "t, velocity\n 1 , 2.5\n2,\t3",
            "\"t\",\"velocity\"\n\"1\",\"2.5\"\n2,3\n  \n",
            "\n\nt,velocity\n\n+1.0,25e-1\n2.,3.0\n",
        ] {
            assert_eq!(speeds(text).unwrap(), plain, "{text:?}");
        }
    }

    #[test]
    fn depths_are_over_places_or_times() {
        let read =
            |text: &str| read_depth(text.as_bytes(), Path::new("d.csv"));
        let rows = DepthRows::new(vec![0.0, 5.0], vec![1.0, 2.0]).unwrap();
        let over = |first: &str| read(&format!("{first},depth\n0,1\n5,2\n"));
        assert_eq!(over("x").unwrap(), Depth::Along(rows.clone()));
        assert_eq!(over("t").unwrap(), Depth::During(rows));
        for (text, part) in [
            ("s,depth\n0,1\n", "\"x,depth\" or \"t,depth\""),
            ("x,depth,z\n0,1,2\n", "d.csv:1"),
            ("x,depth\n0,1\n0,2\n", "d.csv:3: 0 follows 0"),
            ("x,depth\n0,1\n2,0\n", "d.csv:3: depth = 0; expected metres"),
            ("t,depth\n0,inf\n", "d.csv:2: depth is \"inf\""),
            ("t,depth\n", "no rows"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn standard_errors_are_read_where_given() {
        let series = speeds("t,velocity,sigma\n1,2,0.5\n2,3,0\n").unwrap();
        assert_eq!(series.grid().standard_errors(), Some(&[0.5, 0.0][..]));
    }

    #[test]
    fn the_line_named_is_the_line_meant() {
        for (text, line) in [
            ("t,velocity\n1,2\n2,x\n3,4\n", 3),
            ("t,velocity\r\n1,2\r\n2,x\r\n", 3),
            ("\n\nt,velocity\n\n\n1,2\n\n\n2,x", 9),
            ("\r\nt,velocity\r\n\r\n1,x", 4),
        ] {
            let error = speeds(text).unwrap_err().to_string();
            assert!(error.starts_with(&format!("r.csv:{line}: ")), "{error}");
        }
    }
}
