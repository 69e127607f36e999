//! One plain sentence per event, record and command, with pseudonyms and nothing personal.
//!
//! Goals and emergencies are named as the specification names them, or by their numbers if
//! its names are empty, as in the open part of a trace.

use crate::mission::{
    CategoryId, Closing, Command, Event, Evidence, GoalEnd, GoalId, Output, Record, Refusal, Round, Served,
    Specification, Staff, UserId, Waiting,
};

/// An event in a sentence.
#[must_use]
pub fn tell_event(event: &Event, specification: &Specification) -> String {
    match event {
        Event::Request { user, goal, .. } => {
            format!("{} asks for {}.", name(*user), goal_name(*goal, specification))
        }
        Event::Data { user, .. } => format!("{} answers with data.", name(*user)),
        Event::DataTimeout { user, .. } => format!("{} did not answer in time.", name(*user)),
        Event::Context { user, .. } => format!("The context of {} changed.", user_name(*user)),
        Event::Status { user, .. } => format!("{} says something new about a condition.", name(*user)),
        Event::ActionDone { execution } => format!("Execution {} is done.", execution.0),
        Event::ActionFailed { execution } => format!("Execution {} failed.", execution.0),
        Event::NextRound => "It is time for the next round.".to_owned(),
        Event::Emergency { category, evidence, .. } => {
            let basis = match evidence {
                Evidence::Claimed => "claimed",
                Evidence::Sensed => "sensed",
                Evidence::Verified => "verified by a document",
            };
            format!("An emergency is {basis}: {}.", category_name(*category, specification))
        }
        Event::Withdraw { user } => format!("{} no longer wants anything.", name(*user)),
        Event::Shutdown => "The mission is to end.".to_owned(),
    }
}

/// A reply in a sentence; none for changes of lifecycles, of which there are many and which
/// the records tell.
#[must_use]
pub fn tell_output(output: &Output, specification: &Specification) -> Option<String> {
    match output {
        Output::Command(command) => Some(tell_command(command, specification)),
        Output::Record(record) => tell_record(record, specification),
    }
}

fn tell_command(command: &Command, specification: &Specification) -> String {
    match *command {
        Command::AskData { user, within_ms, .. } => {
            format!("The robot asks {} for data, to be answered within {within_ms} ms.", user_name(user))
        }
        Command::Execute { execution, goal, task, action, .. } => {
            let known = specification.goals.get(usize::from(goal.0)).and_then(|goal| goal.tasks.get(task));
            let what = match known.and_then(|task| Some((&task.name, task.actions.get(action)?))) {
                Some((task, action)) if !task.is_empty() => format!("{task}: {action}"),
                _ => format!("action {action} of task {task}"),
            };
            format!("The robot begins execution {}, {what}.", execution.0)
        }
        Command::Stop { execution } => format!("The robot stops execution {}.", execution.0),
        Command::NextRound => "The robot goes on to the next round.".to_owned(),
        Command::Wait { user, why } => {
            format!("The robot asks {} to wait: {}.", user_name(user), waiting(why))
        }
        Command::Refuse { user, goal, why } => {
            let goal = goal_name(goal, specification);
            format!("The robot tells {} that {goal} is refused: {}.", user_name(user), refusal(why))
        }
        Command::Close { user, how } => {
            format!("The robot tells {} that the request is closed: {}.", user_name(user), closing(how))
        }
        Command::CallStaff { user, goal, why, .. } => {
            let whom = user.map_or_else(String::new, |user| format!(" for {}", user_name(user)));
            format!("The robot calls staff{whom}, {}: {}.", goal_name(goal, specification), staff(why))
        }
    }
}

