//! The mission's own state machine, as Stateright sees it.

use std::collections::HashSet;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::sync::Mutex;

use selfneg_core::Options;
use stateright::{Model, Property};

use super::environment::{Happening, MOST_USERS, Onlooker, Seen, Wrong, canary, number};
use crate::input::Rules;
use crate::mission::MissionRules;
use crate::mission::event::{AskId, ExecutionId};
use crate::mission::fault::Fault;
use crate::mission::machine::State;
use crate::mission::record::Served;
use crate::mission::request_queue::Stage;
use crate::mission::specification::{Category, Goal, Limits, Proof, Specification, Task};
use crate::precedence::Policy;

/// What is explored.
pub(super) struct MissionModel {
    pub(super) rules: MissionRules,
    pub(super) users: usize,
    pub(super) fault: Option<Fault>,
    /// Every transition that Stateright has made.
    pub(super) explored: Mutex<Explored>,
}

/// The explored graph, as far as it is needed for finding ways back to idle.
#[derive(Default)]
pub(super) struct Explored {
    pub(super) states: HashSet<u64>,
    pub(super) idle: HashSet<u64>,
    /// Steps that the environment owes the mission.
    pub(super) due: Vec<(u64, u64)>,
    pub(super) transitions: usize,
}

/// The mission itself and what an onlooker knows.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Situation {
    pub(super) mission: State,
    pub(super) onlooker: Onlooker,
}

impl MissionModel {
    pub(super) fn new(users: usize, deferrals: u8, options: Options, policy: Option<Policy>) -> Self {
        let activation: Vec<String> = (0..MOST_USERS)
            .flat_map(|user| (0..2).map(move |nth| format!("\"c{user}{nth}\": [\"D{user}\"]")))
            .collect();
        let dispositions = r#"["D0", "D1", "D2", "mark"]"#;
        let rules = Rules::parse(
            ("activation", &format!("{{\"nobody's\": [\"mark\"], {}}}", activation.join(", "))),
            ("implications", &format!("{{\"g\": {dispositions}, \"e\": {dispositions}}}")),
        );
        let task = |interruptible| Task { name: "t".into(), actions: vec!["a".into()], interruptible };
        let goal = |name: &str, tasks| Goal { name: name.into(), tasks, ..Goal::default() };
        let emergency =
            |name: &str, gravity, proof| Category { name: name.into(), gravity, proof, goal: "e".into() };
        let slots = u8::try_from(users.max(2)).unwrap();
        let specification = Specification {
            goals: vec![goal("g", vec![task(true), task(false)]), goal("e", vec![task(true)])],
            emergencies: vec![emergency("fire", 9, Proof::Sensed), emergency("boarding", 3, Proof::Verified)],
            limits: Limits {
                users: slots,
                requests: slots,
                emergencies: 1,
                profiles: 1,
                conditions: 2,
                attributes: 1,
                deferrals,
                ..Limits::default()
            },
            ..Specification::default()
        };
        let rules = MissionRules::new(&rules.unwrap(), specification, options, policy).unwrap();
        Self { rules, users, fault: None, explored: Mutex::default() }
    }
}

pub(super) fn fingerprint(situation: &Situation) -> u64 {
    let mut hasher = DefaultHasher::new();
    situation.hash(&mut hasher);
    hasher.finish()
}

impl Situation {
    /// Numbers askings and executions anew. Mission and environment only ask whether two
    /// numbers are the same, so the situation stays the same one; without this, no situation
    /// would ever come back.
    fn renumber(&mut self) {
        let mut known: Vec<u32> = Vec::new();
        let mut visit = |number: &mut u32| {
            let at = known.iter().position(|seen| seen == number).unwrap_or_else(|| {
                known.push(*number);
                known.len() - 1
            });
            *number = u32::try_from(at).unwrap();
        };
        let onlooker = &mut self.onlooker;
        for AskId(number) in onlooker.asked.iter_mut().flatten() {
            visit(number);
        }
        if let Some(ExecutionId(number)) = &mut onlooker.running {
            visit(number);
        }
        for request in self.mission.interruptions.requests.all_mut() {
            if let Stage::Awaited(AskId(number)) = &mut request.stage {
                visit(number);
            }
        }
        if let Some(ExecutionId(number)) =
            self.mission.controller.pursuit.as_mut().and_then(|pursuit| pursuit.execution.as_mut())
        {
            visit(number);
        }
        self.mission.next_number = u32::try_from(known.len()).unwrap();
    }

    pub(super) fn is_idle(&self) -> bool {
        self.mission.residue() == 0
    }

    /// Whose data lie anywhere in the mission's memory: found by reading all of it.
    fn found_in_memory(&self) -> [bool; MOST_USERS] {
        let mut found = [false; MOST_USERS];
        for managers in self.mission.users.all() {
            let bytes = managers.bytes();
            for (user, found) in found.iter_mut().enumerate() {
                *found |= bytes.contains(&canary(user));
            }
        }
        found
    }

