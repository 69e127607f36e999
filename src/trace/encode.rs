//! Events and replies as messages: an open half, and what is personal apart from it.

use selfneg_core::{Options, Rank};

use super::schema::evidence::{self as open, command::Command as OpenCommand, record::Record as OpenRecord};
use super::schema::personal::{self, input, reply};
use super::topic::{Topic, Whose};
use crate::input::Truth;
use crate::mission::{
    ActiveProfile, Closing, Command, Component, Disclosed, Dropped, Event, Evidence, GoalEnd, Lifecycle,
    Output, Place, Profile, Record, Refusal, Round, Served, Staff, Stated, Text, Transition, Unusable,
    UserData, UserId, Waiting,
};

/// An event in its two halves.
#[derive(Clone, Debug, PartialEq)]
pub struct EncodedEvent {
    /// What is nobody's data.
    pub open: open::Event,
    /// What is somebody's, if anything.
    pub personal: Option<(Whose, personal::Input)>,
}

/// The open half of a reply.
#[derive(Clone, Debug, PartialEq)]
pub enum Open {
    /// Of a record.
    Record(open::Record),
    /// Of a command.
    Command(open::Command),
}

/// A reply in its halves.
#[derive(Clone, Debug, PartialEq)]
pub struct EncodedOutput {
    /// Where the open half goes.
    pub topic: Topic,
    /// What is nobody's data.
    pub open: Open,
    /// What is somebody's: of a round one message each about its two users.
    pub personal: Vec<(Whose, personal::Reply)>,
}

/// Gives events and replies their indices, and splits them. What a writer and a replay encode
/// alike is alike.
#[derive(Clone, Debug, Default)]
pub struct Encoder {
    next: u64,
    /// Whom the robot serves, whose meeting place an execution names.
    served: Option<UserId>,
}

impl Encoder {
    /// How many events and replies there were.
    #[must_use]
    pub const fn count(&self) -> u64 {
        self.next
    }

    /// Whom the robot serves, as far as the replies have said.
    #[must_use]
    pub const fn served(&self) -> Option<UserId> {
        self.served
    }

    /// The next event in its halves.
    #[must_use]
    pub fn event(&mut self, event: &Event) -> EncodedEvent {
        encode_event(self.advance(), event)
    }

    /// The next reply in its halves.
    #[must_use]
    pub fn output(&mut self, output: &Output) -> EncodedOutput {
        match output {
            Output::Record(Record::GoalStarted { served: Served::User(user), .. }) => {
                self.served = Some(*user);
            }
            Output::Record(Record::GoalStarted { .. } | Record::GoalEnded { .. }) => self.served = None,
            _ => {}
        }
        encode_output(self.advance(), output, self.served)
    }

    fn advance(&mut self) -> u64 {
        let index = self.next;
        self.next = self.next.saturating_add(1);
        index
    }
}

fn encode_event(index: u64, event: &Event) -> EncodedEvent {
    use input::Input;
    use open::event::Event as Open;
    let about = |user: UserId| open::About { user: user.0 };
    let (open, personal) = match event {
        Event::Request { user, goal, place } => (
            Open::Request(open::Request { user: user.0, goal: u32::from(goal.0) }),
            Some((Some(*user), Input::Place(place.0))),
        ),
        Event::Data { user, ask, data } => (
            Open::Data(open::Answer { user: user.0, ask: ask.0 }),
            Some((Some(*user), Input::Data(user_data(data)))),
        ),
        Event::DataTimeout { user, ask } => {
            (Open::DataTimeout(open::Answer { user: user.0, ask: ask.0 }), None)
        }
        Event::Context { user, attribute: name, value } => {
            (Open::Context(about(*user)), Some((Some(*user), Input::Context(attribute(name, value)))))
        }
        Event::Status { user, condition, truth } => (
            Open::Status(about(*user)),
            Some((Some(*user), Input::Status(stated(condition.as_str(), *truth)))),
        ),
        Event::ActionDone { execution } => {
            (Open::ActionDone(open::Execution { execution: execution.0 }), None)
        }
        Event::ActionFailed { execution } => {
            (Open::ActionFailed(open::Execution { execution: execution.0 }), None)
        }
        Event::NextRound => (Open::NextRound(open::Nothing {}), None),
        Event::Emergency { category, place, evidence } => (
            Open::Emergency(open::EmergencyClaim {
                category: u32::from(category.0),
                evidence: evidence_of(*evidence).into(),
            }),
            Some((None, Input::Place(place.0))),
        ),
        Event::Withdraw { user } => (Open::Withdraw(about(*user)), None),
        Event::Shutdown => (Open::Shutdown(open::Nothing {}), None),
    };
    let personal = personal.map(|(user, input)| {
        let message = personal::Input { index, user: user.map(|user| user.0), input: Some(input) };
        (whose(user), message)
    });
    EncodedEvent { open: open::Event { index, event: Some(open) }, personal }
}

