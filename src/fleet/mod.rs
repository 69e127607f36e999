//! Thousands of audited traces as Parquet tables, for whatever reads Parquet.
//!
//! One row per trace, per decision and per round. Users stand in them by pseudonym, and what
//! is personal has no column: `docs/fleet.md` lists all columns. Rows are written in groups
//! of [`ROWS_IN_GROUP`], and no more of a table is kept in memory but what its footer will say.

mod rows;
pub mod schema;
mod table;

use std::collections::BTreeMap;
use std::io::Write;

pub use rows::{DecisionRow, RoundRow, TraceRow};
pub use table::{Cell, ROWS_IN_GROUP, Row, Table, TableError};

use crate::audit::{Audit, DecisionAudit, Redecided};
use crate::case::Docket;
use crate::seal::SealState;
use crate::trace::Opened;

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

impl TraceRows {
    /// The rows of a trace. `opened` is what was audited; `None` if it could not be read.
    #[must_use]
    pub fn of(file: &str, opened: Option<&Opened>, audit: &Audit) -> Self {
        let trace = TraceRow {
            file: file.to_owned(),
            status: audit.status.name().to_owned(),
            trace_id: opened.and_then(trace_id),
            robot_key: audit.seal.as_ref().map(|seal| seal.key.clone()),
            robot_key_trusted: audit.seal.as_ref().map(|seal| seal.trusted),
            decisions: wide(audit.decisions.len()),
            redecided: wide(audit.redecided()),
            erased: wide(audit.erased.len()),
            findings: wide(audit.findings.len()).saturating_add(audit.more_findings),
            first_finding: audit.findings.first().map(|first| format!("{}: {}", first.at, first.what)),
        };
        let (mut decisions, mut rounds) = (Vec::new(), Vec::new());
        let docket = opened.map(|opened| Docket::of(&opened.recording)).unwrap_or_default();
        let found: BTreeMap<u64, &DecisionAudit> =
            audit.decisions.iter().map(|found| (found.decision, found)).collect();
        for decision in &docket.decisions {
            let found = found.get(&decision.decision);
            let redecided = found.map_or(Redecided::Unchecked, |found| found.redecided);
            let welfare = found.and_then(|found| found.welfare);
            decisions.push(DecisionRow::negotiated(file, audit.status, decision, redecided, welfare));
            rounds.extend(RoundRow::of(file, decision));
        }
        for emergency in &docket.emergencies {
            let redecided =
                found.get(&emergency.decision).map_or(Redecided::Unchecked, |found| found.redecided);
            decisions.push(DecisionRow::emergency(file, audit.status, emergency, redecided));
        }
        decisions.sort_by_key(DecisionRow::number);
        Self { trace, decisions, rounds }
    }
}

fn trace_id(opened: &Opened) -> Option<String> {
    match &opened.seal {
        SealState::Signed(report) => Some(report.trace_id.to_string()),
        _ => None,
    }
}

fn wide(number: usize) -> u64 {
    u64::try_from(number).unwrap_or(u64::MAX)
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