    /// Idle: nobody's data. Serving: the served user's. Negotiating: theirs. Nobody's in
    /// memory that nobody has.
    fn holds_only_what_it_may(&self) -> bool {
        let found = self.found_in_memory();
        let may = self.onlooker.may_be_held;
        let served = self.mission.current_user().map(number);
        let alone = !self.mission.negotiation.is_open() && self.onlooker.asked.iter().all(Option::is_none);
        let vacant_is_clean = self
            .mission
            .users
            .all()
            .iter()
            .all(|managers| managers.user.is_some() || managers.residue() == 0);
        let allowed = (0..MOST_USERS).all(|user| {
            let rightly = may[user] && (!alone || served.is_none() || served == Some(user));
            !found[user] || rightly
        });
        let idle_is_empty = self.onlooker.goal.is_some()
            || self.onlooker.open.contains(&true)
            || found.iter().all(|found| !found);
        allowed && vacant_is_clean && idle_is_empty
    }

    fn loses_no_request(&self) -> bool {
        (0..MOST_USERS).all(|user| {
            let kept = self.mission.interruptions.requests.iter().any(|r| number(r.user()) == user);
            kept == self.onlooker.open[user]
        })
    }

    fn has_one_goal(&self) -> bool {
        let goal = self.mission.controller.pursuit.as_ref().map(|pursuit| pursuit.served);
        let same = match (goal, self.onlooker.goal) {
            // A user who withdrew in a task that may not be interrupted.
            (Some(Served::Nobody), Some(_)) => true,
            (mine, seen) => mine == seen,
        };
        same && !matches!(self.onlooker.wrong, Some(Wrong::TwoGoals | Wrong::TwoActions))
    }
}

impl Model for MissionModel {
    type State = Situation;
    type Action = Happening;

    fn init_states(&self) -> Vec<Situation> {
        let mut mission = State::new(&self.rules, &mut Vec::new());
        mission.faults.present = self.fault;
        let mut situation = Situation { mission, onlooker: Onlooker::new() };
        situation.renumber();
        let mut explored = self.explored.lock().unwrap();
        let start = fingerprint(&situation);
        explored.states.insert(start);
        explored.idle.insert(start);
        vec![situation]
    }

    fn actions(&self, situation: &Situation, actions: &mut Vec<Happening>) {
        situation.onlooker.possible(self.users, actions);
    }

    fn next_state(&self, last: &Situation, happening: Happening) -> Option<Situation> {
        let mut next = last.clone();
        let event = next.onlooker.event(happening, &self.rules);
        let mut outputs = Vec::new();
        next.mission.handle(event, &self.rules, &mut outputs);
        next.onlooker.observe(happening, &outputs);
        next.renumber();

        let (from, to) = (fingerprint(last), fingerprint(&next));
        let mut explored = self.explored.lock().unwrap();
        explored.transitions += 1;
        explored.states.insert(to);
        if next.is_idle() {
            explored.idle.insert(to);
        }
        if happening.is_due() {
            explored.due.push((from, to));
        }
        drop(explored);
        Some(next)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("never two active goals", |_, s: &Situation| s.has_one_goal()),
            Property::always("never data of a user who should be wiped", |_, s: &Situation| {
                s.holds_only_what_it_may() && s.onlooker.wrong != Some(Wrong::WipeLeftBytes)
            }),
            Property::always("no request lost", |_, s: &Situation| s.loses_no_request()),
            Property::always("every request is answered at once", |_, s: &Situation| {
                s.onlooker.wrong != Some(Wrong::RequestUnanswered)
            }),
            Property::always("late news have no effect", |_, s: &Situation| {
                s.onlooker.wrong != Some(Wrong::LateNewsHadEffect)
            }),
            Property::always("only transitions that the lifecycle has", |_, s: &Situation| {
                s.onlooker.wrong != Some(Wrong::IllegalTransition)
            }),
            Property::always("emergencies are decided at once, claims have no effect", |_, s: &Situation| {
                !matches!(s.onlooker.wrong, Some(Wrong::EmergencyNotDecided | Wrong::ClaimHadEffect))
            }),
            Property::sometimes("the interrupter is served", |_, s: &Situation| {
                s.onlooker.seen == Some(Seen::InterrupterServed)
            }),
            Property::sometimes("the current user is kept", |_, s: &Situation| {
                s.onlooker.seen == Some(Seen::CurrentKept)
            }),
            Property::sometimes("an emergency overrides a negotiation", |_, s: &Situation| {
                s.onlooker.seen == Some(Seen::NegotiationOverridden)
            }),
            Property::sometimes("a graver emergency overrides another", |_, s: &Situation| {
                s.onlooker.seen == Some(Seen::GraverFirst)
            }),
            Property::sometimes("a request goes to human staff", |_, s: &Situation| {
                s.onlooker.seen == Some(Seen::Staff)
            }),
            Property::sometimes("the robot holds before an uninterruptible task", |_, s: &Situation| {
                s.onlooker.seen == Some(Seen::Held)
            }),
            Property::sometimes("three users negotiate", |model: &Self, s: &Situation| {
                model.users < 3 || s.onlooker.seen == Some(Seen::ThreeNegotiated)
            }),
        ]
    }
}