fn tell_record(record: &Record, specification: &Specification) -> Option<String> {
    let goal_name = |goal: GoalId| goal_name(goal, specification);
    let category_name = |category: CategoryId| category_name(category, specification);
    let serves = |served: Served| match served {
        Served::User(user) => user_name(user),
        Served::Emergency(category) => format!("the emergency {}", category_name(category)),
        Served::Nobody => "nobody".to_owned(),
    };
    Some(match record {
        Record::Lifecycle { .. } => return None,
        Record::IllegalTransition { component, refused } => {
            format!("An illegal transition of {component:?} was refused: {refused}.")
        }
        Record::Refused { user, goal, why } => {
            format!(
                "The request of {} for {} was refused: {}.",
                user_name(*user),
                goal_name(*goal),
                refusal(*why)
            )
        }
        Record::Admitted { user, goal } => {
            format!("The request of {} for {} is kept.", user_name(*user), goal_name(*goal))
        }
        Record::Closed { user, how } => {
            format!("The request of {} is closed: {}.", user_name(*user), closing(*how))
        }
        Record::StaffCalled { why, .. } => format!("Staff is called: {}.", staff(*why)),
        Record::Deferred { user, why, times } => {
            format!("The request of {} waits, for the {times}. time: {}.", user_name(*user), waiting(*why))
        }
        Record::DataAccepted { user } => format!("The data of {} are accepted.", user_name(*user)),
        Record::DataMissing { user } => format!("The data of {} are missing.", user_name(*user)),
        Record::DataUnusable { user, why } => {
            format!("The data of {} cannot be used: {why:?}.", user_name(*user))
        }
        Record::Ignored { what, .. } => format!("No use for this {what}; it is ignored."),
        Record::ProfileActivated { user, .. } => format!("A profile of {} is active.", user_name(*user)),
        Record::ProfileKept { user } => {
            format!("The changed context of {} has no profile; the active one stays.", user_name(*user))
        }
        Record::Inferred { user, .. } => {
            format!("Something about {} follows from the context.", user_name(*user))
        }
        Record::Wiped { user, component, left } => {
            format!("The memory of {component:?} for {} is wiped; {left} bytes are left.", user_name(*user))
        }
        Record::GoalStarted { served, goal } => {
            format!("The robot begins {} for {}.", goal_name(*goal), serves(*served))
        }
        Record::TaskStarted { task, interruptible, .. } => {
            let may = if *interruptible { "may" } else { "may not" };
            format!("Task {task} begins; it {may} be interrupted.")
        }
        Record::Held { task } => {
            format!("The robot waits before task {task}, which may not be interrupted.")
        }
        Record::GoalEnded { served, goal, end } => {
            let end = match end {
                GoalEnd::Reached => "is reached",
                GoalEnd::Failed => "has failed",
                GoalEnd::Preempted => "gives way to another",
                GoalEnd::Abandoned => "is wanted by nobody any more",
            };
            format!("{} for {} {end}.", goal_name(*goal), serves(*served))
        }
        Record::NegotiationStarted { current, interrupting, .. } => {
            format!("{} and {} negotiate.", name(*current), user_name(*interrupting))
        }
        Record::Round { number, sender, receiver, round } => match round {
            Round::Offer { depth, verdict, .. } => format!(
                "Round {number}: {} makes offer {depth}, and {} answers: {verdict}.",
                user_name(*sender),
                user_name(*receiver)
            ),
            Round::Quit => format!("Round {number}: {} has no further offer and quits.", user_name(*sender)),
        },
        Record::NegotiationEnded { winner, rounds, ending, .. } => {
            let winner =
                winner.map_or_else(|| "no agreement".to_owned(), |user| format!("{} wins", user_name(user)));
            format!("The negotiation ends after {rounds} rounds, {ending}: {winner}.")
        }
        Record::NegotiationsDropped { why } => format!("The negotiations are broken off: {why:?}."),
        Record::Decided { agreement, served, rounds, .. } => {
            let how = if agreement.is_some() { "agreed" } else { "without agreement" };
            format!("Decided after {rounds} rounds, {how}: the robot serves {}.", user_name(*served))
        }
        Record::EmergencyDecided { category, .. } => {
            format!("The emergency {} is certain and goes first.", category_name(*category))
        }
        Record::EmergencyUnverified { category, .. } => {
            format!("The emergency {} lacks the evidence that it needs.", category_name(*category))
        }
        Record::ShuttingDown => "The mission is ending.".to_owned(),
        Record::ShutDown => "The mission has ended.".to_owned(),
    })
}

fn user_name(user: UserId) -> String {
    format!("user {}", user.0)
}

/// At the begin of a sentence.
fn name(user: UserId) -> String {
    format!("User {}", user.0)
}

/// A goal by its name, or by its number where names are personal.
fn goal_name(goal: GoalId, specification: &Specification) -> String {
    match specification.goals.get(usize::from(goal.0)) {
        Some(known) if known.name.is_empty() => format!("goal {}", goal.0),
        Some(known) => format!("{:?}", known.name),
        None => format!("the unknown goal {}", goal.0),
    }
}

/// An emergency's category, likewise.
fn category_name(category: CategoryId, specification: &Specification) -> String {
    match specification.emergencies.get(usize::from(category.0)) {
        Some(known) if known.name.is_empty() => format!("category {}", category.0),
        Some(known) => format!("{:?}", known.name),
        None => format!("unknown category {}", category.0),
    }
}

const fn waiting(why: Waiting) -> &'static str {
    match why {
        Waiting::NotInterruptible => "the current task must not be interrupted",
        Waiting::Queued => "others come first, or there is no safe point yet",
        Waiting::NoPrecedence => "another user has precedence",
        Waiting::DataMissing => "data did not arrive in time",
        Waiting::DataUnusable => "data cannot be used",
        Waiting::Emergency => "an emergency comes first",
    }
}

const fn refusal(why: Refusal) -> &'static str {
    match why {
        Refusal::UnknownGoal => "there is no such goal",
        Refusal::Incapable => "the robot cannot do it",
        Refusal::AlreadyAsking => "an earlier request is open",
    }
}

const fn closing(how: Closing) -> &'static str {
    match how {
        Closing::Reached => "the goal was reached",
        Closing::Failed => "the goal failed",
        Closing::Withdrawn => "it was withdrawn",
        Closing::Staff(why) => staff(why),
    }
}

const fn staff(why: Staff) -> &'static str {
    match why {
        Staff::DeferredTooOften => "it was deferred as often as may be",
        Staff::NoRoom => "the robot has no memory left for it",
        Staff::Shutdown => "the mission is ending",
        Staff::EmergencyBeyondRobot => "the emergency is beyond the robot",
    }
}
