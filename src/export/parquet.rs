//! Draws as Parquet: a row a draw, as in `draws.csv`.

use std::sync::Arc;

use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::{DataType, DoubleType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

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

/// What the crate says of a failure.
type Written<T> = parquet::errors::Result<T>;

fn write(draws: &Draws, attributes: &[(String, String)]) -> Written<Vec<u8>> {
    let units = draws.names().iter().zip(draws.units());
    let units = units.map(|(n, unit)| (format!("units:{n}"), unit.clone()));
    let known = attributes.iter().cloned().chain(units);
    let known = known.map(|(key, value)| KeyValue::new(key, value));
    let properties = WriterProperties::builder()
        .set_created_by(concat!("couloir ", env!("CARGO_PKG_VERSION")).into())
        .set_key_value_metadata(Some(known.collect()))
        .build();
    let (schema, properties) =
        (Arc::new(schema(draws)?), Arc::new(properties));
    let mut file = SerializedFileWriter::new(Vec::new(), schema, properties)?;
    let mut rows = file.next_row_group()?;
    let (chains, iterations) = (draws.chains(), draws.iterations());
    let each = |count: fn(usize, usize) -> usize| -> Vec<i64> {
        let all = 0..chains * iterations;
        all.map(|at| count(at, iterations) as i64).collect()
    };
    column::<Int64Type>(&mut rows, &each(|at, length| at / length))?;
    column::<Int64Type>(&mut rows, &each(|at, length| at % length))?;
    for parameter in 0..draws.dimension() {
        column::<DoubleType>(&mut rows, &draws.pooled(parameter))?;
    }
    rows.close()?;
    file.into_inner()
}

fn schema(draws: &Draws) -> Written<Type> {
    let one = |name: &str, kind: Physical| {
        let column = Type::primitive_type_builder(name, kind)
            .with_repetition(Repetition::REQUIRED);
        column.build().map(Arc::new)
    };
    let counts = COUNTS.into_iter().map(|name| one(name, Physical::INT64));
    let parameters = draws.names().iter();
    let parameters = parameters.map(|name| one(name, Physical::DOUBLE));
    let columns = counts.chain(parameters).collect::<Written<Vec<_>>>()?;
    Type::group_type_builder("draws").with_fields(columns).build()
}

fn column<T: DataType>(
    rows: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    values: &[T::T],
) -> Written<()> {
    if let Some(mut column) = rows.next_column()? {
        column.typed::<T>().write_batch(values, None, None)?;
        column.close()?;
    }
    Ok(())
}
