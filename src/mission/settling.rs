//! What follows from a state: the rules that are applied after every event.

use super::command::{Command, Output, Staff, Waiting};
use super::event::{AskId, ExecutionId, UserId};
use super::fault::Fault;
use super::hard_ethics;
use super::lifecycle::{Lifecycle, Transition};
use super::lifecycle_manager::transit;
use super::machine::{Power, State, call_staff};
use super::negotiation::{Next, Pair};
use super::record::{Component, Dropped, GoalEnd, Record, Served};
use super::request_queue::Stage;
use super::specification::MissionRules;
use super::user_managers::UserManagers;

impl State {
    /// Applies the rules, the most urgent first, until none has anything to do.
    pub(super) fn apply_rules(&mut self, rules: &MissionRules, out: &mut Vec<Output>) {
        while self.abandon_goal(rules, out)
            || self.power_off(out)
            || self.act_on_emergency(rules, out)
            || self.close_empty_negotiations(out)
            || self.begin_next(rules, out)
            || self.invite_interrupter(rules, out)
            || self.decide(rules, out)
            || self.proceed(rules, out)
        {}
    }

    /// A goal that nobody wants any more ends at the next safe point.
    fn abandon_goal(&mut self, rules: &MissionRules, out: &mut Vec<Output>) -> bool {
        let unwanted =
            self.controller.pursuit.as_ref().is_some_and(|pursuit| pursuit.served == Served::Nobody);
        if !unwanted || !self.controller.is_at_safe_point(rules) {
            return false;
        }
        self.leave_goal(GoalEnd::Abandoned, out);
        true
    }

    /// An ending mission is over once the robot is at a safe point.
    fn power_off(&mut self, out: &mut Vec<Output>) -> bool {
        if self.power != Power::Ending || self.controller.pursuit.is_some() {
            return false;
        }
        self.power = Power::Off;
        self.users.finalize(out);
        for (lifecycle, component) in [
            (&mut self.negotiation.lifecycle, Component::NegotiationManager),
            (&mut self.interruptions.lifecycle, Component::InterruptionManager),
            (&mut self.controller.lifecycle, Component::MissionController),
        ] {
            transit(lifecycle, Transition::Shutdown, component, None, out);
        }
        out.push(Output::Record(Record::ShutDown));
        true
    }

    /// The gravest emergency goes before everything but an emergency at least as grave.
    fn act_on_emergency(&mut self, rules: &MissionRules, out: &mut Vec<Output>) -> bool {
        let Some(gravest) = self.hard.gravest(rules) else { return false };
        let pursuit = self.controller.pursuit.as_ref();
        let graver = match pursuit.map(|pursuit| pursuit.served) {
            Some(Served::Emergency(now)) => {
                hard_ethics::gravity(gravest, rules) > hard_ethics::gravity(now, rules)
            }
            _ => true,
        };
        if !graver || !self.controller.is_at_safe_point(rules) {
            return false;
        }
        let Some((category, place)) = self.hard.take_gravest(rules) else { return false };
        let Some((_, goal)) = rules.category_of(category) else { return false };
        self.drop_negotiations(Dropped::Emergency, out);
        let candidates: Vec<UserId> = self.interruptions.candidates().collect();
        for user in candidates {
            self.users.release(user, self.faults, out);
            self.defer(user, Stage::Fresh, Waiting::Emergency, rules, out);
        }
        self.displace(Stage::Deferred, Waiting::Emergency, rules, out);
        let served = Served::Emergency(category);
        out.push(Output::Record(Record::GoalStarted { served, goal }));
        self.controller.start(served, goal, place);
        true
    }

    /// A decision for which there is nobody left is over.
    fn close_empty_negotiations(&mut self, out: &mut Vec<Output>) -> bool {
        if !self.negotiation.is_open() || self.participants().len() >= 2 {
            return false;
        }
        self.drop_negotiations(Dropped::NobodyLeft, out);
        true
    }

