//! Who signed the trace, and where what is personal is, in words.

use super::page::Fact;
use crate::audit::{SealAudit, erased};
use crate::seal::SealState;
use crate::trace::{Opened, PersonalPart};

/// What the page says of the seal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seal {
    /// Whether the trace is what the robot wrote, in a sentence.
    pub signature: String,
    /// Where what is personal is, in a sentence.
    pub privacy: String,
    /// The particulars of the signature.
    pub facts: Vec<Fact>,
}

impl Seal {
    pub(super) fn of(opened: &Opened, audit: Option<&SealAudit>) -> Self {
        let signature = match &opened.seal {
            SealState::Unsigned => {
                "Nobody has signed this trace, so it may have been changed by anybody.".to_owned()
            }
            SealState::Broken(fault) => format!("The seal is broken: {fault}."),
            SealState::Signed(report) => match report.faults.as_slice() {
                [] => {
                    let whose = match audit {
                        Some(audit) if audit.trusted => "by a robot key that was given as trusted",
                        _ => "by a key that nobody vouches for here",
                    };
                    let all = if report.complete { "and whole" } else { "but without its signed end" };
                    format!("What is covered is unchanged since it was signed {whose}, {all}.")
                }
                [fault] => format!("This trace is not as it was signed: {fault}."),
                [fault, more @ ..] => {
                    format!("This trace is not as it was signed: {fault}; and {} more.", more.len())
                }
            },
        };
        let mut privacy = match opened.privacy {
            PersonalPart::Plain => "What is personal is in the open, for everybody who has the file.",
            PersonalPart::LeftOut => "What is personal was left out when the trace was written.",
            PersonalPart::Locked if opened.segments == 0 => {
                "What is personal is said to be sealed, and nothing personal is in it."
            }
            PersonalPart::Locked => "What is personal is sealed, and no key given here opens it.",
            PersonalPart::Open => {
                "What is personal is sealed, and was opened with an auditor’s key for this page."
            }
        }
        .to_owned();
        if !opened.erased.is_empty() {
            privacy.push_str(&format!(" Erased: {}.", erased(&opened.erased)));
        }
        Self { signature, privacy, facts: facts(audit) }
    }
}

fn facts(audit: Option<&SealAudit>) -> Vec<Fact> {
    let Some(audit) = audit else { return Vec::new() };
    let trusted = if audit.trusted { "trusted" } else { "not known here" };
    let mut facts = vec![
        Fact { name: "Robot key", value: format!("{} ({trusted})", audit.key) },
        Fact { name: "Checkpoints", value: audit.checkpoints.to_string() },
        Fact {
            name: "Covered",
            value: format!(
                "{} and {}",
                counted(audit.covered_messages, "message"),
                counted(audit.covered_decisions, "decision")
            ),
        },
    ];
    if !audit.recipients.is_empty() {
        facts.push(Fact { name: "Sealed to", value: audit.recipients.join(", ") });
    }
    facts
}

/// Why something personal is not shown, and what would show it.
pub(super) fn why_hidden(opened: &Opened) -> String {
    match opened.privacy {
        PersonalPart::Locked if opened.segments == 0 && opened.erased.is_empty() => {
            "The trace says that it is sealed, and does not hold it.".to_owned()
        }
        PersonalPart::Locked if opened.segments > 0 => {
            let to = match &opened.seal {
                SealState::Signed(report) if !report.recipients.is_empty() => {
                    let recipients: Vec<String> = report.recipients.iter().map(ToString::to_string).collect();
                    format!(" It is sealed to {}.", recipients.join(", "))
                }
                _ => String::new(),
            };
            format!("It is sealed; give the auditor’s private key with --identity.{to}")
        }
        PersonalPart::LeftOut => {
            "It was left out when the trace was written; nothing brings it back. Record with --seal to keep it."
                .to_owned()
        }
        PersonalPart::Plain | PersonalPart::Open | PersonalPart::Locked if !opened.erased.is_empty() => {
            format!("It was erased ({}); nothing brings it back.", erased(&opened.erased))
        }
        PersonalPart::Plain | PersonalPart::Open | PersonalPart::Locked => {
            "The trace does not hold it, or ends before.".to_owned()
        }
    }
}

/// `1 decision`, `2 decisions`.
fn counted(number: u64, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}
