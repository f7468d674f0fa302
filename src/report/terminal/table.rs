//! The table of parameters, fitted to the width of a terminal.

use crate::report::digits::{NONE, beside, whole};
use crate::report::text::{plain, wrap};
use crate::report::{CalibrationReport, ParameterReport};

/// The widest name that stands in its row; longer ones get lines of their
/// own above it.
const NAME: usize = 14;
/// The widest unit that stands in its row.
const UNIT: usize = 8;
/// The narrowest table.
const NARROWEST: usize = 44;

/// A column: its heading, whether it is set to the right, and its cells.
struct Column {
    heading: &'static str,
    right: bool,
    cells: Vec<String>,
}

impl Column {
    fn width(&self) -> usize {
        let cells = self.cells.iter().map(|c| c.chars().count());
        cells.max().unwrap_or(0).max(self.heading.chars().count())
    }

    fn set(&self, cell: &str, width: usize) -> String {
        if self.right {
            format!("{cell:>width$}")
        } else {
            format!("{cell:<width$}")
        }
    }
}

/// The parameters with median, mean, standard deviation, 90 % interval,
/// R-hat and effective sample size, at most `width` characters a line.
///
/// Where the width does not suffice, columns are left out: the mean first,
/// then the unit, the standard deviation, R-hat and ESS.
///
/// ```
/// use couloir::report::{CalibrationReport, table};
/// let text = table(&CalibrationReport::default(), 80);
/// assert!(text.contains("no parameters"));
/// ```
pub fn table(report: &CalibrationReport, width: usize) -> String {
    let width = width.max(NARROWEST);
    let mut out = wrap(&title(report), width).join("\n");
    out.push('\n');
    if report.parameters.is_empty() {
        return out + "no parameters\n";
    }
    let mut columns = columns(&report.parameters);
    for heading in ["mean", "unit", "sd", "R-hat", "ESS"] {
        if total(&columns) > width {
            columns.retain(|c| c.heading != heading);
        }
    }
    let headings: Vec<&str> = columns.iter().map(|c| c.heading).collect();
    push_row(&mut out, &columns, &headings);
    out.push_str(&"─".repeat(total(&columns).min(width)));
    out.push('\n');
    for (i, p) in report.parameters.iter().enumerate() {
        if is_long(p) {
            for line in wrap(&full_name(p), width) {
                out.push_str(&line);
                out.push('\n');
            }
        }
        let cells: Vec<_> =
            columns.iter().map(|c| c.cells[i].as_str()).collect();
        push_row(&mut out, &columns, &cells);
    }
    out
}

fn title(report: &CalibrationReport) -> String {
    let origin = if report.synthetic { ", synthetic data" } else { "" };
    plain(&format!(
        "{}: {} friction, {} errors{}{origin}",
        report.event,
        report.friction,
        report.errors_told(),
        report.terms()
    ))
}

fn is_long(p: &ParameterReport) -> bool {
    p.name.chars().count() > NAME || p.unit.chars().count() > UNIT
}

fn full_name(p: &ParameterReport) -> String {
    match p.unit_shown().as_str() {
        "" => plain(&p.name),
        unit => plain(&format!("{} [{unit}]", p.name)),
    }
}

fn unit_or_dash(p: &ParameterReport) -> String {
    Some(p.unit_shown()).filter(|u| !u.is_empty()).unwrap_or("-".to_owned())
}

fn columns(parameters: &[ParameterReport]) -> Vec<Column> {
    let in_row = |f: fn(&ParameterReport) -> String| {
        move |p: &ParameterReport| match is_long(p) {
            true => String::new(),
            false => f(p),
        }
    };
    let column = |heading,
                  right,
                  cell: &dyn Fn(&ParameterReport) -> String| {
        Column { heading, right, cells: parameters.iter().map(cell).collect() }
    };
    vec![
        column("parameter", false, &in_row(|p| plain(&p.name))),
        column("unit", false, &in_row(unit_or_dash)),
        column("median", true, &|p| beside(p.q50, p.sd)),
        column("mean", true, &|p| beside(p.mean, p.sd)),
        column("sd", true, &|p| beside(p.sd, p.sd)),
        column("90 % interval", true, &interval),
        column("R-hat", true, &|p| rhat(p.rhat)),
        column("ESS", true, &|p| whole(p.ess_bulk.min(p.ess_tail))),
    ]
}

fn interval(p: &ParameterReport) -> String {
    format!("{} .. {}", beside(p.q05, p.sd), beside(p.q95, p.sd))
}

fn rhat(x: f64) -> String {
    match x {
        x if !x.is_finite() => NONE.to_owned(),
        x if x < 100.0 => format!("{x:.3}"),
        _ => "> 100".to_owned(),
    }
}

fn total(columns: &[Column]) -> usize {
    let cells: usize = columns.iter().map(Column::width).sum();
    cells + 2 * columns.len().saturating_sub(1)
}

fn push_row(out: &mut String, columns: &[Column], cells: &[&str]) {
    let set: Vec<String> = columns
        .iter()
        .zip(cells)
        .map(|(c, cell)| c.set(cell, c.width()))
        .collect();
    out.push_str(set.join("  ").trim_end());
    out.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture;

    fn widest(text: &str) -> usize {
        text.lines().map(|l| l.chars().count()).max().unwrap_or(0)
    }

    #[test]
    fn eighty_columns_hold_every_column() {
        let text = table(&fixture::calibration(), 80);
        assert!(widest(&text) <= 80, "{text}");
        for heading in ["unit", "mean", "sd", "90 % interval", "ESS"] {
            assert!(text.contains(heading), "{heading}");
        }
    }

    #[test]
    fn long_names_and_large_numbers_fit() {
        let mut report = fixture::calibration();
        report.event = "long ".repeat(60);
        report.parameters[0].name = "friction[12].".repeat(9);
        report.parameters[1].unit = "kg m2 s-3 per value".to_owned();
        report.parameters[1].q50 = -1.234e-200;
        report.parameters[1].sd = f64::NAN;
        for width in [0, 44, 60, 80, 120] {
            let text = table(&report, width);
            assert!(widest(&text) <= width.max(NARROWEST), "{text}");
        }
    }
}
