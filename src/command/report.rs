//! `selfneg report`: a trace as a page for people.

use std::iter;
use std::path::{Path, PathBuf};

use clap::Args;

use super::key_files::{auditor_keys, robot_public_key};
use super::{CommandError, Report as Said, Status, overwriting, trace_file, write_whole};
use crate::audit::{self, Audit, Keys};
use crate::printable::one_line;
use crate::report::{File, Page};

/// Make a report of a trace for people: one HTML file that needs nothing else
///
/// With what is personal if the trace holds it in the open or a key opens it; else without.
/// Exit code 1 if the trace is cut or damaged, not as signed, or a decision is wrong; the page is
/// written all the same. docs/report.md says what is on it.
#[derive(Debug, Args)]
pub(super) struct Report {
    /// The trace
    #[arg(value_name = "TRACE")]
    trace: PathBuf,
    /// An auditor's private key, which opens what is personal; may be given several times
    #[arg(long, value_name = "AUDITOR_KEY")]
    identity: Vec<PathBuf>,
    /// A robot's public key whose signature is trusted; may be given several times
    #[arg(long, value_name = "PUB")]
    robot_key: Vec<PathBuf>,
    /// The file to write; replaced if it is there
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

impl Report {
    pub(super) fn run(&self) -> Result<Said, CommandError> {
        let read = iter::once(&self.trace).chain(&self.identity).chain(&self.robot_key);
        overwriting::refuse(&self.output, read.map(PathBuf::as_path))?;
        let robots = self.robot_key.iter().map(|file| robot_public_key(file));
        let keys =
            Keys { robots: robots.collect::<Result<_, _>>()?, identities: auditor_keys(&self.identity)? };
        let found = write(&self.trace, &keys, &self.output)?;
        let output = format!("The report is in {}\n", one_line(&self.output.display().to_string()));
        let (warnings, status) = match found.status {
            audit::Status::Unreadable
            | audit::Status::Tampered
            | audit::Status::WrongDecision
            | audit::Status::Violation
            | audit::Status::Truncated => {
                let warning = format!("{}: {}; the report says why", self.trace.display(), found.status);
                (vec![warning], Status::Failed)
            }
            audit::Status::Untrusted
            | audit::Status::Unsealed
            | audit::Status::Incomplete
            | audit::Status::Ok => (Vec::new(), Status::Passed),
        };
        Ok(Said { output, warnings, status })
    }
}

/// Writes the page of a trace; the audit that it shows.
pub(super) fn write(trace: &Path, keys: &Keys, page: &Path) -> Result<Audit, CommandError> {
    let bytes = trace_file::read(trace)?;
    let name = trace.file_name().unwrap_or_default().to_string_lossy();
    let made = Page::of(File { name: &name, bytes: &bytes }, keys);
    let made = made.map_err(|source| CommandError::Trace { file: trace.to_owned(), source })?;
    write_whole(page, &made.to_html())?;
    Ok(made.audit)
}
