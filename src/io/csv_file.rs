//! Data files: the points of a track, the values of a recording, flow depths.

use std::io::{ErrorKind, Read};
use std::path::Path;

use csv::StringRecord;

use super::lines::Lines;
use super::plausible::{Values, is_mark};
use super::words::{admissible, either, place, quoted};
use crate::error::{Error, Result};
use crate::observe::{Quantity, Series};
use crate::physics::{Depth, DepthRows, Track};
use crate::spelling::nearest;

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
    track_of(source, path).map(|(track, _)| track)
}

/// The track, and the columns of the file that it has no use for.
pub(super) fn track_of(
    source: impl Read,
    path: &Path,
) -> Result<(Track, Vec<String>)> {
    let columns = [("x", "m"), ("z", "m")];
    let table = Table { path, columns: &columns, or: &[] };
    let mend =
        "write \"x,z\" over horizontal distances [m] and elevations [m]";
    let Rows { rows, unused, .. } = table.read(source, mend, check_point)?;
    if rows.len() < 2 {
        return Err(Error::input(format!(
            "{}: has one point only; expected at least two: add the end of \
             the slope",
            place(path)
        )));
    }
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<_>>();
    Track::from_points(&column(0), &column(1))
        .map(|track| (track, unused))
        .map_err(|error| error.within(place(path)))
}

fn check_point(before: Option<&Row>, row: &Row) -> Result<(), String> {
    let [x, z, _] = *row;
    if is_mark(z) {
        return Err(format!(
            "z = {z}; expected metres, and this is a mark for no elevation: \
             drop the points where the terrain model has none"
        ));
    }
    match before {
        Some([last, ..]) if x <= *last => Err(format!(
            "x = {x} follows x = {last}; expected horizontal distances that \
             increase: sort the points and drop repeated ones"
        )),
        _ => Ok(()),
    }
}

/// Reads a recording, `t,<quantity>` and, if known, `sigma`: time since the
/// release \[s\], increasing, the value and its standard error in the unit of
/// the quantity. `path` is what messages call the source.
///
/// # Errors
/// An input error that names the line: another header or quantity, a cell
/// that is no finite number, a time that is negative or does not increase, a
/// value that no mass on a slope has, a negative standard error, no row, more
/// than [`MOST_ROWS`], or bytes that are no text.
pub fn read_recording(
    source: impl Read,
    quantity: Quantity,
    path: &Path,
) -> Result<Series> {
    recording_of(source, quantity, path).map(|(series, _)| series)
}

/// The recording, and the columns of the file that it has no use for.
pub(super) fn recording_of(
    source: impl Read,
    quantity: Quantity,
    path: &Path,
) -> Result<(Series, Vec<String>)> {
    let unit = quantity.unit();
    let columns = [("t", "s"), (quantity.name(), unit), ("sigma", unit)];
    let mend = format!(
        "write \"t,{quantity}\" over times [s] and values [{unit}], or change \
         recording.quantity, which is \"{quantity}\""
    );
    let table = Table { path, columns: &columns, or: &[] };
    let Rows { given, rows, lines, unused } =
        table.read(source, &mend, check_values)?;
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<_>>();
    let (times, values) = (column(0), column(1));
    let read =
        Values { quantity, times: &times, values: &values, lines: &lines };
    let wrong = |(line, message)| table.at(line, message);
    read.check().map_err(wrong)?;
    if given.len() == 3 {
        read.check_errors(&column(2)).map_err(wrong)?;
    }
    let series = Series::new(quantity, times, values).and_then(|series| {
        match given.len() {
            3 => series.with_standard_errors(column(2)),
            _ => Ok(series),
        }
    });
    let series = series.map_err(|error| error.within(place(path)))?;
    Ok((series, unused))
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
    depth_of(source, path).map(|(depth, _)| depth)
}

/// The depths, and the columns of the file that they have no use for.
pub(super) fn depth_of(
    source: impl Read,
    path: &Path,
) -> Result<(Depth, Vec<String>)> {
    let table = Table {
        path,
        columns: &[("x", "m"), ("depth", "m")],
        or: &[("t", "s"), ("depth", "m")],
    };
    let mend = "write \"x,depth\" over horizontal distances [m], or \
                \"t,depth\" over times [s], and depths [m]";
    let Rows { given, rows, unused, .. } =
        table.read(source, mend, check_depths)?;
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<_>>();
    let rows = DepthRows::new(column(0), column(1))
        .map_err(|error| error.within(place(path)))?;
    let depth = match given[0].0 {
        "t" => Depth::During(rows),
        _ => Depth::Along(rows),
    };
    Ok((depth, unused))
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

/// What a data file has.
struct Rows<'t> {
    /// The columns of the form that it has.
    given: &'t [Column],
    rows: Vec<Row>,
    /// The lines of the rows.
    lines: Vec<u64>,
    /// The names of columns that nobody asked for.
    unused: Vec<String>,
}

/// A header: the columns of a form, where each of them stands, and how many
/// cells there are.
struct Header<'t> {
    given: &'t [Column],
    at: Vec<usize>,
    width: usize,
    unused: Vec<String>,
}

