//! A table as a Parquet file, in parts, so that it need not be held whole.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{
    ByteArray, ByteArrayType, DataType, DoubleType, Int64Type,
};
use parquet::errors::Result;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

/// The values of a column, a row each.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Column {
    /// Whole numbers.
    Whole(Vec<i64>),
    /// Numbers.
    Double(Vec<f64>),
    /// Numbers, where there are any.
    Maybe(Vec<Option<f64>>),
    /// Texts.
    Text(Vec<String>),
}

/// A Parquet file that grows.
pub(crate) struct Sheet<W: Write + Send> {
    file: SerializedFileWriter<W>,
}

impl<W: Write + Send> Sheet<W> {
    /// A file with columns of these names, of the kinds that empty ones show,
    /// and key-value metadata.
    pub(crate) fn new(
        out: W,
        name: &str,
        columns: &[(String, Column)],
        known: Vec<(String, String)>,
    ) -> Result<Self> {
        let known = known.into_iter();
        let known = known.map(|(key, value)| KeyValue::new(key, value));
        let properties = WriterProperties::builder()
            .set_created_by(
                concat!("couloir ", env!("CARGO_PKG_VERSION")).into(),
            )
            .set_key_value_metadata(Some(known.collect()))
            .build();
        let fields = columns.iter().map(|(name, kind)| field(name, kind));
        let fields = fields.collect::<Result<Vec<_>>>()?;
        let schema =
            Type::group_type_builder(name).with_fields(fields).build()?;
        let (schema, properties) = (Arc::new(schema), Arc::new(properties));
        let file = SerializedFileWriter::new(out, schema, properties)?;
        Ok(Self { file })
    }

    /// Adds rows: as many values in every column.
    pub(crate) fn add(&mut self, columns: &[Column]) -> Result<()> {
        let mut rows = self.file.next_row_group()?;
        for column in columns {
            write(&mut rows, column)?;
        }
        rows.close().map(drop)
    }

    /// Completes the file.
    pub(crate) fn finish(self) -> Result<W> {
        self.file.into_inner()
    }
}

fn field(name: &str, kind: &Column) -> Result<Arc<Type>> {
    let (physical, repetition) = match kind {
        Column::Whole(_) => (Physical::INT64, Repetition::REQUIRED),
        Column::Double(_) => (Physical::DOUBLE, Repetition::REQUIRED),
        Column::Maybe(_) => (Physical::DOUBLE, Repetition::OPTIONAL),
        Column::Text(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED),
    };
    let field = Type::primitive_type_builder(name, physical)
        .with_repetition(repetition);
    let field = match kind {
        Column::Text(_) => field.with_converted_type(ConvertedType::UTF8),
        _ => field,
    };
    field.build().map(Arc::new)
}

fn write<W: Write + Send>(
    rows: &mut SerializedRowGroupWriter<'_, W>,
    column: &Column,
) -> Result<()> {
    match column {
        Column::Whole(values) => typed::<Int64Type, W>(rows, values, None),
        Column::Double(values) => typed::<DoubleType, W>(rows, values, None),
        Column::Maybe(values) => {
            let there = values.iter().map(|v| i16::from(v.is_some()));
            let there: Vec<i16> = there.collect();
            let own: Vec<f64> = values.iter().flatten().copied().collect();
            typed::<DoubleType, W>(rows, &own, Some(&there))
        }
        Column::Text(values) => {
            let bytes = values.iter().map(|text| ByteArray::from(&**text));
            let bytes: Vec<ByteArray> = bytes.collect();
            typed::<ByteArrayType, W>(rows, &bytes, None)
        }
    }
}

fn typed<T: DataType, W: Write + Send>(
    rows: &mut SerializedRowGroupWriter<'_, W>,
    values: &[T::T],
    there: Option<&[i16]>,
) -> Result<()> {
    if let Some(mut column) = rows.next_column()? {
        column.typed::<T>().write_batch(values, there, None)?;
        column.close()?;
    }
    Ok(())
}
