//! The paper's robot architecture as one pure state machine: events in, commands and records
//! out.
//!
//! No clock, no file, no thread: a simulation, a ROS 2 node or a test drives it. It asks for
//! data, for the execution of actions and for the next round, and is told what came of it.
//!
//! ```
//! use selfneg::demo;
//! use selfneg::mission::{
//!     Command, Event, Goal, Mission, MissionRules, Output, Place, Specification, Task, UserId,
//! };
//!
//! let goal = |name: &str| Goal {
//!     name: name.to_owned(),
//!     tasks: vec![Task { name: "guide".to_owned(), actions: vec!["drive".to_owned()], interruptible: true }],
//!     ..Goal::default()
//! };
//! let specification =
//!     Specification { goals: vec![goal("bathroom"), goal("pharmacy")], ..Specification::default() };
//! let rules = MissionRules::new(&demo::rules()?, specification, Default::default(), None)?;
//! let (bathroom, pharmacy) = (rules.goal("bathroom").unwrap(), rules.goal("pharmacy").unwrap());
//! let (mut mission, _) = Mission::new(rules);
//!
//! let (alice, bob) = (UserId(1), UserId(2));
//! let data = |user| if user == alice { demo::alice() } else { demo::bob() };
//! let mut waits = None;
//! for event in [
//!     Event::Request { user: alice, goal: bathroom, place: Place(10) },
//!     Event::Request { user: bob, goal: pharmacy, place: Place(20) },
//! ] {
//!     let mut events = vec![event];
//!     while let Some(event) = events.pop() {
//!         for output in mission.handle(event) {
//!             match output {
//!                 Output::Command(Command::AskData { user, ask, .. }) => {
//!                     let data = (&data(user)?).into();
//!                     events.push(Event::Data { user, ask, data });
//!                 }
//!                 Output::Command(Command::NextRound) => events.push(Event::NextRound),
//!                 Output::Command(Command::Wait { user, .. }) => waits = Some(user),
//!                 _ => {}
//!             }
//!         }
//!     }
//! }
//! // Alice keeps precedence; of Bob nothing is left but that he waits for the pharmacy.
//! assert_eq!(waits, Some(bob));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where the paper's parts are
//!
//! | paper | here |
//! | --- | --- |
//! | context and ethics manager: monitor, analyzer, planner, executor | `context_ethics/` |
//! | mission controller (goal, task, action) | `mission_controller` |
//! | interruption manager | `interruption_manager`, `request_queue` |
//! | lifecycle manager | `lifecycle_manager`, [`Lifecycle`] |
//! | negotiation manager; offer generator, ethical impact analyzer of each user; engine; utility function | `negotiation/`, around [`selfneg_core`] |
//! | hard ethics | `hard_ethics` |
//!
//! `machine` says what an event does, `settling` what follows from the state it leaves.
//!
//! # Memory
//!
//! All memory for user data is allocated when the mission is made, of the sizes in
//! [`Limits`], and never grows, moves or is copied from one place to another but for the two
//! snapshots of a negotiation. Guaranteed, and tested by reading the same memory before and
//! after:
//!
//! - wiping overwrites every byte of it with volatile writes, and the record of each wipe
//!   says how many bytes a second reading found not zero;
//! - the [`UserData`] of an event is wiped, whole capacities included, when it was handled;
//! - a [`Mission`] cannot be cloned, and wipes itself when it is dropped.
//!
//! Not guaranteed, since safe Rust cannot:
//!
//! - single ranks, conditions, pseudonyms, goals and places pass through registers and the
//!   stack, where the compiler may leave them;
//! - what the maker of a [`UserData`] leaves elsewhere: file texts, parsers' buffers, the old
//!   memory of a list that had to grow;
//! - [`Output`]s, which hold pseudonyms, disclosed conditions as numbers, and totals: they
//!   are the environment's. Lists of pseudonyms that a decision needs are freed unwiped;
//! - what the operating system does: swap, hibernation, core dumps.

#[cfg(test)]
mod check;
mod command;
mod context_ethics;
mod event;
mod fault;
mod hard_ethics;
mod interruption_manager;
mod lifecycle;
mod lifecycle_manager;
mod machine;
mod memory;
mod mission_controller;
mod negotiation;
mod recollection;
mod record;
mod request_queue;
mod settling;
mod specification;
mod user_data;
mod user_managers;
#[cfg(test)]
mod wiping;

pub use command::{Closing, Command, Output, Refusal, Staff, Waiting};
pub use event::{AskId, CategoryId, Event, Evidence, ExecutionId, GoalId, Place, UserId};
pub use lifecycle::{IllegalTransition, Lifecycle, Transition};
pub use memory::NAME_BYTES;
pub(crate) use recollection::{Recollection, Snapshot};
pub use record::{ActiveProfile, Component, Disclosed, Dropped, GoalEnd, Record, Round, Served, Unusable};
pub use specification::{
    Category, ContextImplication, Goal, Inference, Limits, MissionRules, Proof, Specification,
    SpecificationError, Task, Willingness,
};
pub use user_data::{LOCATION, Profile, Stated, Text, UserData};

use machine::{Power, State};

/// A mission under way.
#[derive(Debug)]
pub struct Mission {
    rules: MissionRules,
    state: State,
}

impl Mission {
    /// An idle mission, and the records of its start.
    #[must_use]
    pub fn new(rules: MissionRules) -> (Self, Vec<Output>) {
        let mut out = Vec::new();
        let state = State::new(&rules, &mut out);
        (Self { rules, state }, out)
    }

    /// Handles one event. The replies come in the order in which things happened.
    #[must_use = "the commands are to be carried out"]
    pub fn handle(&mut self, event: Event) -> Vec<Output> {
        let mut out = Vec::new();
        self.state.handle(event, &self.rules, &mut out);
        out
    }

    /// The rules in force.
    #[must_use]
    pub fn rules(&self) -> &MissionRules {
        &self.rules
    }

    /// The user whom the robot serves, if it serves one.
    #[must_use]
    pub fn current_user(&self) -> Option<UserId> {
        self.state.current_user()
    }

    /// Whose data, beyond a request, the mission holds, or has memory assigned for.
    #[must_use]
    pub fn holds_data_of(&self) -> Vec<UserId> {
        self.state.users.all().iter().filter_map(|managers| managers.user).collect()
    }

    /// Whose requests are open, by arrival.
    #[must_use]
    pub fn open_requests(&self) -> Vec<UserId> {
        self.state.interruptions.requests.iter().map(|request| request.user()).collect()
    }

    /// Whether the robot has no goal and no request, nor an emergency.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.residue() == 0
    }

    /// Whether the mission has ended.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.state.power == Power::Off
    }

    /// How many bytes of the memory for user data are not zero. Idle: 0.
    #[must_use]
    pub fn residue(&self) -> usize {
        self.state.residue()
    }
}