fn encode_output(index: u64, output: &Output, served: Option<UserId>) -> EncodedOutput {
    let (topic, open, personal) = match output {
        Output::Command(command) => {
            let (open, personal) = encode_command(command, served);
            let open = Open::Command(open::Command { index, command: Some(open) });
            (Topic::COMMAND, open, personal)
        }
        Output::Record(record) => {
            let (open, personal) = encode_record(record);
            let open = Open::Record(open::Record { index, record: Some(open) });
            (Topic::of_record(record), open, personal)
        }
    };
    let reply = |(user, reply): (Option<UserId>, reply::Reply)| {
        (whose(user), personal::Reply { index, user: user.map(|user| user.0), reply: Some(reply) })
    };
    EncodedOutput { topic, open, personal: personal.into_iter().map(reply).collect() }
}

type Private = Vec<(Option<UserId>, reply::Reply)>;

fn at(user: Option<UserId>, place: Place) -> Private {
    vec![(user, reply::Reply::Place(place.0))]
}

fn encode_command(command: &Command, served: Option<UserId>) -> (OpenCommand, Private) {
    match *command {
        Command::AskData { user, ask, within_ms } => {
            (OpenCommand::AskData(open::AskData { user: user.0, ask: ask.0, within_ms }), Vec::new())
        }
        Command::Execute { execution, goal, task, action, place } => (
            OpenCommand::Execute(open::Execute {
                execution: execution.0,
                goal: u32::from(goal.0),
                task: wide(task),
                action: wide(action),
            }),
            at(served, place),
        ),
        Command::Stop { execution } => (OpenCommand::Stop(open::Stop { execution: execution.0 }), Vec::new()),
        Command::NextRound => (OpenCommand::NextRound(open::ProceedToNextRound {}), Vec::new()),
        Command::Wait { user, why } => {
            (OpenCommand::Wait(open::Wait { user: user.0, why: waiting(why).into() }), Vec::new())
        }
        Command::Refuse { user, goal, why } => (
            OpenCommand::Refuse(open::Refuse {
                user: user.0,
                goal: u32::from(goal.0),
                why: refusal(why).into(),
            }),
            Vec::new(),
        ),
        Command::Close { user, how } => {
            (OpenCommand::Close(open::Close { user: user.0, how: closing(how).into() }), Vec::new())
        }
        Command::CallStaff { user, goal, place, why } => (
            OpenCommand::CallStaff(open::CallStaff {
                user: user.map(|user| user.0),
                goal: u32::from(goal.0),
                why: staff(why).into(),
            }),
            at(user, place),
        ),
    }
}

