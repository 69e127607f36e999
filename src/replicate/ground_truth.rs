//! The published table of expected winners.

use std::collections::HashMap;
use std::path::Path;

use super::ReplicateError;
use crate::input::InputError;

/// Expected winners: the row is the current user, the column the interrupting one, `--`
/// is no agreement.
pub(super) struct GroundTruth {
    winners: HashMap<(String, String), Option<String>>,
}

impl GroundTruth {
    pub(super) fn read(file: &Path) -> Result<Self, ReplicateError> {
        let text = std::fs::read_to_string(file)
            .map_err(|source| InputError::Unreadable { file: file.to_owned(), source })?;
        Self::parse(&text).map_err(|(line, problem)| ReplicateError::GroundTruth {
            file: file.to_owned(),
            line,
            problem,
        })
    }

    fn parse(text: &str) -> Result<Self, (usize, String)> {
        let mut lines = text.lines().map(|line| line.split(',').map(str::trim).collect::<Vec<_>>());
        let Some(header) = lines.next() else { return Err((1, "is empty, expected user names".to_owned())) };
        let columns = header.get(1..).unwrap_or_default();
        let mut winners = HashMap::new();
        for (nth, row) in lines.enumerate() {
            let [current, cells @ ..] = row.as_slice() else { continue };
            if row.len() == 1 && current.is_empty() {
                continue;
            }
            if cells.len() != columns.len() {
                let problem = format!("has {} cells, expected {}", cells.len(), columns.len());
                return Err((nth.saturating_add(2), problem));
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
                    return Err((nth.saturating_add(2), problem));
                };
                winners.insert(((*current).to_owned(), (*interrupting).to_owned()), winner);
            }
        }
        Ok(Self { winners })
    }

    /// The expected winner among these two users, the current one first: outer `None` if
    /// the table does not say, inner `None` for no agreement.
    pub(super) fn winner(&self, users: &[&str]) -> Option<Option<&str>> {
        let [current, interrupting] = users else { return None };
        self.winners.get(&((*current).to_owned(), (*interrupting).to_owned())).map(Option::as_deref)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_current_and_columns_interrupting() {
        let truth = GroundTruth::parse(",A,B\nA,--,B\nB,--,--\n").unwrap();
        assert_eq!(truth.winner(&["A", "B"]), Some(Some("B")));
        assert_eq!(truth.winner(&["B", "A"]), Some(None));
        assert_eq!(truth.winner(&["A", "C"]), None);
    }

    #[test]
    fn a_ragged_row_or_a_stranger_is_refused() {
        assert!(GroundTruth::parse(",A,B\nA,--\n").is_err());
        assert!(GroundTruth::parse(",A,B\nA,--,C\n").is_err());
    }
}
