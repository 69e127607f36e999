//! The auditor: whether a trace is whole and unchanged, and whether the robot decided as its
//! rules say.
//!
//! Pure: a trace's bytes and keys in, what was found out. `docs/audit.md` says what every
//! status and every check means, and which of them need the auditor's key.
//!
//! ```no_run
//! use selfneg::audit::{Keys, Status, audit};
//! use selfneg::seal::RobotPublicKey;
//!
//! let robot = RobotPublicKey::from_pem(&std::fs::read_to_string("robot.pub")?)?;
//! let keys = Keys { robots: vec![robot], identities: Vec::new() };
//! let found = audit(&std::fs::read("trace.mcap")?, &keys);
//! for finding in &found.findings {
//!     println!("{}: {}", finding.at, finding.what);
//! }
//! assert_eq!(found.status, Status::Ok);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | job |
//! | --- | --- |
//! | `protocol` | each negotiation, round by round, from the open records |
//! | `policy` | each decision from its negotiations |
//! | `course` | goals and requests, by what happened and was decided |
//! | `wiping`, `hard_ethics` | nobody's data kept, emergencies first |
//! | `redecide` | each decision again from its inputs, and its welfare |
//! | `replay` | the whole mission again |
//! | `seal` | signatures, recipients, commitments |

mod course;
mod document;
mod finding;
mod hard_ethics;
mod policy;
mod property;
mod protocol;
mod redecide;
mod replay;
mod seal;
mod status;
mod turn;
mod wiping;

use std::time::Duration;

pub use document::AuditRecord;
pub(crate) use document::erased;
pub use finding::{Finding, Place};
pub use property::{Property, PropertyResult, Verdict};
pub(crate) use redecide::redecided;
pub use redecide::{Redecided, Welfare};
pub use seal::SealAudit;
pub use status::Status;

use crate::case::{Case, CaseError, Docket, NegotiatedCase, RecordedEmergency, options_in};
use crate::mission::UserId;
use crate::seal::{AuditorKey, RobotPublicKey};
use crate::trace::schema::evidence::{GoalEnd, record::Record, served};
use crate::trace::{Opened, PersonalPart, Recording, TraceError, open};
use finding::{Log, printable};
use policy::InForce;
use protocol::Sides;
use turn::Turn;

/// What an auditor brings along.
#[derive(Clone, Debug, Default)]
pub struct Keys {
    /// The robots whose signatures are trusted.
    pub robots: Vec<RobotPublicKey>,
    /// What opens the personal part.
    pub identities: Vec<AuditorKey>,
}

/// What was found out about a trace.
#[derive(Clone, Debug)]
pub struct Audit {
    /// The worst of all findings.
    pub status: Status,
    /// Every decision that is there.
    pub decisions: Vec<DecisionAudit>,
    /// What is not as it should be, in the order of the checks; at most 1,000.
    pub findings: Vec<Finding>,
    /// How many more findings there were.
    pub more_findings: u64,
    /// Every property, and whether it held.
    pub properties: Vec<PropertyResult>,
    /// What could not be checked, and why.
    pub unchecked: Vec<String>,
    /// What the seal says; `None` of a trace that is not signed.
    pub seal: Option<SealAudit>,
    /// Whose personal data are erased, at least in part.
    pub erased: Vec<String>,
}

/// What was found out about a decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecisionAudit {
    /// Its number in the trace, from 1.
    pub decision: u64,
    /// When, since the run's begin.
    pub at: Duration,
    /// The outcome's name as `selfneg negotiate` has it, or `emergency`.
    pub outcome: String,
    /// Who took part, by arrival; nobody in an emergency.
    pub participants: Vec<UserId>,
    /// Whom the robot serves; nobody in an emergency.
    pub served: Option<UserId>,
    /// The rounds of all negotiations.
    pub rounds: u32,
    /// Whether it is the same when it is made again.
    pub redecided: Redecided,
    /// What it is worth, if the personal data are there.
    pub welfare: Option<Welfare>,
}

impl Audit {
    /// How many decisions were made again.
    #[must_use]
    pub fn redecided(&self) -> usize {
        self.decisions.iter().filter(|decision| decision.redecided != Redecided::Unchecked).count()
    }

    /// Of what cannot be read as a trace.
    #[must_use]
    pub fn unreadable(error: &TraceError) -> Self {
        Self::nothing(place_of(error), &error.to_string())
    }

    /// Of a file that cannot be opened, for this reason.
    #[must_use]
    pub fn unopened(why: &str) -> Self {
        Self::nothing(Place::WHOLE, why)
    }