#[expect(clippy::too_many_lines, reason = "one arm a record")]
fn encode_record(record: &Record) -> (OpenRecord, Private) {
    let subject = |user: &UserId| open::Subject { user: user.0 };
    let mut private = Vec::new();
    let open = match record {
        Record::Lifecycle { component, user, from, to } => OpenRecord::Lifecycle(open::LifecycleChange {
            component: component_of(*component).into(),
            user: user.map(|user| user.0),
            from: lifecycle(*from).into(),
            to: lifecycle(*to).into(),
        }),
        Record::IllegalTransition { component, refused } => {
            OpenRecord::IllegalTransition(open::IllegalTransition {
                component: component_of(*component).into(),
                from: lifecycle(refused.from).into(),
                transition: transition(refused.transition).into(),
            })
        }
        Record::Refused { user, goal, why } => OpenRecord::Refused(open::Refused {
            user: user.0,
            goal: u32::from(goal.0),
            why: refusal(*why).into(),
        }),
        Record::Admitted { user, goal } => {
            OpenRecord::Admitted(open::Admitted { user: user.0, goal: u32::from(goal.0) })
        }
        Record::Closed { user, how } => {
            OpenRecord::Closed(open::Closed { user: user.0, how: closing(*how).into() })
        }
        Record::StaffCalled { user, goal, why } => OpenRecord::StaffCalled(open::StaffCalled {
            user: user.map(|user| user.0),
            goal: u32::from(goal.0),
            why: staff(*why).into(),
        }),
        Record::Deferred { user, why, times } => OpenRecord::Deferred(open::Deferred {
            user: user.0,
            why: waiting(*why).into(),
            times: u32::from(*times),
        }),
        Record::DataAccepted { user } => OpenRecord::DataAccepted(subject(user)),
        Record::DataMissing { user } => OpenRecord::DataMissing(subject(user)),
        Record::DataUnusable { user, why } => {
            OpenRecord::DataUnusable(open::DataUnusable { user: user.0, why: unusable(*why).into() })
        }
        Record::Ignored { what, user } => {
            OpenRecord::Ignored(open::Ignored { what: (*what).to_owned(), user: user.map(|user| user.0) })
        }
        Record::ProfileActivated { user, profile } => {
            let profile = match *profile {
                ActiveProfile::None => None,
                ActiveProfile::Own(nth) => Some(personal::active_profile::Profile::Own(u32::from(nth))),
                ActiveProfile::Normative(nth) => {
                    Some(personal::active_profile::Profile::Normative(u32::from(nth)))
                }
            };
            private.push((Some(*user), reply::Reply::Profile(personal::ActiveProfile { profile })));
            OpenRecord::ProfileActivated(subject(user))
        }
        Record::ProfileKept { user } => OpenRecord::ProfileKept(subject(user)),
        Record::Inferred { user, rule, holds } => {
            let inferred = personal::Inferred { rule: wide(*rule), holds: *holds };
            private.push((Some(*user), reply::Reply::Inferred(inferred)));
            OpenRecord::Inferred(subject(user))
        }
        Record::Wiped { user, component, left } => OpenRecord::Wiped(open::Wiped {
            user: user.0,
            component: component_of(*component).into(),
            left: wide(*left),
        }),
        Record::GoalStarted { served, goal } => OpenRecord::GoalStarted(open::GoalStarted {
            served: Some(served_of(*served)),
            goal: u32::from(goal.0),
        }),
        Record::TaskStarted { goal, task, interruptible } => OpenRecord::TaskStarted(open::TaskStarted {
            goal: u32::from(goal.0),
            task: wide(*task),
            interruptible: *interruptible,
        }),
        Record::Held { task } => OpenRecord::Held(open::Held { task: wide(*task) }),
        Record::GoalEnded { served, goal, end } => OpenRecord::GoalEnded(open::GoalEnded {
            served: Some(served_of(*served)),
            goal: u32::from(goal.0),
            end: goal_end(*end).into(),
        }),
        Record::NegotiationStarted { current, interrupting, willingness } => {
            OpenRecord::NegotiationStarted(open::NegotiationStarted {
                current: current.0,
                interrupting: interrupting.0,
                willingness: u32::from(*willingness),
            })
        }
        Record::Round { number, sender, receiver, round } => {
            let round = match round {
                Round::Offer { depth, discloses, value, threshold, verdict } => {
                    let disclosed = personal::Disclosed { disclosed: Some(disclosed(*discloses)) };
                    private.push((Some(*sender), reply::Reply::Disclosed(disclosed)));
                    let worth = personal::Worth { value: *value, threshold: *threshold };
                    private.push((Some(*receiver), reply::Reply::Worth(worth)));
                    let verdict = verdict_of(verdict).into();
                    open::round::Round::Offer(open::Offer { depth: wide(*depth), verdict })
                }
                Round::Quit => open::round::Round::Quit(open::Mark {}),
            };
            OpenRecord::Round(open::Round {
                number: *number,
                sender: sender.0,
                receiver: receiver.0,
                round: Some(round),
            })
        }
        Record::NegotiationEnded { current, interrupting, winner, rounds, ending } => {
            OpenRecord::NegotiationEnded(open::NegotiationEnded {
                current: current.0,
                interrupting: interrupting.0,
                winner: winner.map(|user| user.0),
                rounds: *rounds,
                ending: (*ending).to_owned(),
            })
        }
        Record::NegotiationsDropped { why } => {
            OpenRecord::NegotiationsDropped(open::NegotiationsDropped { why: dropped(*why).into() })
        }
        Record::Decided { policy, options, participants, agreement, served, rounds } => {
            OpenRecord::Decided(open::Decided {
                policy: policy.to_string(),
                options: Some(options_of(*options)),
                participants: participants.iter().map(|user| user.0).collect(),
                agreement: agreement.map(|user| user.0),
                served: served.0,
                rounds: *rounds,
            })
        }
        Record::EmergencyDecided { category, place, evidence } => {
            private.extend(at(None, *place));
            OpenRecord::EmergencyDecided(known(category.0, *evidence))
        }
        Record::EmergencyUnverified { category, place, evidence } => {
            private.extend(at(None, *place));
            OpenRecord::EmergencyUnverified(known(category.0, *evidence))
        }
        Record::ShuttingDown => OpenRecord::ShuttingDown(open::Mark {}),
        Record::ShutDown => OpenRecord::ShutDown(open::Mark {}),
    };
    (open, private)
}

