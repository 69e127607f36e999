//! Reruns a published package checkout against its own logs.

mod ground_truth;
mod log;
mod package;
mod warnings;

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};

use selfneg_core::{Options, QuitRule};
use serde::Serialize;

use crate::input::InputError;
use crate::precedence::{self, Policy, PrecedenceError};

use ground_truth::GroundTruth;
use package::{Dataset, LoggedCase};

/// What the rerun of a package found.
#[derive(Debug, Serialize)]
pub struct Replication {
    /// One entry for each dataset whose log is there.
    pub datasets: Vec<DatasetReport>,
    /// The datasets whose log is not there, with the log that was looked for.
    pub missing: Vec<MissingDataset>,
}

/// A dataset that the package does not hold.
#[derive(Debug, Serialize)]
pub struct MissingDataset {
    /// Its name.
    pub name: &'static str,
    /// The log that it would have.
    pub log: PathBuf,
}

/// What the rerun of one dataset found.
#[derive(Debug, Serialize)]
pub struct DatasetReport {
    /// `validation`, `scalability`, `willingness` or `multi-lateral`.
    pub name: &'static str,
    /// Runs in the log.
    pub cases: usize,
    /// Runs that the engine decides otherwise.
    pub outcome_mismatches: usize,
    /// Runs for which the engine takes another number of rounds. In the three-user log
    /// the rounds are those of the first bilateral negotiation.
    pub round_mismatches: usize,
    /// Agreement with `ground_truth.csv`; only for the validation users.
    pub ground_truth: Option<GroundTruthReport>,
    /// Unordered pairs of users of the log; `None` where runs have three users.
    pub pairs: Option<usize>,
    /// Pairs whose agreed winner depends on who interrupts.
    pub order_dependent_pairs: Option<usize>,
    /// Sets of three users of the log; `None` where runs have two.
    pub triples: Option<usize>,
    /// Sets of three whose agreed winner depends on the order of arrival.
    pub order_dependent_triples: Option<usize>,
    /// Runs that the paper's literal quit rule would have decided otherwise.
    pub literal_quit_differs: usize,
    /// Lines of the log that are no run.
    pub unreadable_lines: Vec<usize>,
    /// The runs that do not match, one by one.
    pub mismatches: Vec<Mismatch>,
    /// What is legal in the dataset's files but surely not meant.
    pub warnings: Vec<String>,
    /// The log.
    pub log: PathBuf,
}

/// How the engine's outcomes agree with the expected ones.
#[derive(Debug, Serialize)]
pub struct GroundTruthReport {
    /// Runs that the table has an expectation for.
    pub cases: usize,
    /// Runs that meet it.
    pub agree: usize,
    /// Runs that the table says nothing of.
    pub uncovered: usize,
    /// The table.
    pub file: PathBuf,
    /// The runs that do not, one by one.
    pub disagreements: Vec<Disagreement>,
}

/// A run that does not end as the ground truth expects.
#[derive(Debug, Serialize)]
pub struct Disagreement {
    /// The line of the table, from 1.
    pub line: usize,
    /// Who took part, the current user first.
    pub users: String,
    /// The expected winner; `None` is no agreement.
    pub expected: Option<String>,
    /// The engine's; `None` is no agreement.
    pub decided: Option<String>,
}

/// A run that does not match its log line.
#[derive(Debug, Serialize)]
pub struct Mismatch {
    /// The line of the log, from 1.
    pub line: usize,
    /// Who took part, the current user first.
    pub users: String,
    /// What the log says.
    pub logged: Ended,
    /// What the engine says.
    pub decided: Ended,
}

/// An outcome and its rounds.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct Ended {
    /// As in the logs.
    pub outcome: String,
    /// Of the first bilateral negotiation.
    pub rounds: u64,
}

impl DatasetReport {
    /// Whether everything matches; a ground truth that does not cover every run does not.
    #[must_use]
    pub fn matches(&self) -> bool {
        self.reproduces_log()
            && self
                .ground_truth
                .as_ref()
                .is_none_or(|truth| truth.uncovered == 0 && truth.agree == truth.cases)
    }

