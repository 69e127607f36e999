//! `selfneg erase`: a person's data out of a sealed trace.

use std::path::PathBuf;

use clap::Args;

use super::key_files::auditor_keys;
use super::private_file::{Readers, replace};
use super::{CommandError, Report, Status, overwriting, trace_file};
use crate::printable::one_line;
use crate::trace::{Recording, erase, open};

/// Erase a person's data from a sealed trace; the seal of the rest stays valid
#[derive(Debug, Args)]
pub(super) struct Erase {
    /// The sealed trace; replaced, unless --out says otherwise
    #[arg(value_name = "TRACE")]
    trace: PathBuf,
    /// Whose: a pseudonym as the trace has it (user-2, or 2 for short; bystander-1), or with
    /// --identity a user's name
    #[arg(value_name = "PERSON")]
    person: String,
    /// An auditor's private key, to know people by their names; may be given several times
    #[arg(long, value_name = "KEY")]
    identity: Vec<PathBuf>,
    /// Write the trace without the person's data here, and leave TRACE as it is
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl Erase {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let out = self.out.as_ref().unwrap_or(&self.trace);
        overwriting::refuse(out, self.identity.iter().map(PathBuf::as_path))?;
        let keys = auditor_keys(&self.identity)?;
        let bytes = trace_file::read(&self.trace)?;
        let unerasable = |source| CommandError::Unerasable { file: self.trace.clone(), source };
        let mut subject = match self.person.parse::<u32>() {
            Ok(number) => format!("user-{number}"),
            Err(_) => self.person.clone(),
        };
        if !keys.is_empty() {
            let opened = open(&bytes, &keys).map_err(|error| unerasable(error.into()))?;
            if let Some(pseudonym) = named(&opened.recording, &self.person) {
                subject = pseudonym;
            }
        }
        let erased = erase(&bytes, &subject).map_err(unerasable)?;
        replace(out, &erased.bytes, Readers::Anybody)?;
        let file = one_line(&out.display().to_string());
        let output = if erased.own == 0 {
            format!("{file}: the data of {subject} were erased before.\n")
        } else {
            format!(
                "{file}: erased {} of {subject}, and {} about several people at once (the story, the robot's \
                 path). The signatures of the rest stay valid.\nCopies, backups and what the disk keeps of \
                 the file as it was are not reached.\n",
                segments(erased.own),
                segments(erased.several)
            )
        };
        Ok(Report { output, warnings: Vec::new(), status: Status::Passed })
    }
}

fn segments(count: u64) -> String {
    if count == 1 { "1 segment".to_owned() } else { format!("{count} segments") }
}

/// The pseudonym of the only user of this name.
fn named(recording: &Recording, name: &str) -> Option<String> {
    let mut users = recording.participants.iter().filter(|one| one.person == name || one.name == name);
    match (users.next(), users.next()) {
        (Some(user), None) => Some(format!("user-{}", user.user)),
        _ => None,
    }
}