fn known(category: u16, evidence: Evidence) -> open::EmergencyKnown {
    open::EmergencyKnown { category: u32::from(category), evidence: evidence_of(evidence).into() }
}

pub(super) fn options_of(options: Options) -> open::Options {
    open::Options {
        quit: options.quit.name().to_owned(),
        aggregation: options.aggregation.name().to_owned(),
        tie: options.tie.name().to_owned(),
        fallback: options.fallback.name().to_owned(),
        willingness: u32::from(options.willingness),
    }
}

pub(super) fn whose(user: Option<UserId>) -> Whose {
    user.map_or(Whose::Everyone, Whose::User)
}

fn wide(number: usize) -> u64 {
    u64::try_from(number).unwrap_or(u64::MAX)
}

fn attribute(name: &Text, value: &Text) -> personal::Attribute {
    personal::Attribute { name: name.as_str().to_owned(), value: value.as_str().to_owned() }
}

pub(super) fn stated(condition: &str, truth: Truth) -> personal::Stated {
    let truth = match truth {
        Truth::True => personal::Truth::True,
        Truth::False => personal::Truth::False,
        Truth::Withheld => personal::Truth::Withheld,
    };
    personal::Stated { condition: condition.to_owned(), truth: truth.into() }
}

pub(super) fn rank((disposition, Rank(rank)): (&str, Rank)) -> personal::Rank {
    personal::Rank { disposition: disposition.to_owned(), rank: u32::from(rank) }
}

fn user_data(data: &UserData) -> personal::UserData {
    let profile = |profile: &Profile| personal::Profile {
        label: profile.label.as_str().to_owned(),
        ranks: profile.ranks.iter().map(|(name, value)| rank((name.as_str(), Rank(*value)))).collect(),
    };
    let status = |one: &Stated| stated(one.condition.as_str(), one.truth);
    personal::UserData {
        profiles: data.profiles.iter().map(profile).collect(),
        status: data.status.iter().map(status).collect(),
        context: data.context.iter().map(|(name, value)| attribute(name, value)).collect(),
    }
}

