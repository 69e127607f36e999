//! Random missions, rich in decisions: what an environment may do, and the trace of it.
#![allow(dead_code, reason = "each test uses a part")]

use std::collections::BTreeMap;
use std::time::Duration;

use proptest::prelude::*;
use selfneg::demo;
use selfneg::input::Truth;
use selfneg::mission::{
    AskId, Category, CategoryId, Command, ContextImplication, Event, Evidence, ExecutionId, Goal, GoalId,
    Inference, LOCATION, Mission, MissionRules, Output, Place, Profile, Proof, Record, Specification, Stated,
    Task, UserData, UserId, Willingness,
};
use selfneg::precedence::Policy;
use selfneg::run::{Participant, Setup, Watcher};
use selfneg::trace::TraceWriter;
use selfneg_core::{Aggregation, Fallback, Options, QuitRule, TieRule};
use selfneg_sim::{Building, Cell, Floor, OccupancyGrid, Point};

const DISPOSITIONS: [&str; 6] = [
    "people with a small child",
    "elderly people",
    "disabled people",
    "people in urgency",
    "people with health conditions",
    "people with crowd anxiety",
];

const CONDITIONS: [&str; 6] =
    ["with a small child", "elderly", "in urgency", "crowd anxiety", "of nobody's rules", "nor this"];

