//! Which columns of a log are taken: those that `--columns` names, and those
//! whose names are known.

use std::collections::BTreeMap;

use super::role::Role;
use crate::error::{Error, Result};
use crate::io::either;
use crate::spelling::{breaks_line, nearest, quoted};

/// A column that a user named.
#[derive(Debug, Clone, PartialEq)]
struct Named {
    column: String,
    unit: Option<String>,
}

/// The columns that a user named: `time=UTC,speed=v_kmh:km/h`.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Columns(BTreeMap<Role, Named>);

/// A column as it is read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    /// Its place in a row, from 0.
    pub(super) at: usize,
    /// Its name in the header.
    pub(super) name: String,
    /// What one of its values is in the role's first unit.
    pub(super) factor: f64,
    /// The unit it was taken to have.
    pub(super) unit: String,
    /// Whether a header or the user said the unit.
    pub(super) unit_is_known: bool,
}

/// The columns of a log by what they hold.
pub(super) type Found = BTreeMap<Role, Column>;

impl Columns {
    /// Reads what `--columns` says.
    pub(super) fn parse(text: &str) -> Result<Self> {
        let mut named = BTreeMap::new();
        for part in text.split(',').filter(|part| !part.trim().is_empty()) {
            let (role, column) = one(part)?;
            if named.insert(role, column).is_some() {
                return Err(Error::input(format!(
                    "--columns: has {:?} twice; expected each once: drop one",
                    role.name()
                )));
            }
        }
        Ok(Self(named))
    }

    /// The columns of a header, as far as it has them.
    pub(super) fn find(&self, header: &[&str]) -> Result<Found, String> {
        let cells: Vec<_> = header.iter().map(|cell| split(cell)).collect();
        let mut found = Found::new();
        for role in Role::all() {
            let taken = |rival: &Role| self.0.contains_key(rival);
            let column = match self.0.get(&role) {
                Some(named) => Some(named.find(role, header, &cells)?),
                None if role.rivals().iter().any(taken) => None,
                None => known(role, header, &cells)?,
            };
            if let Some(column) = column {
                found.insert(role, column);
            }
        }
        Ok(found)
    }
}

/// One `role=column` or `role=column:unit`.
fn one(part: &str) -> Result<(Role, Named)> {
    let wrong = |what: String| Err(Error::input(format!("--columns: {what}")));
    let Some((name, column)) = part.split_once('=') else {
        return wrong(format!(
            "found {}; expected what=column or what=column:unit, such as \
             speed=v_kmh:km/h",
            quoted(part)
        ));
    };
    let (name, column) = (name.trim(), column.trim());
    let Some(role) = Role::named(name) else {
        let names = Role::names();
        let meant = nearest(name, &names);
        let meant = meant.map(|m| format!(": did you mean {m:?}?"));
        return wrong(format!(
            "found {}; expected {}{}",
            quoted(name),
            either(&names),
            meant.unwrap_or_default()
        ));
    };
    // Units have colons themselves (hh:mm:ss): the longest one that fits.
    let cuts = column.match_indices(':').map(|(at, _)| at);
    let unit = cuts
        .map(|at| (&column[..at], &column[at + 1..]))
        .find(|(_, unit)| role.factor(unit).is_some());
    let (column, unit) = match unit {
        Some((column, unit)) => (column, Some(unit.to_owned())),
        None => (column, None),
    };
    if column.is_empty() {
        return wrong(format!(
            "{name:?} names no column; expected {name}=column"
        ));
    }
    Ok((role, Named { column: column.to_owned(), unit }))
}

impl Named {
    fn find(
        &self,
        role: Role,
        header: &[&str],
        cells: &[(String, Option<String>)],
    ) -> Result<Column, String> {
        let whole = header.iter().position(|cell| *cell == self.column);
        let bare = || cells.iter().position(|cell| cell.0 == self.column);
        let Some(at) = whole.or_else(bare) else {
            let names: Vec<_> = cells.iter().map(|c| c.0.as_str()).collect();
            let meant = nearest(&self.column, &names);
            // A unit that is not known was taken for a part of the name.
            let unit = self.column.rsplit_once(':').map(|_| {
                let units = either(&role.units());
                format!("; units of {:?} are {units}", role.name())
            });
            return Err(format!(
                "the header is {}; expected the column {} in it, which \
                 --columns names{}{}",
                quoted(&header.join(",")),
                quoted(&self.column),
                unit.unwrap_or_default(),
                meant
                    .map(|m| format!(": did you mean {}?", quoted(m)))
                    .unwrap_or_default()
            ));
        };
        let unit = self.unit.clone().or_else(|| cells[at].1.clone());
        column(role, at, &cells[at].0, unit.as_deref())
            .ok_or_else(|| of_no_unit(role, &cells[at].0, unit.as_deref()))
    }
}