fn disclosed(disclosed: Disclosed) -> personal::disclosed::Disclosed {
    match disclosed {
        Disclosed::Listed(nth) => personal::disclosed::Disclosed::Listed(u32::from(nth)),
        Disclosed::Unlisted(nth) => personal::disclosed::Disclosed::Unlisted(u32::from(nth)),
        Disclosed::Willingness => personal::disclosed::Disclosed::Willingness(true),
    }
}

fn served_of(served: Served) -> open::Served {
    let served = match served {
        Served::User(user) => Some(open::served::Served::User(user.0)),
        Served::Emergency(category) => Some(open::served::Served::Emergency(u32::from(category.0))),
        Served::Nobody => None,
    };
    open::Served { served }
}

/// A word that this format does not have stays unspecified; a replay then differs.
fn verdict_of(verdict: &str) -> open::Verdict {
    match verdict {
        "accept" => open::Verdict::Accept,
        "reject" => open::Verdict::Reject,
        "hold" => open::Verdict::Hold,
        _ => open::Verdict::Unspecified,
    }
}

fn evidence_of(evidence: Evidence) -> open::Evidence {
    match evidence {
        Evidence::Claimed => open::Evidence::Claimed,
        Evidence::Sensed => open::Evidence::Sensed,
        Evidence::Verified => open::Evidence::Verified,
    }
}

fn waiting(why: Waiting) -> open::Waiting {
    match why {
        Waiting::NotInterruptible => open::Waiting::NotInterruptible,
        Waiting::Queued => open::Waiting::Queued,
        Waiting::NoPrecedence => open::Waiting::NoPrecedence,
        Waiting::DataMissing => open::Waiting::DataMissing,
        Waiting::DataUnusable => open::Waiting::DataUnusable,
        Waiting::Emergency => open::Waiting::Emergency,
    }
}

fn refusal(why: Refusal) -> open::Refusal {
    match why {
        Refusal::UnknownGoal => open::Refusal::UnknownGoal,
        Refusal::Incapable => open::Refusal::Incapable,
        Refusal::AlreadyAsking => open::Refusal::AlreadyAsking,
    }
}

fn closing(how: Closing) -> open::Closing {
    match how {
        Closing::Reached => open::Closing::Reached,
        Closing::Failed => open::Closing::Failed,
        Closing::Withdrawn => open::Closing::Withdrawn,
        Closing::Staff(Staff::DeferredTooOften) => open::Closing::StaffDeferredTooOften,
        Closing::Staff(Staff::NoRoom) => open::Closing::StaffNoRoom,
        Closing::Staff(Staff::Shutdown) => open::Closing::StaffShutdown,
        Closing::Staff(Staff::EmergencyBeyondRobot) => open::Closing::StaffEmergencyBeyondRobot,
    }
}

fn staff(why: Staff) -> open::Staff {
    match why {
        Staff::DeferredTooOften => open::Staff::DeferredTooOften,
        Staff::NoRoom => open::Staff::NoRoom,
        Staff::Shutdown => open::Staff::Shutdown,
        Staff::EmergencyBeyondRobot => open::Staff::EmergencyBeyondRobot,
    }
}

fn component_of(component: Component) -> open::Component {
    match component {
        Component::MissionController => open::Component::MissionController,
        Component::InterruptionManager => open::Component::InterruptionManager,
        Component::NegotiationManager => open::Component::NegotiationManager,
        Component::ContextEthicsManager => open::Component::ContextEthicsManager,
        Component::OfferGenerator => open::Component::OfferGenerator,
        Component::EthicalImpactAnalyzer => open::Component::EthicalImpactAnalyzer,
    }
}

fn lifecycle(state: Lifecycle) -> open::Lifecycle {
    match state {
        Lifecycle::Unconfigured => open::Lifecycle::Unconfigured,
        Lifecycle::Inactive => open::Lifecycle::Inactive,
        Lifecycle::Active => open::Lifecycle::Active,
        Lifecycle::Finalized => open::Lifecycle::Finalized,
    }
}

fn transition(transition: Transition) -> open::Transition {
    match transition {
        Transition::Configure => open::Transition::Configure,
        Transition::Activate => open::Transition::Activate,
        Transition::Deactivate => open::Transition::Deactivate,
        Transition::Cleanup => open::Transition::Cleanup,
        Transition::Shutdown => open::Transition::Shutdown,
    }
}

