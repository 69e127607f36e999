//! The mission's state machine: what each event does, and what follows from the state it
//! leaves.
//!
//! An event changes little by itself. Then *rules* are applied, the most urgent first, until
//! none has anything to do; so whatever the order of events, the same state is continued in
//! the same way.

use super::command::{Closing, Command, Output, Refusal, Staff, Waiting};
use super::context_ethics::Update;
use super::event::{AskId, CategoryId, Event, Evidence, ExecutionId, GoalId, Place, UserId};
use super::fault::{Fault, Faults};
use super::hard_ethics::{self, HardEthics};
use super::interruption_manager::{Admission, Deferral, InterruptionManager};
use super::lifecycle::{Lifecycle, Transition};
use super::lifecycle_manager::{LifecycleManager, bring_up, transit};
use super::mission_controller::MissionController;
use super::negotiation::{NegotiationManager, Pair, next_round};
use super::record::{Component, Disclosed, Dropped, GoalEnd, Record, Round, Served};
use super::request_queue::Stage;
use super::specification::MissionRules;
use super::user_data::UserData;
use super::user_managers::UserManagers;
use crate::transcript;

/// Whether the mission takes requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Power {
    On,
    /// It ends at the next safe point.
    Ending,
    Off,
}

/// Everything of a mission that changes.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct State {
    pub(super) power: Power,
    pub(super) controller: MissionController,
    pub(super) interruptions: InterruptionManager,
    pub(super) users: LifecycleManager,
    pub(super) negotiation: NegotiationManager,
    pub(super) hard: HardEthics,
    pub(super) next_number: u32,
    pub(super) faults: Faults,
}

impl State {
    pub(super) fn new(rules: &MissionRules, out: &mut Vec<Output>) -> Self {
        let mut state = Self {
            power: Power::On,
            controller: MissionController::new(),
            interruptions: InterruptionManager::new(rules),
            users: LifecycleManager::new(rules),
            negotiation: NegotiationManager::new(rules),
            hard: HardEthics::new(rules),
            next_number: 0,
            faults: Faults::default(),
        };
        bring_up(&mut state.controller.lifecycle, Component::MissionController, out);
        bring_up(&mut state.interruptions.lifecycle, Component::InterruptionManager, out);
        state
    }

    /// Handles one event.
    pub(super) fn handle(&mut self, event: Event, rules: &MissionRules, out: &mut Vec<Output>) {
        match event {
            Event::Request { user, goal, place } => return self.request(user, goal, place, rules, out),
            Event::Data { user, ask, data } => self.data(user, ask, &data, rules, out),
            Event::DataTimeout { user, ask } => self.data_timeout(user, ask, rules, out),
            Event::Context { user, attribute, value } => {
                self.update(user, Update::Context(attribute.as_str(), value.as_str()), rules, out);
            }
            Event::Status { user, condition, truth } => {
                self.update(user, Update::Status(condition.as_str(), truth), rules, out);
            }
            Event::ActionDone { execution } => self.action_done(execution, rules, out),
            Event::ActionFailed { execution } => self.action_failed(execution, out),
            Event::NextRound => self.next_round(rules, out),
            Event::Emergency { category, place, evidence } => {
                self.emergency(category, place, evidence, rules, out);
            }
            Event::Withdraw { user } => self.withdraw(user, out),
            Event::Shutdown => self.shutdown(rules, out),
        }
        self.apply_rules(rules, out);
    }

    fn request(
        &mut self,
        user: UserId,
        goal: GoalId,
        place: Place,
        rules: &MissionRules,
        out: &mut Vec<Output>,
    ) {
        if self.power != Power::On {
            return call_staff(Some(user), goal, place, Staff::Shutdown, out);
        }
        let awaits_another = self
            .interruptions
            .candidates()
            .any(|candidate| matches!(self.interruptions.stage(candidate), Some(Stage::Awaited(_))));
        if awaits_another && self.faults.has(Fault::DropSecondInterruption) {
            return;
        }
        match self.interruptions.admit(user, goal, place, rules) {
            Admission::Refused(why) => return refuse(user, goal, why, out),
            Admission::NoRoom => return call_staff(Some(user), goal, place, Staff::NoRoom, out),
            Admission::Admitted => out.push(Output::Record(Record::Admitted { user, goal })),
        }
        self.apply_rules(rules, out);
        if self.interruptions.stage(user) == Some(Stage::Fresh) {
            let why = match self.controller.is_at_safe_point(rules) {
                true => Waiting::Queued,
                false => Waiting::NotInterruptible,
            };
            out.push(Output::Command(Command::Wait { user, why }));
        }
    }

