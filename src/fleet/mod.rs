//! Thousands of audited traces as Parquet tables, for whatever reads Parquet.
//!
//! One row per trace, per decision and per round. Users stand in them by pseudonym, and what
//! is personal has no column: `docs/fleet.md` lists all columns. Rows are written in groups
//! of [`ROWS_IN_GROUP`], so memory does not grow with the number of traces.

mod rows;
pub mod schema;
mod table;

use std::io::Write;

pub use rows::{DecisionRow, Loss, Redecided, RoundRow, TraceRow};
pub use table::{Cell, ROWS_IN_GROUP, Row, Table, TableError};

/// All that one trace adds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TraceRows {
    /// The trace itself.
    pub trace: TraceRow,
    /// Its decisions.
    pub decisions: Vec<DecisionRow>,
    /// The rounds that they rest on.
    pub rounds: Vec<RoundRow>,
}

/// The three tables of a fleet.
pub struct Tables<W: Write + Send> {
    traces: Table<TraceRow, W>,
    decisions: Table<DecisionRow, W>,
    rounds: Table<RoundRow, W>,
}

/// How many rows each table has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowCounts {
    /// Of traces.
    pub traces: u64,
    /// Of decisions.
    pub decisions: u64,
    /// Of rounds.
    pub rounds: u64,
}

impl<W: Write + Send> Tables<W> {
    /// The files' names, in the order of [`Tables::new`].
    pub const FILES: [&'static str; 3] = ["traces.parquet", "decisions.parquet", "rounds.parquet"];

    /// Begins the tables.
    ///
    /// # Errors
    /// [`TableError`] if a file cannot be written.
    pub fn new([traces, decisions, rounds]: [W; 3]) -> Result<Self, TableError> {
        Ok(Self {
            traces: Table::new(traces)?,
            decisions: Table::new(decisions)?,
            rounds: Table::new(rounds)?,
        })
    }

    /// Adds a trace.
    ///
    /// # Errors
    /// [`TableError`] if a file cannot be written.
    pub fn push(&mut self, rows: TraceRows) -> Result<(), TableError> {
        self.traces.push(rows.trace)?;
        rows.decisions.into_iter().try_for_each(|row| self.decisions.push(row))?;
        rows.rounds.into_iter().try_for_each(|row| self.rounds.push(row))
    }

    /// Writes the files' ends.
    ///
    /// # Errors
    /// [`TableError`] if a file cannot be written.
    pub fn finish(self) -> Result<([W; 3], RowCounts), TableError> {
        let (traces, traces_written) = self.traces.finish()?;
        let (decisions, decisions_written) = self.decisions.finish()?;
        let (rounds, rounds_written) = self.rounds.finish()?;
        let counts =
            RowCounts { traces: traces_written, decisions: decisions_written, rounds: rounds_written };
        Ok(([traces, decisions, rounds], counts))
    }
}
