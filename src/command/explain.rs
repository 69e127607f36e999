//! `selfneg explain`: why was Bob made to wait?

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde::Serialize;

use super::key_files::auditor_keys;
use super::{CommandError, Report, Status, json, trace_file};
use crate::explain::{Audience, ExplainError, Explained, Level, explain, pseudonym};
use crate::seal::SealState;
use crate::trace::{Opened, PersonalPart, open};

/// Explain the decisions of a trace: why was Bob made to wait?
///
/// For anybody (nothing personal), for one user (only that user's own data), or for the auditor
/// (everything). Exit code 1 if the trace is cut, damaged or not as signed, or a decision is not
/// the one that its rules give; whose signature it is, `audit` asks.
#[derive(Debug, Args)]
pub(super) struct Explain {
    /// The trace
    #[arg(value_name = "TRACE")]
    trace: PathBuf,
    /// The decision's number in the trace, from 1 [default: all]
    #[arg(value_name = "DECISION")]
    decision: Option<u64>,
    /// An auditor's private key, for a sealed trace; may be given several times
    #[arg(long, value_name = "KEY")]
    identity: Vec<PathBuf>,
    /// For whom: anybody (nothing personal), one user (only that user's own data), or the
    /// auditor (everything) [default: user with --user, else auditor if the personal part can
    /// be read, else public]
    #[arg(long, value_name = "LEVEL", value_parser = PossibleValuesParser::new(Level::ALL.iter().map(|level| level.name())).try_map(|name| name.parse::<Level>()))]
    level: Option<Level>,
    /// The user for whom, by pseudonym (2, user-2) or by name
    #[arg(long, value_name = "USER")]
    user: Option<String>,
    /// Print one JSON document instead of the sentences
    #[arg(long)]
    json: bool,
}

/// What `--json` prints.
#[derive(Serialize)]
struct ExplanationRecord<'a> {
    trace: String,
    level: Level,
    decisions: &'a [Explained],
}

impl Explain {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let keys = auditor_keys(&self.identity)?;
        let bytes = trace_file::read(&self.trace)?;
        let opened =
            open(&bytes, &keys).map_err(|source| CommandError::Trace { file: self.trace.clone(), source })?;
        let recording = &opened.recording;
        let audience = self.audience(&opened)?;
        let explained = explain(recording, audience, self.decision).map_err(|error| self.unusable(error))?;
        let warnings = self.doubts(&opened);
        let wrong = explained.iter().any(Explained::is_wrong);
        let status = if wrong || !warnings.is_empty() { Status::Failed } else { Status::Passed };
        let output = if self.json {
            json(&ExplanationRecord {
                trace: self.trace.display().to_string(),
                level: audience.level(),
                decisions: &explained,
            })?
        } else if explained.is_empty() {
            "There is no decision to explain.\n".to_owned()
        } else {
            let texts: Vec<String> = explained.iter().map(|one| one.told().text()).collect();
            texts.join("\n\n")
        };
        Ok(Report { output, warnings, status })
    }

    fn unusable(&self, source: ExplainError) -> CommandError {
        CommandError::Unexplained { file: self.trace.clone(), source }
    }

    fn audience(&self, opened: &Opened) -> Result<Audience, CommandError> {
        let readable = opened.recording.rules.is_some();
        let level = match (self.level, &self.user) {
            (None | Some(Level::User), Some(_)) => Level::User,
            (Some(Level::User), None) => {
                return Err(CommandError::Arguments(
                    "--level user: expected --user with the user's pseudonym or name".to_owned(),
                ));
            }
            (Some(level), Some(_)) => {
                return Err(CommandError::Arguments(format!(
                    "--user: expected the level user, found {level}"
                )));
            }
            (Some(level), None) => level,
            // Whoever gives a key wants what it opens.
            (None, None) if readable || !self.identity.is_empty() => Level::Auditor,
            (None, None) => Level::Public,
        };
        if level != Level::Public && opened.privacy == PersonalPart::Locked {
            let recipients = match &opened.seal {
                SealState::Signed(report) => report.recipients.iter().map(ToString::to_string).collect(),
                SealState::Unsigned | SealState::Broken(_) => Vec::new(),
            };
            return Err(self.unusable(ExplainError::Locked { level, recipients }));
        }
        match (level, &self.user) {
            (Level::User, Some(user)) => {
                let user = pseudonym(&opened.recording, user).map_err(|error| self.unusable(error))?;
                Ok(Audience::User(user))
            }
            (Level::Auditor, _) => Ok(Audience::Auditor),
            (Level::Public | Level::User, _) => Ok(Audience::Public),
        }
    }

    /// Why the trace may not be as the robot wrote it.
    fn doubts(&self, opened: &Opened) -> Vec<String> {
        let mut doubts: Vec<String> = Vec::new();
        doubts.extend(
            opened
                .recording
                .damage
                .as_ref()
                .map(|damage| format!("{damage}; what comes before it is explained")),
        );
        match &opened.seal {
            SealState::Unsigned => {}
            SealState::Broken(fault) => doubts.push(fault.to_string()),
            SealState::Signed(report) => doubts.extend(report.faults.iter().map(ToString::to_string)),
        }
        for unopened in &opened.unopened {
            doubts.push(format!(
                "message {}, about {}: {}",
                unopened.sequence, unopened.subject, unopened.what
            ));
        }
        doubts.iter().map(|doubt| format!("{}: {doubt}", self.trace.display())).collect()
    }
}
