//! `selfneg replicate`: reruns a published package checkout against its logs.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::{CommandError, Report, Status, json, progress};
use crate::replicate::{DatasetReport, Replication, dataset_names, replicate};

/// Rerun a checkout of the published replication package against its own logs
/// (exit code 1 if anything differs)
#[derive(Debug, Args)]
pub(super) struct Replicate {
    /// The package: it has the folders run and results
    #[arg(value_name = "DIR")]
    package: PathBuf,
    /// Fail unless DATASET (validation, scalability, willingness or multi-lateral) is there and
    /// has N runs; may be given several times
    #[arg(long, value_name = "DATASET=N", value_parser = dataset_runs)]
    runs: Vec<(String, usize)>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

/// Reads `validation=90`.
fn dataset_runs(text: &str) -> Result<(String, usize), String> {
    text.split_once('=')
        .and_then(|(name, runs)| Some((name.to_owned(), runs.parse().ok()?)))
        .filter(|(name, _)| dataset_names().any(|known| known == name))
        .ok_or_else(|| {
            let known: Vec<&str> = dataset_names().collect();
            format!("expected DATASET=N with one of {}, found {text:?}", known.join(", "))
        })
}

impl Replicate {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let bar = progress::bar(0, "{bar:40} {pos} of {len} runs");
        let replication = replicate(&self.package, |progress| {
            bar.set_length(u64::try_from(progress.of).unwrap_or(u64::MAX));
            bar.set_position(u64::try_from(progress.done).unwrap_or(u64::MAX));
        })?;
        bar.finish_and_clear();
        let output = if self.json { json(&replication)? } else { table(&replication) };
        let mut warnings: Vec<String> = replication
            .datasets
            .iter()
            .flat_map(|dataset| dataset.warnings.iter().map(|text| format!("{}: {text}", dataset.name)))
            .collect();
        let mut passed = replication.datasets.iter().all(DatasetReport::matches);
        for (name, expected) in &self.runs {
            let found = replication.datasets.iter().find(|dataset| dataset.name == name);
            let runs = found.map_or(0, |dataset| dataset.cases);
            if runs != *expected {
                passed = false;
                warnings.push(format!("{name}: found {runs} runs, expected {expected}"));
            }
        }
        let status = if passed { Status::Passed } else { Status::Failed };
        Ok(Report { output, warnings, status })
    }
}

/// How many differences of a kind and dataset are shown one by one.
const SHOWN: usize = 10;

fn table(replication: &Replication) -> String {
    let mut text = String::from(
        "                       mismatches of      ground   order-dependent   literal quit\n\
         dataset        runs   outcome   rounds    truth             pairs   would differ\n",
    );
    for dataset in &replication.datasets {
        let truth = dataset.ground_truth.as_ref().map_or("-".to_owned(), |truth| {
            format!("{}/{}", truth.agree, truth.cases.saturating_add(truth.uncovered))
        });
        let order = match (dataset.pairs, dataset.triples) {
            (Some(pairs), _) => format!("{} of {pairs}", dataset.order_dependent_pairs.unwrap_or(0)),
            (None, Some(triples)) => {
                format!("{} of {triples} triples", dataset.order_dependent_triples.unwrap_or(0))
            }
            (None, None) => "-".to_owned(),
        };
        let _ = writeln!(
            text,
            "{:<13} {:>5}   {:>7}   {:>6}   {:>6}   {:>15}   {:>12}",
            dataset.name,
            dataset.cases,
            dataset.outcome_mismatches,
            dataset.round_mismatches,
            truth,
            order,
            dataset.literal_quit_differs
        );
    }
    for missing in &replication.missing {
        let _ = writeln!(text, "{:<13} not there: {}", missing.name, missing.log.display());
    }
    text.push('\n');
    for dataset in &replication.datasets {
        what_differs(&mut text, dataset);
    }
    let verdict = if replication.datasets.iter().all(DatasetReport::matches) {
        "Every run of these logs is reproduced: outcome and rounds."
    } else if replication.datasets.iter().all(DatasetReport::reproduces_log) {
        "Every run of these logs is reproduced, but not as the ground truth expects."
    } else {
        "Not every run of these logs is reproduced."
    };
    let _ = writeln!(text, "{verdict}");
    text
}

/// One line for each difference, up to [`SHOWN`] of a kind.
fn what_differs(text: &mut String, dataset: &DatasetReport) {
    let log = dataset.log.display();
    let unreadable =
        dataset.unreadable_lines.iter().map(|line| format!("{log}:{line}: is no run of the published form"));
    list(text, dataset.name, "unreadable lines", unreadable);
    let mismatches = dataset.mismatches.iter().map(|mismatch| {
        format!(
            "{log}:{}: {}: logged {} in {}, decided {} in {}",
            mismatch.line,
            mismatch.users,
            mismatch.logged.outcome,
            rounds(mismatch.logged.rounds),
            mismatch.decided.outcome,
            rounds(mismatch.decided.rounds)
        )
    });
    list(text, dataset.name, "mismatches", mismatches);
    if let Some(truth) = &dataset.ground_truth {
        let winner = |winner: &Option<String>| winner.clone().unwrap_or_else(|| "no agreement".to_owned());
        let disagreements = truth.disagreements.iter().map(|differs| {
            format!(
                "{}:{}: {}: expected {}, decided {}",
                truth.file.display(),
                differs.line,
                differs.users,
                winner(&differs.expected),
                winner(&differs.decided)
            )
        });
        list(text, dataset.name, "disagreements with the ground truth", disagreements);
    }
}

fn list<I: ExactSizeIterator<Item = String>>(text: &mut String, dataset: &str, what: &str, lines: I) {
    let more = lines.len().saturating_sub(SHOWN);
    for line in lines.take(SHOWN) {
        let _ = writeln!(text, "{line}");
    }
    if more > 0 {
        let _ = writeln!(text, "{dataset}: and {more} more {what} (all of them with --json)");
    }
}

fn rounds(count: u64) -> String {
    match count {
        1 => "1 round".to_owned(),
        count => format!("{count} rounds"),
    }
}