    fn data(
        &mut self,
        user: UserId,
        ask: AskId,
        data: &UserData,
        rules: &MissionRules,
        out: &mut Vec<Output>,
    ) {
        let awaited = match self.interruptions.stage(user) {
            Some(Stage::Awaited(open)) => open == ask || self.faults.has(Fault::TakeLateData),
            _ => false,
        };
        let Some(managers) = self.users.of_mut(user).filter(|_| awaited) else {
            return out.push(Output::Record(Record::Ignored { what: "data", user: Some(user) }));
        };
        let tell = |record| out.push(Output::Record(record));
        match managers.context.update(Update::Data(data), user, rules, tell) {
            Ok(()) => {
                out.push(Output::Record(Record::DataAccepted { user }));
                self.users.activate_context(user, out);
                self.set_stage(user, Stage::Ready);
            }
            Err(why) => {
                out.push(Output::Record(Record::DataUnusable { user, why }));
                self.without_data(user, Waiting::DataUnusable, rules, out);
            }
        }
    }

    fn data_timeout(&mut self, user: UserId, ask: AskId, rules: &MissionRules, out: &mut Vec<Output>) {
        if self.interruptions.stage(user) != Some(Stage::Awaited(ask)) {
            return out.push(Output::Record(Record::Ignored { what: "data timeout", user: Some(user) }));
        }
        if self.faults.has(Fault::ForgetOnTimeout) {
            self.users.release(user, self.faults, out);
            return self.interruptions.requests.remove(user);
        }
        out.push(Output::Record(Record::DataMissing { user }));
        self.without_data(user, Waiting::DataMissing, rules, out);
    }

    /// A user without usable data cannot negotiate now. The request goes behind the others.
    fn without_data(&mut self, user: UserId, why: Waiting, rules: &MissionRules, out: &mut Vec<Output>) {
        self.users.release(user, self.faults, out);
        self.interruptions.requests.put_last(user);
        self.defer(user, Stage::Deferred, why, rules, out);
    }

    /// Takes note of a change. A negotiation under way has its snapshot, and does not.
    fn update(&mut self, user: UserId, update: Update<'_>, rules: &MissionRules, out: &mut Vec<Output>) {
        let active = |managers: &&mut UserManagers| managers.context.lifecycle == Lifecycle::Active;
        let Some(managers) = self.users.of_mut(user).filter(active) else {
            return out.push(Output::Record(Record::Ignored { what: "update", user: Some(user) }));
        };
        let tell = |record| out.push(Output::Record(record));
        if let Err(why) = managers.context.update(update, user, rules, tell) {
            out.push(Output::Record(Record::DataUnusable { user, why }));
        }
    }

    fn action_done(&mut self, execution: ExecutionId, rules: &MissionRules, out: &mut Vec<Output>) {
        match self.controller.pursuit.as_mut().filter(|pursuit| pursuit.execution == Some(execution)) {
            None => out.push(Output::Record(Record::Ignored { what: "action done", user: None })),
            Some(pursuit) => {
                if pursuit.advance(rules) {
                    self.end_goal(GoalEnd::Reached, out);
                }
            }
        }
    }

    fn action_failed(&mut self, execution: ExecutionId, out: &mut Vec<Output>) {
        match self.controller.pursuit.as_ref().filter(|pursuit| pursuit.execution == Some(execution)) {
            None => out.push(Output::Record(Record::Ignored { what: "action failed", user: None })),
            Some(_) => self.end_goal(GoalEnd::Failed, out),
        }
    }

    /// The goal came to its own end, and with it the user's part in any negotiation.
    fn end_goal(&mut self, end: GoalEnd, out: &mut Vec<Output>) {
        let Some(pursuit) = self.controller.pursuit.take() else { return };
        let (served, goal, place) = (pursuit.served, pursuit.goal, pursuit.place);
        out.push(Output::Record(Record::GoalEnded { served, goal, end }));
        match served {
            Served::User(user) => {
                let how = if end == GoalEnd::Reached { Closing::Reached } else { Closing::Failed };
                self.negotiation.leave(user);
                self.users.release(user, self.faults, out);
                self.close(user, how, out);
            }
            Served::Emergency(_) if end == GoalEnd::Failed => {
                call_staff(None, goal, place, Staff::EmergencyBeyondRobot, out);
            }
            Served::Emergency(_) | Served::Nobody => {}
        }
    }

