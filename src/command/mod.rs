//! The command line.
//!
//! A command is given its arguments and yields a [`Report`]: what to print, and whether
//! everything was right. Printing and exit codes are left to the program.

mod audit;
mod demo;
mod durable;
mod erase;
mod explain;
mod graph;
mod key_files;
mod keygen;
mod lint;
mod negotiate;
mod optimum;
mod options;
mod overwriting;
mod parquet_folder;
mod policies;
mod present;
mod private_file;
mod progress;
mod rank_range;
mod regret;
mod replicate;
mod report;
mod simulate;
mod trace_file;
mod unseal;
mod verify;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::{Parser, Subcommand};
use selfneg_core::{RulesError, TooManyConditions};
use selfneg_model::lottery::LotteryError;
use selfneg_model::order::OrderError;
use serde::Serialize;

use crate::explain::ExplainError;
use crate::fleet::TableError;
use crate::input::InputError;
use crate::policies::PoliciesError;
use crate::precedence::PrecedenceError;
use crate::regret::RegretError;
use crate::replicate::ReplicateError;
use crate::scenario::ScenarioError;
use crate::seal::KeyError;
use crate::trace::{EraseError, TraceError, UnsealError};
use crate::verify::VerifyError;

/// Who gets the robot? Ethical decisions between interrupting users.
///
/// A service robot is serving one user when another interrupts. It negotiates with itself:
/// it speaks for each user in turn, from that user's own ethical profile, disclosing one
/// condition a round, until one side accepts or both have run out of offers.
///
/// Exit codes: 0 done and nothing wrong, 1 a check failed, 2 unusable input or arguments.
#[derive(Debug, Parser)]
#[command(name = "selfneg", version, arg_required_else_help = true)]
pub struct Program {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Demo),
    Negotiate(negotiate::Negotiate),
    Simulate(simulate::Simulate),
    Explain(explain::Explain),
    Report(report::Report),
    Keygen(keygen::Keygen),
    Audit(audit::Audit),
    Unseal(unseal::Unseal),
    Erase(erase::Erase),
    Replicate(replicate::Replicate),
    Optimum(optimum::Optimum),
    Regret(regret::Regret),
    Policies(policies::Policies),
    Graph(graph::Graph),
    Lint(lint::Lint),
    Verify(verify::Verify),
}

/// What a command has to say.
#[derive(Debug, Default)]
pub struct Report {
    /// For standard output.
    pub output: String,
    /// For standard error, one line each.
    pub warnings: Vec<String>,
    /// Whether every check passed.
    pub status: Status,
}

/// Whether what was checked is right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Status {
    /// Done, and nothing wrong.
    #[default]
    Passed,
    /// A check failed.
    Failed,
    /// Some of the input cannot be used; what can be was done.
    Unusable,
}

/// Why a command could not do its work.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CommandError {
    /// A file is not as expected.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The users cannot be decided among.
    #[error(transparent)]
    Precedence(#[from] PrecedenceError),
    /// A package cannot be rerun.
    #[error(transparent)]
    Replicate(#[from] ReplicateError),
    /// Nothing can be verified.
    #[error(transparent)]
    Verify(#[from] VerifyError),
    /// No optimal lottery.
    #[error(transparent)]
    Lottery(#[from] LotteryError),
    /// No optimal order.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// The policies cannot be compared.
    #[error(transparent)]
    Policies(#[from] PoliciesError),
    /// The worst case is not known.
    #[error(transparent)]
    Regret(#[from] RegretError),
    /// The engine refused the rules.
    #[error("rules: {0}")]
    Rules(#[from] RulesError),
    /// The engine refused a status.
    #[error("status: {0}")]
    Status(#[from] TooManyConditions),
    /// A scenario cannot be run.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// Somebody who watches a run cannot go on.
    #[error("the run cannot be recorded: {0}")]
    Recording(io::Error),
    /// A trace cannot be read.
    #[error("{}: {source}", file.display())]
    Trace {
        /// The trace.
        file: PathBuf,
        /// Why.
        source: TraceError,
    },
    /// A trace's decisions cannot be explained so.
    #[error("{}: {source}", file.display())]
    Unexplained {
        /// The trace.
        file: PathBuf,
        /// Why.
        source: ExplainError,
    },
    /// A file holds no key.
    #[error("{}: {source}", file.display())]
    Key {
        /// The file.
        file: PathBuf,
        /// Why not.
        source: KeyError,
    },
    /// A trace cannot be unsealed.
    #[error("{}: {source}", file.display())]
    Unsealable {
        /// The trace.
        file: PathBuf,
        /// Why not.
        source: UnsealError,
    },
    /// Nothing can be erased from a trace.
    #[error("{}: {source}", file.display())]
    Unerasable {
        /// The trace.
        file: PathBuf,
        /// Why not.
        source: EraseError,
    },
    /// The arguments do not fit together.
    #[error("{0}")]
    Arguments(String),
    /// A file cannot be written.
    #[error("{}: cannot be written: {source}", file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The tables of a fleet cannot be written.
    #[error("{}: the tables cannot be written: {source}", folder.display())]
    Tables {
        /// Where to.
        folder: PathBuf,
        /// Why.
        source: TableError,
    },
    /// A document cannot be made JSON.
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl Program {
    /// Runs the command.
    ///
    /// # Errors
    /// [`CommandError`] if the input or the arguments cannot be used.
    pub fn run(&self) -> Result<Report, CommandError> {
        match &self.command {
            Command::Demo(demo) => demo.run(),
            Command::Negotiate(negotiate) => negotiate.run(),
            Command::Simulate(simulate) => simulate.run(),
            Command::Explain(explain) => explain.run(),
            Command::Report(report) => report.run(),
            Command::Keygen(keygen) => keygen.run(),
            Command::Audit(audit) => audit.run(),
            Command::Unseal(unseal) => unseal.run(),
            Command::Erase(erase) => erase.run(),
            Command::Replicate(replicate) => replicate.run(),
            Command::Optimum(optimum) => optimum.run(),
            Command::Regret(regret) => regret.run(),
            Command::Graph(graph) => graph.run(),
            Command::Policies(policies) => policies.run(),
            Command::Lint(lint) => lint.run(),
            Command::Verify(verify) => verify.run(),
        }
    }
}

/// One JSON document, ended by a newline.
fn json<T: Serialize>(document: &T) -> Result<String, CommandError> {
    let mut text = serde_json::to_string_pretty(document)?;
    text.push('\n');
    Ok(text)
}

/// Writes a whole file or leaves what was there. Folders are made if need be.
fn write_whole(file: &Path, text: &str) -> Result<(), CommandError> {
    let unwritable = |file: &Path| {
        let file = file.to_owned();
        move |source| CommandError::Unwritable { file, source }
    };
    let folder = file.parent().unwrap_or(Path::new(""));
    if !folder.as_os_str().is_empty() {
        fs::create_dir_all(folder).map_err(unwritable(folder))?;
    }
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let part = folder.join(format!(".{name}.part"));
    fs::write(&part, text).map_err(unwritable(&part))?;
    fs::rename(&part, file).map_err(|source| {
        let _ = fs::remove_file(&part);
        unwritable(file)(source)
    })
}
