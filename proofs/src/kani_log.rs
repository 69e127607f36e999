//! Reads what `cargo kani` prints, to make sure that it proved what it should have.
//!
//! Kani's own exit code is not enough: it says nothing of a harness that is no longer
//! there, and a harness whose assumptions contradict each other passes, with its covers
//! unsatisfied.

use std::fmt;

/// What should be in the log: a harness by the last part of its path, and its covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expected<'a> {
    /// The harness.
    pub name: &'a str,
    /// How many covers it has.
    pub covers: usize,
}

/// Why a log does not show that everything was proved.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Problem {
    /// A harness that should have been checked is not in the log.
    Missing(String),
    /// A harness was checked that is not expected, or twice.
    Unexpected(String),
    /// A harness was not verified: it failed, or the log ends before it says.
    NotVerified(String),
    /// Not every cover was satisfied, or there are more or fewer than expected.
    Covers {
        /// The harness.
        name: String,
        /// What the log says: satisfied, of how many; `None` if it says nothing.
        found: Option<(usize, usize)>,
        /// How many there should be, all satisfied.
        expected: usize,
    },
    /// The last line does not say that all were verified and none failed.
    Summary {
        /// How many harnesses it should have said.
        expected: usize,
    },
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(name) => write!(f, "{name}: not checked"),
            Self::Unexpected(name) => write!(f, "{name}: checked, but not expected, or twice"),
            Self::NotVerified(name) => write!(f, "{name}: not verified"),
            Self::Covers { name, found: Some((satisfied, of)), expected } => {
                write!(f, "{name}: {satisfied} of {of} covers satisfied, expected {expected} of {expected}")
            }
            Self::Covers { name, found: None, expected } => {
                write!(f, "{name}: no cover line, expected {expected} of {expected}")
            }
            Self::Summary { expected } => {
                write!(
                    f,
                    "no summary line that says {expected} verified harnesses, 0 failures, {expected} total"
                )
            }
        }
    }
}

impl std::error::Error for Problem {}

/// What the log says of one harness.
#[derive(Debug)]
struct Checked<'a> {
    name: &'a str,
    verified: bool,
    covers: Option<(usize, usize)>,
}

/// What is wrong with `log`, given that these harnesses should have been checked. Nothing
/// is wrong if each of them was, once, was verified, and had all its covers satisfied, no
/// other one was, and the summary says so too.
#[must_use]
pub fn problems(log: &str, expected: &[Expected<'_>]) -> Vec<Problem> {
    let mut checked: Vec<Checked<'_>> = Vec::new();
    let mut summary = false;
    for line in log.lines().map(str::trim) {
        if let Some(path) = line.strip_prefix("Checking harness ").and_then(|rest| rest.strip_suffix("...")) {
            let name = path.rsplit("::").next().unwrap_or(path);
            checked.push(Checked { name, verified: false, covers: None });
        } else if let ("VERIFICATION:- SUCCESSFUL", Some(last)) = (line, checked.last_mut()) {
            last.verified = true;
        } else if let (Some(covers), Some(last)) = (covers(line), checked.last_mut()) {
            last.covers = Some(covers);
        }
        let count = expected.len();
        summary |=
            line == format!("Complete - {count} successfully verified harnesses, 0 failures, {count} total.");
    }
    let mut problems = Vec::new();
    for harness in expected {
        let mut runs = checked.iter().filter(|checked| checked.name == harness.name);
        match (runs.next(), runs.next()) {
            (None, _) => problems.push(Problem::Missing(harness.name.to_owned())),
            (Some(_), Some(_)) => problems.push(Problem::Unexpected(harness.name.to_owned())),
            (Some(run), None) => {
                if !run.verified {
                    problems.push(Problem::NotVerified(harness.name.to_owned()));
                }
                if run.covers != Some((harness.covers, harness.covers)) {
                    problems.push(Problem::Covers {
                        name: harness.name.to_owned(),
                        found: run.covers,
                        expected: harness.covers,
                    });
                }
            }
        }
    }
    let unknown = checked.iter().filter(|run| !expected.iter().any(|harness| harness.name == run.name));
    problems.extend(unknown.map(|run| Problem::Unexpected(run.name.to_owned())));
    if !summary {
        problems.push(Problem::Summary { expected: expected.len() });
    }
    problems
}

/// `** 2 of 3 cover properties satisfied (1 unreachable)` is 2 of 3.
fn covers(line: &str) -> Option<(usize, usize)> {
    let (counts, _) = line.strip_prefix("** ")?.split_once(" cover properties satisfied")?;
    let (satisfied, of) = counts.split_once(" of ")?;
    Some((satisfied.parse().ok()?, of.parse().ok()?))
}
