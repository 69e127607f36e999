//! `selfneg unseal`: the clear copy of a sealed trace.

use std::iter;
use std::path::PathBuf;

use clap::Args;

use super::key_files::auditor_keys;
use super::private_file::{Readers, replace};
use super::{CommandError, Report, Status, overwriting, trace_file};
use crate::audit::erased;
use crate::printable::one_line;
use crate::seal::SealState;
use crate::trace::unseal;

/// Decrypt a sealed trace into a copy that viewers show whole
///
/// The copy holds everything personal in the open and proves nothing: keep it as long as it is
/// looked at, and the sealed trace, which is the evidence and is not written to. Exit code 1 if the trace is cut, damaged or not as signed; what could be read is in
/// the copy all the same.
#[derive(Debug, Args)]
pub(super) struct Unseal {
    /// The sealed trace
    #[arg(value_name = "TRACE")]
    trace: PathBuf,
    /// An auditor's private key; may be given several times
    #[arg(long, value_name = "KEY", required = true)]
    identity: Vec<PathBuf>,
    /// The copy; only its owner may read it
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
}

impl Unseal {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let read = iter::once(&self.trace).chain(&self.identity);
        overwriting::refuse(&self.out, read.map(PathBuf::as_path))?;
        let keys = auditor_keys(&self.identity)?;
        let bytes = trace_file::read(&self.trace)?;
        let unsealed = unseal(&bytes, &keys)
            .map_err(|source| CommandError::Unsealable { file: self.trace.clone(), source })?;
        replace(&self.out, &unsealed.bytes, Readers::Owner)?;
        let opened = &unsealed.opened;
        let mut wrong: Vec<String> = Vec::new();
        wrong.extend(opened.recording.damage.as_ref().map(ToString::to_string));
        match &opened.seal {
            SealState::Unsigned => {}
            SealState::Broken(fault) => wrong.push(fault.to_string()),
            SealState::Signed(report) => wrong.extend(report.faults.iter().map(ToString::to_string)),
        }
        for unopened in &opened.unopened {
            let (sequence, subject) = (unopened.sequence, &unopened.subject);
            wrong.push(format!("message {sequence}, about {subject}: {}", unopened.what));
        }
        let status = if wrong.is_empty() { Status::Passed } else { Status::Failed };
        let file = self.trace.display();
        let mut warnings: Vec<String> = wrong.into_iter().map(|what| format!("{file}: {what}")).collect();
        if !opened.erased.is_empty() {
            warnings.push(format!("{file}: erased: {}", erased(&opened.erased)));
        }
        let output = format!(
            "{} holds what is in {}, with everything personal in the open. Delete it when done.\n",
            one_line(&self.out.display().to_string()),
            one_line(&file.to_string())
        );
        Ok(Report { output, warnings, status })
    }
}
