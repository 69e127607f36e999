//! What an audit found, and where.

use std::fmt;
use std::time::Duration;

use serde::{Serialize, Serializer};

use super::property::{Property, PropertyResult, Verdict};
use super::status::Status;

/// Findings beyond so many are counted and not kept.
const MOST_FINDINGS: usize = 1_000;

/// Longer words of a file are not repeated whole.
const MOST_LETTERS: usize = 500;

/// Words that may come from a file whose writer nobody knows, as they may be printed: what
/// would move a terminal's cursor, or begin a line of its own, is shown as an escape.
pub(super) fn printable(text: &str) -> String {
    let mut printable = String::with_capacity(text.len().min(MOST_LETTERS));
    for (number, letter) in text.chars().enumerate() {
        if number == MOST_LETTERS {
            printable.push_str(" ...");
            break;
        }
        match letter {
            ' '..='~' => printable.push(letter),
            other => printable.extend(other.escape_default()),
        }
    }
    printable
}

/// One thing that is not as it should be. It names users by pseudonym alone, and no
/// condition, rank or total.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Where.
    #[serde(serialize_with = "as_text")]
    pub at: Place,
    /// What.
    pub what: String,
    /// What it makes of the trace.
    pub status: Status,
}

/// A place in a trace, as far as it is known. Written from the coarse to the fine:
/// `12.400 s, decision 2, round 3, entry 118`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Simulated time since the run's begin.
    pub time: Option<Duration>,
    /// A decision's number, from 1.
    pub decision: Option<u64>,
    /// A round's number in its negotiation, from 1.
    pub round: Option<u32>,
    /// The place among events and replies, from 0.
    pub entry: Option<u64>,
    /// The place among all messages, from 0.
    pub message: Option<u64>,
    /// Bytes from the file's begin.
    pub byte: Option<u64>,
}

impl Place {
    /// The trace as a whole.
    pub const WHOLE: Self =
        Self { time: None, decision: None, round: None, entry: None, message: None, byte: None };

    /// An event or reply.
    #[must_use]
    pub const fn entry(index: u64, time: Duration) -> Self {
        Self { time: Some(time), entry: Some(index), ..Self::WHOLE }
    }

    /// A message.
    #[must_use]
    pub const fn message(sequence: u64) -> Self {
        Self { message: Some(sequence), ..Self::WHOLE }
    }

    /// A byte of the file.
    #[must_use]
    pub const fn byte(byte: u64) -> Self {
        Self { byte: Some(byte), ..Self::WHOLE }
    }

    /// The same within this decision, if there is one.
    #[must_use]
    pub const fn of_decision(self, decision: Option<u64>) -> Self {
        Self { decision, ..self }
    }

    /// The same in this round.
    #[must_use]
    pub const fn in_round(self, round: u32) -> Self {
        Self { round: Some(round), ..self }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = self.time.map(|time| format!("{}.{:03} s", time.as_secs(), time.subsec_millis()));
        let number = |what: &str, number: Option<u64>| number.map(|number| format!("{what} {number}"));
        let parts: Vec<String> = [
            time,
            number("decision", self.decision),
            number("round", self.round.map(u64::from)),
            number("entry", self.entry),
            number("message", self.message),
            number("byte", self.byte),
        ]
        .into_iter()
        .flatten()
        .collect();
        if parts.is_empty() { f.write_str("the whole trace") } else { f.write_str(&parts.join(", ")) }
    }
}

fn as_text<S: Serializer>(place: &Place, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(place)
}

/// Collects what the checks have to say.
#[derive(Debug, Default)]
pub(super) struct Log {
    pub(super) findings: Vec<Finding>,
    /// Findings that were not kept.
    pub(super) more: u64,
    /// For each property how often it was checked, and how often it did not hold.
    pub(super) tallies: [(u64, u64); Property::ALL.len()],
    /// For each property whether some of what it is checked on could not be.
    pub(super) in_part: [bool; Property::ALL.len()],
    pub(super) worst: Option<Status>,
}

impl Log {
    /// Something is not as it should be.
    pub(super) fn find(&mut self, status: Status, at: Place, what: impl Into<String>) {
        self.worst = Some(self.worst.map_or(status, |worst| worst.min(status)));
        if self.findings.len() < MOST_FINDINGS {
            self.findings.push(Finding { at, what: printable(&what.into()), status });
        } else {
            self.more = self.more.saturating_add(1);
        }
    }

    /// A property was checked once, and held.
    pub(super) fn held(&mut self, property: Property) {
        self.held_times(property, 1);
    }

    /// A property was checked so many times, and held.
    pub(super) fn held_times(&mut self, property: Property, times: u64) {
        if let Some((checked, _)) = self.tallies.get_mut(property.place()) {
            *checked = checked.saturating_add(times);
        }
    }

    /// There was something to check a property on, and not what is needed for it.
    pub(super) fn not_checked(&mut self, property: Property) {
        if let Some(in_part) = self.in_part.get_mut(property.place()) {
            *in_part = true;
        }
    }

    /// What came of a property.
    pub(super) fn result(&self, property: Property) -> PropertyResult {
        let (checked, broken) = self.tallies.get(property.place()).copied().unwrap_or_default();
        let in_part = self.in_part.get(property.place()).copied().unwrap_or_default();
        let result = match (checked, broken, in_part) {
            (0, _, true) => Verdict::NotChecked,
            (0, _, false) => Verdict::NothingToCheck,
            (_, 0, true) => Verdict::HeldInPart,
            (_, 0, false) => Verdict::Held,
            _ => Verdict::Violated,
        };
        PropertyResult { name: property.name(), result, checked }
    }

    /// A property was checked once, and did not hold.
    pub(super) fn broken(&mut self, property: Property, at: Place, what: impl Into<String>) {
        self.broken_as(property, property.status(), at, what);
    }

    /// The same, where it makes of the trace something else than usual.
    pub(super) fn broken_as(
        &mut self,
        property: Property,
        status: Status,
        at: Place,
        what: impl Into<String>,
    ) {
        self.not_held(property);
        self.find(status, at, what);
    }

    /// The same without a finding of its own.
    pub(super) fn not_held(&mut self, property: Property) {
        if let Some((checked, broken)) = self.tallies.get_mut(property.place()) {
            *checked = checked.saturating_add(1);
            *broken = broken.saturating_add(1);
        }
    }
}

/// So many conditions, in words.
pub(super) fn conditions(number: u64) -> String {
    if number == 1 { "1 condition".to_owned() } else { format!("{number} conditions") }
}