    fn next_round(&mut self, rules: &MissionRules, out: &mut Vec<Output>) {
        let pair = self.negotiation.pair;
        let two =
            pair.as_ref().and_then(|pair| self.users.of(pair.current).zip(self.users.of(pair.interrupting)));
        let (Some(mut pair), Some((current, interrupting))) = (pair, two) else {
            return out.push(Output::Record(Record::Ignored { what: "next round", user: None }));
        };
        let Ok((round, conclusion)) = next_round(&pair, current, interrupting, rules) else {
            return out.push(Output::Record(Record::Ignored { what: "next round", user: None }));
        };
        pair.rounds = pair.rounds.saturating_add(1);
        if let Some(round) = round {
            out.push(Output::Record(round_record(&pair, round, rules)));
        }
        match conclusion {
            None => {
                self.negotiation.pair = Some(pair);
                out.push(Output::Command(Command::NextRound));
            }
            Some(conclusion) => {
                let Pair { current, interrupting, .. } = pair;
                let winner = conclusion.outcome.winner().map(|side| match side {
                    selfneg_core::Side::Current => current,
                    selfneg_core::Side::Interrupting => interrupting,
                });
                let (rounds, ending) = (conclusion.rounds, conclusion.ending.name());
                let ended = Record::NegotiationEnded { current, interrupting, winner, rounds, ending };
                out.push(Output::Record(ended));
                self.negotiation.settle(pair, conclusion.outcome);
            }
        }
    }

    /// Decides at once whether an emergency is certain. A claim that is not leaves no trace
    /// but its record.
    fn emergency(
        &mut self,
        category: CategoryId,
        place: Place,
        evidence: Evidence,
        rules: &MissionRules,
        out: &mut Vec<Output>,
    ) {
        let Some((_, goal)) = rules.category_of(category) else {
            return out.push(Output::Record(Record::Ignored { what: "emergency", user: None }));
        };
        let certain = hard_ethics::is_certain(category, evidence, rules);
        if !certain && !self.faults.has(Fault::BelieveClaims) {
            return out.push(Output::Record(Record::EmergencyUnverified { category, place, evidence }));
        }
        out.push(Output::Record(Record::EmergencyDecided { category, place, evidence }));
        if self.power != Power::On {
            call_staff(None, goal, place, Staff::Shutdown, out);
        } else if rules.within_capabilities(goal) != Some(true) {
            call_staff(None, goal, place, Staff::EmergencyBeyondRobot, out);
        } else if !self.hard.keep(category, place) {
            call_staff(None, goal, place, Staff::NoRoom, out);
        }
    }

    /// A user who withdraws is wiped at once, also if the robot has yet to reach a safe point
    /// on its way.
    fn withdraw(&mut self, user: UserId, out: &mut Vec<Output>) {
        if self.interruptions.stage(user).is_none() {
            return out.push(Output::Record(Record::Ignored { what: "withdrawal", user: Some(user) }));
        }
        self.nobody_instead_of(Served::User(user));
        self.negotiation.leave(user);
        self.users.release(user, self.faults, out);
        self.close(user, Closing::Withdrawn, out);
    }

    fn shutdown(&mut self, rules: &MissionRules, out: &mut Vec<Output>) {
        if self.power != Power::On {
            return out.push(Output::Record(Record::Ignored { what: "shutdown", user: None }));
        }
        self.power = Power::Ending;
        out.push(Output::Record(Record::ShuttingDown));
        self.drop_negotiations(Dropped::Shutdown, out);
        while let Some((user, goal, place)) = self.interruptions.requests.first() {
            self.nobody_instead_of(Served::User(user));
            self.users.release(user, self.faults, out);
            self.hand_over(user, goal, place, Staff::Shutdown, out);
        }
        while let Some((category, place)) = self.hard.take_gravest(rules) {
            if let Some((_, goal)) = rules.category_of(category) {
                call_staff(None, goal, place, Staff::Shutdown, out);
            }
        }
        let pursuit = self.controller.pursuit.as_ref();
        if let Some((served @ Served::Emergency(_), goal, place)) =
            pursuit.map(|pursuit| (pursuit.served, pursuit.goal, pursuit.place))
        {
            self.nobody_instead_of(served);
            call_staff(None, goal, place, Staff::Shutdown, out);
        }
    }
}

/// What events and rules have in common.
impl State {
    pub(super) fn set_stage(&mut self, user: UserId, stage: Stage) {
        if let Some(request) = self.interruptions.requests.get_mut(user) {
            request.stage = stage;
        }
    }

    /// A number that no open asking or execution has.
    pub(super) fn fresh_number(&mut self) -> u32 {
        let number = self.next_number;
        self.next_number = self.next_number.wrapping_add(1);
        number
    }

    /// Counts a deferral; from the specified number on the request goes to human staff.
    pub(super) fn defer(
        &mut self,
        user: UserId,
        stage: Stage,
        why: Waiting,
        rules: &MissionRules,
        out: &mut Vec<Output>,
    ) {
        match self.interruptions.defer(user, stage, rules) {
            Deferral::Waits(times) => {
                out.push(Output::Record(Record::Deferred { user, why, times }));
                out.push(Output::Command(Command::Wait { user, why }));
            }
            Deferral::TooOften => {
                let Some(request) = self.interruptions.requests.get(user) else { return };
                let (goal, place) = (request.goal(), request.place());
                self.hand_over(user, goal, place, Staff::DeferredTooOften, out);
            }
        }
    }

