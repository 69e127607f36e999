//! Where a message goes, and whether it is personal.

use std::borrow::Cow;

use super::schema::Schema;
use crate::mission::{Record, UserId};

/// What all personal topics begin with, and no other.
pub const PERSONAL: &str = "/personal/";

/// Whose personal data a message holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Whose {
    /// One user's.
    User(UserId),
    /// Somebody's in the simulated world who is not a user, by order of appearance from 1.
    Bystander(u32),
    /// Nobody's in particular: it is needed to read all the others, or may name several people.
    Everyone,
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
    /// Frames of the floors and of the robot.
    pub const FRAMES: Self = topic("/tf", Schema::FrameTransforms);
    /// Walls and named places.
    pub const BUILDING: Self = topic("/scene/building", Schema::SceneUpdate);
    /// The robot's shape, in its own frames.
    pub const ROBOT: Self = topic("/scene/robot", Schema::SceneUpdate);
    /// Where the robot is.
    pub const ROBOT_POSE: Self = topic("/robot/pose", Schema::PoseInFrame);
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

    /// A person as a shape.
    #[must_use]
    pub fn person_scene(whose: Whose) -> Self {
        Self { name: format!("/personal/people/{}/scene", id(whose)).into(), schema: Schema::SceneUpdate }
    }

    /// Where a person is.
    #[must_use]
    pub fn person_pose(whose: Whose) -> Self {
        Self { name: format!("/personal/people/{}/pose", id(whose)).into(), schema: Schema::PoseInFrame }
    }

    /// Whether its messages are personal.
    #[must_use]
    pub fn is_personal(&self) -> bool {
        self.name.starts_with(PERSONAL)
    }
}

/// A pseudonym as it stands in topics and scenes.
pub(super) fn id(whose: Whose) -> String {
    match whose {
        Whose::User(UserId(number)) => format!("user-{number}"),
        Whose::Bystander(number) => format!("bystander-{number}"),
        Whose::Everyone => "everyone".to_owned(),
    }
}
