//! Where a message goes, and whether it is personal.

use std::borrow::Cow;
use std::fmt;

use super::schema::Schema;
use crate::mission::{Record, UserId};

/// What all personal topics begin with, and no other.
pub const PERSONAL: &str = "/personal/";

/// What the topics begin with that hold personal messages encrypted.
pub const SEALED: &str = "/sealed/";

/// Whose personal data a message holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Whose {
    /// One user's.
    User(UserId),
    /// Somebody's in the simulated world who is not a user, by order of appearance from 1.
    Bystander(u32),
    /// Nobody's: it is needed to read all the others.
    Everyone,
    /// It names or shows several people. It is erased with the first of them.
    Several,
}

impl fmt::Display for Whose {
    /// As it stands in topics and scenes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::User(UserId(number)) => write!(f, "user-{number}"),
            Self::Bystander(number) => write!(f, "bystander-{number}"),
            Self::Everyone => f.write_str("everyone"),
            Self::Several => f.write_str("several"),
        }
    }
}

/// A topic, with its schema.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Topic {
    /// Its name.
    pub name: Cow<'static, str>,
    /// Its messages' type.
    pub schema: Schema,
}

const fn topic(name: &'static str, schema: Schema) -> Topic {
    Topic { name: Cow::Borrowed(name), schema }
}

impl Topic {
    /// What is fixed before the run.
    pub const HEADER: Self = topic("/mission/header", Schema::Header);
    /// What a complete trace holds.
    pub const END: Self = topic("/mission/end", Schema::End);
    /// What happened to the mission.
    pub const EVENT: Self = topic("/mission/event", Schema::Event);
    /// What the mission wants done.
    pub const COMMAND: Self = topic("/mission/command", Schema::Command);
    /// One plain sentence per event, record and command, with pseudonyms.
    pub const LOG: Self = topic("/log", Schema::Log);
    /// Frames of the floors.
    pub const FRAMES: Self = topic("/tf", Schema::FrameTransforms);
    /// Commitments to what is personal.
    pub const COMMITMENT: Self = topic("/mission/commitment", Schema::Commitment);
    /// Walls.
    pub const BUILDING: Self = topic("/scene/building", Schema::SceneUpdate);
    /// The robot's shape, in its own frames.
    pub const ROBOT: Self = topic("/scene/robot", Schema::SceneUpdate);
    /// Frames of the robot: where it is, and so where people are met.
    pub const ROBOT_FRAMES: Self = topic("/personal/tf", Schema::FrameTransforms);
    /// Where the robot is.
    pub const ROBOT_POSE: Self = topic("/personal/robot/pose", Schema::PoseInFrame);
    /// Named places.
    pub const PLACES: Self = topic("/personal/places", Schema::SceneUpdate);
    /// What opens commitments.
    pub const OPENING: Self = topic("/personal/opening", Schema::Opening);
    /// What rules and specification name and rank.
    pub const RULES: Self = topic("/personal/rules", Schema::Rules);
    /// Who a pseudonym is.
    pub const PARTICIPANT: Self = topic("/personal/participant", Schema::Participant);
    /// What is personal of an event.
    pub const INPUT: Self = topic("/personal/input", Schema::Input);
    /// What is personal of a record or command.
    pub const REPLY: Self = topic("/personal/reply", Schema::Reply);
    /// The story, with names.
    pub const STORY: Self = topic("/personal/log", Schema::Log);
    /// Where the robot is going: where somebody is to be met.
    pub const DESTINATION: Self = topic("/personal/destination", Schema::SceneUpdate);

    /// The topic of a record's open half.
    #[must_use]
    pub const fn of_record(record: &Record) -> Self {
        let name = match record {
            Record::Lifecycle { .. } | Record::IllegalTransition { .. } => "/mission/lifecycle",
            Record::Refused { .. }
            | Record::Admitted { .. }
            | Record::Closed { .. }
            | Record::StaffCalled { .. }
            | Record::Deferred { .. } => "/mission/request",
            Record::DataAccepted { .. }
            | Record::DataMissing { .. }
            | Record::DataUnusable { .. }
            | Record::Ignored { .. }
            | Record::ProfileActivated { .. }
            | Record::ProfileKept { .. }
            | Record::Inferred { .. } => "/mission/data",
            Record::Wiped { .. } => "/mission/wipe",
            Record::GoalStarted { .. }
            | Record::TaskStarted { .. }
            | Record::Held { .. }
            | Record::GoalEnded { .. } => "/mission/goal",
            Record::NegotiationStarted { .. }
            | Record::Round { .. }
            | Record::NegotiationEnded { .. }
            | Record::NegotiationsDropped { .. } => "/mission/negotiation",
            Record::Decided { .. } => "/mission/decision",
            Record::EmergencyDecided { .. } | Record::EmergencyUnverified { .. } => "/mission/emergency",
            Record::ShuttingDown | Record::ShutDown => "/mission/power",
        };
        topic(name, Schema::Record)
    }

    /// The map of a floor, by its index.
    #[must_use]
    pub fn map(floor: usize) -> Self {
        Self { name: format!("/map/{floor}").into(), schema: Schema::Grid }
    }

    /// The walls of a floor as points, by its index.
    #[must_use]
    pub fn walls(floor: usize) -> Self {
        Self { name: format!("/map/{floor}/walls").into(), schema: Schema::PointCloud }
    }

    /// What is personal of one subject, encrypted.
    #[must_use]
    pub fn sealed(whose: Whose) -> Self {
        Self { name: format!("{SEALED}{whose}").into(), schema: Schema::Sealed }
    }

    /// A person as a shape.
    #[must_use]
    pub fn person_scene(whose: Whose) -> Self {
        Self { name: format!("/personal/people/{}/scene", whose).into(), schema: Schema::SceneUpdate }
    }

    /// Where a person is.
    #[must_use]
    pub fn person_pose(whose: Whose) -> Self {
        Self { name: format!("/personal/people/{}/pose", whose).into(), schema: Schema::PoseInFrame }
    }

    /// Whether its messages are personal.
    #[must_use]
    pub fn is_personal(&self) -> bool {
        self.name.starts_with(PERSONAL)
    }
}
