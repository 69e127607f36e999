//! What a mission wants done: the only way out, with its [`Record`](super::Record)s.

use serde::Serialize;

use super::event::{AskId, ExecutionId, GoalId, Place, UserId};
use super::record::Record;

/// What a mission says in reply to an event, in order.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// To be done.
    Command(Command),
    /// To be kept: what happened and why.
    Record(Record),
}

/// What the environment is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case", tag = "command")]
pub enum Command {
    /// Ask a user for data, and whether they still want their goal. The answer is `Data`
    /// or `Withdraw`; after `within_ms` milliseconds it is `DataTimeout`.
    AskData {
        /// Whom.
        user: UserId,
        /// To be cited in the answer.
        ask: AskId,
        /// The time to answer, in milliseconds.
        within_ms: u32,
    },
    /// Execute an action. The answer is `ActionDone` or `ActionFailed`.
    Execute {
        /// To be cited in the answer.
        execution: ExecutionId,
        /// For which goal.
        goal: GoalId,
        /// The task, counted from 0 within the goal.
        task: usize,
        /// The action, counted from 0 within the task.
        action: usize,
        /// Where the goal's user is to be met.
        place: Place,
    },
    /// Stop executing.
    Stop {
        /// What.
        execution: ExecutionId,
    },
    /// Send `NextRound` when ready for it.
    NextRound,
    /// Tell a user to wait; the request is kept.
    Wait {
        /// Whom.
        user: UserId,
        /// Why.
        why: Waiting,
    },
    /// Tell a user that this request is refused; an earlier one stays as it is.
    Refuse {
        /// Whom.
        user: UserId,
        /// What was asked for.
        goal: GoalId,
        /// Why.
        why: Refusal,
    },
    /// Tell a user that the request is closed.
    Close {
        /// Whom.
        user: UserId,
        /// How it ended.
        how: Closing,
    },
    /// Call human staff.
    CallStaff {
        /// For whom; nobody in particular in an emergency.
        user: Option<UserId>,
        /// What was asked for.
        goal: GoalId,
        /// Where.
        place: Place,
        /// Why.
        why: Staff,
    },
}

/// Why a user has to wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Waiting {
    /// The current task must not be interrupted.
    NotInterruptible,
    /// The request has its turn as soon as there is room or a safe point.
    Queued,
    /// The negotiation gave another user precedence.
    NoPrecedence,
    /// Data were asked for and did not arrive in time.
    DataMissing,
    /// Data arrived and cannot be used.
    DataUnusable,
    /// An emergency came first.
    Emergency,
}

/// How a request ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Closing {
    /// The goal was reached.
    Reached,
    /// The goal failed.
    Failed,
    /// The user withdrew.
    Withdrawn,
    /// Handed to human staff.
    Staff(Staff),
}

/// Why something goes to human staff.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Staff {
    /// It was deferred as often as the specification allows.
    DeferredTooOften,
    /// There is no memory left to keep it.
    NoRoom,
    /// The mission is ending.
    Shutdown,
    /// The emergency's goal is beyond the robot's capabilities, or failed.
    EmergencyBeyondRobot,
}

/// Why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Refusal {
    /// The specification has no such goal.
    UnknownGoal,
    /// The robot lacks a capability that the goal needs.
    Incapable,
    /// The user has an open request already.
    AlreadyAsking,
}
