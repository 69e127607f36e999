//! Whether goals and requests take the course that events and decisions give them, as far as the
//! open records tell: a goal ends as the event before it says, whoever loses the robot or a
//! decision is put off, deferrals are counted, and requests are closed for a reason that there
//! is.
//!
//! What holds here is not counted among the checks of a property: each decision counts once.

use std::collections::BTreeMap;

use super::finding::{Log, Place};
use super::property::Property;
use super::status::Status;
use super::turn::Turn;
use crate::trace::schema::evidence::{
    self, Closing, GoalEnd, Header, command, event::Event, record::Record, served::Served,
};
use crate::trace::{Open, Step};

/// Checks all turns of a trace.
pub(super) fn check(header: &Header, turns: &[Turn<'_>], log: &mut Log) {
    let mut course =
        Course { header, open: BTreeMap::new(), pursued: None, under_way: None, ending: false, log };
    for turn in turns {
        course.turn(turn);
    }
}

/// What a turn still has to tell of a user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owed {
    /// The request is closed so.
    Closed(Closing),
    /// The request waits, or goes to human staff for having waited too often.
    PutOff,
}

/// The robot's work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Pursued {
    /// Nobody any more, if whoever wanted it has withdrawn or the mission is ending.
    served: Option<Served>,
    goal: u32,
}

struct Course<'a> {
    header: &'a Header,
    /// How often each open request was put off.
    open: BTreeMap<u32, u32>,
    pursued: Option<Pursued>,
    under_way: Option<evidence::Execute>,
    /// The mission is ending, or has ended.
    ending: bool,
    log: &'a mut Log,
}

/// What is found of one turn.
#[derive(Default)]
struct Found {
    /// How the goal must end before anything else is told.
    due: Option<GoalEnd>,
    /// A goal has made room for another one that has not begun.
    room_made: Option<Place>,
    owed: BTreeMap<u32, (Owed, Place)>,
}

