//! Tells a run to people: one plain sentence for whatever is worth it.

use selfneg_core::Fallback;
use selfneg_sim as sim;

use super::watcher::Participant;
use crate::input::Truth;
use crate::mission::{
    CategoryId, Command, Component, Disclosed, Event, Evidence, GoalEnd, GoalId, Output, Place, Record,
    Refusal, Round, Served, Staff, UserId, Waiting,
};
use crate::scenario::{Action, Scenario};

/// Knows what was told last, so as not to repeat it.
#[derive(Debug)]
pub(super) struct Narrator<'a> {
    scenario: &'a Scenario,
    /// Whom the robot was last told to wait for on the present way.
    waits_for: Option<String>,
    /// Who has disclosed something in the present negotiation.
    has_disclosed: Vec<UserId>,
}

impl<'a> Narrator<'a> {
    pub(super) fn new(scenario: &'a Scenario) -> Self {
        Self { scenario, waits_for: None, has_disclosed: Vec::new() }
    }

    fn name(&self, user: UserId) -> &'a str {
        self.scenario.participant(user).map_or("somebody", |participant| participant.person.as_str())
    }

    fn goal(&self, goal: GoalId) -> &'a str {
        self.scenario.goal_name(goal)
    }

    fn place(&self, place: Place) -> &'a str {
        let at = usize::try_from(place.0).ok();
        at.and_then(|at| self.scenario.places.get(at)).map_or("?", String::as_str)
    }

    fn category(&self, category: CategoryId) -> &'a str {
        let known = &self.scenario.specification.emergencies;
        known.get(usize::from(category.0)).map_or("?", |category| category.name.as_str())
    }

    fn floor(&self, floor: usize) -> &'a str {
        self.scenario.world.building().floors().get(floor).map_or("?", |floor| floor.name.as_str())
    }

    /// What there is to say of an event before it is handled.
    pub(super) fn event(&self, event: &Event) -> Option<String> {
        Some(match event {
            Event::Request { user, goal, place } => {
                let (name, goal, place) = (self.name(*user), self.goal(*goal), self.place(*place));
                if goal == place {
                    format!("{name} asks for the {goal}, where they meet.")
                } else {
                    format!("{name} asks for the {goal}, to be met at the {place}.")
                }
            }
            Event::Data { user, .. } => format!("{} answers.", self.name(*user)),
            Event::Context { user, attribute, value } => {
                let (attribute, value) = (attribute.as_str(), value.as_str());
                format!("The context of {} changes: {attribute} is now {value:?}.", self.name(*user))
            }
            Event::Status { user, condition, truth } => {
                let (name, condition) = (self.name(*user), condition.as_str());
                match truth {
                    Truth::True => format!("{name} now says {condition:?}."),
                    Truth::False => format!("{name} now says not {condition:?}."),
                    Truth::Withheld => format!("{name} no longer wants {condition:?} to be told."),
                }
            }
            Event::Withdraw { user } => format!("{} does not want anything any more.", self.name(*user)),
            Event::Shutdown => "The robot is to stop working.".to_owned(),
            Event::Emergency { category, place, evidence } => {
                let by = match evidence {
                    Evidence::Claimed => "somebody says so",
                    Evidence::Sensed => "the robot's own sensors say so",
                    Evidence::Verified => "a document was checked",
                };
                let (category, place) = (self.category(*category), self.place(*place));
                format!("Emergency at the {place}: {category}; {by}.")
            }
            Event::DataTimeout { .. }
            | Event::ActionDone { .. }
            | Event::ActionFailed { .. }
            | Event::NextRound => return None,
        })
    }

    /// What there is to say of a reply.
    pub(super) fn output(&mut self, output: &Output) -> Option<String> {
        match output {
            Output::Command(command) => self.command(*command),
            Output::Record(record) => self.record(record),
        }
    }

    fn command(&self, command: Command) -> Option<String> {
        Some(match command {
            Command::AskData { user, .. } => format!("The robot asks {} for data.", self.name(user)),
            Command::Refuse { user, goal, why } => {
                let why = match why {
                    Refusal::UnknownGoal => "it knows no such goal",
                    Refusal::Incapable => "it lacks what that takes",
                    Refusal::AlreadyAsking => "an earlier request is still open",
                };
                format!("The robot refuses {} the {}: {why}.", self.name(user), self.goal(goal))
            }
            Command::Wait { user, why: why @ (Waiting::NotInterruptible | Waiting::Queued) } => {
                format!("{} has to wait: {}.", self.name(user), waiting(why))
            }
            Command::Wait { .. }
            | Command::Close { .. }
            | Command::CallStaff { .. }
            | Command::Execute { .. }
            | Command::Stop { .. }
            | Command::NextRound => return None,
        })
    }

    /// What there is to say of an action that begins. Driving tells of itself.
    pub(super) fn action(&self, goal: GoalId, name: &str, action: &Action) -> Option<String> {
        match action {
            Action::Say(text, _) => Some(format!("The robot says: {text:?}")),
            Action::Wait(time) => {
                let (goal, seconds) = (self.goal(goal), time.as_secs_f64());
                Some(format!("For the {goal}: {name}; this takes {seconds} s."))
            }
            Action::Meet | Action::Drive(_) | Action::Guide(_) => None,
        }
    }

    fn record(&mut self, record: &Record) -> Option<String> {
        Some(match record {
            Record::StaffCalled { user, goal, why } => {
                let goal = self.goal(*goal);
                let whom = user.map_or_else(String::new, |user| format!(" for {}", self.name(user)));
                format!("The robot calls human staff{whom} (the {goal}): {}.", staff(*why))
            }
            Record::Deferred { user, why, times } => {
                let times =
                    if *times == 1 { String::new() } else { format!(" (for the {} time)", nth(*times)) };
                format!("{} has to wait{times}: {}.", self.name(*user), waiting(*why))
            }
            Record::DataMissing { user } => format!("{} has not answered in time.", self.name(*user)),
            Record::DataUnusable { user, .. } => {
                format!("What {} says cannot be used.", self.name(*user))
            }
            Record::Ignored { what, user: Some(user) } => {
                format!("That of {} ({what}) has no effect any more.", self.name(*user))
            }
            Record::Inferred { user, rule, holds } => {
                let inferences = &self.scenario.specification.inferences;
                let condition = inferences.get(*rule).map_or("?", |inference| inference.condition.as_str());
                let name = self.name(*user);
                match holds {
                    true => format!("From {name}'s context follows {condition:?}."),
                    false => format!("From {name}'s context {condition:?} follows no longer."),
                }
            }
            Record::Wiped { user, component: Component::ContextEthicsManager, left: 0 } => {
                format!("What {} has told is wiped from memory.", self.name(*user))
            }
            Record::Wiped { left: 1.., user, .. } => {
                format!("Not everything that {} has told could be wiped from memory.", self.name(*user))
            }
            Record::GoalStarted { served: Served::Emergency(category), .. } => {
                format!("The robot turns to the emergency ({}).", self.category(*category))
            }
            Record::GoalStarted { served, goal } => {
                format!("The robot begins to serve {}: the {}.", self.served(*served), self.goal(*goal))
            }
            Record::TaskStarted { goal, task, interruptible: false } => {
                let goals = &self.scenario.specification.goals;
                let task = goals.get(usize::from(goal.0)).and_then(|goal| goal.tasks.get(*task));
                let task = task.map_or("?", |task| task.name.as_str());
                format!("A task begins that may not be interrupted: {task}.")
            }
            Record::Held { .. } => {
                "The next task may not be interrupted; the robot waits for the decision.".to_owned()
            }
            Record::GoalEnded { served: Served::Emergency(category), end: GoalEnd::Reached, .. } => {
                format!("The robot has done what is to be done ({}).", self.category(*category))
            }
            Record::GoalEnded { served, goal, end } => {
                let (whom, goal) = (self.served(*served), self.goal(*goal));
                match end {
                    GoalEnd::Reached => format!("The {goal} is reached: {whom} has been served."),
                    GoalEnd::Failed => format!("The {goal} has failed: {whom} could not be served."),
                    GoalEnd::Preempted => format!("The robot leaves the {goal} for now."),
                    GoalEnd::Abandoned => format!("The robot leaves the {goal}: nobody wants it any more."),
                }
            }
            Record::NegotiationStarted { current, interrupting, .. } => {
                self.has_disclosed.clear();
                let (current, interrupting) = (self.name(*current), self.name(*interrupting));
                format!("The robot negotiates with itself, for {current} and for {interrupting}.")
            }
            Record::Round { number, sender, receiver, round } => {
                self.round(*number, *sender, *receiver, *round)
            }
            Record::NegotiationEnded { winner, rounds, .. } => {
                let rounds = if *rounds == 1 { "1 round".to_owned() } else { format!("{rounds} rounds") };
                match winner {
                    Some(winner) => format!("Agreement for {} after {rounds}.", self.name(*winner)),
                    None => format!("No agreement after {rounds}."),
                }
            }
            Record::NegotiationsDropped { .. } => "The negotiation is broken off.".to_owned(),
            Record::Decided { options, participants, agreement, served, .. } => {
                let verb = if participants.first() == Some(served) { "keeps" } else { "gets" };
                let why = match (agreement, options.fallback) {
                    (Some(_), _) => "Decision",
                    (None, Fallback::FirstCome) => "Decision by the fallback, first come, first served",
                    (None, Fallback::Utilitarian) => {
                        "Decision by the fallback, whoever's service is worth most"
                    }
                };
                format!("{why}: {} {verb} precedence.", self.name(*served))
            }
            Record::EmergencyDecided { category, .. } => {
                format!("Decision: the emergency ({}) is certain and goes first.", self.category(*category))
            }
            Record::EmergencyUnverified { .. } => {
                "That is no proof; it is recorded and changes nothing.".to_owned()
            }
            Record::ShutDown => "The mission has ended.".to_owned(),
            _ => return None,
        })
    }

    fn served(&self, served: Served) -> String {
        match served {
            Served::User(user) => self.name(user).to_owned(),
            Served::Emergency(category) => format!("an emergency ({})", self.category(category)),
            Served::Nobody => "nobody".to_owned(),
        }
    }

    fn round(&mut self, number: u32, sender: UserId, receiver: UserId, round: Round) -> String {
        let (from, to) = (self.name(sender), self.name(receiver));
        match round {
            Round::Quit => {
                let more = if self.has_disclosed.contains(&sender) { " more" } else { "" };
                format!("Round {number}: {from} has nothing{more} to disclose and quits.")
            }
            Round::Offer { discloses, value, threshold, verdict, .. } => {
                self.has_disclosed.push(sender);
                let what = match discloses {
                    Disclosed::Listed(condition) => {
                        let bound = self.scenario.mission_rules.bound();
                        format!("{:?}", bound.condition_name(selfneg_core::Condition(condition)))
                    }
                    Disclosed::Unlisted(_) => match self.unlisted(sender) {
                        Some(condition) => format!("{condition:?}"),
                        None => "a condition that no rule knows".to_owned(),
                    },
                    Disclosed::Willingness => "being close to the end of the goal".to_owned(),
                };
                let verdict = match verdict {
                    "accept" => "accepts",
                    "reject" => "rejects",
                    _ => "would accept, but first makes an offer as deep",
                };
                format!(
                    "Round {number}: {from} discloses {what}. To {to} that is worth {value}, {to}'s own case \
                     {threshold}: {to} {verdict}."
                )
            }
        }
    }

    /// The one condition of a user that no rule knows, if there is but one.
    fn unlisted(&self, user: UserId) -> Option<&'a str> {
        let participant: &'a Participant = self.scenario.participant(user)?;
        let bound = self.scenario.mission_rules.bound();
        let mut unlisted = participant
            .user
            .status
            .iter()
            .filter(|(name, _)| bound.condition(name).is_none())
            .map(|(name, _)| name.as_str());
        let only = unlisted.next()?;
        unlisted.next().is_none().then_some(only)
    }

    /// What there is to say of the robot's way.
    pub(super) fn world(&mut self, event: &sim::Event) -> Option<String> {
        Some(match event {
            sim::Event::SetOut { place, estimate } => {
                self.waits_for = None;
                if estimate.distance < 0.05 {
                    return None;
                }
                format!(
                    "The robot sets out for the {place}: {:.0} m, about {:.0} s.",
                    estimate.distance, estimate.seconds
                )
            }
            sim::Event::Unreachable { place, .. } => format!("There is no way to the {place}."),
            sim::Event::Arrived { place } => format!("The robot is at the {place}."),
            sim::Event::Waiting { person } => {
                if self.waits_for.as_ref() == Some(person) {
                    return None;
                }
                self.waits_for = Some(person.clone());
                format!("The robot stops for {person}, who is in the way.")
            }
            sim::Event::Blocked { place, person: Some(person) } => {
                format!("The robot gives up the way to the {place}: {person} does not move.")
            }
            sim::Event::Blocked { place, person: None } => {
                format!("The robot gives up the way to the {place}.")
            }
            sim::Event::RideBegun { to, .. } => {
                format!("The robot is in the elevator to the {} floor.", self.floor(*to))
            }
            sim::Event::FloorChanged { floor } => format!("The doors open: {} floor.", self.floor(*floor)),
            sim::Event::Dropped { .. }
            | sim::Event::Paused { .. }
            | sim::Event::Resumed { .. }
            | sim::Event::MovingOn
            | sim::Event::Rerouted
            | sim::Event::PersonDone { .. } => return None,
        })
    }
}

fn waiting(why: Waiting) -> &'static str {
    match why {
        Waiting::NotInterruptible => "the robot must not be interrupted now",
        Waiting::Queued => "there is no room for another decision yet",
        Waiting::NoPrecedence => "another user has precedence",
        Waiting::DataMissing => "data are missing",
        Waiting::DataUnusable => "data cannot be used",
        Waiting::Emergency => "an emergency goes first",
    }
}

fn staff(why: Staff) -> &'static str {
    match why {
        Staff::DeferredTooOften => "it was put off as often as is allowed",
        Staff::NoRoom => "there is no memory left for it",
        Staff::Shutdown => "the robot stops working",
        Staff::EmergencyBeyondRobot => "the emergency is beyond the robot",
    }
}

/// `2nd`, `3rd`, ...
fn nth(times: u8) -> String {
    let ending = match (times % 10, times % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{times}{ending}")
}
