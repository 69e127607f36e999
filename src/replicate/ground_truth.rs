//! The published table of expected winners.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::ReplicateError;
use crate::input::InputError;

/// Expected winners: the row is the current user, the column the interrupting one, `--`
/// is no agreement.
pub(super) struct GroundTruth {
    pub(super) file: PathBuf,
    winners: HashMap<(String, String), Expected>,
}

/// One cell of the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Expected {
    /// The cell's line, from 1.
    pub(super) line: usize,
    /// `None` for no agreement.
    pub(super) winner: Option<String>,
}

impl GroundTruth {
    pub(super) fn read(file: &Path) -> Result<Self, ReplicateError> {
        let text = std::fs::read_to_string(file)
            .map_err(|source| InputError::Unreadable { file: file.to_owned(), source })?;
        match parse(&text) {
            Ok(winners) => Ok(Self { file: file.to_owned(), winners }),
            Err((line, problem)) => Err(ReplicateError::GroundTruth { file: file.to_owned(), line, problem }),
        }
    }

    /// The expectation for these two users, the current one first, if the table has one.
    pub(super) fn expected(&self, users: &[&str]) -> Option<&Expected> {
        let [current, interrupting] = users else { return None };
        self.winners.get(&((*current).to_owned(), (*interrupting).to_owned()))
    }
}

/// The cells by current and interrupting user; an error is a line and what is wrong with it.
fn parse(text: &str) -> Result<HashMap<(String, String), Expected>, (usize, String)> {
    let mut lines = text.lines().map(|line| line.split(',').map(str::trim).collect::<Vec<_>>());
    let Some(header) = lines.next() else { return Err((1, "is empty, expected user names".to_owned())) };
    let columns = header.get(1..).unwrap_or_default();
    let mut winners = HashMap::new();
    for (nth, row) in lines.enumerate() {
        let line = nth.saturating_add(2);
        let [current, cells @ ..] = row.as_slice() else { continue };
        if row.len() == 1 && current.is_empty() {
            continue;
        }
        if cells.len() != columns.len() {
            let problem = format!("has {} cells, expected {}", cells.len(), columns.len());
            return Err((line, problem));
        }
        for (interrupting, cell) in columns.iter().zip(cells) {
            if interrupting == current {
                continue;
            }
            let winner = if *cell == "--" {
                None
            } else if cell == current || cell == interrupting {
                Some((*cell).to_owned())
            } else {
                let problem = format!("expected {current}, {interrupting} or --, found {cell:?}");
                return Err((line, problem));
            };
            let pair = ((*current).to_owned(), (*interrupting).to_owned());
            if winners.insert(pair, Expected { line, winner }).is_some() {
                let problem =
                    format!("{current} and {interrupting} stand here twice, expected each pair once");
                return Err((line, problem));
            }
        }
    }
    Ok(winners)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(table: &str, current: &str, interrupting: &str) -> Option<(usize, Option<String>)> {
        let winners = parse(table).unwrap();
        let cell = winners.get(&(current.to_owned(), interrupting.to_owned()))?;
        Some((cell.line, cell.winner.clone()))
    }

    #[test]
    fn rows_are_current_and_columns_interrupting() {
        let table = ",A,B\nA,--,B\nB,--,--\n";
        assert_eq!(cell(table, "A", "B"), Some((2, Some("B".to_owned()))));
        assert_eq!(cell(table, "B", "A"), Some((3, None)));
        assert_eq!(cell(table, "A", "C"), None);
    }

    #[test]
    fn a_ragged_row_or_a_stranger_is_refused() {
        assert!(parse(",A,B\nA,--\n").is_err());
        assert!(parse(",A,B\nA,--,C\n").is_err());
    }
}