impl Course<'_> {
    fn broken(&mut self, at: Place, what: impl Into<String>) {
        self.log.broken_as(Property::Policy, Status::Violation, at, what);
    }

    /// Whether this was the last action of its goal, if the header says how many there are.
    fn is_last(&self, execute: &evidence::Execute) -> Option<bool> {
        let goals = &self.header.specification.as_ref()?.goals;
        let tasks = &goals.get(usize::try_from(execute.goal).ok()?)?.tasks;
        let task = usize::try_from(execute.task).ok()?;
        let action = usize::try_from(execute.action).ok()?;
        let actions = &tasks.get(task)?.actions;
        Some(task.saturating_add(1) == tasks.len() && action.saturating_add(1) == actions.len())
    }

    fn deferrals_allowed(&self) -> u32 {
        let limits = self.header.specification.as_ref().and_then(|one| one.limits.as_ref());
        limits.map_or(u32::MAX, |limits| limits.deferrals)
    }

    fn turn(&mut self, turn: &Turn<'_>) {
        let event = turn.happened();
        let at = turn.event.map_or(Place::WHOLE, |event| Place::entry(event.index, event.at));
        let mut found = Found { due: self.due(event), ..Found::default() };
        for entry in turn.replies {
            let Step::Reply { open, .. } = &entry.step else { continue };
            match open {
                Open::Command(open) => match &open.command {
                    Some(command::Command::Execute(execute)) => self.under_way = Some(*execute),
                    Some(command::Command::Stop(_)) => self.under_way = None,
                    _ => {}
                },
                Open::Record(open) => {
                    if let Some(record) = &open.record {
                        self.record(event, record, Place::entry(entry.index, entry.at), &mut found);
                    }
                }
            }
        }
        if !turn.may_be_cut {
            self.end_of_turn(event, at, found);
        }
    }

    /// How the event ends the goal by itself.
    fn due(&mut self, event: Option<&Event>) -> Option<GoalEnd> {
        let (execution, end) = match event? {
            Event::ActionDone(done) => (done.execution, GoalEnd::Reached),
            Event::ActionFailed(failed) => (failed.execution, GoalEnd::Failed),
            _ => return None,
        };
        let done = self.under_way.take_if(|under_way| under_way.execution == execution)?;
        (end == GoalEnd::Failed || self.is_last(&done) == Some(true)).then_some(end)
    }

    fn record(&mut self, event: Option<&Event>, record: &Record, at: Place, found: &mut Found) {
        if found.due.is_some() && !matches!(record, Record::GoalEnded(_)) {
            found.due = None;
            self.broken(
                at,
                "the robot's last action on a goal is over, and the goal is not told to have ended",
            );
        }
        match record {
            Record::GoalStarted(started) => {
                found.room_made = None;
                let served = served_in(started.served.as_ref());
                self.pursued = Some(Pursued { served, goal: started.goal });
            }
            Record::GoalEnded(ended) => self.goal_ended(ended, at, found),
            Record::Decided(decided) => {
                for &user in decided.participants.iter().filter(|&&user| user != decided.served) {
                    found.owed.insert(user, (Owed::PutOff, at));
                }
            }
            Record::Admitted(admitted) => {
                let asked = matches!(event, Some(Event::Request(request))
                    if (request.user, request.goal) == (admitted.user, admitted.goal));
                if !asked || self.ending || self.open.insert(admitted.user, 0).is_some() {
                    self.broken(
                        at,
                        format!("a request of user {} is kept that it did not make", admitted.user),
                    );
                }
            }
            Record::Deferred(deferred) => self.deferred(deferred, at, found),
            Record::Closed(closed) => self.closed(event, closed, at, found),
            Record::ShuttingDown(_) => {
                if self.ending || !matches!(event, Some(Event::Shutdown(_))) {
                    let what = "the mission is ending without having been told to";
                    self.log.broken(Property::HardEthics, at, what);
                } else {
                    self.ending = true;
                    self.nobody_instead_of(|served| matches!(served, Served::Emergency(_)));
                }
            }
            _ => {}
        }
    }

    fn goal_ended(&mut self, ended: &evidence::GoalEnded, at: Place, found: &mut Found) {
        let served = served_in(ended.served.as_ref());
        if self.pursued.take() != Some(Pursued { served, goal: ended.goal }) {
            self.broken(at, "a goal ends that the robot does not work on, or for somebody else");
        }
        self.under_way = None;
        let end = ended.end();
        let fits = match end {
            GoalEnd::Reached | GoalEnd::Failed => found.due == Some(end),
            GoalEnd::Preempted => found.due.is_none() && served.is_some(),
            GoalEnd::Abandoned => found.due.is_none() && served.is_none(),
            GoalEnd::Unspecified => false,
        };
        if !fits {
            let how = match end {
                GoalEnd::Reached => "reached",
                GoalEnd::Failed => "failed",
                GoalEnd::Preempted => "preempted",
                GoalEnd::Abandoned => "abandoned",
                GoalEnd::Unspecified => "of unknown end",
            };
            self.broken(at, format!("a goal is told to be {how}, and it is not by what happened"));
        }
        found.due = None;
        if end == GoalEnd::Preempted {
            found.room_made = Some(at);
        }
        if let Some(Served::User(user)) = served {
            let owed = match end {
                GoalEnd::Reached => Owed::Closed(Closing::Reached),
                GoalEnd::Failed => Owed::Closed(Closing::Failed),
                _ => Owed::PutOff,
            };
            found.owed.insert(user, (owed, at));
        }
    }

    fn deferred(&mut self, deferred: &evidence::Deferred, at: Place, found: &mut Found) {
        let user = deferred.user;
        if let Some((Owed::Closed(_), _)) = found.owed.remove(&user) {
            self.broken(at, format!("user {user} is put off, whose goal has come to its end"));
        }
        let most = self.deferrals_allowed();
        let Some(times) = self.open.get_mut(&user) else {
            return self.broken(at, format!("user {user} is put off, and has no open request"));
        };
        *times = times.saturating_add(1);
        let times = *times;
        if deferred.times != times {
            let told = deferred.times;
            self.broken(at, format!("deferral {times} of user {user} is told to be deferral {told}"));
        } else if times >= most {
            self.broken(at, format!("user {user} is put off {times} times, where {most} go to human staff"));
        }
    }

    fn closed(&mut self, event: Option<&Event>, closed: &evidence::Closed, at: Place, found: &mut Found) {
        let user = closed.user;
        let owed = found.owed.remove(&user).map(|(owed, _)| owed);
        let times = self.open.remove(&user);
        let fits = match (closed.how(), owed) {
            (how @ (Closing::Reached | Closing::Failed), _) => owed == Some(Owed::Closed(how)),
            (_, Some(Owed::Closed(_))) => false,
            (Closing::StaffDeferredTooOften, _) => {
                times.is_some_and(|times| times.saturating_add(1) >= self.deferrals_allowed())
            }
            (_, Some(Owed::PutOff)) => false,
            (Closing::Withdrawn, None) => {
                times.is_some() && matches!(event, Some(Event::Withdraw(about)) if about.user == user)
            }
            (Closing::StaffShutdown, None) => self.ending,
            (Closing::StaffNoRoom, None) => {
                times.is_none() && matches!(event, Some(Event::Request(request)) if request.user == user)
            }
            (Closing::StaffEmergencyBeyondRobot | Closing::Unspecified, None) => false,
        };
        if !fits {
            self.broken(at, format!("a request of user {user} is closed for a reason that there is not"));
        }
        self.nobody_instead_of(|served| served == Served::User(user));
    }

    fn end_of_turn(&mut self, event: Option<&Event>, at: Place, found: Found) {
        if found.due.is_some() {
            self.broken(
                at,
                "the robot's last action on a goal is over, and the goal is not told to have ended",
            );
        }
        if let Some(at) = found.room_made {
            self.broken(at, "a goal makes room for another one, and none begins");
        }
        for (user, (owed, at)) in found.owed {
            let what = match owed {
                Owed::Closed(_) => format!("the goal of user {user} is over, and its request is not closed"),
                Owed::PutOff => format!("user {user} has no precedence, and is not told to wait"),
            };
            self.broken(at, what);
        }
        match event {
            Some(Event::Withdraw(about)) if self.open.contains_key(&about.user) => {
                self.broken(at, format!("user {} withdraws, and its request is not closed", about.user));
            }
            Some(Event::Shutdown(_)) if !self.ending => {
                self.ending = true;
                self.broken(at, "the mission is told to end, and goes on");
            }
            Some(Event::Shutdown(_)) => {
                if let Some((user, _)) = self.open.pop_first() {
                    self.open.clear();
                    self.broken(
                        at,
                        format!("the mission is ending, and a request of user {user} is not closed"),
                    );
                }
            }
            _ => {}
        }
    }

    fn nobody_instead_of(&mut self, whom: impl Fn(Served) -> bool) {
        if let Some(pursued) = self.pursued.as_mut().filter(|pursued| pursued.served.is_some_and(whom)) {
            pursued.served = None;
        }
    }
}

fn served_in(served: Option<&evidence::Served>) -> Option<Served> {
    served.and_then(|served| served.served)
}