    /// A free robot serves whoever is ready; with nobody ready it asks the first who waits.
    fn begin_next(&mut self, rules: &MissionRules, out: &mut Vec<Output>) -> bool {
        if self.power != Power::On || self.controller.pursuit.is_some() {
            return false;
        }
        let mut candidates = self.interruptions.candidates();
        match (candidates.next(), candidates.next()) {
            (None, _) => {
                drop(candidates);
                self.interruptions.first_waiting().is_some_and(|user| self.ask(user, rules, out))
            }
            (Some(only), None) => {
                drop(candidates);
                let ready = self.interruptions.stage(only) == Some(Stage::Ready);
                ready && self.serve(only, out)
            }
            (Some(_), Some(_)) => false,
        }
    }

    /// Where the current user may be interrupted, whoever wants to is asked for data.
    fn invite_interrupter(&mut self, rules: &MissionRules, out: &mut Vec<Output>) -> bool {
        if self.current_user().is_none() || !self.controller.is_at_safe_point(rules) || !self.users.has_room()
        {
            return false;
        }
        let Some(user) = self.interruptions.first_fresh() else { return false };
        if !self.negotiation.is_open() {
            let component = Component::NegotiationManager;
            transit(&mut self.negotiation.lifecycle, Transition::Configure, component, None, out);
        }
        self.ask(user, rules, out)
    }

    /// Holds the next negotiation, once both users' data are there, or acts on what all of
    /// them came to.
    fn decide(&mut self, rules: &MissionRules, out: &mut Vec<Output>) -> bool {
        if !self.negotiation.is_open() || self.negotiation.pair.is_some() {
            return false;
        }
        let participants = self.participants();
        let managers: Vec<&UserManagers> =
            participants.iter().filter_map(|&user| self.users.of(user)).collect();
        match self.negotiation.next(&participants, &managers, rules) {
            Err(_) | Ok(None) => false,
            Ok(Some(Next::Negotiate(current, interrupting))) => {
                self.start_pair(current, interrupting, rules, out)
            }
            Ok(Some(Next::Decided { policy, agreement, served, rounds })) => {
                let options = rules.options;
                out.push(Output::Record(Record::Decided {
                    policy,
                    options,
                    participants: participants.clone(),
                    agreement,
                    served,
                    rounds,
                }));
                self.act_on_decision(served, &participants, rules, out);
                true
            }
        }
    }

    fn start_pair(
        &mut self,
        current: UserId,
        interrupting: UserId,
        rules: &MissionRules,
        out: &mut Vec<Output>,
    ) -> bool {
        let ready = |user| matches!(self.interruptions.stage(user), Some(Stage::Ready | Stage::Served));
        if !ready(current) || !ready(interrupting) {
            return false;
        }
        if self.negotiation.lifecycle == Lifecycle::Inactive {
            let component = Component::NegotiationManager;
            transit(&mut self.negotiation.lifecycle, Transition::Activate, component, None, out);
            let close = self.controller.pursuit.as_ref().is_some_and(|pursuit| {
                pursuit.percent_done(rules) >= usize::from(rules.specification.willingness.from_percent)
            });
            self.negotiation.willingness = if close { rules.options.willingness } else { 0 };
        }
        for user in [current, interrupting] {
            if let Some(goal) = self.interruptions.requests.get(user).map(|request| request.goal()) {
                self.users.snapshot(user, goal, rules, out);
            }
        }
        let serves = self.current_user() == Some(current);
        let willingness = if serves { self.negotiation.willingness } else { 0 };
        self.negotiation.pair = Some(Pair { current, interrupting, willingness, rounds: 0 });
        out.push(Output::Record(Record::NegotiationStarted { current, interrupting, willingness }));
        let speechless = |user| self.users.of(user).is_some_and(|managers| !managers.offers.has_conditions());
        let hangs = speechless(current) || speechless(interrupting);
        if !(hangs && self.faults.has(Fault::HangWithoutConditions)) {
            out.push(Output::Command(Command::NextRound));
        }
        false
    }