    fn nothing(at: Place, what: &str) -> Self {
        let finding = Finding { at, what: printable(what), status: Status::Unreadable };
        Self {
            status: Status::Unreadable,
            decisions: Vec::new(),
            findings: vec![finding],
            more_findings: 0,
            properties: Vec::new(),
            unchecked: Vec::new(),
            seal: None,
            erased: Vec::new(),
        }
    }
}

/// Audits a trace's bytes.
#[must_use]
pub fn audit(bytes: &[u8], keys: &Keys) -> Audit {
    match open(bytes, &keys.identities) {
        Ok(opened) => audit_opened(&opened, keys),
        Err(error) => Audit::unreadable(&error),
    }
}

/// Audits a trace that was opened with the keys' identities.
#[must_use]
pub fn audit_opened(opened: &Opened, keys: &Keys) -> Audit {
    let mut log = Log::default();
    let recording = &opened.recording;
    if let Some(damage) = &recording.damage {
        let status =
            if matches!(damage, TraceError::Truncated { .. }) { Status::Truncated } else { Status::Tampered };
        log.find(status, place_of(damage), format!("{damage}; what is before it was audited"));
    }
    let seal = seal::check(opened, keys, &mut log);
    let examination = Examination::new(opened, !keys.identities.is_empty(), &mut log);
    let (decisions, unchecked) = examination.run(&mut log);
    let properties = Property::ALL.map(|property| log.result(property));
    Audit {
        status: log.worst.unwrap_or(Status::Ok),
        decisions,
        findings: log.findings,
        more_findings: log.more,
        properties: properties.to_vec(),
        unchecked: unchecked.iter().map(|what| printable(what)).collect(),
        seal,
        erased: opened.erased.iter().map(|subject| printable(subject)).collect(),
    }
}

fn place_of(error: &TraceError) -> Place {
    match error {
        TraceError::Truncated { at }
        | TraceError::CrcMismatch { at, .. }
        | TraceError::Malformed { at, .. }
        | TraceError::Unsupported { at, .. } => Place::byte(*at),
        TraceError::BadMessage { sequence, .. } => Place::message(u64::from(*sequence)),
        TraceError::Gap { expected, .. } => Place::message(*expected),
        _ => Place::WHOLE,
    }
}

/// The checks of what is recorded, whatever the seal says.
struct Examination<'o> {
    opened: &'o Opened,
    /// Whether any identity was given.
    identified: bool,
    recording: &'o Recording,
    turns: Vec<Turn<'o>>,
    in_force: Option<InForce>,
}

impl<'o> Examination<'o> {
    fn new(opened: &'o Opened, identified: bool, log: &mut Log) -> Self {
        let recording = &opened.recording;
        let header = &recording.header;
        let options = header.options.as_ref().and_then(options_in);
        let policy = if header.policy.is_empty() { Some(None) } else { header.policy.parse().ok().map(Some) };
        let in_force = options.zip(policy).map(|(options, policy)| InForce { options, policy });
        if in_force.is_none() {
            let what = "the header names no variant and policy that this program knows";
            log.find(Status::Unreadable, Place::WHOLE, what);
        }
        Self { opened, identified, recording, turns: turn::turns(recording), in_force }
    }

    fn run(&self, log: &mut Log) -> (Vec<DecisionAudit>, Vec<String>) {
        let mut unchecked = Vec::new();
        let docket = Docket::of(self.recording);
        for &index in &docket.stray {
            let at = Place { entry: Some(index), ..Place::WHOLE };
            log.broken(Property::NoVerdictWithoutOffer, at, "a round or an end of no negotiation");
        }
        let cases = self.recording.cases();
        if let Some(in_force) = &self.in_force {
            for negotiation in &docket.without_decision {
                protocol::check(negotiation, None, None, &in_force.options, log);
            }
        }
        let mut current = CurrentUser::new(self.recording);
        let mut decisions = Vec::with_capacity(cases.len());
        for case in &cases {
            decisions.push(match case {
                Case::Emergency(emergency) => self.emergency(emergency),
                Case::Negotiated(case) => {
                    let served = current.before(case.recorded.index);
                    self.decision(case, served, &mut unchecked, log)
                }
            });
        }
        self.carried_out(&docket, log);
        course::check(&self.recording.header, &self.turns, log);
        wiping::check(&self.turns, log);
        hard_ethics::check(&self.recording.header, &self.turns, log);
        let run_again = self.personal(&cases, &mut unchecked, log);
        // What makes an emergency's decision is the mission alone.
        for (case, decision) in cases.iter().zip(&mut decisions) {
            if matches!(case, Case::Emergency(emergency) if !run_again.reaches(emergency.index)) {
                decision.redecided = Redecided::Unchecked;
            }
        }
        (decisions, unchecked)
    }

