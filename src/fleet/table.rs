//! A Parquet file that is written row by row, within bounded memory.

use std::io::Write;
use std::marker::PhantomData;
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type, ZstdLevel};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::ColumnDescriptor;

use crate::trace::PROGRAM;

/// A value of a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cell {
    /// A text, or null.
    Text(Option<String>),
    /// A number, or null.
    Number(Option<i64>),
    /// True, false or null.
    Truth(Option<bool>),
    /// A list of numbers, maybe empty.
    Numbers(Vec<i64>),
}

/// What becomes a row of a table.
pub trait Row {
    /// The table's columns, as a Parquet message type.
    const SCHEMA: &'static str;

    /// The values, one for each column, in the schema's order.
    fn into_cells(self) -> Vec<Cell>;
}

/// How many rows are held back at most, to be written together.
///
/// Parquet is read by columns, and a row group's columns lie one after the other, so a group
/// must be whole before any of it is written.
pub const ROWS_IN_GROUP: usize = 4_096;

/// Writes rows of one kind.
pub struct Table<R: Row, W: Write + Send> {
    kind: PhantomData<fn(R)>,
    file: SerializedFileWriter<W>,
    columns: Vec<Column>,
    held: usize,
    written: u64,
}

/// Why a table cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// The file cannot be written.
    #[error(transparent)]
    Parquet(#[from] ParquetError),
    /// A row does not have the columns of its schema.
    #[error("column {column}: the row has another type or number of values than the schema")]
    NotAsInSchema {
        /// The column's number, from 0.
        column: usize,
    },
}

impl<R: Row, W: Write + Send> Table<R, W> {
    /// Begins a table.
    ///
    /// # Errors
    /// [`TableError`] if the file cannot be written.
    pub fn new(file: W) -> Result<Self, TableError> {
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_created_by(PROGRAM.to_owned())
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .build();
        let schema = Arc::new(parse_message_type(R::SCHEMA)?);
        let file = SerializedFileWriter::new(file, schema, Arc::new(properties))?;
        let columns = file.schema_descr().columns().iter().map(|column| Column::of(column)).collect();
        Ok(Self { kind: PhantomData, file, columns, held: 0, written: 0 })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`TableError`] if the file cannot be written.
    pub fn push(&mut self, row: R) -> Result<(), TableError> {
        let cells = row.into_cells();
        if cells.len() != self.columns.len() {
            return Err(TableError::NotAsInSchema { column: cells.len().min(self.columns.len()) });
        }
        for (nth, (column, cell)) in self.columns.iter_mut().zip(cells).enumerate() {
            column.push(cell).ok_or(TableError::NotAsInSchema { column: nth })?;
        }
        self.held = self.held.saturating_add(1);
        if self.held >= ROWS_IN_GROUP { self.write_group() } else { Ok(()) }
    }

    /// Writes what is held back and the file's end, and gives the number of rows.
    ///
    /// # Errors
    /// [`TableError`] if the file cannot be written.
    pub fn finish(mut self) -> Result<(W, u64), TableError> {
        if self.held > 0 {
            self.write_group()?;
        }
        Ok((self.file.into_inner()?, self.written))
    }

    fn write_group(&mut self) -> Result<(), TableError> {
        let mut group = self.file.next_row_group()?;
        for column in &mut self.columns {
            let Some(mut writer) = group.next_column()? else { break };
            let definitions = column.definitions.as_deref();
            let repetitions = column.repetitions.as_deref();
            let _values = match &column.values {
                Values::Texts(texts) => {
                    writer.typed::<ByteArrayType>().write_batch(texts, definitions, repetitions)?
                }
                Values::Numbers(numbers) => {
                    writer.typed::<Int64Type>().write_batch(numbers, definitions, repetitions)?
                }
                Values::Truths(truths) => {
                    writer.typed::<BoolType>().write_batch(truths, definitions, repetitions)?
                }
            };
            writer.close()?;
            column.clear();
        }
        let _metadata = group.close()?;
        self.written = self.written.saturating_add(u64::try_from(self.held).unwrap_or(u64::MAX));
        self.held = 0;
        Ok(())
    }
}

/// The values of a column that are held back, as Parquet has them: nulls and empty lists are
/// only in the levels.
struct Column {
    values: Values,
    /// 1 for a value, 0 for null or an empty list; `None` where there is always a value.
    definitions: Option<Vec<i16>>,
    /// 0 for the first of a row, 1 for the further ones; `None` where there is always one.
    repetitions: Option<Vec<i16>>,
}

enum Values {
    Texts(Vec<ByteArray>),
    Numbers(Vec<i64>),
    Truths(Vec<bool>),
}

impl Column {
    fn of(described: &ColumnDescriptor) -> Self {
        let values = match described.physical_type() {
            Type::INT64 => Values::Numbers(Vec::new()),
            Type::BOOLEAN => Values::Truths(Vec::new()),
            _ => Values::Texts(Vec::new()),
        };
        let list = described.max_rep_level() > 0;
        let optional = described.self_type().get_basic_info().repetition() == Repetition::OPTIONAL;
        Self { values, definitions: (list || optional).then(Vec::new), repetitions: list.then(Vec::new) }
    }

    /// `None` if the column takes no such value.
    fn push(&mut self, cell: Cell) -> Option<()> {
        match (&mut self.values, cell, self.repetitions.is_some()) {
            (Values::Texts(_), Cell::Text(None), false)
            | (Values::Numbers(_), Cell::Number(None), false)
            | (Values::Truths(_), Cell::Truth(None), false) => {
                self.definitions.as_mut()?.push(0);
                return Some(());
            }
            (Values::Texts(texts), Cell::Text(Some(text)), false) => {
                texts.push(ByteArray::from(text.into_bytes()));
            }
            (Values::Numbers(numbers), Cell::Number(Some(number)), false) => numbers.push(number),
            (Values::Truths(truths), Cell::Truth(Some(truth)), false) => truths.push(truth),
            (Values::Numbers(numbers), Cell::Numbers(more), true) => {
                let (definitions, repetitions) = (self.definitions.as_mut()?, self.repetitions.as_mut()?);
                definitions.extend(if more.is_empty() { vec![0] } else { vec![1; more.len()] });
                repetitions.push(0);
                repetitions.extend(more.iter().skip(1).map(|_| 1));
                numbers.extend(more);
                return Some(());
            }
            _ => return None,
        }
        if let Some(definitions) = &mut self.definitions {
            definitions.push(1);
        }
        Some(())
    }

    fn clear(&mut self) {
        match &mut self.values {
            Values::Texts(texts) => texts.clear(),
            Values::Numbers(numbers) => numbers.clear(),
            Values::Truths(truths) => truths.clear(),
        }
        if let Some(definitions) = &mut self.definitions {
            definitions.clear();
        }
        if let Some(repetitions) = &mut self.repetitions {
            repetitions.clear();
        }
    }
}
