//! What a mission tells of itself: enough to say afterwards what it did and why.
//!
//! Records hold pseudonyms and numbers, never names: a condition is its place in the rules,
//! or, if only the user names it, its place in the user's own list. Rounds still tell
//! personal facts (which condition, which totals); sealing them is the trace's job.

use selfneg_core::Options;
use serde::Serialize;

use super::command::{Closing, Refusal, Staff, Waiting};
use super::event::{CategoryId, Evidence, GoalId, Place, UserId};
use super::lifecycle::{IllegalTransition, Lifecycle};
use crate::precedence::Policy;

/// A part of the architecture that has a lifecycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Component {
    /// One for the whole mission.
    MissionController,
    /// One for the whole mission.
    InterruptionManager,
    /// One for the whole mission.
    NegotiationManager,
    /// One for each user.
    ContextEthicsManager,
    /// One for each user.
    OfferGenerator,
    /// One for each user.
    EthicalImpactAnalyzer,
}

/// Whom or what the robot serves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Served {
    /// A user.
    User(UserId),
    /// An emergency.
    Emergency(CategoryId),
    /// Nobody any more: the robot is on its way to a safe point.
    Nobody,
}

/// How the robot's work on a goal ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum GoalEnd {
    /// Its last action was done.
    Reached,
    /// An action failed.
    Failed,
    /// Another goal took its place.
    Preempted,
    /// Nobody wants it any more.
    Abandoned,
}

/// Which profile a manager has activated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ActiveProfile {
    /// None.
    None,
    /// The user's own, by its place among them.
    Own(u16),
    /// A normative default, by its place in the specification.
    Normative(u16),
}

/// Why data cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unusable {
    /// The context has no `location`.
    NoLocation,
    /// Neither the user nor, for users who gave none, the specification has a profile for
    /// the location.
    UnknownContext,
    /// More of something than the limits allow.
    TooMuch,
    /// A name longer than [`NAME_BYTES`](super::NAME_BYTES).
    NameTooLong,
}

/// What an offer discloses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Disclosed {
    /// A condition that the rules list, by its place there.
    Listed(u16),
    /// A condition that only the user names, by its place among those of the user.
    Unlisted(u16),
    /// Willingness to be interrupted.
    Willingness,
}

/// What happened in a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Round {
    /// The sender disclosed one more condition.
    Offer {
        /// How many it has disclosed now.
        depth: usize,
        /// The new one.
        discloses: Disclosed,
        /// The offer in the receiver's eyes.
        value: u64,
        /// The receiver's own complete offer in the receiver's eyes.
        threshold: u64,
        /// `accept`, `reject` or `hold`.
        verdict: &'static str,
    },
    /// The sender had no further offer.
    Quit,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case", tag = "record")]