    fn emergency(&self, emergency: &RecordedEmergency) -> DecisionAudit {
        let redecided = match (self.recording.rules.is_some(), emergency.certain) {
            (false, _) => Redecided::Unchecked,
            (true, true) => Redecided::Same,
            (true, false) => Redecided::Differs,
        };
        DecisionAudit {
            decision: emergency.decision,
            at: emergency.at,
            outcome: "emergency".to_owned(),
            participants: Vec::new(),
            served: None,
            rounds: 0,
            redecided,
            welfare: None,
        }
    }

    fn decision(
        &self,
        case: &NegotiatedCase,
        current: Option<UserId>,
        unchecked: &mut Vec<String>,
        log: &mut Log,
    ) -> DecisionAudit {
        let recorded = &case.recorded;
        let number = Some(recorded.decision);
        let inputs = case.inputs.as_ref().ok();
        if let Some(in_force) = &self.in_force {
            for negotiation in &recorded.negotiations {
                let offers = |user: UserId, willingness: u32| {
                    let user = inputs?.users.get(recorded.place_of(user)?)?;
                    let own = u64::try_from(user.conditions().len()).ok()?;
                    Some(own.saturating_add(u64::from(willingness > 0)))
                };
                let current = offers(negotiation.current, negotiation.willingness);
                let offers = current
                    .zip(offers(negotiation.interrupting, 0))
                    .map(|(current, interrupting)| Sides { current, interrupting });
                protocol::check(negotiation, offers, number, &in_force.options, log);
            }
            policy::check(recorded, current, in_force, log);
        }
        let (mut redecided, mut welfare) = (Redecided::Unchecked, None);
        match &case.inputs {
            Ok(inputs) => {
                redecided = redecide::check(case, inputs, log);
                welfare = redecide::welfare(recorded, inputs);
            }
            Err(error) => {
                log.not_checked(Property::Redecision);
                self.not_made_again(case, error, unchecked, log);
            }
        }
        DecisionAudit {
            decision: recorded.decision,
            at: recorded.at,
            outcome: recorded.outcome_name(),
            participants: recorded.participants.clone(),
            served: Some(recorded.served),
            rounds: recorded.rounds,
            redecided,
            welfare,
        }
    }

    /// Where the personal part is complete, a decision's inputs have to be there.
    fn not_made_again(
        &self,
        case: &NegotiatedCase,
        error: &CaseError,
        unchecked: &mut Vec<String>,
        log: &mut Log,
    ) {
        let recorded = &case.recorded;
        if self.has_everything() && recorded.index < self.recording.personal_until {
            let at = Place::entry(recorded.index, recorded.at).of_decision(Some(recorded.decision));
            let what = format!("it cannot be made again: {error}");
            match error {
                CaseError::NotNegotiated(_) => log.broken(Property::Redecision, at, what),
                _ => log.find(Status::Incomplete, at, what),
            }
        } else if self.recording.rules.is_some() {
            unchecked.push(format!("decision {} was not made again: {error}", recorded.decision));
        }
    }

    /// Whether nothing personal is missing, as far as the trace goes.
    fn has_everything(&self) -> bool {
        let there = matches!(self.opened.privacy, PersonalPart::Plain | PersonalPart::Open);
        there && self.opened.erased.is_empty() && self.opened.unopened.is_empty()
    }

    /// Whether the robot does what was decided.
    fn carried_out(&self, docket: &Docket, log: &mut Log) {
        let mut decisions = docket.decisions.iter();
        let mut current = CurrentUser::new(self.recording);
        for turn in &self.turns {
            let mut decided = None;
            let mut started = None;
            let mut preempted = false;
            for (entry, record) in turn.records() {
                match record {
                    Record::Decided(_) => {
                        decided = decisions.next().filter(|decision| decision.index == entry.index);
                        started = None;
                    }
                    Record::GoalStarted(goal) => {
                        if let Some(served::Served::User(user)) =
                            goal.served.as_ref().and_then(|served| served.served.as_ref())
                        {
                            started = started.or(Some(UserId(*user)));
                            if preempted && decided.is_none() {
                                let at = Place::entry(entry.index, entry.at);
                                let what =
                                    format!("user {user} takes the robot from another without a decision");
                                log.broken(Property::Policy, at, what);
                            }
                        }
                    }
                    Record::GoalEnded(goal) => {
                        let served = goal.served.as_ref().and_then(|served| served.served.as_ref());
                        preempted = goal.end() == GoalEnd::Preempted
                            && matches!(served, Some(served::Served::User(_)));
                    }
                    _ => {}
                }
            }
            let Some(decision) = decided else { continue };
            let at = Place::entry(decision.index, decision.at).of_decision(Some(decision.decision));
            let keeps = current.before(decision.index) == Some(decision.served);
            match started {
                Some(user) if user != decision.served => {
                    let what = format!(
                        "the decision serves user {}, and the robot begins with user {}",
                        decision.served.0, user.0
                    );
                    log.broken(Property::Policy, at, what);
                }
                None if !keeps && !turn.may_be_cut => {
                    let what = format!(
                        "the decision serves user {}, and the robot does not begin with it",
                        decision.served.0
                    );
                    log.broken(Property::Policy, at, what);
                }
                _ => log.held(Property::Policy),
            }
        }
    }

