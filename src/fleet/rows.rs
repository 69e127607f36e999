//! What a table's rows hold.

use std::time::Duration;

use selfneg_core::Options;

use super::schema;
use super::table::{Cell, Row};
use crate::audit::{Redecided, Status, Welfare};
use crate::case::{RecordedDecision, RecordedEmergency, RecordedEvent};
use crate::mission::{Evidence, UserId};

/// A row of `traces.parquet`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TraceRow {
    /// The file, as it was named.
    pub file: String,
    /// What the audit found.
    pub status: String,
    /// The trace's own number, in hexadecimal digits, if it is signed.
    pub trace_id: Option<String>,
    /// The public key that signed it, in hexadecimal digits, if it is signed.
    pub robot_key: Option<String>,
    /// Whether that is a key that was to be trusted.
    pub robot_key_trusted: Option<bool>,
    /// How many decisions it has.
    pub decisions: u64,
    /// How many of them were decided again, with whatever result.
    pub redecided: u64,
    /// How many people's data were erased.
    pub erased: u64,
    /// How many findings there are.
    pub findings: u64,
    /// The first of them.
    pub first_finding: Option<String>,
}

/// A row of `decisions.parquet`: what is open of a decision, and what the audit made of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecisionRow {
    file: String,
    trace_status: Status,
    number: u64,
    entry: u64,
    at: Duration,
    what: What,
    redecided: Redecided,
    welfare: Option<Welfare>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum What {
    Negotiated {
        policy: Option<&'static str>,
        options: Option<Options>,
        participants: Vec<UserId>,
        disclosed: Vec<u64>,
        outcome: String,
        agreement: Option<UserId>,
        served: UserId,
        negotiations: usize,
        rounds: u32,
    },
    Emergency {
        category: u32,
        evidence: Option<Evidence>,
    },
}

/// A row of `rounds.parquet`. What was disclosed and what it was worth is somebody's personal
/// data and has no column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RoundRow {
    file: String,
    decision: u64,
    negotiation: usize,
    current: UserId,
    interrupting: UserId,
    willingness: u32,
    entry: u64,
    at: Duration,
    number: u32,
    sender: UserId,
    receiver: UserId,
    event: RecordedEvent,
}

impl DecisionRow {
    /// Its number in the trace, from 1.
    #[must_use]
    pub const fn number(&self) -> u64 {
        self.number
    }

    /// A decision among users.
    #[must_use]
    pub fn negotiated(
        file: &str,
        trace_status: Status,
        decision: &RecordedDecision,
        redecided: Redecided,
        welfare: Option<Welfare>,
    ) -> Self {
        let what = What::Negotiated {
            policy: decision.policy.map(|policy| policy.name()),
            options: decision.options,
            participants: decision.participants.clone(),
            disclosed: decision.participants.iter().map(|user| disclosed_by(*user, decision)).collect(),
            outcome: decision.outcome_name(),
            agreement: decision.agreement,
            served: decision.served,
            negotiations: decision.negotiations.len(),
            rounds: decision.rounds,
        };
        Self {
            file: file.to_owned(),
            trace_status,
            number: decision.decision,
            entry: decision.index,
            at: decision.at,
            what,
            redecided,
            welfare,
        }
    }

    /// An emergency that was found certain.
    #[must_use]
    pub fn emergency(
        file: &str,
        trace_status: Status,
        emergency: &RecordedEmergency,
        redecided: Redecided,
    ) -> Self {
        Self {
            file: file.to_owned(),
            trace_status,
            number: emergency.decision,
            entry: emergency.index,
            at: emergency.at,
            what: What::Emergency { category: emergency.category, evidence: emergency.evidence },
            redecided,
            welfare: None,
        }
    }
}

/// How many of its conditions a user disclosed to anybody: its deepest offer. Offers of one
/// user begin with the same conditions, whomever they are made to.
fn disclosed_by(user: UserId, decision: &RecordedDecision) -> u64 {
    let offers = decision.negotiations.iter().flat_map(|negotiation| &negotiation.rounds);
    offers
        .filter(|round| round.sender == user)
        .map(|round| match round.event {
            RecordedEvent::Offer { depth, .. } => depth,
            _ => 0,
        })
        .max()
        .unwrap_or(0)
}

impl RoundRow {
    /// All rounds that a decision rests on.
    pub fn of<'d>(file: &'d str, decision: &'d RecordedDecision) -> impl Iterator<Item = Self> + 'd {
        (1..).zip(&decision.negotiations).flat_map(move |(negotiation, held)| {
            held.rounds.iter().map(move |round| Self {
                file: file.to_owned(),
                decision: decision.decision,
                negotiation,
                current: held.current,
                interrupting: held.interrupting,
                willingness: held.willingness,
                entry: round.index,
                at: round.at,
                number: round.number,
                sender: round.sender,
                receiver: round.receiver,
                event: round.event,
            })
        })
    }
}

