//! What is recorded of a decision, by type.

use std::time::Duration;

use selfneg_core::{Options, Ruling};

use crate::mission::{Disclosed, Evidence, UserId};
use crate::precedence::Policy;
use crate::trace::schema::evidence;

/// A decision among users, as recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedDecision {
    /// Its number among all decisions of the trace, from 1; emergencies count too.
    pub decision: u64,
    /// The place of its record among events and replies.
    pub index: u64,
    /// When, since the run's begin.
    pub at: Duration,
    /// The policy; `None` if the record names none that this program knows.
    pub policy: Option<Policy>,
    /// The variant; `None` if the record names none that this program knows.
    pub options: Option<Options>,
    /// Everybody who took part, by arrival; the current user, if there was one, is the first.
    pub participants: Vec<UserId>,
    /// Whom the negotiations gave precedence, if anybody.
    pub agreement: Option<UserId>,
    /// Whom the robot serves.
    pub served: UserId,
    /// The rounds of all negotiations.
    pub rounds: u32,
    /// The negotiations that it rests on, in the order in which they ended.
    pub negotiations: Vec<RecordedNegotiation>,
}

impl RecordedDecision {
    /// The place of the served user among the participants.
    #[must_use]
    pub fn served_place(&self) -> Option<usize> {
        self.place_of(self.served)
    }

    /// The place of whom the negotiations gave precedence among the participants.
    #[must_use]
    pub fn agreement_place(&self) -> Option<usize> {
        self.place_of(self.agreement?)
    }

    /// The place of a user among the participants.
    #[must_use]
    pub fn place_of(&self, user: UserId) -> Option<usize> {
        self.participants.iter().position(|&participant| participant == user)
    }

    /// The outcome's name, as `selfneg negotiate` has it: `current`, `no-agreement`, and
    /// `interrupting` among two or `interrupting_1`, `interrupting_2`, ... among more.
    #[must_use]
    pub fn outcome_name(&self) -> String {
        match (self.agreement, self.agreement_place()) {
            (None, _) => "no-agreement".to_owned(),
            (_, Some(0)) => "current".to_owned(),
            (_, Some(1)) if self.participants.len() == 2 => "interrupting".to_owned(),
            (_, Some(nth)) => format!("interrupting_{nth}"),
            (Some(user), None) => format!("user {}, who took no part", user.0),
        }
    }
}

/// A bilateral negotiation, as recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedNegotiation {
    /// The place of the record of its begin among events and replies.
    pub index: u64,
    /// When it began.
    pub at: Duration,
    /// The current side.
    pub current: UserId,
    /// The interrupting side.
    pub interrupting: UserId,
    /// The current side's willingness.
    pub willingness: u32,
    /// Its rounds, in the order of the trace.
    pub rounds: Vec<RecordedRound>,
    /// How it ended; `None` if it was broken off or the trace ends before.
    pub end: Option<RecordedEnd>,
}

/// The end of a negotiation, as recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedEnd {
    /// The place of its record among events and replies.
    pub index: u64,
    /// The two sides that it names, current and interrupting.
    pub sides: (UserId, UserId),
    /// Who won, if anybody.
    pub winner: Option<UserId>,
    /// How many rounds it says that there were.
    pub rounds: u32,
    /// Why it ended: `accepted`, `held-offer-stands`, `tie`, `both-quit` or `literal-quit`.
    pub ending: String,
}

/// One round, as recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedRound {
    /// The place of its record among events and replies.
    pub index: u64,
    /// When.
    pub at: Duration,
    /// From 1.
    pub number: u32,
    /// Who sends.
    pub sender: UserId,
    /// Who receives.
    pub receiver: UserId,
    /// What happened.
    pub event: RecordedEvent,
}

/// What happened in a round, as recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordedEvent {
    /// The sender disclosed one more condition.
    Offer {
        /// How many it has disclosed now.
        depth: u64,
        /// What became of the offer; `None` if the record does not say.
        verdict: Option<Ruling>,
        /// The new condition; `None` if the sender's part is not there.
        discloses: Option<Disclosed>,
        /// What it is worth; `None` if the receiver's part is not there.
        worth: Option<Worth>,
    },
    /// The sender had no further offer.
    Quit,
    /// The record does not say.
    Unknown,
}

/// What an offer is worth to its receiver, as ranks summed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Worth {
    /// The offer in the receiver's eyes.
    pub value: u64,
    /// The receiver's own complete offer in the receiver's eyes.
    pub threshold: u64,
}

/// An emergency that was found certain, as recorded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedEmergency {
    /// Its number among all decisions of the trace, from 1.
    pub decision: u64,
    /// The place of its record among events and replies.
    pub index: u64,
    /// When, since the run's begin.
    pub at: Duration,
    /// Its category, by its number in the specification.
    pub category: u32,
    /// What it rests on; `None` if the record does not say.
    pub evidence: Option<Evidence>,
    /// Whether this evidence is what the category asks for. False for a category that the
    /// specification does not have.
    pub certain: bool,
    /// How grave the category is; 0 if the specification does not have it.
    pub gravity: u32,
}

/// The variant that a message names, if this program knows all of it.
#[must_use]
pub fn options_in(options: &evidence::Options) -> Option<Options> {
    Some(Options {
        quit: options.quit.parse().ok()?,
        aggregation: options.aggregation.parse().ok()?,
        tie: options.tie.parse().ok()?,
        fallback: options.fallback.parse().ok()?,
        willingness: options.willingness.try_into().ok()?,
    })
}

pub(super) fn ruling(verdict: evidence::Verdict) -> Option<Ruling> {
    match verdict {
        evidence::Verdict::Accept => Some(Ruling::Accept),
        evidence::Verdict::Reject => Some(Ruling::Reject),
        evidence::Verdict::Hold => Some(Ruling::Hold),
        evidence::Verdict::Unspecified => None,
    }
}

pub(super) fn evidence_of(evidence: evidence::Evidence) -> Option<Evidence> {
    match evidence {
        evidence::Evidence::Claimed => Some(Evidence::Claimed),
        evidence::Evidence::Sensed => Some(Evidence::Sensed),
        evidence::Evidence::Verified => Some(Evidence::Verified),
        evidence::Evidence::Unspecified => None,
    }
}

/// Whether evidence is what a category asks for.
pub(super) fn is_certain(category: &evidence::Emergency, evidence: Option<Evidence>) -> bool {
    match category.proof() {
        evidence::Proof::Sensed => evidence == Some(Evidence::Sensed),
        evidence::Proof::Verified => evidence == Some(Evidence::Verified),
        evidence::Proof::Unspecified => false,
    }
}
