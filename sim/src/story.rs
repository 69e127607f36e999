//! What the robot is told, what happens, and what can be seen of it.

use crate::drive::Twist;
use crate::error::RouteError;
use crate::geometry::Pose;
use crate::joints::{JointTargets, Joints};
use crate::route::Estimate;

/// What the robot is told, at most one thing a step.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "kebab-case"))]
pub enum Command {
    /// Nothing new.
    #[default]
    Continue,
    /// Go to a place, instead of anywhere else.
    GoTo {
        /// The place's name.
        place: String,
    },
    /// Stop, but keep the goal. A ride in an elevator ends first.
    Stop,
    /// Go on after [`Command::Stop`]; without a goal that was stopped, nothing.
    Resume,
    /// Stop and forget the goal.
    Cancel,
    /// Hold torso and head; `targets: None` lets them show by themselves what the robot is about.
    Hold {
        /// Where to.
        targets: Option<JointTargets>,
    },
}

impl Command {
    /// [`Command::GoTo`] a place.
    #[must_use]
    pub fn go_to(place: &str) -> Self {
        Self::GoTo { place: place.to_owned() }
    }
}

/// What has happened in a step.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "kebab-case"))]
pub enum Event {
    /// The robot sets out.
    SetOut {
        /// For this place.
        place: String,
        /// What it will take if nobody is in the way.
        estimate: Estimate,
    },
    /// There is no way; the robot has no goal now.
    Unreachable {
        /// The place asked for.
        place: String,
        /// Why.
        reason: RouteError,
    },
    /// An earlier goal is given up, by [`Command::GoTo`] or [`Command::Cancel`].
    Dropped {
        /// The earlier goal.
        place: String,
    },
    /// The robot is there, turned as the place wants, and stands.
    Arrived {
        /// Where.
        place: String,
    },
    /// [`Command::Stop`] is obeyed.
    Paused {
        /// The goal kept.
        place: String,
    },
    /// [`Command::Resume`] is obeyed.
    Resumed {
        /// The goal.
        place: String,
    },
    /// The robot stands and waits for someone in its way.
    Waiting {
        /// Who.
        person: String,
    },
    /// It moves again.
    MovingOn,
    /// It has found another way, around someone or from where it is.
    Rerouted,
    /// It has got no further for too long and has no goal now.
    Blocked {
        /// The goal given up.
        place: String,
        /// Who was in the way, if anybody.
        person: Option<String>,
    },
    /// The robot is in an elevator and its doors close.
    RideBegun {
        /// The elevator.
        elevator: String,
        /// Index of the floor it leaves.
        from: usize,
        /// Index of the floor it rides to.
        to: usize,
    },
    /// The doors open on another floor.
    FloorChanged {
        /// Index of the floor.
        floor: usize,
    },
    /// A person has been at the last waypoint as long as wanted.
    PersonDone {
        /// Who.
        person: String,
    },
}

/// What the robot is doing.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "kebab-case"))]
pub enum Activity {
    /// It has no goal.
    Idle,
    /// It is on its way.
    Driving,
    /// It waits for somebody in its way.
    Waiting {
        /// Who.
        person: String,
    },
    /// It was told to stop.
    Paused,
    /// It is inside an elevator.
    Riding {
        /// The elevator.
        elevator: String,
        /// Index of the floor it rides to.
        to: usize,
        /// Seconds to go.
        seconds: f64,
    },
}

/// Where the robot is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Robot {
    /// Index of the floor.
    pub floor: usize,
    /// Where and which way.
    pub pose: Pose,
    /// How fast.
    pub twist: Twist,
    /// Torso, head, wheels.
    pub joints: Joints,
}

/// How far the robot is with its goal.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Progress {
    /// The goal.
    pub place: String,
    /// Metres driven since it set out.
    pub travelled: f64,
    /// Still to go, if nobody is in the way.
    pub remaining: Estimate,
    /// Share of the distance that is done, 0 to 1.
    pub fraction: f64,
}
