//! `selfneg lint`: what is legal but surely not meant.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::{CommandError, Report, Status, json};
use crate::input::{Rules, User};
use crate::lint::{Finding, lint_rules, lint_user};

/// Look for what is legal in rules and users but surely not meant (exit code 1 if any)
#[derive(Debug, Args)]
pub(super) struct Lint {
    /// Folder of the rules (disposition activation and ethical implications)
    #[arg(long, value_name = "DIR")]
    rules: PathBuf,
    /// User folders
    #[arg(value_name = "USER_DIR")]
    users: Vec<PathBuf>,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Document<'a> {
    users: usize,
    findings: Vec<FindingRecord<'a>>,
}

#[derive(Serialize)]
struct FindingRecord<'a> {
    #[serde(flatten)]
    finding: &'a Finding,
    message: String,
}

impl Lint {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let rules = Rules::read(&self.rules)?;
        let mut findings = lint_rules(&rules);
        for folder in &self.users {
            findings.extend(lint_user(&rules, &User::read(folder)?, true));
        }
        let status = if findings.is_empty() { Status::Passed } else { Status::Failed };
        let output = if self.json {
            json(&Document {
                users: self.users.len(),
                findings: findings
                    .iter()
                    .map(|finding| FindingRecord { finding, message: finding.to_string() })
                    .collect(),
            })?
        } else {
            let mut text = String::new();
            for finding in &findings {
                let _ = writeln!(text, "{finding}");
            }
            let users = match self.users.len() {
                1 => "1 user".to_owned(),
                users => format!("{users} users"),
            };
            let _ = match findings.len() {
                0 => writeln!(text, "The rules and {users}: nothing stands out."),
                1 => writeln!(text, "The rules and {users}: 1 finding."),
                many => writeln!(text, "The rules and {users}: {many} findings."),
            };
            text
        };
        Ok(Report { output, warnings: Vec::new(), status })
    }
}
