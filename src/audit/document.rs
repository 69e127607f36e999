//! An audit as JSON, and for people.

use std::fmt::Write as _;

use serde::Serialize;

use super::{Audit, DecisionAudit, Finding, PropertyResult, Redecided, SealAudit, Status, Verdict, Welfare};
use crate::mission::UserId;
use crate::printable::one_line;
use crate::trace::Whose;

/// What `selfneg audit --json` says of one trace.
#[derive(Clone, Debug, Serialize)]
pub struct AuditRecord {
    file: String,
    status: Status,
    decisions: usize,
    redecided: usize,
    findings: Vec<Finding>,
    more_findings: u64,
    unchecked: Vec<String>,
    properties: Vec<PropertyResult>,
    seal: Option<SealAudit>,
    erased: Vec<String>,
    each_decision: Vec<DecisionRecord>,
}

#[derive(Clone, Debug, Serialize)]
struct DecisionRecord {
    decision: u64,
    at_s: f64,
    outcome: String,
    participants: Vec<String>,
    served: Option<String>,
    rounds: u32,
    redecided: Redecided,
    welfare: Option<Welfare>,
}

impl Audit {
    /// The JSON document of a trace in this file.
    #[must_use]
    pub fn record(&self, file: &str) -> AuditRecord {
        let decision = |decision: &DecisionAudit| DecisionRecord {
            decision: decision.decision,
            at_s: decision.at.as_secs_f64(),
            outcome: decision.outcome.clone(),
            participants: decision.participants.iter().copied().map(pseudonym).collect(),
            served: decision.served.map(pseudonym),
            rounds: decision.rounds,
            redecided: decision.redecided,
            welfare: decision.welfare,
        };
        AuditRecord {
            file: file.to_owned(),
            status: self.status,
            decisions: self.decisions.len(),
            redecided: self.redecided(),
            findings: self.findings.clone(),
            more_findings: self.more_findings,
            unchecked: self.unchecked.clone(),
            properties: self.properties.clone(),
            seal: self.seal.clone(),
            erased: self.erased.clone(),
            each_decision: self.decisions.iter().map(decision).collect(),
        }
    }

    /// A block of text about a trace in this file, for people.
    #[must_use]
    pub fn tell(&self, file: &str) -> String {
        let but = match (self.status, self.unchecked.is_empty()) {
            (Status::Ok, false) => ", as far as it could be checked",
            _ => "",
        };
        let mut text = format!("{}: {}{but}\n", one_line(file), self.status);
        if let Some(seal) = &self.seal {
            tell_seal(seal, &mut text);
        }
        if !self.erased.is_empty() {
            let _ = writeln!(text, "  erased: {}", erased(&self.erased));
        }
        if !self.decisions.is_empty() {
            text.push('\n');
            tell_decisions(&self.decisions, &mut text);
        }
        let mut list = |title: &str, lines: Vec<String>| {
            if !lines.is_empty() {
                let _ = write!(text, "\n  {title}\n");
                for line in lines {
                    let _ = writeln!(text, "    {line}");
                }
            }
        };
        let finding = |finding: &Finding| format!("{}, at {}: {}", finding.status, finding.at, finding.what);
        let mut findings: Vec<String> = self.findings.iter().map(finding).collect();
        if self.more_findings > 0 {
            findings.push(format!("and {} more", self.more_findings));
        }
        list("Findings", findings);
        list("Not checked", self.unchecked.clone());
        let named = |result: Verdict| {
            let mine = self.properties.iter().filter(|property| property.result == result);
            mine.map(|property| property.name).collect::<Vec<_>>().join(", ")
        };
        for (what, result) in [
            ("violated", Verdict::Violated),
            ("held", Verdict::Held),
            ("held as far as it could be checked", Verdict::HeldInPart),
            ("not checked, as said above", Verdict::NotChecked),
            ("nothing to check on", Verdict::NothingToCheck),
        ] {
            let names = named(result);
            if !names.is_empty() {
                let _ = write!(text, "\n  {what}: {names}");
            }
        }
        text.push('\n');
        text
    }
}

/// Whose data are erased, in words.
pub(crate) fn erased(subjects: &[String]) -> String {
    let several = Whose::Several.to_string();
    let subjects: Vec<&str> = subjects
        .iter()
        .map(|subject| if *subject == several { "what shows several people at once" } else { subject })
        .collect();
    subjects.join(", ")
}

fn tell_seal(seal: &SealAudit, text: &mut String) {
    let _ = writeln!(
        text,
        "  signed by {} ({}); {} cover {} and {}, {}",
        seal.key,
        if seal.trusted { "trusted" } else { "not trusted" },
        count(seal.checkpoints, "checkpoint"),
        count(seal.covered_messages, "message"),
        count(seal.covered_decisions, "decision"),
        if seal.complete { "to the end" } else { "not to the end" }
    );
}

fn count(number: u64, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

fn tell_decisions(decisions: &[DecisionAudit], text: &mut String) {
    let mut rows = vec![
        ["decision", "at", "outcome", "serves", "rounds", "made again", "welfare", "best", "regret"]
            .map(str::to_owned),
    ];
    for decision in decisions {
        let again = match decision.redecided {
            Redecided::Same => "the same",
            Redecided::Differs => "differs",
            Redecided::Unchecked => "not checked",
        };
        let welfare = |number: fn(&Welfare) -> u64| match &decision.welfare {
            Some(welfare) => number(welfare).to_string(),
            None => "-".to_owned(),
        };
        rows.push([
            decision.decision.to_string(),
            format!("{:.3} s", decision.at.as_secs_f64()),
            decision.outcome.clone(),
            decision.served.map_or_else(|| "-".to_owned(), pseudonym),
            decision.rounds.to_string(),
            again.to_owned(),
            welfare(|welfare| welfare.served),
            welfare(|welfare| welfare.optimum),
            welfare(|welfare| welfare.regret),
        ]);
    }
    let mut widths = [0_usize; 9];
    for row in &rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.len());
        }
    }
    for row in &rows {
        let cells: Vec<String> =
            row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}")).collect();
        let _ = writeln!(text, "  {}", cells.join("  ").trim_end());
    }
}

fn pseudonym(user: UserId) -> String {
    format!("user-{}", user.0)
}
