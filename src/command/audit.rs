//! `selfneg audit`: whether traces are whole, unchanged, and of a robot that kept its rules.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use rayon::prelude::*;
use serde::Serialize;

use super::key_files::{auditor_keys, robot_public_key};
use super::{CommandError, Report, Status, json, progress, trace_file};
use crate::audit::{self, AuditRecord, Keys};
use crate::input::InputError;

/// Check traces: seal, properties, and every decision made again from its inputs
///
/// Exit code 0 only if every trace is ok: signed by a robot key given, sealed, whole, and with
/// nothing wrong in it. Without --identity a sealed trace can be ok, and the output says what was
/// not checked. docs/audit.md says what every status means.
#[derive(Debug, Args)]
pub(super) struct Audit {
    /// Traces, or folders with traces (*.mcap, also in folders below)
    #[arg(value_name = "TRACE", required = true)]
    traces: Vec<PathBuf>,
    /// A robot's public key whose signature is trusted; may be given several times
    #[arg(long, value_name = "PUB")]
    robot_key: Vec<PathBuf>,
    /// An auditor's private key, which opens what is personal; may be given several times
    #[arg(long, value_name = "AUDITOR_KEY")]
    identity: Vec<PathBuf>,
    /// Print one JSON document instead of the findings in words
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Document {
    traces: Vec<AuditRecord>,
}

impl Audit {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let robots = self.robot_key.iter().map(|file| robot_public_key(file));
        let keys = Keys {
            robots: robots.collect::<Result<_, _>>()?,
            identities: if self.identity.is_empty() { Vec::new() } else { auditor_keys(&self.identity)? },
        };
        let (mut files, mut unusable) = (Vec::new(), Vec::new());
        for path in &self.traces {
            match traces_at(path) {
                Ok(found) => files.extend(found),
                Err(error) => unusable.push(error),
            }
        }
        let bar =
            progress::bar(u64::try_from(files.len()).unwrap_or(u64::MAX), "{bar:20} {pos} of {len} traces");
        // In the order of the files, whatever the order in which they are done. Each worker
        // holds one file at a time, and of it keeps what is printed.
        let audited: Vec<Result<Audited, CommandError>> = files
            .par_iter()
            .map(|file| {
                let audited = trace_file::read(file).map(|bytes| self.audited(file, &bytes, &keys));
                bar.inc(1);
                audited
            })
            .collect();
        bar.finish_and_clear();
        let mut done = Vec::new();
        for audited in audited {
            match audited {
                Ok(audited) => done.push(audited),
                Err(error) => unusable.push(error),
            }
        }
        if done.is_empty() {
            return Err(unusable.into_iter().next().unwrap_or_else(|| {
                CommandError::Arguments(
                    "no trace was given, expected a file or a folder of traces".to_owned(),
                )
            }));
        }
        let is = |status: audit::Status| done.iter().filter(|one| one.status == status).count();
        let status = if !unusable.is_empty() || is(audit::Status::Unreadable) == done.len() {
            Status::Unusable
        } else if is(audit::Status::Ok) == done.len() {
            Status::Passed
        } else {
            Status::Failed
        };
        let warnings = unusable.iter().map(ToString::to_string).collect();
        let output = match self.json {
            true => json(&Document { traces: done.into_iter().filter_map(|one| one.record).collect() })?,
            false => told(&done),
        };
        Ok(Report { output, warnings, status })
    }

    fn audited(&self, file: &Path, bytes: &[u8], keys: &Keys) -> Audited {
        let found = audit::audit(bytes, keys);
        let name = file.display().to_string();
        Audited {
            status: found.status,
            decisions: found.decisions.len(),
            redecided: found.redecided(),
            record: self.json.then(|| found.record(&name)),
            text: if self.json { String::new() } else { found.tell(&name) },
        }
    }
}

/// What is kept of a trace.
struct Audited {
    status: audit::Status,
    decisions: usize,
    redecided: usize,
    record: Option<AuditRecord>,
    text: String,
}

/// The traces at a path: itself, or all below a folder, sorted.
fn traces_at(path: &Path) -> Result<Vec<PathBuf>, CommandError> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut found = Vec::new();
    below(path, &mut found)?;
    if found.is_empty() {
        let what = format!("{}: no trace in this folder, expected files *.mcap", path.display());
        return Err(CommandError::Arguments(what));
    }
    found.sort();
    Ok(found)
}

fn below(folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), CommandError> {
    let unreadable = |source| InputError::Unreadable { file: folder.to_owned(), source };
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let kind = entry.file_type().map_err(unreadable)?;
        let path = entry.path();
        // A link to a folder may lead back here, and is not followed.
        if kind.is_dir() {
            below(&path, found)?;
        } else if path.extension().is_some_and(|extension| extension == "mcap") && path.is_file() {
            found.push(path);
        }
    }
    Ok(())
}

fn told(done: &[Audited]) -> String {
    let mut text = String::new();
    for one in done {
        text.push_str(&one.text);
        text.push('\n');
    }
    text.push_str(&summary(done));
    text
}

fn summary(done: &[Audited]) -> String {
    let count = |number: usize, what: &str| format!("{number} {what}{}", if number == 1 { "" } else { "s" });
    let statuses: Vec<String> = audit::Status::ALL
        .into_iter()
        .rev()
        .map(|status| (status, done.iter().filter(|one| one.status == status).count()))
        .filter(|&(_, number)| number > 0)
        .map(|(status, number)| format!("{number} {status}"))
        .collect();
    let decisions = done.iter().map(|one| one.decisions).sum();
    let redecided: usize = done.iter().map(|one| one.redecided).sum();
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}: {}. {}, {redecided} of them made again.",
        count(done.len(), "trace"),
        statuses.join(", "),
        count(decisions, "decision")
    );
    text
}
