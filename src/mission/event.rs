//! What happens to a mission: the only way in.
//!
//! There is no time in it. The mission has no clock; deadlines come back as `DataTimeout`,
//! and whoever keeps the records stamps them with the time of the event.

use serde::{Deserialize, Serialize};

use super::user_data::{Text, UserData};
use crate::input::Truth;

/// A user by the environment's pseudonym. Names never reach the mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct UserId(pub u32);

/// A goal by its place in the [`Specification`](super::Specification).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct GoalId(pub u16);

/// An emergency category by its place in the [`Specification`](super::Specification).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct CategoryId(pub u16);

/// A meeting place by the environment's numbering; the mission only hands it back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Place(pub u32);

/// One asking of one user for data. An answer to an older asking counts for nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct AskId(pub u32);

/// One execution of one action. News of an older execution counts for nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ExecutionId(pub u32);

/// What an emergency claim rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Evidence {
    /// Somebody says so.
    Claimed,
    /// The robot's own sensors say so.
    Sensed,
    /// A document was checked (a scanned boarding pass).
    Verified,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "event")]
pub enum Event {
    /// A user asks for a goal: at first, or as an interruption.
    Request {
        /// Who.
        user: UserId,
        /// What.
        goal: GoalId,
        /// Where to meet.
        place: Place,
    },
    /// A user's data, as asked for.
    Data {
        /// Whose.
        user: UserId,
        /// Which asking this answers.
        ask: AskId,
        /// The data; wiped when the event has been handled.
        data: UserData,
    },
    /// The data asked for did not arrive in time, or cannot be read.
    DataTimeout {
        /// Whose.
        user: UserId,
        /// Which asking.
        ask: AskId,
    },
    /// An attribute of a user's context has a new value, by the user or by a sensor.
    Context {
        /// Whose context.
        user: UserId,
        /// The attribute.
        attribute: Text,
        /// Its value.
        value: Text,
    },
    /// A user says something new about a condition.
    Status {
        /// Whose.
        user: UserId,
        /// The condition.
        condition: Text,
        /// What is said of it.
        #[serde(with = "super::user_data::truth")]
        truth: Truth,
    },
    /// The action was done.
    ActionDone {
        /// Which execution.
        execution: ExecutionId,
    },
    /// The action cannot be done: the goal has failed.
    ActionFailed {
        /// Which execution.
        execution: ExecutionId,
    },
    /// The next round of the negotiation, as asked for.
    NextRound,
    /// Somebody or something says that there is an emergency.
    Emergency {
        /// Of which category.
        category: CategoryId,
        /// Where.
        place: Place,
        /// What the claim rests on.
        evidence: Evidence,
    },
    /// A user no longer wants anything.
    Withdraw {
        /// Who.
        user: UserId,
    },
    /// The mission is to end.
    Shutdown,
}