/// What an environment does next.
#[derive(Clone, Debug)]
pub(crate) enum Choice {
    Request(u32, u16),
    /// Answers the latest asking.
    Answer(UserData),
    /// Lets the latest asking go unanswered.
    Timeout,
    Context(u32, bool),
    Status(u32, &'static str, Truth),
    Done,
    Failed,
    /// As many rounds as are asked for, at most this many.
    Rounds(u8),
    Emergency(u16, Evidence),
    Withdraw(u32),
    Shutdown,
}

/// What a user of the mall says: ranks of [`DISPOSITIONS`], and what is true.
pub(crate) fn data(ranks: [u8; 6], conditions: &[&'static str]) -> UserData {
    let stated = |&condition: &&'static str| Stated { condition: condition.into(), truth: Truth::True };
    UserData {
        profiles: vec![Profile {
            label: "mall".into(),
            ranks: DISPOSITIONS.into_iter().map(Into::into).zip(ranks).collect(),
        }],
        status: conditions.iter().map(stated).collect(),
        context: vec![(LOCATION.into(), "mall".into())],
    }
}

fn truth() -> impl Strategy<Value = Truth> {
    prop::sample::select(vec![Truth::True, Truth::True, Truth::False, Truth::Withheld])
}

fn user_data() -> impl Strategy<Value = UserData> {
    let ranks = prop::collection::vec(0..=5_u8, 6);
    let status = prop::collection::vec((prop::sample::select(CONDITIONS.to_vec()), truth()), 0..5);
    (ranks, status, 0..12_u8, any::<bool>(), any::<bool>()).prop_map(|(ranks, status, where_, dense, own)| {
        let status: BTreeMap<_, _> = status.into_iter().collect();
        let stated = |(condition, truth): (&str, Truth)| Stated { condition: condition.into(), truth };
        let profile = Profile {
            label: "mall".into(),
            ranks: DISPOSITIONS.iter().map(|&name| name.into()).zip(ranks).collect(),
        };
        let mut context = Vec::new();
        if where_ > 0 {
            context.push((LOCATION.into(), if where_ == 1 { "moon".into() } else { "mall".into() }));
        }
        if dense {
            context.push(("crowd".into(), "dense".into()));
        }
        let profiles = if own || where_ > 3 { vec![profile] } else { Vec::new() };
        UserData { profiles, status: status.into_iter().map(stated).collect(), context }
    })
}

/// One thing that an environment does.
pub(crate) fn choice() -> impl Strategy<Value = Choice> {
    let user = || 1..5_u32;
    let evidence = prop::sample::select(vec![Evidence::Claimed, Evidence::Sensed, Evidence::Verified]);
    prop_oneof![
        10 => (user(), prop::sample::select(vec![0, 0, 0, 1, 1, 1, 2_u16])).prop_map(|(user, goal)| Choice::Request(user, goal)),
        12 => user_data().prop_map(Choice::Answer),
        1 => Just(Choice::Timeout),
        1 => (user(), any::<bool>()).prop_map(|(user, dense)| Choice::Context(user, dense)),
        1 => (user(), prop::sample::select(CONDITIONS.to_vec()), truth())
            .prop_map(|(user, condition, truth)| Choice::Status(user, condition, truth)),
        5 => Just(Choice::Done),
        1 => Just(Choice::Failed),
        14 => (0..60_u8).prop_map(Choice::Rounds),
        1 => (0..3_u16, evidence).prop_map(|(category, evidence)| Choice::Emergency(category, evidence)),
        1 => user().prop_map(Choice::Withdraw),
    ]
}

/// What an environment does, from begin to end.
pub(crate) fn choices() -> impl Strategy<Value = Vec<Choice>> {
    (prop::collection::vec(choice(), 0..160), any::<bool>()).prop_map(|(mut choices, off)| {
        choices.extend(off.then_some(Choice::Shutdown));
        choices
    })
}

/// Any variant.
pub(crate) fn options() -> impl Strategy<Value = Options> {
    (
        prop::sample::select(QuitRule::ALL.to_vec()),
        prop::sample::select(Aggregation::ALL.to_vec()),
        prop::sample::select(TieRule::ALL.to_vec()),
        prop::sample::select(Fallback::ALL.to_vec()),
        0..4_u8,
    )
        .prop_map(|(quit, aggregation, tie, fallback, willingness)| Options {
            quit,
            aggregation,
            tie,
            fallback,
            willingness,
        })
}

/// Any policy, the default included.
pub(crate) fn policy() -> impl Strategy<Value = Option<Policy>> {
    prop::sample::select(vec![None, Some(Policy::Published), Some(Policy::Condorcet)])
}

/// Goals of an interruptible and an uninterruptible task, two kinds of emergency, inferences,
/// a normative profile, an implication in a context.
pub(crate) fn specification() -> Specification {
    let task = |name: &str, interruptible| Task {
        name: name.to_owned(),
        actions: vec!["drive".to_owned(), "speak".to_owned()],
        interruptible,
    };
    let goal = |name: &str| Goal {
        name: name.to_owned(),
        needs: vec!["drive".to_owned()],
        tasks: vec![task("meet", true), task("lead", false), task("leave", true)],
        implications: vec![ContextImplication {
            attribute: "crowd".to_owned(),
            value: "dense".to_owned(),
            dispositions: vec![DISPOSITIONS[5].to_owned(), DISPOSITIONS[1].to_owned()],
        }],
    };
    let category = |name: &str, gravity, proof| Category {
        name: name.to_owned(),
        gravity,
        proof,
        goal: "pharmacy".to_owned(),
    };
    Specification {
        capabilities: vec!["drive".to_owned()],
        goals: vec![goal("bathroom"), goal("pharmacy")],
        emergencies: vec![category("fall", 5, Proof::Sensed), category("flight", 2, Proof::Verified)],
        inferences: vec![Inference {
            attribute: "crowd".to_owned(),
            value: "dense".to_owned(),
            condition: "crowd anxiety".to_owned(),
        }],
        normative: [("mall".to_owned(), [(DISPOSITIONS[1].to_owned(), 3)].into())].into(),
        willingness: Willingness { from_percent: 20 },
        ..Specification::default()
    }
}

/// One small room.
pub(crate) fn building() -> Building {
    let map = OccupancyGrid::new(2, 1, 1.0, Point::default(), vec![Cell::Free; 2]).unwrap();
    let floor = Floor { name: "ground".into(), map, places: Vec::new() };
    Building::new("room".into(), vec![floor], Vec::new()).unwrap()
}

/// Plays a mission before `watcher`, with a millisecond between events.
pub(crate) fn play(
    choices: Vec<Choice>,
    options: Options,
    policy: Option<Policy>,
    watcher: &mut dyn Watcher,
) {
    let (rules, specification, building) = (demo::rules().unwrap(), specification(), building());
    let one = |number, user: selfneg::input::User| Participant {
        pseudonym: UserId(number),
        person: user.name.clone(),
        user,
    };
    watcher
        .begin(&Setup {
            name: "random",
            building: &building,
            rules: &rules,
            specification: &specification,
            options,
            policy,
            participants: &[one(1, demo::alice().unwrap()), one(2, demo::bob().unwrap())],
            places: &[],
        })
        .unwrap();
    let rules = MissionRules::new(&rules, specification, options, policy).unwrap();
    let (mission, first) = Mission::new(rules);
    let mut stage = Stage { watcher, mission, asks: Vec::new(), execution: ExecutionId(0), due: 0, now: 0 };
    stage.replies(first);
    for choice in choices {
        stage.act(choice);
    }
    let at = Duration::from_millis(stage.now);
    stage.watcher.end(at).unwrap();
}

/// The trace of a mission.
pub(crate) fn trace(choices: Vec<Choice>, options: Options, policy: Option<Policy>) -> Vec<u8> {
    let mut writer = TraceWriter::plain(Vec::new()).unwrap();
    play(choices, options, policy, &mut writer);
    writer.into_inner().unwrap()
}

struct Stage<'w> {
    watcher: &'w mut dyn Watcher,
    mission: Mission,
    asks: Vec<(UserId, AskId)>,
    execution: ExecutionId,
    /// How many rounds were asked for and have not been played.
    due: u32,
    now: u64,
}

impl Stage<'_> {
    fn act(&mut self, choice: Choice) {
        let event = match choice {
            Choice::Request(user, goal) => {
                Event::Request { user: UserId(user), goal: GoalId(goal), place: Place(user) }
            }
            Choice::Answer(data) => match self.asks.pop() {
                Some((user, ask)) => Event::Data { user, ask, data },
                None => return,
            },
            Choice::Timeout => match self.asks.pop() {
                Some((user, ask)) => Event::DataTimeout { user, ask },
                None => return,
            },
            Choice::Context(user, dense) => Event::Context {
                user: UserId(user),
                attribute: "crowd".into(),
                value: if dense { "dense".into() } else { "thin".into() },
            },
            Choice::Status(user, condition, truth) => {
                Event::Status { user: UserId(user), condition: condition.into(), truth }
            }
            Choice::Done => Event::ActionDone { execution: self.execution },
            Choice::Failed => Event::ActionFailed { execution: self.execution },
            Choice::Rounds(most) => {
                for _ in 0..most {
                    if self.due > 0 {
                        self.due -= 1;
                        self.happen(Event::NextRound);
                    }
                }
                return;
            }
            Choice::Emergency(category, evidence) => {
                Event::Emergency { category: CategoryId(category), place: Place(9), evidence }
            }
            Choice::Withdraw(user) => Event::Withdraw { user: UserId(user) },
            Choice::Shutdown => Event::Shutdown,
        };
        self.happen(event);
    }

    fn happen(&mut self, event: Event) {
        self.now += 1;
        self.watcher.event(Duration::from_millis(self.now), &event).unwrap();
        let outputs = self.mission.handle(event);
        self.replies(outputs);
    }

    fn replies(&mut self, outputs: Vec<Output>) {
        let at = Duration::from_millis(self.now);
        let mut decided = false;
        for output in outputs {
            match &output {
                Output::Command(Command::AskData { user, ask, .. }) => self.asks.push((*user, *ask)),
                Output::Command(Command::Execute { execution, .. }) => self.execution = *execution,
                Output::Command(Command::NextRound) => self.due += 1,
                Output::Record(Record::Decided { .. } | Record::EmergencyDecided { .. }) => decided = true,
                _ => {}
            }
            self.watcher.output(at, &output).unwrap();
        }
        if decided {
            self.watcher.decided(at).unwrap();
        }
    }
}
