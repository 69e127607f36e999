//! A scripted environment: it keeps what the mission asks for, and answers when told to.

#![allow(dead_code, unreachable_pub, reason = "each test file uses its own part")]
#![expect(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "it is used in tests alone")]

use selfneg::input::{Rules, Truth};
use selfneg::mission::{
    AskId, Category, Closing, Command, Event, Evidence, ExecutionId, Goal, LOCATION, Limits, Mission,
    MissionRules, Output, Place, Profile, Proof, Record, Specification, Stated, Task, UserData, UserId,
};
use selfneg::precedence::Policy;
use selfneg_core::Options;

pub const ALICE: UserId = UserId(1);
pub const BOB: UserId = UserId(2);
pub const CAROL: UserId = UserId(3);

pub struct Environment {
    pub mission: Mission,
    /// Everything that the mission has put out.
    pub all: Vec<Output>,
    /// What it put out in reply to the last event.
    pub last: Vec<Output>,
    pub asks: Vec<(UserId, AskId)>,
    pub running: Option<ExecutionId>,
    pub round_due: bool,
}

/// Conditions a, b, c, each activating one disposition; goals t1, t2, t3 imply all three.
/// A goal has a task `approach` of one action, a task `lift` of two that may not be
/// interrupted, and a task `leave` of two.
pub fn specification() -> Specification {
    let task = |name: &str, actions: usize, interruptible| Task {
        name: name.to_owned(),
        actions: (0..actions).map(|nth| format!("{name} {nth}")).collect(),
        interruptible,
    };
    let goal = |name: &str, needs: &[&str]| Goal {
        name: name.to_owned(),
        needs: needs.iter().map(|&need| need.to_owned()).collect(),
        tasks: vec![task("approach", 1, true), task("lift", 2, false), task("leave", 2, true)],
        implications: Vec::new(),
    };
    let category = |name: &str, gravity, proof| Category {
        name: name.to_owned(),
        gravity,
        proof,
        goal: "t3".to_owned(),
    };
    Specification {
        capabilities: vec!["drive".to_owned()],
        goals: vec![goal("t1", &["drive"]), goal("t2", &["drive"]), goal("t3", &[]), goal("fly", &["wings"])],
        emergencies: vec![
            category("fire", 9, Proof::Sensed),
            category("smoke", 9, Proof::Sensed),
            category("fall", 5, Proof::Sensed),
            category("boarding", 3, Proof::Verified),
        ],
        limits: Limits { users: 4, requests: 6, deferrals: 3, emergencies: 2, ..Limits::default() },
        ..Specification::default()
    }
}