pub enum Record {
    /// A component changed its lifecycle state.
    Lifecycle {
        /// Which.
        component: Component,
        /// Whose, of a component that each user has one of.
        user: Option<UserId>,
        /// From which state.
        from: Lifecycle,
        /// To which.
        to: Lifecycle,
    },
    /// A transition was asked for that the lifecycle does not have, and was not made. The
    /// model checker finds none.
    IllegalTransition {
        /// Which component.
        component: Component,
        /// What was refused.
        refused: IllegalTransition,
    },
    /// A request was refused at once, and nothing of it is kept.
    Refused {
        /// Whose.
        user: UserId,
        /// For what.
        goal: GoalId,
        /// Why.
        why: Refusal,
    },
    /// A request is kept.
    Admitted {
        /// Whose.
        user: UserId,
        /// For what.
        goal: GoalId,
    },
    /// A request ended.
    Closed {
        /// Whose.
        user: UserId,
        /// How.
        how: Closing,
    },
    /// Human staff is called.
    StaffCalled {
        /// For whom, if anybody.
        user: Option<UserId>,
        /// For what.
        goal: GoalId,
        /// Why.
        why: Staff,
    },
    /// A request waits for its next turn; of the user nothing else is kept.
    Deferred {
        /// Whose.
        user: UserId,
        /// Why.
        why: Waiting,
        /// How often by now.
        times: u8,
    },
    /// Data were accepted.
    DataAccepted {
        /// Whose.
        user: UserId,
    },
    /// Data did not arrive in time; the current mission, if there is one, continues.
    DataMissing {
        /// Whose.
        user: UserId,
    },
    /// Data cannot be used; the current mission, if there is one, continues.
    DataUnusable {
        /// Whose.
        user: UserId,
        /// Why.
        why: Unusable,
    },
    /// An event came for which there is no use (any more), and had no effect.
    Ignored {
        /// What kind.
        what: &'static str,
        /// Whose, if anybody's.
        user: Option<UserId>,
    },
    /// A manager activated a profile.
    ProfileActivated {
        /// Whose manager.
        user: UserId,
        /// Which profile.
        profile: ActiveProfile,
    },
    /// A changed context has no profile; the active one stays.
    ProfileKept {
        /// Whose manager.
        user: UserId,
    },
    /// A declared rule inferred a condition, or no longer does.
    Inferred {
        /// Of whom.
        user: UserId,
        /// The rule, by its place in the specification.
        rule: usize,
        /// Whether it holds now.
        holds: bool,
    },
    /// A user's memory in one component was overwritten, and read again.
    Wiped {
        /// Whose.
        user: UserId,
        /// Where.
        component: Component,
        /// How many bytes are not zero after it: 0.
        left: usize,
    },
    /// Work on a goal begins.
    GoalStarted {
        /// For whom or what.
        served: Served,
        /// Which goal.
        goal: GoalId,
    },
    /// A task begins.
    TaskStarted {
        /// Of which goal.
        goal: GoalId,
        /// Which, from 0.
        task: usize,
        /// Whether it may be interrupted.
        interruptible: bool,
    },
    /// The robot waits before a task that may not be interrupted, because an open
    /// negotiation could take it elsewhere.
    Held {
        /// Before which task.
        task: usize,
    },
    /// Work on a goal ended.
    GoalEnded {
        /// For whom or what.
        served: Served,
        /// Which goal.
        goal: GoalId,
        /// How.
        end: GoalEnd,
    },
    /// Both users' data are ready, and a bilateral negotiation begins on a snapshot.
    NegotiationStarted {
        /// The current side.
        current: UserId,
        /// The interrupting side.
        interrupting: UserId,
        /// The current user's willingness, from its real progress.
        willingness: u8,
    },
    /// One round.
    Round {
        /// From 1.
        number: u32,
        /// Who sends.
        sender: UserId,
        /// Who receives.
        receiver: UserId,
        /// What happened.
        round: Round,
    },
    /// A bilateral negotiation ended.
    NegotiationEnded {
        /// The current side.
        current: UserId,
        /// The interrupting side.
        interrupting: UserId,
        /// Who won, if anybody.
        winner: Option<UserId>,
        /// How many rounds it took.
        rounds: u32,
        /// Why it ended, as [`Ending`](selfneg_core::Ending) names it.
        ending: &'static str,
    },
    /// Negotiations are broken off without an outcome.
    NegotiationsDropped {
        /// Why.
        why: Dropped,
    },
    /// Whom the negotiations give precedence.
    Decided {
        /// The policy.
        #[serde(serialize_with = "as_text")]
        policy: Policy,
        /// The protocol variant.
        #[serde(serialize_with = "as_text")]
        options: Options,
        /// Everybody who took part, by arrival, the current user first.
        participants: Vec<UserId>,
        /// Whom the negotiations gave precedence, if anybody.
        agreement: Option<UserId>,
        /// Whom the robot serves.
        served: UserId,
        /// The rounds of all negotiations.
        rounds: u32,
    },
    /// An emergency is certain; it goes first, at the next safe point.
    EmergencyDecided {
        /// Its category.
        category: CategoryId,
        /// Where.
        place: Place,
        /// What it rests on.
        evidence: Evidence,
    },
    /// An emergency was claimed without the evidence that its category needs. No effect.
    EmergencyUnverified {
        /// Its category.
        category: CategoryId,
        /// Where.
        place: Place,
        /// What it rests on.
        evidence: Evidence,
    },
    /// The mission is ending.
    ShuttingDown,
    /// The mission has ended.
    ShutDown,
}

/// Why negotiations are broken off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Dropped {
    /// A verified emergency.
    Emergency,
    /// Nobody is left to negotiate with.
    NobodyLeft,
    /// The mission is ending.
    Shutdown,
}

fn as_text<T: std::fmt::Display, S: serde::Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}
