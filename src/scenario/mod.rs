//! Scenarios: who asks the robot for what, when and where, as a TOML file.
//!
//! `docs/scenario.md` describes the format, and `examples/scenarios/annotated.toml` shows
//! every key of it. A [`Scenario`] is checked: what it names is there, figures are in range,
//! the robot and everybody else fit where they stand. [`run`](crate::run) runs it.
//!
//! ```
//! use std::path::Path;
//!
//! use selfneg::run::run;
//! use selfneg::scenario::Scenario;
//!
//! let scenario = Scenario::open(Path::new("examples/scenarios/mall.toml"))?;
//! let outcome = run(&scenario, &mut [])?;
//! assert!(outcome.is_all_right());
//! assert_eq!(outcome.requests[0].user, "Alice");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod folders;
mod format;
mod reading;

use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::time::Duration;

use selfneg_core::Options;
use selfneg_sim::World;

pub use error::ScenarioError;
pub use folders::{Folders, OnDisk};

use crate::input::Rules;
use crate::mission::{Event, GoalId, MissionRules, Specification, UserData, UserId};
use crate::precedence::Policy;
use crate::run::Participant;

/// Most bytes that are read of a scenario file.
const MAX_BYTES: u64 = 1 << 20;

/// A checked scenario.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Its name.
    pub name: String,
    /// What it is about, in a few words; may be empty.
    pub about: String,
    /// The building with the robot and everybody in it, at time 0.
    pub world: World,
    /// Disposition activation and ethical implications.
    pub rules: Rules,
    /// Goals, capabilities, emergencies and limits.
    pub specification: Specification,
    /// The same, checked against the rules.
    pub mission_rules: MissionRules,
    /// The protocol variant.
    pub options: Options,
    /// The policy among several interrupters, if one is named.
    pub policy: Option<Policy>,
    /// What the robot does for each action: by goal, task and place in the task.
    pub actions: Vec<Vec<Vec<Action>>>,
    /// Everybody who takes part; a user's pseudonym is the place here, from 1.
    pub participants: Vec<Participant>,
    /// What the robot cannot know beforehand of each participant.
    pub behaviours: Vec<Behaviour>,
    /// The names of the places, by number.
    pub places: Vec<String>,
    /// What happens, in the order in which things of the same moment happen.
    pub happenings: Vec<Happening>,
    /// Most simulated time that the run takes.
    pub until: Duration,
    /// How long a round of a negotiation takes.
    pub round: Duration,
}

/// What the robot does to execute an action.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Drive to where the request is to be met.
    Meet,
    /// Drive to a place.
    Drive(String),
    /// Drive to a place, the served user walking behind.
    Guide(String),
    /// Stand still.
    Wait(Duration),
    /// Say something, for as long as it takes.
    Say(String, Duration),
}

/// How a user behaves.
#[derive(Clone, Debug)]
pub struct Behaviour {
    /// The data that the user gives when asked.
    pub data: UserData,
    /// How long the answer takes; `None`: the user never answers.
    pub answers_after: Option<Duration>,
    /// Whether the user leaves the scene once served.
    pub leaves: bool,
}

/// Something that happens once.
#[derive(Clone, Debug)]
pub struct Happening {
    /// When.
    pub when: When,
    /// What the mission is told.
    pub event: Event,
    /// The key in the scenario file.
    pub key: String,
}

/// A moment.
#[derive(Clone, Debug, PartialEq)]
pub struct When {
    /// What makes it.
    pub cause: Cause,
    /// How long after that.
    pub later: Duration,
}

/// What makes a moment.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    /// The clock, since the begin of the run.
    At(Duration),
    /// The robot is near a person: middles on the same floor, within this many metres.
    NearPerson(String, f64),
    /// The robot is near a place, likewise.
    NearPlace(String, f64),
    /// The robot arrives at a place to which it was driving.
    Reaching(String),
}

impl Scenario {
    /// Reads a scenario file. Paths in it are relative to its folder.
    ///
    /// # Errors
    /// [`ScenarioError`] if anything is not as documented.
    pub fn open(file: &Path) -> Result<Self, ScenarioError> {
        let unreadable = |source| ScenarioError::Unreadable { file: file.to_owned(), source };
        let mut text = String::new();
        let read = File::open(file)
            .and_then(|opened| opened.take(MAX_BYTES.saturating_add(1)).read_to_string(&mut text))
            .map_err(unreadable)?;
        if u64::try_from(read).is_ok_and(|read| read > MAX_BYTES) {
            return Err(unreadable(std::io::Error::other("more than 1 MiB")));
        }
        let base = file.parent().unwrap_or(Path::new("")).to_owned();
        Self::parse(&text, file, &OnDisk { base })
    }

    /// Takes the file's text instead; `file` is for messages.
    ///
    /// # Errors
    /// [`ScenarioError`] if anything is not as documented.
    pub fn parse(text: &str, file: &Path, folders: &dyn Folders) -> Result<Self, ScenarioError> {
        reading::read(text, file, folders)
    }

    /// The participant of a pseudonym.
    #[must_use]
    pub fn participant(&self, user: UserId) -> Option<&Participant> {
        self.participants.iter().find(|participant| participant.pseudonym == user)
    }

    /// The name of a goal.
    #[must_use]
    pub fn goal_name(&self, goal: GoalId) -> &str {
        self.specification.goals.get(usize::from(goal.0)).map_or("?", |goal| goal.name.as_str())
    }
}
