//! `--figures`: the pictures as files of their own.

use std::path::PathBuf;

use clap::Args;

use super::made::Files;
use crate::error::Result;
#[cfg(feature = "export")]
use crate::export::png;

/// The folder of the pictures, within that of the results.
pub(super) const FOLDER: &str = "pictures/";

/// Whether all pictures are wanted as files.
#[derive(Debug, Args)]
pub(super) struct Figures {
    /// Write every picture of the report as a file of its own, too: as SVG
    /// and, where built with the feature export, as PNG
    #[arg(long, requires = "out")]
    pub(super) figures: bool,
}

impl Figures {
    /// Pictures by their names, as SVG and, where asked for, as PNG.
    pub(super) fn files(
        &self,
        pictures: impl IntoIterator<Item = (String, String)>,
    ) -> Result<Files> {
        let mut files = Files::new();
        for (name, svg) in pictures {
            let path = PathBuf::from(FOLDER).join(&name);
            #[cfg(feature = "export")]
            if self.figures {
                files.push((path.with_extension("png"), png(&svg)?));
            }
            files.push((path.with_extension("svg"), svg.into_bytes()));
        }
        Ok(files)
    }
}
