//! `selfneg report`: a trace as a page for people.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::{CommandError, Report as Said, Status, write_whole};
use crate::report::{Page, Source};
use crate::trace::{Message, Reader, Recording};

/// Make a page of a trace that anybody can read: one HTML file, without network
#[derive(Debug, Args)]
pub(super) struct Report {
    /// The trace (MCAP; docs/trace.md)
    #[arg(value_name = "TRACE")]
    trace: PathBuf,
    /// The file to write; replaced if it is there
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

impl Report {
    pub(super) fn run(&self) -> Result<Said, CommandError> {
        write(&self.trace, &self.output)?;
        let output = format!("The report is in {}\n", self.output.display());
        Ok(Said { output, warnings: Vec::new(), status: Status::Passed })
    }
}

/// Writes the page of a trace.
pub(super) fn write(trace: &Path, page: &Path) -> Result<(), CommandError> {
    let unreadable = |source| CommandError::Unreadable { file: trace.to_owned(), source };
    let bytes = fs::read(trace).map_err(unreadable)?;
    let not_a_trace = |source| CommandError::Trace { file: trace.to_owned(), source };
    let recording = Recording::read(&bytes).map_err(not_a_trace)?;
    let messages: Vec<Message> = Reader::new(&bytes).map_while(Result::ok).collect();
    let file = trace.file_name().unwrap_or_default().to_string_lossy();
    let source = Source { file: &file, bytes: &bytes, recording: &recording, messages: &messages };
    write_whole(page, &Page::of(source).to_html())
}
