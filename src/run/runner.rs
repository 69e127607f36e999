//! Steps mission and world together on simulated time.

use std::collections::BTreeMap;
use std::io;
use std::time::Duration;

use selfneg_sim as sim;
use selfneg_sim::{Point, World};

use super::following::Following;
use super::narrator::Narrator;
use super::outcome::{Ended, Failure, HowItEnded, Outcome, RequestOutcome};
use super::watcher::{Setup, Watcher};
use crate::mission::{
    Closing, Command, Event, ExecutionId, Mission, Output, Place, Record, Served, Stated, UserData, UserId,
};
use crate::scenario::{Action, Cause, Scenario};

/// How often the world is shown, and a guided user sent on, when nothing happens.
const SHOWN_EVERY: Duration = Duration::from_millis(200);

/// Runs a scenario to its end, with everybody in `watchers` watching, in this order.
///
/// # Errors
/// The first error of a watcher; the run ends there.
pub fn run(scenario: &Scenario, watchers: &mut [&mut dyn Watcher]) -> io::Result<Outcome> {
    let (mission, started) = Mission::new(scenario.mission_rules.clone());
    let mut runner = Runner::new(scenario, mission, watchers);
    runner.begin(&started)?;
    let ended = loop {
        runner.cause();
        while let Some((event, happening)) = runner.next_due() {
            runner.handle(event, happening)?;
        }
        if let Some(ended) = runner.is_over() {
            break ended;
        }
        runner.step()?;
    };
    runner.end(ended)
}

/// The action under way.
#[derive(Clone, Debug)]
struct Executing {
    execution: ExecutionId,
    what: Work,
}

#[derive(Clone, Debug)]
enum Work {
    Driving(String),
    Until(Duration),
}

/// What is to happen at a moment: at equal times by number.
type Agenda = BTreeMap<(Duration, u64), (Event, Option<usize>)>;

struct Runner<'s, 'w, 'a> {
    scenario: &'s Scenario,
    watchers: &'w mut [&'a mut dyn Watcher],
    narrator: Narrator<'s>,
    world: World,
    mission: Mission,
    agenda: Agenda,
    next_number: u64,
    /// Happenings, by number, whose cause is still to come.
    uncaused: Vec<usize>,
    /// Happenings, by number, that have not happened.
    outstanding: Vec<usize>,
    /// The places at which the robot arrived in the last step.
    reached: Vec<String>,
    /// What each participant would answer now.
    data: Vec<UserData>,
    /// For the robot's next step.
    told: sim::Command,
    executing: Option<Executing>,
    following: Option<Following>,
    served: Served,
    /// Whether the mission was idle after the last event. To find out it reads all its memory.
    idle: bool,
    next_show: Duration,
    outcome: Outcome,
}