    /// Whoever has no precedence is wiped, and the request waits.
    fn act_on_decision(
        &mut self,
        served: UserId,
        participants: &[UserId],
        rules: &MissionRules,
        out: &mut Vec<Output>,
    ) {
        self.end_negotiations(out);
        let current = self.current_user();
        if current != Some(served) {
            self.displace(Stage::Deferred, Waiting::NoPrecedence, rules, out);
        }
        for &user in participants {
            if user != served && Some(user) != current {
                self.users.release(user, self.faults, out);
                self.defer(user, Stage::Deferred, Waiting::NoPrecedence, rules, out);
            }
        }
        if current != Some(served) {
            self.serve(served, out);
        }
    }

    /// The next action, if there is nothing to wait for.
    fn proceed(&mut self, rules: &MissionRules, out: &mut Vec<Output>) -> bool {
        let undecided = self.negotiation.is_open();
        let Some(pursuit) = &mut self.controller.pursuit else { return false };
        let Some(task) = pursuit.current_task(rules).filter(|_| pursuit.execution.is_none()) else {
            return false;
        };
        let interruptible = task.interruptible;
        if pursuit.action == 0 && !interruptible && undecided {
            if !pursuit.held {
                out.push(Output::Record(Record::Held { task: pursuit.task }));
            }
            pursuit.held = true;
            return false;
        }
        let (goal, task, action, place) = (pursuit.goal, pursuit.task, pursuit.action, pursuit.place);
        pursuit.held = false;
        if action == 0 {
            out.push(Output::Record(Record::TaskStarted { goal, task, interruptible }));
        }
        let execution = ExecutionId(self.fresh_number());
        if let Some(pursuit) = &mut self.controller.pursuit {
            pursuit.execution = Some(execution);
        }
        out.push(Output::Command(Command::Execute { execution, goal, task, action, place }));
        true
    }

    /// Who takes part in a decision: the current user, and all candidates by arrival.
    fn participants(&self) -> Vec<UserId> {
        self.current_user().into_iter().chain(self.interruptions.candidates()).collect()
    }

    /// Asks a user for data. Only now are there components for the user.
    fn ask(&mut self, user: UserId, rules: &MissionRules, out: &mut Vec<Output>) -> bool {
        if !self.users.assign(user, out) {
            return false;
        }
        let ask = AskId(self.fresh_number());
        self.set_stage(user, Stage::Awaited(ask));
        let within_ms = rules.limits().data_within_ms;
        out.push(Output::Command(Command::AskData { user, ask, within_ms }));
        true
    }

    fn serve(&mut self, user: UserId, out: &mut Vec<Output>) -> bool {
        let Some(request) = self.interruptions.requests.get_mut(user) else { return false };
        request.stage = Stage::Served;
        let (goal, place, served) = (request.goal(), request.place(), Served::User(user));
        out.push(Output::Record(Record::GoalStarted { served, goal }));
        self.controller.start(served, goal, place);
        self.users.drop_snapshot(user, out);
        true
    }

    /// Stops the goal under way for another one: its user is wiped and waits, its emergency
    /// waits.
    fn displace(&mut self, stage: Stage, why: Waiting, rules: &MissionRules, out: &mut Vec<Output>) {
        let Some(pursuit) = &self.controller.pursuit else { return };
        let (served, goal, place) = (pursuit.served, pursuit.goal, pursuit.place);
        self.leave_goal(GoalEnd::Preempted, out);
        match served {
            Served::User(user) => {
                self.users.release(user, self.faults, out);
                self.defer(user, stage, why, rules, out);
            }
            Served::Emergency(category) => {
                if !self.hard.keep_first(category, place) {
                    call_staff(None, goal, place, Staff::NoRoom, out);
                }
            }
            Served::Nobody => {}
        }
    }

    fn leave_goal(&mut self, end: GoalEnd, out: &mut Vec<Output>) {
        let Some(pursuit) = self.controller.pursuit.take() else { return };
        if end == GoalEnd::Preempted && self.faults.has(Fault::LeaveGoalRunning) {
            return;
        }
        if let Some(execution) = pursuit.execution {
            out.push(Output::Command(Command::Stop { execution }));
        }
        out.push(Output::Record(Record::GoalEnded { served: pursuit.served, goal: pursuit.goal, end }));
    }
}