impl<'t> Table<'t> {
    /// The rows, in the order of the form's columns.
    fn read(
        &self,
        source: impl Read,
        mend: &str,
        check: impl Fn(Option<&Row>, &Row) -> Result<(), String>,
    ) -> Result<Rows<'t>> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .quoting(false)
            .trim(csv::Trim::All)
            .from_reader(Lines::new(source));
        let mut record = StringRecord::new();
        let (mut rows, mut lines) = (Vec::<Row>::new(), Vec::new());
        let mut header: Option<Header<'t>> = None;
        while reader
            .read_record(&mut record)
            .map_err(|error| self.broken(error))?
        {
            // Every line ends in one line feed: the reader stands behind it.
            let line = reader.position().line() - 1;
            let at = |message| self.at(line, message);
            let Some(header) = &header else {
                header = Some(self.header(&record, mend).map_err(at)?);
                continue;
            };
            if rows.len() == MOST_ROWS {
                return Err(at(format!(
                    "there are more than {MOST_ROWS} rows; expected at most \
                     as many: thin them out"
                )));
            }
            let row = row(&record, header).map_err(at)?;
            check(rows.last(), &row).map_err(at)?;
            rows.push(row);
            lines.push(line);
        }
        match header {
            Some(Header { given, unused, .. }) if !rows.is_empty() => {
                Ok(Rows { given, rows, lines, unused })
            }
            header => Err(self.empty(header.is_some())),
        }
    }

    /// A good header: it has the names of a form, in whatever order and beside
    /// whatever others.
    fn header(
        &self,
        record: &StringRecord,
        mend: &str,
    ) -> Result<Header<'t>, String> {
        let found: Vec<_> = record.iter().map(bare).collect();
        let names: Vec<_> = self.columns.iter().map(|c| c.0).collect();
        let has = |form: &[Column]| {
            form.len() >= NEEDED
                && form[..NEEDED].iter().all(|c| found.contains(&c.0))
        };
        match (has(self.columns), has(self.or)) {
            (true, true) => return Err(self.both(&found)),
            (true, false) => {
                let also = self.columns[NEEDED..].iter();
                let also = also.take_while(|c| found.contains(&c.0)).count();
                return header_of(&found, &self.columns[..NEEDED + also]);
            }
            (false, true) => return header_of(&found, self.or),
            (false, false) => {}
        }
        let other: Vec<_> = self.or.iter().map(|c| c.0).collect();
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

    /// The error for a header that has the columns of both forms.
    fn both(&self, found: &[&str]) -> String {
        format!(
            "the header is {}; expected either {:?} or {:?} in it: drop one",
            quoted(&found.join(",")),
            self.columns[0].0,
            self.or[0].0
        )
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
        let lacking: Vec<_> =
            names.iter().copied().filter(|n| !found.contains(n)).collect();
        let mut strange = found.iter().filter(|cell| !names.contains(cell));
        match strange.find_map(|cell| nearest(cell, &lacking)) {
            Some(name) => format!("did you mean {name:?}? {mend}"),
            None => mend.to_owned(),
        }
    }

    fn at(&self, line: u64, message: String) -> Error {
        Error::input(message)
            .within(format_args!("{}:{line}", place(self.path)))
    }

    fn empty(&self, has_header: bool) -> Error {
        let names: Vec<_> = self.columns.iter().map(|c| c.0).collect();
        let header = names[..NEEDED].join(",");
        let found = match has_header {
            false => "is empty",
            true => "has a header and no rows",
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

/// Where the columns of a form stand in a header that has them.
fn header_of<'t>(
    found: &[&str],
    given: &'t [Column],
) -> Result<Header<'t>, String> {
    let mut at = Vec::with_capacity(given.len());
    for (name, _) in given {
        let mut places = found.iter().enumerate().filter(|(_, c)| *c == name);
        at.extend(places.next().map(|(i, _)| i));
        if places.next().is_some() {
            return Err(format!(
                "the header is {}, which has {name:?} twice; expected each \
                 column once: drop or rename one",
                quoted(&found.join(","))
            ));
        }
    }
    let others = found.iter().enumerate().filter(|(i, _)| !at.contains(i));
    let unused = others.map(|(_, name)| (*name).to_owned()).collect();
    Ok(Header { given, at, width: found.len(), unused })
}

/// The numbers of a row, in the order of the form's columns.
fn row(record: &StringRecord, header: &Header<'_>) -> Result<Row, String> {
    if record.len() != header.width {
        return Err(format!(
            "has {}; expected {}, as in the header: separate them by commas, \
             and write decimals with a point",
            match record.len() {
                1 => "1 cell".to_owned(),
                count => format!("{count} cells"),
            },
            header.width
        ));
    }
    let mut row = Row::default();
    let columns = header.at.iter().zip(header.given);
    for (value, (at, (name, unit))) in row.iter_mut().zip(columns) {
        let cell = record.get(*at).unwrap_or_default();
        *value = number(bare(cell), unit)
            .map_err(|what| format!("{name} {what}"))?;
    }
    Ok(row)
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
            ("x,t,depth\n0,0,1\n", "either \"x\" or \"t\" in it"),
            ("x,depth,x\n0,1,2\n", "\"x\" twice"),
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
    fn columns_are_found_by_their_names() {
        let plain = speeds("t,velocity,sigma\n1,2,0.5\n2,3,0\n").unwrap();
        for text in [
            "t,velocity,sigma,note\n1,2,0.5,a\n2,3,0,\n",
            "id,sigma,velocity,hdop,t\nx,0.5,2,1.1,1\ny,0,3,n/a,2\n",
        ] {
            assert_eq!(speeds(text).unwrap(), plain, "{text:?}");
        }
        let path = Path::new("track.csv");
        let text = "z,name,x\n30,top,0\n0,end,40\n";
        let (track, unused) = track_of(text.as_bytes(), path).unwrap();
        assert_eq!((track.length(), unused), (50.0, vec!["name".to_owned()]));
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
