//! `selfneg replicate`: reruns a published package checkout against its logs.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::{CommandError, Report, Status, json};
use crate::replicate::{DatasetReport, Replication, replicate};

/// Rerun a checkout of the published replication package against its own logs
/// (exit code 1 if anything differs)
#[derive(Debug, Args)]
pub(super) struct Replicate {
    /// The package: it has the folders run and results
    #[arg(value_name = "DIR")]
    package: PathBuf,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
}

impl Replicate {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        // Drawn on standard error, and only on a terminal.
        let bar = ProgressBar::new(0);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos} of {len} runs") {
            bar.set_style(style);
        }
        let replication = replicate(&self.package, |progress| {
            bar.set_length(u64::try_from(progress.of).unwrap_or(u64::MAX));
            bar.set_position(u64::try_from(progress.done).unwrap_or(u64::MAX));
        })?;
        bar.finish_and_clear();
        let output = if self.json { json(&replication)? } else { table(&replication) };
        let warnings = replication
            .datasets
            .iter()
            .flat_map(|dataset| dataset.warnings.iter().map(|text| format!("{}: {text}", dataset.name)))
            .collect();
        let passed = replication.datasets.iter().all(DatasetReport::matches);
        let status = if passed { Status::Passed } else { Status::Failed };
        Ok(Report { output, warnings, status })
    }
}

/// How many mismatches of a dataset are shown one by one.
const SHOWN: usize = 10;

fn table(replication: &Replication) -> String {
    let mut text = String::from(
        "                       mismatches of      ground   order-dependent   literal quit\n\
         dataset        runs   outcome   rounds    truth             pairs   would differ\n",
    );
    for dataset in &replication.datasets {
        let truth = dataset
            .ground_truth
            .as_ref()
            .map_or("-".to_owned(), |truth| format!("{}/{}", truth.agree, truth.cases));
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
        for line in dataset.unreadable_lines.iter().take(SHOWN) {
            let _ = writeln!(text, "{}:{line}: is no run of the published form", dataset.log.display());
        }
        for mismatch in dataset.mismatches.iter().take(SHOWN) {
            let _ = writeln!(
                text,
                "{}:{}: {}: logged {} in {} rounds, decided {} in {}",
                dataset.log.display(),
                mismatch.line,
                mismatch.users,
                mismatch.logged.outcome,
                mismatch.logged.rounds,
                mismatch.decided.outcome,
                mismatch.decided.rounds
            );
        }
        if let Some(more) = dataset.mismatches.len().checked_sub(SHOWN).filter(|&more| more > 0) {
            let _ = writeln!(text, "{}: and {more} more mismatches (all of them with --json)", dataset.name);
        }
    }
    let verdict = if replication.datasets.iter().all(DatasetReport::matches) {
        "Every run of these logs is reproduced: outcome and rounds."
    } else {
        "Not every run of these logs is reproduced."
    };
    let _ = writeln!(text, "{verdict}");
    text
}
