//! What every decision and every run must have.

use serde::Serialize;

use super::status::Status;

/// A property that is checked on every trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Property {
    /// A negotiation has at most a + c + 2 rounds, where a and c are the numbers of offers of
    /// its two users; without personal data, of offers made.
    Termination,
    /// Each offer discloses one condition more than the sender's last one.
    OneDisclosure,
    /// Every round is an offer with a verdict, or a quit; who wins made an offer that was
    /// accepted.
    NoVerdictWithoutOffer,
    /// Rounds are numbered from 1 without a gap; who sends, when it ends, who wins and why
    /// follow from the verdicts by quit and tie rule.
    Protocol,
    /// Variant and policy are those of the header.
    RulesInForce,
    /// The decision follows from the bilateral outcomes by policy and fallback, and the robot
    /// does what was decided.
    Policy,
    /// Whoever is put off or done with has no data left when the event is over, and nobody has
    /// a snapshot left after a decision.
    WipedInTime,
    /// Certain emergencies are decided at once and acted on at the next safe point, the graver
    /// first; claims without evidence have no effect.
    HardEthics,
    /// Each decision made again, from the inputs alone, is the recorded one in every round.
    Redecision,
    /// The whole mission, run again, replies to every event as recorded.
    Replay,
    /// Every commitment fits its opening and what it commits to.
    Commitments,
}

impl Property {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Termination,
        Self::OneDisclosure,
        Self::NoVerdictWithoutOffer,
        Self::Protocol,
        Self::RulesInForce,
        Self::Policy,
        Self::WipedInTime,
        Self::HardEthics,
        Self::Redecision,
        Self::Replay,
        Self::Commitments,
    ];

    /// The name in reports and JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Termination => "termination",
            Self::OneDisclosure => "one-disclosure-a-round",
            Self::NoVerdictWithoutOffer => "no-verdict-without-offer",
            Self::Protocol => "protocol",
            Self::RulesInForce => "rules-in-force",
            Self::Policy => "policy",
            Self::WipedInTime => "wiped-in-time",
            Self::HardEthics => "hard-ethics",
            Self::Redecision => "redecision",
            Self::Replay => "replay",
            Self::Commitments => "commitments",
        }
    }

    /// What a trace is of which it does not hold.
    #[must_use]
    pub const fn status(self) -> Status {
        match self {
            Self::Protocol | Self::RulesInForce | Self::Policy | Self::Redecision => Status::WrongDecision,
            Self::Commitments => Status::Tampered,
            Self::Termination
            | Self::OneDisclosure
            | Self::NoVerdictWithoutOffer
            | Self::WipedInTime
            | Self::HardEthics
            | Self::Replay => Status::Violation,
        }
    }

    pub(super) fn place(self) -> usize {
        Self::ALL.iter().position(|&one| one == self).unwrap_or_default()
    }
}

/// What came of checking a property on one trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PropertyResult {
    /// Its name.
    pub name: &'static str,
    /// Whether it held.
    pub result: Verdict,
    /// How often it was checked.
    pub checked: u64,
}

/// Whether a property held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Everywhere.
    Held,
    /// Wherever it could be checked. For more of the trace what is needed is not there.
    HeldInPart,
    /// Not everywhere.
    Violated,
    /// There was nothing to check it on.
    NothingToCheck,
    /// What is needed to check it is not there, or not open.
    NotChecked,
}
