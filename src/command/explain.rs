//! `selfneg explain`: why was Bob made to wait?

use std::fs;
use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde::Serialize;

use super::{CommandError, Report, Status, json};
use crate::explain::{Audience, Explained, Level, explain, pseudonym};
use crate::input::InputError;
use crate::trace::Recording;

/// Explain the decisions of a trace: why was Bob made to wait? For anybody, for one user, or
/// for the auditor (exit code 1 if the trace is damaged, or a decision is not the one that its
/// rules give)
#[derive(Debug, Args)]
pub(super) struct Explain {
    /// The trace
    #[arg(value_name = "TRACE")]
    trace: PathBuf,
    /// The decision's number in the trace, from 1 [default: all]
    #[arg(value_name = "DECISION")]
    decision: Option<u64>,
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
        let unusable = |source| CommandError::Unexplained { file: self.trace.clone(), source };
        let bytes = fs::read(&self.trace)
            .map_err(|source| InputError::Unreadable { file: self.trace.clone(), source })?;
        let recording = Recording::read(&bytes)
            .map_err(|source| CommandError::Trace { file: self.trace.clone(), source })?;
        let audience = self.audience(&recording)?;
        let explained = explain(&recording, audience, self.decision).map_err(unusable)?;
        let mut warnings = Vec::new();
        if let Some(damage) = &recording.damage {
            warnings.push(format!("{}: {damage}; what comes before it is explained", self.trace.display()));
        }
        let wrong = explained.iter().any(Explained::is_wrong);
        let status = if wrong || !warnings.is_empty() { Status::Failed } else { Status::Passed };
        let output = if self.json {
            json(&ExplanationRecord {
                trace: self.trace.display().to_string(),
                level: audience.level(),
                decisions: &explained,
            })?
        } else if explained.is_empty() {
            "No decision.\n".to_owned()
        } else {
            let texts: Vec<String> = explained.iter().map(|one| one.told().text()).collect();
            texts.join("\n\n")
        };
        Ok(Report { output, warnings, status })
    }

    fn audience(&self, recording: &Recording) -> Result<Audience, CommandError> {
        let readable = recording.rules.is_some();
        match (self.level, &self.user) {
            (Some(Level::User) | None, Some(user)) => {
                let source = |source| CommandError::Unexplained { file: self.trace.clone(), source };
                Ok(Audience::User(pseudonym(recording, user).map_err(source)?))
            }
            (Some(Level::User), None) => Err(CommandError::Arguments(
                "--level user: expected --user with the user's pseudonym or name".to_owned(),
            )),
            (Some(level), Some(_)) => {
                Err(CommandError::Arguments(format!("--user: expected the level user, found {level}")))
            }
            (Some(Level::Public), None) => Ok(Audience::Public),
            (Some(Level::Auditor), None) => Ok(Audience::Auditor),
            (None, None) => Ok(if readable { Audience::Auditor } else { Audience::Public }),
        }
    }
}