    /// What needs the personal part.
    fn personal(&self, cases: &[Case], unchecked: &mut Vec<String>, log: &mut Log) -> RunAgain {
        let sealed = matches!(self.opened.privacy, PersonalPart::Open);
        seal::check_commitments(self.recording, sealed, log);
        let rules = match crate::case::rules_to_run(self.recording) {
            Ok(rules) => rules,
            Err(error) => {
                if self.has_everything() && self.recording.personal_until > 0 {
                    log.find(
                        Status::Incomplete,
                        Place::WHOLE,
                        format!("the mission cannot be run again: {error}"),
                    );
                }
                log.not_checked(Property::Replay);
                unchecked.push(self.why_nothing_personal(cases.len(), &error));
                return RunAgain::No;
            }
        };
        let erased = !self.opened.erased.is_empty();
        match replay::check(self.recording, rules, &self.turns, erased, log) {
            replay::Extent::Whole => RunAgain::Whole,
            replay::Extent::Until(at) => {
                let entry = at.entry.unwrap_or_default();
                log.not_checked(Property::Replay);
                if self.has_everything() && entry < self.recording.personal_until {
                    log.find(Status::Incomplete, at, "the personal part of an event is missing");
                } else {
                    unchecked.push(format!(
                        "the mission was run again up to {at} only: the personal part of what follows is not there"
                    ));
                }
                RunAgain::Before(entry)
            }
            replay::Extent::Unknown(at, what) => {
                log.not_checked(Property::Replay);
                log.find(Status::Violation, at, format!("an event that no robot records: {what}"));
                RunAgain::Before(at.entry.unwrap_or_default())
            }
        }
    }

    fn why_nothing_personal(&self, decisions: usize, error: &str) -> String {
        let why = match self.opened.privacy {
            PersonalPart::LeftOut => "the personal data were left out",
            PersonalPart::Locked if self.opened.segments == 0 => "no personal data are in it",
            PersonalPart::Locked if self.identified => "the identity given does not open the personal data",
            PersonalPart::Locked => "no identity was given that opens the personal data",
            PersonalPart::Plain | PersonalPart::Open => error,
        };
        let decisions = if decisions == 1 {
            "the decision was".to_owned()
        } else {
            format!("the {decisions} decisions were")
        };
        format!(
            "{decisions} not made again, nor the mission run again, nor commitments opened, nor welfare compared: {why}"
        )
    }
}

/// How far the mission was run again.
#[derive(Clone, Copy, Debug)]
enum RunAgain {
    No,
    /// To this entry, and not with it.
    Before(u64),
    Whole,
}

impl RunAgain {
    const fn reaches(self, index: u64) -> bool {
        match self {
            Self::No => false,
            Self::Before(end) => index < end,
            Self::Whole => true,
        }
    }
}

/// Whom the robot served before an entry, from the records of goals.
struct CurrentUser<'r> {
    recording: &'r Recording,
    done: usize,
    now: Option<UserId>,
}

impl<'r> CurrentUser<'r> {
    fn new(recording: &'r Recording) -> Self {
        Self { recording, done: 0, now: None }
    }

    fn before(&mut self, index: u64) -> Option<UserId> {
        let upto = usize::try_from(index).unwrap_or(usize::MAX);
        for entry in self.recording.entries.get(self.done..upto).unwrap_or_default() {
            let crate::trace::Step::Reply { open: crate::trace::Open::Record(open), .. } = &entry.step else {
                continue;
            };
            match &open.record {
                Some(Record::GoalStarted(goal)) => {
                    let served = goal.served.as_ref().and_then(|served| served.served.as_ref());
                    self.now = match served {
                        Some(served::Served::User(user)) => Some(UserId(*user)),
                        _ => None,
                    };
                }
                Some(Record::GoalEnded(_)) => self.now = None,
                Some(Record::Closed(closed)) if self.now == Some(UserId(closed.user)) => self.now = None,
                _ => {}
            }
        }
        self.done = self.done.max(upto);
        self.now
    }
}
