//! Draws as Parquet: a row a draw, as in `draws.csv`.

use super::sheet::{Column, Sheet};
use crate::draws::Draws;
use crate::error::{Error, Result};

/// A Parquet file with the columns `chain`, `iteration` (whole numbers from 0)
/// and one of doubles for each parameter, by its name. The attributes are the
/// file's key-value metadata, and so is the unit of each parameter, as
/// `units:NAME`.
///
/// ```
/// use couloir::draws::Draws;
/// let names = || vec!["mu".to_owned()];
/// let mut draws = Draws::new(names(), vec!["1".to_owned()])?;
/// draws.push_chain(vec![0.2, 0.3], None)?;
/// let bytes = couloir::export::parquet(&draws, &[])?;
/// assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
/// # Ok::<(), couloir::Error>(())
/// ```
///
/// # Errors
/// A parameter called `chain` or `iteration`, which two columns would be.
pub fn parquet(
    draws: &Draws,
    attributes: &[(String, String)],
) -> Result<Vec<u8>> {
    if let Some(name) = draws.names().iter().find(|n| COUNTS.contains(&&***n))
    {
        return Err(Error::input(format!(
            "a parameter is called {name}, as is a column that counts; \
             expected another name: rename it, or write csv"
        )));
    }
    write(draws, attributes).map_err(|error| {
        Error::system(format!(
            "the draws could not be put as Parquet: {error}"
        ))
    })
}

/// The columns that count.
const COUNTS: [&str; 2] = ["chain", "iteration"];

fn write(
    draws: &Draws,
    attributes: &[(String, String)],
) -> parquet::errors::Result<Vec<u8>> {
    let units = draws.names().iter().zip(draws.units());
    let units = units.map(|(n, unit)| (format!("units:{n}"), unit.clone()));
    let known = attributes.iter().cloned().chain(units).collect();
    let counts = COUNTS.map(|name| (name.to_owned(), Column::Whole(vec![])));
    let parameters = draws.names().iter();
    let parameters =
        parameters.map(|name| (name.clone(), Column::Double(vec![])));
    let columns: Vec<_> = counts.into_iter().chain(parameters).collect();
    let mut sheet = Sheet::new(Vec::new(), "draws", &columns, known)?;
    let (chains, iterations) = (draws.chains(), draws.iterations());
    let each = |count: fn(usize, usize) -> usize| {
        let all = 0..chains * iterations;
        Column::Whole(all.map(|at| count(at, iterations) as i64).collect())
    };
    let counted =
        [each(|at, length| at / length), each(|at, length| at % length)];
    let values =
        (0..draws.dimension()).map(|i| Column::Double(draws.pooled(i)));
    sheet.add(&counted.into_iter().chain(values).collect::<Vec<_>>())?;
    sheet.finish()
}