/// A column whose unit its role does not have.
fn of_no_unit(role: Role, name: &str, unit: Option<&str>) -> String {
    format!(
        "the column {} has the unit {}; expected {}: name it as in --columns \
         {}={name}:{}",
        quoted(name),
        quoted(unit.unwrap_or_default()),
        either(&role.units()),
        role.name(),
        role.units()[0]
    )
}

/// The column of a role by the names that are known, where its unit is. A speed
/// in a unit that is not known is refused: without it others would be worked
/// out from the places.
fn known(
    role: Role,
    header: &[&str],
    cells: &[(String, Option<String>)],
) -> Result<Option<Column>, String> {
    let simple: Vec<String> = cells.iter().map(|c| simple(&c.0)).collect();
    let named = role
        .columns()
        .iter()
        .flat_map(|name| (0..header.len()).filter(|at| simple[*at] == *name));
    let places: Vec<usize> = named.collect();
    let of = |at: &usize| column(role, *at, &cells[*at].0, unit(cells, *at));
    let found = places.iter().find_map(of);
    let is_speed = matches!(role, Role::Speed | Role::GroundSpeed);
    match places.first() {
        Some(&at) if found.is_none() && is_speed => {
            Err(of_no_unit(role, &cells[at].0, unit(cells, at)))
        }
        _ => Ok(found),
    }
}

fn unit(cells: &[(String, Option<String>)], at: usize) -> Option<&str> {
    cells[at].1.as_deref()
}

fn column(
    role: Role,
    at: usize,
    name: &str,
    unit: Option<&str>,
) -> Option<Column> {
    let taken = unit.unwrap_or(role.units()[0]);
    // A date's parts, as in utc[year:month:day:hour:minute:second], say how
    // it is written.
    let factor = match role {
        Role::Time if taken.starts_with("year") => Some(1.0),
        _ => role.factor(taken),
    }?;
    Some(Column {
        at,
        name: name.to_owned(),
        factor,
        unit: shown(taken),
        unit_is_known: unit.is_some(),
    })
}

/// A header's cell as name and unit: `velN[mm/s]`, `speed (km/h)`.
fn split(cell: &str) -> (String, Option<String>) {
    let cell = cell.trim_matches(|c: char| c == '#' || c.is_whitespace());
    let open = cell.find(['[', '(']);
    let closed = open.and_then(|at| {
        let (name, rest) = cell.split_at(at);
        let unit = rest[1..].trim_end().strip_suffix([']', ')'])?;
        Some((name.trim().to_owned(), unit.trim().to_owned()))
    });
    match closed {
        Some((name, unit)) if unit.is_empty() => (name, None),
        Some((name, unit)) => (name, Some(unit)),
        None => (cell.to_owned(), None),
    }
}

/// A unit as messages show it: where none is needed, a header may have
/// anything in its place.
fn shown(unit: &str) -> String {
    let is_plain = unit.len() <= 20 && !unit.chars().any(breaks_line);
    if is_plain { unit.to_owned() } else { quoted(unit) }
}

/// A name in small letters and digits alone.
fn simple(name: &str) -> String {
    let plain = name.chars().filter(char::is_ascii_alphanumeric);
    plain.map(|c| c.to_ascii_lowercase()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(columns: &str, header: &[&str]) -> Result<Found, String> {
        Columns::parse(columns).unwrap().find(header)
    }

    #[test]
    fn units_stand_in_the_header_or_behind_the_name() {
        let header = ["#iTow[ms]", "v_kmh", "UTC", "height [mm]", "height[m]"];
        let named = found("speed=v_kmh:km/h", &header).unwrap();
        assert_eq!(named[&Role::Time].factor, 1e-3);
        assert_eq!(named[&Role::Height].at, 3);
        assert!((named[&Role::Speed].factor - 1.0 / 3.6).abs() < 1e-15);
        let clock = found("time=UTC:hh:mm:ss", &header).unwrap();
        assert_eq!(
            (clock[&Role::Time].at, clock[&Role::Time].factor),
            (2, 1.0)
        );
        let other = found("ground-speed=v_kmh:km/h", &["t", "v_kmh", "velN"]);
        assert_eq!(other.unwrap().keys().count(), 2);
    }

    #[test]
    fn what_is_wrong_is_said_with_the_mend() {
        for (text, part) in [
            ("speed", "what=column"),
            ("sped=v", "did you mean \"speed\"?"),
            ("speed=", "names no column"),
            ("speed=v,speed=u", "twice"),
        ] {
            let error = Columns::parse(text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
        let error = found("speed=v:furlong", &["t", "v"]).unwrap_err();
        assert!(error.contains("units of \"speed\" are \"m/s\""), "{error}");
        let error = found("speed=v", &["t", "v[furlong]"]).unwrap_err();
        assert!(error.contains("has the unit \"furlong\""), "{error}");
    }
}