    pub(super) fn close(&mut self, user: UserId, how: Closing, out: &mut Vec<Output>) {
        self.interruptions.requests.remove(user);
        out.push(Output::Record(Record::Closed { user, how }));
        out.push(Output::Command(Command::Close { user, how }));
    }

    fn hand_over(&mut self, user: UserId, goal: GoalId, place: Place, why: Staff, out: &mut Vec<Output>) {
        self.interruptions.requests.remove(user);
        call_staff(Some(user), goal, place, why, out);
    }

    /// The robot goes on to a safe point, but no longer for `served`.
    fn nobody_instead_of(&mut self, served: Served) {
        if let Some(pursuit) = self.controller.pursuit.as_mut().filter(|pursuit| pursuit.served == served) {
            pursuit.served = Served::Nobody;
        }
    }

    /// Ends the open decision, with or without an outcome, and wipes the current user's
    /// snapshot.
    pub(super) fn end_negotiations(&mut self, out: &mut Vec<Output>) {
        if !self.negotiation.is_open() {
            return;
        }
        self.negotiation.clear();
        let component = Component::NegotiationManager;
        if self.negotiation.lifecycle == Lifecycle::Active {
            transit(&mut self.negotiation.lifecycle, Transition::Deactivate, component, None, out);
        }
        transit(&mut self.negotiation.lifecycle, Transition::Cleanup, component, None, out);
        if let Some(user) = self.current_user() {
            self.users.drop_snapshot(user, out);
        }
    }

    pub(super) fn drop_negotiations(&mut self, why: Dropped, out: &mut Vec<Output>) {
        if self.negotiation.is_open() {
            out.push(Output::Record(Record::NegotiationsDropped { why }));
            self.end_negotiations(out);
        }
    }

    /// The user whom the robot serves.
    pub(super) fn current_user(&self) -> Option<UserId> {
        match self.controller.pursuit.as_ref()?.served {
            Served::User(user) => Some(user),
            Served::Emergency(_) | Served::Nobody => None,
        }
    }

    /// How many bytes of user data the mission's memory holds, as far as they are not zero.
    pub(super) fn residue(&self) -> usize {
        let users: usize = self.users.all().iter().map(UserManagers::residue).sum();
        [
            users,
            self.interruptions.requests.residue(),
            self.negotiation.residue(),
            self.hard.residue(),
            usize::from(self.controller.pursuit.is_some()),
        ]
        .into_iter()
        .sum()
    }
}

/// Calls human staff, and tells the user, if there is one, that the request is closed.
pub(super) fn call_staff(
    user: Option<UserId>,
    goal: GoalId,
    place: Place,
    why: Staff,
    out: &mut Vec<Output>,
) {
    out.push(Output::Record(Record::StaffCalled { user, goal, why }));
    out.push(Output::Command(Command::CallStaff { user, goal, place, why }));
    if let Some(user) = user {
        let how = Closing::Staff(why);
        out.push(Output::Record(Record::Closed { user, how }));
        out.push(Output::Command(Command::Close { user, how }));
    }
}

fn refuse(user: UserId, goal: GoalId, why: Refusal, out: &mut Vec<Output>) {
    out.push(Output::Record(Record::Refused { user, goal, why }));
    out.push(Output::Command(Command::Refuse { user, goal, why }));
}

fn round_record(pair: &Pair, round: transcript::Round, rules: &MissionRules) -> Record {
    let (sender, receiver) = match round.sender {
        selfneg_core::Side::Current => (pair.current, pair.interrupting),
        selfneg_core::Side::Interrupting => (pair.interrupting, pair.current),
    };
    let what = match round.event {
        transcript::Event::Quit => Round::Quit,
        transcript::Event::Offer { depth, discloses, weighing, ruling } => Round::Offer {
            depth,
            discloses: disclosed(discloses, rules),
            value: weighing.value.0,
            threshold: weighing.threshold.0,
            verdict: ruling.name(),
        },
    };
    Record::Round { number: round.number, sender, receiver, round: what }
}

fn disclosed(discloses: selfneg_core::Disclosure, rules: &MissionRules) -> Disclosed {
    match discloses {
        selfneg_core::Disclosure::Willingness => Disclosed::Willingness,
        selfneg_core::Disclosure::Condition(condition) => {
            let beyond = usize::from(condition.0).checked_sub(rules.bound().conditions());
            match beyond.and_then(|nth| u16::try_from(nth).ok()) {
                Some(nth) => Disclosed::Unlisted(nth),
                None => Disclosed::Listed(condition.0),
            }
        }
    }
}