impl Row for TraceRow {
    const SCHEMA: &'static str = schema::TRACES;

    fn into_cells(self) -> Vec<Cell> {
        vec![
            text(self.file),
            text(self.status),
            Cell::Text(self.trace_id),
            Cell::Text(self.robot_key),
            Cell::Truth(self.robot_key_trusted),
            number(self.decisions),
            number(self.redecided),
            number(self.erased),
            number(self.findings),
            Cell::Text(self.first_finding),
        ]
    }
}

impl Row for DecisionRow {
    const SCHEMA: &'static str = schema::DECISIONS;

    fn into_cells(self) -> Vec<Cell> {
        let mut cells = vec![
            text(self.file),
            text(self.trace_status.name()),
            number(self.number),
            number(self.entry),
            nanoseconds(self.at),
        ];
        match self.what {
            What::Negotiated {
                policy,
                options,
                participants,
                disclosed,
                outcome,
                agreement,
                served,
                negotiations,
                rounds,
            } => {
                cells.extend([
                    text("negotiated"),
                    name(policy),
                    name(options.map(|options| options.quit.name())),
                    name(options.map(|options| options.aggregation.name())),
                    name(options.map(|options| options.tie.name())),
                    name(options.map(|options| options.fallback.name())),
                    Cell::Number(options.map(|options| options.willingness.into())),
                    Cell::Numbers(participants.into_iter().map(|user| user.0.into()).collect()),
                    Cell::Numbers(disclosed.into_iter().map(signed).collect()),
                    text(outcome),
                    Cell::Number(agreement.map(|user| user.0.into())),
                    number(served.0),
                    Cell::Number(Some(i64::try_from(negotiations).unwrap_or(i64::MAX))),
                    number(rounds),
                    Cell::Number(None),
                    Cell::Text(None),
                ]);
            }
            What::Emergency { category, evidence } => {
                cells.push(text("emergency"));
                cells.extend([const { Cell::Text(None) }; 5]);
                cells.extend([
                    Cell::Number(None),
                    Cell::Numbers(Vec::new()),
                    Cell::Numbers(Vec::new()),
                    Cell::Text(None),
                    Cell::Number(None),
                    Cell::Number(None),
                    number(0_u32),
                    number(0_u32),
                    number(category),
                    name(evidence.map(evidence_name)),
                ]);
            }
        }
        cells.extend([
            text(redecided_name(self.redecided)),
            Cell::Number(self.welfare.map(|welfare| signed(welfare.served))),
            Cell::Number(self.welfare.map(|welfare| signed(welfare.optimum))),
            Cell::Number(self.welfare.map(|welfare| signed(welfare.regret))),
        ]);
        cells
    }
}

impl Row for RoundRow {
    const SCHEMA: &'static str = schema::ROUNDS;

    fn into_cells(self) -> Vec<Cell> {
        let (event, depth, verdict) = match self.event {
            RecordedEvent::Offer { depth, verdict, .. } => (Some("offer"), Some(signed(depth)), verdict),
            RecordedEvent::Quit => (Some("quit"), None, None),
            RecordedEvent::Unknown => (None, None, None),
        };
        vec![
            text(self.file),
            number(self.decision),
            Cell::Number(Some(i64::try_from(self.negotiation).unwrap_or(i64::MAX))),
            number(self.current.0),
            number(self.interrupting.0),
            number(self.willingness),
            number(self.entry),
            nanoseconds(self.at),
            number(self.number),
            number(self.sender.0),
            number(self.receiver.0),
            name(event),
            Cell::Number(depth),
            name(verdict.map(|verdict| verdict.name())),
        ]
    }
}

fn text(text: impl Into<String>) -> Cell {
    Cell::Text(Some(text.into()))
}

fn name(name: Option<&'static str>) -> Cell {
    Cell::Text(name.map(str::to_owned))
}

fn number(number: impl Into<u64>) -> Cell {
    Cell::Number(Some(signed(number.into())))
}

/// Numbers beyond the column's range do not occur but in a forged trace: the largest stands
/// for them.
fn signed(number: u64) -> i64 {
    i64::try_from(number).unwrap_or(i64::MAX)
}

fn nanoseconds(at: Duration) -> Cell {
    Cell::Number(Some(i64::try_from(at.as_nanos()).unwrap_or(i64::MAX)))
}

const fn redecided_name(redecided: Redecided) -> &'static str {
    match redecided {
        Redecided::Same => "same",
        Redecided::Differs => "differs",
        Redecided::Unchecked => "unchecked",
    }
}

const fn evidence_name(evidence: Evidence) -> &'static str {
    match evidence {
        Evidence::Claimed => "claimed",
        Evidence::Sensed => "sensed",
        Evidence::Verified => "verified",
    }
}