    /// Whether every line of the log is a run that the engine decides in the same way.
    #[must_use]
    pub fn reproduces_log(&self) -> bool {
        self.outcome_mismatches == 0 && self.round_mismatches == 0 && self.unreadable_lines.is_empty()
    }
}

/// Why a package could not be rerun.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplicateError {
    /// A file of the package is not as expected.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The folder holds no log of any dataset.
    #[error("{}: holds no published log, expected at least one of {expected}", folder.display())]
    NothingThere {
        /// The folder.
        folder: PathBuf,
        /// The logs that were looked for.
        expected: String,
    },
    /// The folder itself cannot be read.
    #[error("{}: cannot be read: {source}", folder.display())]
    NoFolder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A log without any line: nothing would be checked.
    #[error("{}: holds no run, expected one in each line", log.display())]
    NoRuns {
        /// The log.
        log: PathBuf,
    },
    /// A line of a log names users who are not there.
    #[error("{}:{line}: {problem}", log.display())]
    Line {
        /// The log.
        log: PathBuf,
        /// From 1.
        line: usize,
        /// What is wrong with it, and what was expected.
        problem: String,
    },
    /// The ground truth is not a table of users.
    #[error("{}:{line}: {problem}", file.display())]
    GroundTruth {
        /// The table.
        file: PathBuf,
        /// From 1.
        line: usize,
        /// What is wrong with it, and what was expected.
        problem: String,
    },
    /// The engine refused a case.
    #[error("{}:{line}: {source}", log.display())]
    Precedence {
        /// The log.
        log: PathBuf,
        /// From 1.
        line: usize,
        /// Why.
        source: PrecedenceError,
    },
}

/// The names of the datasets that a package can hold.
pub fn dataset_names() -> impl Iterator<Item = &'static str> {
    package::LAYOUTS.iter().map(|layout| layout.name)
}

/// How far a rerun is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Runs done so far, all datasets together.
    pub done: usize,
    /// Runs in all.
    pub of: usize,
}

/// Reruns every dataset that `folder` holds. `progress` is told after each run.
///
/// # Errors
/// [`ReplicateError`] if the folder holds no dataset, or a file that a log relies on is
/// not as expected.
pub fn replicate<F: FnMut(Progress)>(folder: &Path, mut progress: F) -> Result<Replication, ReplicateError> {
    std::fs::read_dir(folder)
        .map_err(|source| ReplicateError::NoFolder { folder: folder.to_owned(), source })?;
    let mut datasets = Vec::new();
    let mut missing = Vec::new();
    for layout in package::LAYOUTS {
        let log = folder.join(layout.log);
        if log.exists() {
            datasets.push(Dataset::read(folder, layout)?);
        } else {
            missing.push(MissingDataset { name: layout.name, log });
        }
    }
    if datasets.is_empty() {
        let logs: Vec<&str> = package::LAYOUTS.iter().map(|layout| layout.log).collect();
        return Err(ReplicateError::NothingThere { folder: folder.to_owned(), expected: logs.join(", ") });
    }
    let of = datasets.iter().map(|dataset| dataset.cases.len()).sum();
    let mut done = 0usize;
    let mut reports = Vec::new();
    for dataset in &datasets {
        let truth = match dataset.layout.ground_truth {
            Some(file) if folder.join(file).exists() => Some(GroundTruth::read(&folder.join(file))?),
            _ => None,
        };
        reports.push(rerun(dataset, truth.as_ref(), || {
            done = done.saturating_add(1);
            progress(Progress { done, of });
        })?);
    }
    Ok(Replication { datasets: reports, missing })
}