fn unusable(why: Unusable) -> open::Unusable {
    match why {
        Unusable::NoLocation => open::Unusable::NoLocation,
        Unusable::UnknownContext => open::Unusable::UnknownContext,
        Unusable::TooMuch => open::Unusable::TooMuch,
        Unusable::NameTooLong => open::Unusable::NameTooLong,
    }
}

fn goal_end(end: GoalEnd) -> open::GoalEnd {
    match end {
        GoalEnd::Reached => open::GoalEnd::Reached,
        GoalEnd::Failed => open::GoalEnd::Failed,
        GoalEnd::Preempted => open::GoalEnd::Preempted,
        GoalEnd::Abandoned => open::GoalEnd::Abandoned,
    }
}

fn dropped(why: Dropped) -> open::Dropped {
    match why {
        Dropped::Emergency => open::Dropped::Emergency,
        Dropped::NobodyLeft => open::Dropped::NobodyLeft,
        Dropped::Shutdown => open::Dropped::Shutdown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A value's name here, as its type in the format writes it.
    fn named(kind: &str, value: impl serde::Serialize) -> String {
        let value = serde_json::to_value(value).unwrap();
        let name = match &value {
            serde_json::Value::Object(map) => {
                let (outer, inner) = map.iter().next().unwrap();
                format!("{outer}-{}", inner.as_str().unwrap())
            }
            value => value.as_str().unwrap().to_owned(),
        };
        format!("{kind}-{name}").replace('-', "_").to_uppercase()
    }

    macro_rules! same_names {
        ($kind:literal, $encode:path, $($value:expr),+) => {
            $( assert_eq!($encode($value).as_str_name(), named($kind, $value)); )+
        };
    }

    #[test]
    fn every_value_keeps_its_name() {
        same_names!("evidence", evidence_of, Evidence::Claimed, Evidence::Sensed, Evidence::Verified);
        same_names!(
            "waiting",
            waiting,
            Waiting::NotInterruptible,
            Waiting::Queued,
            Waiting::NoPrecedence,
            Waiting::DataMissing,
            Waiting::DataUnusable,
            Waiting::Emergency
        );
        same_names!("refusal", refusal, Refusal::UnknownGoal, Refusal::Incapable, Refusal::AlreadyAsking);
        same_names!("closing", closing, Closing::Reached, Closing::Failed, Closing::Withdrawn);
        for why in [Staff::DeferredTooOften, Staff::NoRoom, Staff::Shutdown, Staff::EmergencyBeyondRobot] {
            same_names!("staff", staff, why);
            same_names!("closing", closing, Closing::Staff(why));
        }
        same_names!(
            "component",
            component_of,
            Component::MissionController,
            Component::InterruptionManager,
            Component::NegotiationManager,
            Component::ContextEthicsManager,
            Component::OfferGenerator,
            Component::EthicalImpactAnalyzer
        );
        same_names!(
            "lifecycle",
            lifecycle,
            Lifecycle::Unconfigured,
            Lifecycle::Inactive,
            Lifecycle::Active,
            Lifecycle::Finalized
        );
        same_names!(
            "transition",
            transition,
            Transition::Configure,
            Transition::Activate,
            Transition::Deactivate,
            Transition::Cleanup,
            Transition::Shutdown
        );
        same_names!(
            "unusable",
            unusable,
            Unusable::NoLocation,
            Unusable::UnknownContext,
            Unusable::TooMuch,
            Unusable::NameTooLong
        );
        same_names!(
            "goal-end",
            goal_end,
            GoalEnd::Reached,
            GoalEnd::Failed,
            GoalEnd::Preempted,
            GoalEnd::Abandoned
        );
        same_names!("dropped", dropped, Dropped::Emergency, Dropped::NobodyLeft, Dropped::Shutdown);
        for verdict in ["accept", "reject", "hold"] {
            same_names!("verdict", verdict_of, verdict);
        }
    }
}