pub fn rules() -> Rules {
    Rules::parse(
        ("activation", r#"{"a": ["A"], "b": ["B"], "c": ["C"]}"#),
        (
            "implications",
            r#"{"t1": ["A", "B", "C"], "t2": ["A", "B", "C"], "t3": ["A", "B", "C"], "fly": ["A"]}"#,
        ),
    )
    .unwrap()
}

/// A user at `mall` with these ranks of A, B, C, and these true conditions.
pub fn data(ranks: [u8; 3], conditions: &[&str]) -> UserData {
    UserData {
        profiles: vec![profile("mall", ranks)],
        status: conditions.iter().map(|&name| stated(name, Truth::True)).collect(),
        context: vec![(LOCATION.into(), "mall".into())],
    }
}

pub fn profile(label: &str, ranks: [u8; 3]) -> Profile {
    Profile {
        label: label.into(),
        ranks: ["A".into(), "B".into(), "C".into()].into_iter().zip(ranks).collect(),
    }
}

pub fn stated(name: &str, truth: Truth) -> Stated {
    Stated { condition: name.into(), truth }
}

/// Alice has a, and gives a 5 and b 1: against Bob's b she keeps precedence if Bob defers.
pub fn alice() -> UserData {
    data([5, 1, 1], &["a"])
}

/// Bob has b and gives a more than b: he defers to Alice.
pub fn bob_who_defers() -> UserData {
    data([5, 1, 1], &["b"])
}

/// Bob has b and gives b most.
pub fn bob_who_insists() -> UserData {
    data([1, 5, 1], &["b"])
}

/// Alice has a and gives b most.
pub fn alice_who_defers() -> UserData {
    data([1, 5, 1], &["a"])
}

impl Environment {
    pub fn new() -> Self {
        Self::with(specification(), Options::default(), None)
    }

    pub fn with(specification: Specification, options: Options, policy: Option<Policy>) -> Self {
        Self::under(&rules(), specification, options, policy)
    }

    pub fn under(
        rules: &Rules,
        specification: Specification,
        options: Options,
        policy: Option<Policy>,
    ) -> Self {
        let (mission, all) = Mission::new(MissionRules::new(rules, specification, options, policy).unwrap());
        Self { mission, all, last: Vec::new(), asks: Vec::new(), running: None, round_due: false }
    }

    /// Alice is being served.
    pub fn serving(data: UserData) -> Self {
        let mut environment = Self::new();
        environment.request(ALICE, "t1");
        environment.data(ALICE, data);
        assert_eq!(environment.mission.current_user(), Some(ALICE));
        environment
    }

    pub fn send(&mut self, event: Event) -> &mut Self {
        let done = match event {
            Event::ActionDone { execution } | Event::ActionFailed { execution } => Some(execution),
            _ => None,
        };
        if done.is_some() && done == self.running {
            self.running = None;
        }
        if matches!(event, Event::NextRound) {
            self.round_due = false;
        }
        self.last = self.mission.handle(event);
        for output in &self.last {
            match output {
                Output::Command(Command::AskData { user, ask, .. }) => {
                    self.asks.retain(|(asked, _)| asked != user);
                    self.asks.push((*user, *ask));
                }
                Output::Command(Command::Execute { execution, .. }) => {
                    assert_eq!(self.running, None, "two actions at a time");
                    self.running = Some(*execution);
                }
                Output::Command(Command::Stop { execution }) => {
                    assert_eq!(self.running, Some(*execution));
                    self.running = None;
                }
                Output::Command(Command::NextRound) => self.round_due = true,
                Output::Record(Record::IllegalTransition { component, refused }) => {
                    panic!("{component:?}: {refused}")
                }
                Output::Record(Record::Wiped { left, .. }) => assert_eq!(*left, 0),
                _ => {}
            }
        }
        self.all.extend(self.last.iter().cloned());
        self
    }

    pub fn request(&mut self, user: UserId, goal: &str) -> &mut Self {
        let goal = self.mission.rules().goal(goal).unwrap();
        self.send(Event::Request { user, goal, place: Place(100 + user.0) })
    }

    pub fn ask_of(&self, user: UserId) -> Option<AskId> {
        self.asks.iter().find(|(asked, _)| *asked == user).map(|(_, ask)| *ask)
    }

    pub fn data(&mut self, user: UserId, data: UserData) -> &mut Self {
        let ask = self.ask_of(user).expect("the user was not asked");
        self.send(Event::Data { user, ask, data })
    }

    pub fn timeout(&mut self, user: UserId) -> &mut Self {
        let ask = self.ask_of(user).expect("the user was not asked");
        self.send(Event::DataTimeout { user, ask })
    }

    pub fn action_done(&mut self) -> &mut Self {
        let execution = self.running.expect("nothing runs");
        self.send(Event::ActionDone { execution })
    }

    /// Plays all rounds that are due.
    pub fn negotiate(&mut self) -> &mut Self {
        for _ in 0..1_000 {
            if !self.round_due {
                return self;
            }
            self.send(Event::NextRound);
        }
        panic!("the negotiation has no end");
    }

    pub fn emergency(&mut self, name: &str, evidence: Evidence) -> &mut Self {
        let category = self.mission.rules().category(name).unwrap();
        self.send(Event::Emergency { category, place: Place(911), evidence })
    }

    /// Does everything that the current goal needs.
    pub fn finish_goal(&mut self) -> &mut Self {
        for _ in 0..5 {
            self.action_done();
        }
        self
    }

    pub fn records(&self) -> impl Iterator<Item = &Record> {
        self.all.iter().filter_map(|output| match output {
            Output::Record(record) => Some(record),
            Output::Command(_) => None,
        })
    }

    pub fn has_record(&self, wanted: impl Fn(&Record) -> bool) -> bool {
        self.records().any(wanted)
    }

    pub fn last_has(&self, wanted: impl Fn(&Output) -> bool) -> bool {
        self.last.iter().any(wanted)
    }

    pub fn commands(&self) -> impl Iterator<Item = &Command> {
        self.all.iter().filter_map(|output| match output {
            Output::Command(command) => Some(command),
            Output::Record(_) => None,
        })
    }

    pub fn closed(&self, user: UserId) -> Option<Closing> {
        self.commands().find_map(|command| match command {
            Command::Close { user: closed, how } if *closed == user => Some(*how),
            _ => None,
        })
    }

    /// Whose data are held, in order of their pseudonyms.
    pub fn held(&self) -> Vec<UserId> {
        let mut held = self.mission.holds_data_of();
        held.sort_unstable();
        held
    }
}
