//! `selfneg audit`: whether traces are whole, unchanged, and of a robot that kept its rules.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use rayon::prelude::*;
use serde::Serialize;

use super::key_files::{auditor_keys, robot_public_key};
use super::parquet_folder::ParquetFolder;
use super::{CommandError, Report, Status, json, overwriting, progress, trace_file};
use crate::audit::{self, AuditRecord, Keys};
use crate::fleet::{RowCounts, Tables, TraceRows};
use crate::input::InputError;
use crate::printable::one_line;
use crate::trace::{Opened, open};

/// Check traces: seal, properties, and every decision made again from its inputs
///
/// Exit code 0 only if every trace is ok: signed by a robot key given, sealed, whole, and with
/// nothing wrong in it. Without --identity a sealed trace can be ok, and the output says what was
/// not checked. docs/audit.md says what every status means.
#[derive(Debug, Args)]
pub(super) struct Audit {
    /// Traces, or folders with traces (*.mcap or *.MCAP, also in folders below)
    #[arg(value_name = "TRACE", required = true)]
    traces: Vec<PathBuf>,
    /// A robot's public key whose signature is trusted; may be given several times
    #[arg(long, value_name = "PUB")]
    robot_key: Vec<PathBuf>,
    /// An auditor's private key, which opens what is personal; may be given several times
    #[arg(long, value_name = "AUDITOR_KEY")]
    identity: Vec<PathBuf>,
    /// Write what is open of all decisions and rounds, and what was found, as three tables
    /// into this folder (Parquet; docs/fleet.md), and print the summary alone
    #[arg(long, value_name = "DIR")]
    parquet: Option<PathBuf>,
    /// Print one JSON document instead of the findings in words
    #[arg(long)]
    json: bool,
}

/// How many traces are audited before their rows are written: enough to keep all workers busy,
/// and few enough that what is held back does not grow with the number of traces.
const BATCH: usize = 64;

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
        let mut files: Vec<(PathBuf, Option<Box<CommandError>>)> = Vec::new();
        for path in &self.traces {
            match traces_at(path) {
                Ok(found) => files.extend(found.into_iter().map(|file| (file, None))),
                Err(error) => files.push((path.clone(), Some(Box::new(error)))),
            }
        }
        if let Some(folder) = &self.parquet {
            for table in Tables::<fs::File>::FILES {
                let keys = self.robot_key.iter().chain(&self.identity);
                let read = files.iter().map(|(file, _)| file).chain(keys).map(PathBuf::as_path);
                overwriting::refuse(&folder.join(table), read)?;
            }
        }
        let bar =
            progress::bar(u64::try_from(files.len()).unwrap_or(u64::MAX), "{bar:20} {pos} of {len} traces");
        let mut tables = self.parquet.as_deref().map(ParquetFolder::create).transpose()?;
        let (mut done, mut unusable, mut opened) = (Vec::new(), Vec::new(), 0_usize);
        // In the order of the files, whatever the order in which they are done. Each worker
        // holds one file at a time, and of it keeps what is printed or written.
        for batch in files.chunks_mut(BATCH) {
            let audited: Vec<_> = batch
                .par_iter_mut()
                .map(|(file, error)| {
                    let bytes = match error.take() {
                        None => trace_file::read(file),
                        Some(error) => Err(*error),
                    };
                    let audited = match bytes {
                        Ok(bytes) => (self.audited(file, &bytes, &keys), None),
                        Err(error) => (self.unopened(file, &error), Some(error)),
                    };
                    bar.inc(1);
                    audited
                })
                .collect();
            for (mut audited, error) in audited {
                if let (Some(tables), Some(rows)) = (&mut tables, audited.rows.take()) {
                    tables.push(*rows)?;
                }
                done.push(audited);
                match error {
                    None => opened = opened.saturating_add(1),
                    Some(error) => unusable.push(error),
                }
            }
        }
        bar.finish_and_clear();
        if opened == 0 && (done.is_empty() || !self.json || self.parquet.is_some()) {
            return Err(unusable.into_iter().next().unwrap_or_else(|| {
                CommandError::Arguments(
                    "no trace was given, expected a file or a folder of traces".to_owned(),
                )
            }));
        }
        let rows = tables.map(ParquetFolder::finish).transpose()?;
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
            true => json(&Document {
                traces: done.into_iter().filter_map(|one| one.record).map(|record| *record).collect(),
            })?,
            false => told(&done, self.parquet.as_deref().zip(rows)),
        };
        Ok(Report { output, warnings, status })
    }

    fn audited(&self, file: &Path, bytes: &[u8], keys: &Keys) -> Audited {
        let opened = open(bytes, &keys.identities);
        let found = match &opened {
            Ok(opened) => audit::audit_opened(opened, keys),
            Err(error) => audit::Audit::unreadable(error),
        };
        self.kept(file, opened.ok().as_ref(), &found)
    }

    /// Of a path at which there is nothing to audit.
    fn unopened(&self, file: &Path, error: &CommandError) -> Audited {
        let what = error.to_string();
        let why = what.strip_prefix(&format!("{}: ", file.display())).unwrap_or(&what);
        self.kept(file, None, &audit::Audit::unopened(why))
    }

    fn kept(&self, file: &Path, opened: Option<&Opened>, found: &audit::Audit) -> Audited {
        let name = file.display().to_string();
        let tables = self.parquet.is_some();
        Audited {
            status: found.status,
            decisions: found.decisions.len(),
            redecided: found.redecided(),
            record: self.json.then(|| Box::new(found.record(&name))),
            text: if self.json || tables { String::new() } else { found.tell(&name) },
            rows: tables.then(|| Box::new(TraceRows::of(&name, opened, found))),
        }
    }
}

/// What is kept of a trace.
struct Audited {
    status: audit::Status,
    decisions: usize,
    redecided: usize,
    record: Option<Box<AuditRecord>>,
    text: String,
    /// Until they are written.
    rows: Option<Box<TraceRows>>,
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
        } else if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"))
            && path.is_file()
        {
            found.push(path);
        }
    }
    Ok(())
}

fn told(done: &[Audited], tables: Option<(&Path, RowCounts)>) -> String {
    let mut text = String::new();
    for one in done.iter().filter(|one| !one.text.is_empty()) {
        text.push_str(&one.text);
        text.push('\n');
    }
    text.push_str(&summary(done));
    if let Some((folder, RowCounts { traces, decisions, rounds })) = tables {
        let _ = writeln!(
            text,
            "{}: one row for each of {traces} traces, {decisions} decisions and {rounds} rounds.",
            Tables::<fs::File>::FILES
                .map(|name| one_line(&folder.join(name).display().to_string()))
                .join(", ")
        );
    }
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
