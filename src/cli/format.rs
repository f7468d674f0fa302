//! `--format`: in which formats draws and figures are written.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::made::Files;
use crate::draws::Draws;
use crate::error::Result;
use crate::export::{InferenceData, latex};
#[cfg(feature = "export")]
use crate::export::{parquet, zarr};
use crate::report::{CalibrationReport, PROGRAM};

/// A format of what is written beside the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Csv,
    Latex,
    #[cfg(feature = "export")]
    Parquet,
    #[cfg(feature = "export")]
    Zarr,
}

impl Format {
    const ALL: &[Self] = &[
        Self::Csv,
        Self::Latex,
        #[cfg(feature = "export")]
        Self::Parquet,
        #[cfg(feature = "export")]
        Self::Zarr,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Latex => "latex",
            #[cfg(feature = "export")]
            Self::Parquet => "parquet",
            #[cfg(feature = "export")]
            Self::Zarr => "zarr",
        }
    }

    /// The file it is written to, with `/` behind the name of a folder.
    fn file(self) -> &'static str {
        match self {
            Self::Csv => "draws.csv",
            Self::Latex => "table.tex",
            #[cfg(feature = "export")]
            Self::Parquet => "draws.parquet",
            #[cfg(feature = "export")]
            Self::Zarr => "draws.zarr/",
        }
    }

    /// Whether it has what the draws say of the data.
    fn has_data(self) -> bool {
        self.name() == "zarr"
    }
}

fn named(text: &str) -> Result<Format, String> {
    let known = Format::ALL.iter();
    if let Some(format) = known.clone().find(|f| f.name() == text.trim()) {
        return Ok(*format);
    }
    let names: Vec<_> = known.map(|format| format.name()).collect();
    let names = names.join(", ");
    Err(match text.trim() {
        "zarr" | "parquet" => format!(
            "it is not built in; build couloir with --features export, or \
             take {names}"
        ),
        _ => format!("expected one or more of {names}, with commas between"),
    })
}

/// The formats asked for.
#[derive(Debug, Args)]
pub(super) struct Formats {
    /// What to write beside the report, with commas between: csv (draws.csv),
    /// latex (table.tex, a table of the parameters) and, where built with the
    /// feature export, parquet (draws.parquet) and zarr (draws.zarr, ArviZ's
    /// InferenceData; of a calibration with log likelihood of each value,
    /// predictions before and after, recording, and loo in calibration.json)
    #[arg(long = "format", value_name = "FORMATS", requires = "out",
          value_parser = named, value_delimiter = ',', default_value = "csv")]
    formats: Vec<Format>,
}

impl Formats {
    /// The names of the files, in a fixed order.
    pub(super) fn names(&self) -> Vec<&'static str> {
        self.asked().map(Format::file).collect()
    }

    fn asked(&self) -> impl Iterator<Item = Format> {
        let all = Format::ALL.iter().copied();
        all.filter(|format| self.formats.contains(format))
    }

    /// Whether a format has what the draws say of the data.
    pub(super) fn have_data(&self) -> bool {
        self.asked().any(Format::has_data)
    }

    /// The files in these formats.
    pub(super) fn files(&self, of: &Results<'_>) -> Result<Files> {
        let mut files = Files::new();
        for format in self.asked() {
            let path = PathBuf::from(format.file());
            let one = |bytes| vec![(path.clone(), bytes)];
            files.extend(match format {
                Format::Csv => one(of.draws.to_csv().into_bytes()),
                Format::Latex => one(latex(of.report).into_bytes()),
                #[cfg(feature = "export")]
                Format::Parquet => {
                    one(parquet(of.draws, &of.data.attributes)?)
                }
                #[cfg(feature = "export")]
                Format::Zarr => {
                    let all = zarr(of.data)?.into_iter();
                    all.map(|(n, bytes)| (path.join(n), bytes)).collect()
                }
            });
        }
        #[cfg(not(feature = "export"))]
        let _ = of.data;
        Ok(files)
    }
}

/// What the formats are written from.
pub(super) struct Results<'a> {
    pub(super) draws: &'a Draws,
    pub(super) report: &'a CalibrationReport,
    pub(super) data: &'a InferenceData,
}

/// What was run, on what, and how, as attributes.
pub(super) fn described(
    data: InferenceData,
    report: &CalibrationReport,
) -> InferenceData {
    let noise = match report.noises.first() {
        None => report.noise.clone(),
        Some(_) => "infer".to_owned(),
    };
    let mut data = data
        .with("program", PROGRAM)
        .with("command", &*report.origin.command)
        .with("seed", report.seed.to_string())
        .with("backend", &*report.backend)
        .with("event", &*report.event)
        .with("friction", &*report.friction)
        .with("noise", noise)
        .with("inputs", json!(report.origin.inputs).to_string());
    if !report.mechanisms.is_empty() {
        data = data.with("mechanisms", report.mechanisms.join(", "));
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_format_that_there_is_not_is_told() {
        let error = named("hdf5").unwrap_err();
        assert!(error.contains("csv, latex"), "{error}");
        let zarr = named(" zarr ");
        match cfg!(feature = "export") {
            true => assert!(zarr.is_ok()),
            false => assert!(zarr.unwrap_err().contains("--features export")),
        }
    }
}