fn rerun<F: FnMut()>(
    dataset: &Dataset,
    truth: Option<&GroundTruth>,
    mut tick: F,
) -> Result<DatasetReport, ReplicateError> {
    let mut mismatches = Vec::new();
    let (mut outcome_mismatches, mut round_mismatches, mut literal_quit_differs) = (0usize, 0usize, 0usize);
    let mut ground_truth = truth.map(|truth| GroundTruthReport {
        cases: 0,
        agree: 0,
        uncovered: 0,
        file: truth.file.clone(),
        disagreements: Vec::new(),
    });
    let mut groups: BTreeMap<BTreeSet<usize>, &LoggedCase> = BTreeMap::new();
    for case in &dataset.cases {
        let decision = decide(dataset, case, &case.users, QuitRule::Exhausted)?;
        let decided = Ended {
            outcome: decision.outcome_name(case.users.len()),
            rounds: decision.negotiations.first().map_or(0, |held| u64::from(held.conclusion.rounds)),
        };
        let logged = Ended { outcome: case.outcome.clone(), rounds: case.rounds };
        if decided.outcome != logged.outcome {
            outcome_mismatches = outcome_mismatches.saturating_add(1);
        }
        if decided.rounds != logged.rounds {
            round_mismatches = round_mismatches.saturating_add(1);
        }
        if decided != logged {
            mismatches.push(Mismatch { line: case.line, users: dataset.label(case), logged, decided });
        }
        let names = dataset.names(case);
        let cell = truth.and_then(|truth| truth.expected(&names));
        if let (Some(report), None) = (&mut ground_truth, cell) {
            report.uncovered = report.uncovered.saturating_add(1);
        }
        if let (Some(report), Some(cell)) = (&mut ground_truth, cell) {
            let decided = decision.agreement.and_then(|user| names.get(user)).map(|&name| name.to_owned());
            report.cases = report.cases.saturating_add(1);
            if decided == cell.winner {
                report.agree = report.agree.saturating_add(1);
            } else {
                report.disagreements.push(Disagreement {
                    line: cell.line,
                    users: dataset.label(case),
                    expected: cell.winner.clone(),
                    decided,
                });
            }
        }
        if decide(dataset, case, &case.users, QuitRule::Literal)?.agreement != decision.agreement {
            literal_quit_differs = literal_quit_differs.saturating_add(1);
        }
        groups.entry(case.users.iter().copied().collect()).or_insert(case);
        tick();
    }
    let mut order_dependent = 0usize;
    for case in groups.values() {
        if depends_on_order(dataset, case)? {
            order_dependent = order_dependent.saturating_add(1);
        }
    }
    let of_two = dataset.layout.users_per_run == 2;
    let (twos, threes) = if of_two { (Some(groups.len()), None) } else { (None, Some(groups.len())) };
    Ok(DatasetReport {
        name: dataset.layout.name,
        cases: dataset.cases.len(),
        outcome_mismatches,
        round_mismatches,
        ground_truth,
        pairs: twos,
        order_dependent_pairs: twos.map(|_| order_dependent),
        triples: threes,
        order_dependent_triples: threes.map(|_| order_dependent),
        literal_quit_differs,
        unreadable_lines: dataset.unreadable_lines.clone(),
        mismatches,
        warnings: warnings::summarised(&dataset.findings),
        log: dataset.log.clone(),
    })
}

/// Whether the agreed winner changes with the order in which the users of `case` arrive.
fn depends_on_order(dataset: &Dataset, case: &LoggedCase) -> Result<bool, ReplicateError> {
    let mut winners = BTreeSet::new();
    for order in orders(&case.users) {
        let decision = decide(dataset, case, &order, QuitRule::Exhausted)?;
        winners.insert(decision.agreement.and_then(|user| order.get(user).copied()));
    }
    Ok(winners.len() > 1)
}

/// Every order of a few users.
fn orders(users: &[usize]) -> Vec<Vec<usize>> {
    let [first, rest @ ..] = users else { return vec![Vec::new()] };
    let mut all = Vec::new();
    for order in orders(rest) {
        for at in 0..=order.len() {
            let mut longer = order.clone();
            longer.insert(at, *first);
            all.push(longer);
        }
    }
    all
}

fn decide(
    dataset: &Dataset,
    case: &LoggedCase,
    users: &[usize],
    quit: QuitRule,
) -> Result<precedence::Decision, ReplicateError> {
    let users = dataset.seated(users);
    let willingness = u8::from(users.first().is_some_and(|current| current.end_of_goal));
    let options = Options { quit, willingness, ..Options::default() };
    precedence::decide(&dataset.rules, &users, options, Policy::Published)
        .map_err(|source| ReplicateError::Precedence { log: dataset.log.clone(), line: case.line, source })
}