impl<'s, 'w, 'a> Runner<'s, 'w, 'a> {
    fn new(scenario: &'s Scenario, mission: Mission, watchers: &'w mut [&'a mut dyn Watcher]) -> Self {
        let mut runner = Self {
            scenario,
            watchers,
            narrator: Narrator::new(scenario),
            world: scenario.world.clone(),
            mission,
            agenda: Agenda::new(),
            next_number: 0,
            uncaused: Vec::new(),
            outstanding: (0..scenario.happenings.len()).collect(),
            reached: Vec::new(),
            data: scenario.behaviours.iter().map(|behaviour| behaviour.data.clone()).collect(),
            told: sim::Command::Continue,
            executing: None,
            following: None,
            served: Served::Nobody,
            idle: true,
            next_show: Duration::ZERO,
            outcome: Outcome {
                ended: Ended::Idle,
                after: Duration::ZERO,
                requests: Vec::new(),
                decisions: 0,
                failures: Vec::new(),
                never_happened: Vec::new(),
                metres: 0.0,
            },
        };
        for (nth, happening) in scenario.happenings.iter().enumerate() {
            match happening.when.cause {
                Cause::At(time) => {
                    let at = time.saturating_add(happening.when.later);
                    runner.schedule(at, happening.event.clone(), Some(nth));
                }
                _ => runner.uncaused.push(nth),
            }
        }
        runner
    }

    fn now(&self) -> Duration {
        self.world.time()
    }

    fn schedule(&mut self, at: Duration, event: Event, happening: Option<usize>) {
        self.agenda.insert((at, self.next_number), (event, happening));
        self.next_number = self.next_number.saturating_add(1);
    }

    fn schedule_in(&mut self, delay: Duration, event: Event) {
        self.schedule(self.now().saturating_add(delay), event, None);
    }

    fn next_due(&mut self) -> Option<(Event, Option<usize>)> {
        let now = self.now();
        self.agenda.first_entry().filter(|entry| entry.key().0 <= now).map(|entry| entry.remove())
    }

    fn begin(&mut self, started: &[Output]) -> io::Result<()> {
        let scenario = self.scenario;
        let setup = Setup {
            name: &scenario.name,
            building: scenario.world.building(),
            rules: &scenario.rules,
            specification: &scenario.specification,
            options: scenario.options,
            policy: scenario.policy,
            participants: &scenario.participants,
            places: &scenario.places,
        };
        for watcher in &mut *self.watchers {
            watcher.begin(&setup)?;
        }
        self.outputs(started)?;
        self.show()
    }

    /// Looks which causes are there now.
    fn cause(&mut self) {
        let (scenario, robot) = (self.scenario, *self.world.robot());
        let near = |at: Point, floor: usize, within: f64| {
            floor == robot.floor && at.distance(robot.pose.position) <= within
        };
        let is_there = |runner: &Self, cause: &Cause| match cause {
            Cause::At(_) => false,
            Cause::NearPerson(name, within) => {
                let person = runner.world.person(name);
                person.is_some_and(|person| near(person.position, person.floor, *within))
            }
            Cause::NearPlace(name, within) => {
                let place = runner.world.building().place(name);
                place.is_some_and(|(floor, place)| near(place.position, floor, *within))
            }
            Cause::Reaching(name) => runner.reached.contains(name),
        };
        for nth in std::mem::take(&mut self.uncaused) {
            match scenario.happenings.get(nth) {
                Some(happening) if is_there(self, &happening.when.cause) => {
                    let at = self.now().saturating_add(happening.when.later);
                    self.schedule(at, happening.event.clone(), Some(nth));
                }
                _ => self.uncaused.push(nth),
            }
        }
        self.reached.clear();
    }

    /// Tells the mission, and does what it says.
    fn handle(&mut self, event: Event, happening: Option<usize>) -> io::Result<()> {
        let at = self.now();
        self.outstanding.retain(|&nth| Some(nth) != happening);
        for watcher in &mut *self.watchers {
            watcher.event(at, &event)?;
        }
        let sentence = self.narrator.event(&event);
        self.tell(sentence)?;
        self.note(&event);
        let outputs = self.mission.handle(event);
        self.idle = self.mission.is_idle();
        self.outputs(&outputs)?;
        let decided = outputs.iter().any(|output| {
            matches!(output, Output::Record(Record::Decided { .. } | Record::EmergencyDecided { .. }))
        });
        if decided {
            self.outcome.decisions = self.outcome.decisions.saturating_add(1);
            for watcher in &mut *self.watchers {
                watcher.decided(at)?;
            }
        }
        self.show()
    }

    /// What the run itself keeps of an event.
    fn note(&mut self, event: &Event) {
        match event {
            Event::Request { user, goal, .. } => {
                let user = self.scenario.participant(*user).map(|participant| participant.person.clone());
                self.outcome.requests.push(RequestOutcome {
                    user: user.unwrap_or_default(),
                    goal: self.scenario.goal_name(*goal).to_owned(),
                    asked: self.now(),
                    closed: None,
                    how: None,
                });
            }
            Event::Status { user, condition, truth } => {
                let stated = Stated { condition: condition.clone(), truth: *truth };
                if let Some(data) = self.data_of(*user) {
                    match data.status.iter_mut().find(|known| known.condition == *condition) {
                        Some(known) => *known = stated,
                        None => data.status.push(stated),
                    }
                }
            }
            Event::Context { user, attribute, value } => {
                let entry = (attribute.clone(), value.clone());
                if let Some(data) = self.data_of(*user) {
                    match data.context.iter_mut().find(|known| known.0 == *attribute) {
                        Some(known) => *known = entry,
                        None => data.context.push(entry),
                    }
                }
            }
            _ => {}
        }
    }

    fn data_of(&mut self, user: UserId) -> Option<&mut UserData> {
        let at = self.scenario.participants.iter().position(|known| known.pseudonym == user)?;
        self.data.get_mut(at)
    }

    fn outputs(&mut self, outputs: &[Output]) -> io::Result<()> {
        let at = self.now();
        for output in outputs {
            for watcher in &mut *self.watchers {
                watcher.output(at, output)?;
            }
            let sentence = self.narrator.output(output);
            self.tell(sentence)?;
            match output {
                Output::Record(Record::GoalStarted { served, .. }) => self.served = *served,
                Output::Record(_) => {}
                Output::Command(command) => self.obey(*command)?,
            }
        }
        Ok(())
    }

    fn obey(&mut self, command: Command) -> io::Result<()> {
        match command {
            Command::AskData { user, ask, within_ms } => {
                let within = Duration::from_millis(u64::from(within_ms));
                let at = self.scenario.participants.iter().position(|known| known.pseudonym == user);
                let behaviour = at.and_then(|at| self.scenario.behaviours.get(at));
                let after = behaviour.and_then(|behaviour| behaviour.answers_after);
                if after.is_none_or(|after| after > within) {
                    self.schedule_in(within, Event::DataTimeout { user, ask });
                }
                if let (Some(after), Some(data)) = (after, self.data_of(user).cloned()) {
                    self.schedule_in(after, Event::Data { user, ask, data });
                }
            }
            Command::Execute { execution, goal, task, action, place } => {
                let actions = self.scenario.actions.get(usize::from(goal.0));
                let bound = actions.and_then(|tasks| tasks.get(task)).and_then(|task| task.get(action));
                let specified = self.scenario.specification.goals.get(usize::from(goal.0));
                let name = specified.and_then(|goal| goal.tasks.get(task)?.actions.get(action));
                let Some((bound, name)) = bound.zip(name) else {
                    self.schedule_in(Duration::ZERO, Event::ActionFailed { execution });
                    return Ok(());
                };
                let sentence = self.narrator.action(goal, name, bound);
                self.tell(sentence)?;
                self.execute(execution, bound, place);
            }
            Command::Stop { execution } => {
                let stopped = self.executing.take_if(|executing| executing.execution == execution);
                if let Some(Executing { what: Work::Driving(_), .. }) = stopped {
                    self.told = sim::Command::Cancel;
                }
                if let Some(following) = self.following.take() {
                    following.go_back(&mut self.world);
                }
            }
            Command::NextRound => self.schedule_in(self.scenario.round, Event::NextRound),
            Command::Close { user, how } => {
                self.close(user, HowItEnded::Closed(how));
                self.say_goodbye(user, how);
            }
            Command::Refuse { user, why, .. } => self.close(user, HowItEnded::Refused(why)),
            Command::Wait { .. } | Command::CallStaff { .. } => {}
        }
        Ok(())
    }

    fn execute(&mut self, execution: ExecutionId, action: &Action, place: Place) {
        let what = match action {
            Action::Meet => {
                let at = usize::try_from(place.0).ok();
                let place = at.and_then(|at| self.scenario.places.get(at)).cloned();
                self.drive_to(place.unwrap_or_default())
            }
            Action::Drive(place) => self.drive_to(place.clone()),
            Action::Guide(place) => {
                if let Served::User(user) = self.served
                    && let Some(participant) = self.scenario.participant(user)
                {
                    self.following = Some(Following::new(&participant.person, &self.world));
                }
                self.drive_to(place.clone())
            }
            Action::Wait(time) | Action::Say(_, time) => Work::Until(self.now().saturating_add(*time)),
        };
        self.executing = Some(Executing { execution, what });
    }

    fn drive_to(&mut self, place: String) -> Work {
        self.told = sim::Command::GoTo { place: place.clone() };
        Work::Driving(place)
    }

    fn stop_following(&mut self) {
        if let Some(following) = self.following.take() {
            following.stay(&mut self.world);
        }
    }

    /// The user's last open request ends.
    fn close(&mut self, user: UserId, how: HowItEnded) {
        let (now, scenario) = (self.now(), self.scenario);
        let Some(participant) = scenario.participant(user) else { return };
        let mut open = self
            .outcome
            .requests
            .iter_mut()
            .filter(|request| request.user == participant.person && request.how.is_none());
        // A refusal is of the request that has just come, anything else of the one kept.
        let request = match how {
            HowItEnded::Refused(_) => open.next_back(),
            HowItEnded::Closed(_) => open.next(),
        };
        if let Some(request) = request {
            request.closed = Some(now);
            request.how = Some(how);
        }
    }

    fn say_goodbye(&mut self, user: UserId, how: Closing) {
        let at = self.scenario.participants.iter().position(|known| known.pseudonym == user);
        let leaves = at.and_then(|at| self.scenario.behaviours.get(at)).is_some_and(|user| user.leaves);
        if leaves && how == Closing::Reached {
            self.following = None;
            if let Some(participant) = self.scenario.participant(user) {
                // Who has no place in the world need not leave it.
                let _ = self.world.remove_person(&participant.person);
            }
        }
    }

    /// Why the run is over, if it is.
    fn is_over(&self) -> Option<Ended> {
        if self.mission.is_over() {
            return Some(Ended::ShutDown);
        }
        let busy = self.executing.is_some() || self.told != sim::Command::Continue;
        if self.outstanding.is_empty() && !busy && self.idle {
            return Some(Ended::Idle);
        }
        (self.now() >= self.scenario.until).then_some(Ended::TimeUp)
    }

    /// One step of the world.
    fn step(&mut self) -> io::Result<()> {
        let before = *self.world.robot();
        let events = self.world.step(std::mem::take(&mut self.told));
        let after = self.world.robot();
        if before.floor == after.floor {
            self.outcome.metres += before.pose.position.distance(after.pose.position);
        }
        let happened = !events.is_empty();
        for event in events {
            let sentence = self.narrator.world(&event);
            self.tell(sentence)?;
            self.moved(&event);
        }
        let now = self.now();
        if let Some(Executing { execution, what: Work::Until(end) }) = self.executing
            && end <= now
        {
            self.executing = None;
            self.schedule(now, Event::ActionDone { execution }, None);
        }
        if now >= self.next_show {
            if let Some(mut following) = self.following.take()
                && following.go_on(&mut self.world)
            {
                self.following = Some(following);
            }
            self.show()?;
        } else if happened {
            self.show()?;
        }
        Ok(())
    }

    /// What the robot's way means for the action under way.
    fn moved(&mut self, event: &sim::Event) {
        let now = self.now();
        let under_way = |place: &String| {
            let executing = self.executing.as_ref()?;
            matches!(&executing.what, Work::Driving(to) if to == place).then_some(executing.execution)
        };
        match event {
            sim::Event::Arrived { place } => {
                let arrived = under_way(place);
                self.reached.push(place.clone());
                if let Some(execution) = arrived {
                    self.executing = None;
                    self.stop_following();
                    self.schedule(now, Event::ActionDone { execution }, None);
                }
            }
            sim::Event::Unreachable { place, .. } | sim::Event::Blocked { place, .. } => {
                if let Some(execution) = under_way(place) {
                    self.executing = None;
                    self.stop_following();
                    let what = match event {
                        sim::Event::Unreachable { reason, .. } => reason.to_string(),
                        _ => format!("the way to {place:?} is blocked"),
                    };
                    self.outcome.failures.push(Failure { at: now, what });
                    self.schedule(now, Event::ActionFailed { execution }, None);
                }
            }
            _ => {}
        }
    }

    fn tell(&mut self, sentence: Option<String>) -> io::Result<()> {
        let at = self.now();
        if let Some(sentence) = sentence {
            for watcher in &mut *self.watchers {
                watcher.sentence(at, &sentence)?;
            }
        }
        Ok(())
    }

    fn show(&mut self) -> io::Result<()> {
        let at = self.now();
        self.next_show = at.saturating_add(SHOWN_EVERY);
        for watcher in &mut *self.watchers {
            watcher.world(at, &self.world)?;
        }
        Ok(())
    }

    fn end(mut self, ended: Ended) -> io::Result<Outcome> {
        let at = self.now();
        if ended == Ended::TimeUp {
            self.tell(Some("The scenario's time is up.".to_owned()))?;
        }
        for watcher in &mut *self.watchers {
            watcher.end(at)?;
        }
        let happenings = &self.scenario.happenings;
        let keys = self.outstanding.iter().filter_map(|&nth| happenings.get(nth));
        let never_happened = if ended == Ended::ShutDown {
            // What comes after the end is not expected to have an effect.
            Vec::new()
        } else {
            keys.map(|happening| happening.key.clone()).collect()
        };
        Ok(Outcome { ended, after: at, never_happened, ..self.outcome })
    }
}
