//! Every environment that keeps to what the mission asks for, as nondeterminism; and what an
//! onlooker who sees only events and outputs can hold against the mission.

use crate::mission::command::{Command, Output};
use crate::mission::event::{AskId, Event, Evidence, ExecutionId, Place, UserId};
use crate::mission::record::{GoalEnd, Record, Served};
use crate::mission::user_data::{LOCATION, Profile, Stated, Text, UserData};
use crate::mission::{Dropped, MissionRules};

use crate::input::Truth;

/// Users are numbered from 0.
pub(super) const MOST_USERS: usize = 3;

/// One thing that can happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Happening {
    Request(usize),
    Data(usize, Kind),
    Timeout(usize),
    /// News of something that is over.
    Late(Late),
    ActionDone,
    ActionFailed,
    NextRound,
    Emergency(u16, Evidence),
    Withdraw(usize),
    Shutdown,
}

impl Happening {
    /// Whether it is the environment's duty to let it happen: the mission asked for it, and
    /// it needs no user's goodwill.
    pub(super) fn is_due(self) -> bool {
        matches!(self, Self::Timeout(_) | Self::ActionDone | Self::NextRound)
    }
}

/// News that come when nobody waits for them any more: an answer to an asking that has timed
/// out or was for a withdrawn request, say. Their number is none that is open, and that is
/// all that the mission looks at; so one such number stands for all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Late {
    Data(usize),
    Timeout(usize),
    ActionDone,
    ActionFailed,
    NextRound,
    Withdraw(usize),
}

const NOT_OPEN: u32 = u32::MAX;

/// What data a user gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    /// Ranks the own conditions high.
    Insists,
    /// Ranks the others' conditions high.
    Defers,
    /// Has no true condition.
    Silent,
    /// Is where no profile is for.
    Lost,
}

/// What the onlooker found wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Wrong {
    TwoGoals,
    TwoActions,
    LateNewsHadEffect,
    RequestUnanswered,
    IllegalTransition,
    WipeLeftBytes,
    EmergencyNotDecided,
    ClaimHadEffect,
}

/// What the onlooker knows.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Onlooker {
    /// Whose request was made and not yet closed.
    pub(super) open: [bool; MOST_USERS],
    /// Whose data were accepted, and who was neither deferred nor closed since.
    pub(super) may_be_held: [bool; MOST_USERS],
    pub(super) asked: [Option<AskId>; MOST_USERS],
    pub(super) running: Option<ExecutionId>,
    pub(super) goal: Option<Served>,
    pub(super) round_due: bool,
    pub(super) wrong: Option<Wrong>,
    /// What the last event brought about; for seeing that everything is reached.
    pub(super) seen: Option<Seen>,
}

/// Something worth being reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Seen {
    InterrupterServed,
    CurrentKept,
    ThreeNegotiated,
    NegotiationOverridden,
    GraverFirst,
    Staff,
    Held,
}

/// The data of a user. Rank 200 + n stands in no other user's data.
pub(super) fn data_of(user: usize, kind: Kind) -> UserData {
    let ranks = (0..MOST_USERS).map(|other| {
        let own = other == user;
        let rank = if own == (kind == Kind::Insists) { 5 } else { 1 };
        (Text::new(format!("D{other}")), rank)
    });
    let mark = (Text::from("mark"), canary(user));
    let condition = |nth: usize| Stated { condition: Text::new(format!("c{user}{nth}")), truth: Truth::True };
    let status = if kind == Kind::Silent { 0..0 } else { 0..2 };
    let place = if kind == Kind::Lost { "moon" } else { "mall" };
    UserData {
        profiles: vec![Profile { label: "mall".into(), ranks: ranks.chain([mark]).collect() }],
        status: status.map(condition).collect(),
        context: vec![(LOCATION.into(), place.into())],
    }
}

pub(super) fn canary(user: usize) -> u8 {
    200 + u8::try_from(user).unwrap()
}

fn id(user: usize) -> UserId {
    UserId(u32::try_from(user).unwrap() + 1)
}

pub(super) fn number(user: UserId) -> usize {
    usize::try_from(user.0).unwrap() - 1
}

impl Onlooker {
    pub(super) fn new() -> Self {
        Self {
            open: [false; MOST_USERS],
            may_be_held: [false; MOST_USERS],
            asked: [None; MOST_USERS],
            running: None,
            goal: None,
            round_due: false,
            wrong: None,
            seen: None,
        }
    }

    /// Everything that can happen next.
    pub(super) fn possible(&self, users: usize, into: &mut Vec<Happening>) {
        for user in 0..users {
            into.push(Happening::Request(user));
            into.extend([Late::Data(user), Late::Timeout(user)].map(Happening::Late));
            if self.open[user] {
                into.push(Happening::Withdraw(user));
            } else {
                into.push(Happening::Late(Late::Withdraw(user)));
            }
            if self.asked[user].is_some() {
                into.push(Happening::Timeout(user));
                for kind in [Kind::Insists, Kind::Defers, Kind::Silent, Kind::Lost] {
                    into.push(Happening::Data(user, kind));
                }
            }
        }
        if self.running.is_some() {
            into.extend([Happening::ActionDone, Happening::ActionFailed]);
        }
        into.push(if self.round_due { Happening::NextRound } else { Happening::Late(Late::NextRound) });
        into.extend([
            Happening::Late(Late::ActionDone),
            Happening::Late(Late::ActionFailed),
            Happening::Emergency(0, Evidence::Sensed),
            Happening::Emergency(1, Evidence::Verified),
            Happening::Emergency(1, Evidence::Claimed),
            Happening::Emergency(0, Evidence::Verified),
            Happening::Shutdown,
        ]);
    }

    /// The event, which the environment lets happen.
    pub(super) fn event(&mut self, happening: Happening, rules: &MissionRules) -> Event {
        let goal = rules.goal("g").unwrap();
        match happening {
            Happening::Request(user) => Event::Request { user: id(user), goal, place: Place(1) },
            Happening::Data(user, kind) => {
                let ask = self.asked[user].take().unwrap();
                Event::Data { user: id(user), ask, data: data_of(user, kind) }
            }
            Happening::Timeout(user) => {
                let ask = self.asked[user].take().unwrap();
                Event::DataTimeout { user: id(user), ask }
            }
            Happening::Late(late) => match late {
                Late::Data(user) => {
                    let data = data_of(user, Kind::Insists);
                    Event::Data { user: id(user), ask: AskId(NOT_OPEN), data }
                }
                Late::Timeout(user) => Event::DataTimeout { user: id(user), ask: AskId(NOT_OPEN) },
                Late::ActionDone => Event::ActionDone { execution: ExecutionId(NOT_OPEN) },
                Late::ActionFailed => Event::ActionFailed { execution: ExecutionId(NOT_OPEN) },
                Late::NextRound => Event::NextRound,
                Late::Withdraw(user) => Event::Withdraw { user: id(user) },
            },
            Happening::ActionDone => Event::ActionDone { execution: self.running.take().unwrap() },
            Happening::ActionFailed => Event::ActionFailed { execution: self.running.take().unwrap() },
            Happening::NextRound => {
                self.round_due = false;
                Event::NextRound
            }
            Happening::Emergency(category, evidence) => {
                let category = crate::mission::CategoryId(category);
                Event::Emergency { category, place: Place(2), evidence }
            }
            Happening::Withdraw(user) => Event::Withdraw { user: id(user) },
            Happening::Shutdown => Event::Shutdown,
        }
    }

    /// Takes note of what the mission put out in reply.
    pub(super) fn observe(&mut self, happening: Happening, outputs: &[Output]) {
        self.seen = None;
        self.observe_late(happening, outputs);
        self.observe_request(happening, outputs);
        let mut preempted = false;
        for output in outputs {
            match output {
                Output::Command(command) => self.observe_command(*command),
                Output::Record(record) => {
                    if let Record::GoalEnded {
                        served: Served::Emergency(_), end: GoalEnd::Preempted, ..
                    } = record
                    {
                        preempted = true;
                    }
                    self.observe_record(happening, record, preempted);
                }
            }
        }
        let decided = |o: &Output| matches!(o, Output::Record(Record::EmergencyDecided { .. }));
        if let Happening::Emergency(..) = happening {
            let certain = happening == Happening::Emergency(0, Evidence::Sensed)
                || happening == Happening::Emergency(1, Evidence::Verified);
            if certain != outputs.iter().any(decided) {
                self.wrong = Some(Wrong::EmergencyNotDecided);
            }
            if !certain && outputs.len() != 1 {
                self.wrong = Some(Wrong::ClaimHadEffect);
            }
        }
    }

    /// Late news are recorded, and that is all.
    fn observe_late(&mut self, happening: Happening, outputs: &[Output]) {
        let ignored = matches!(outputs, [Output::Record(Record::Ignored { .. })]);
        if matches!(happening, Happening::Late(_)) && !ignored {
            self.wrong = Some(Wrong::LateNewsHadEffect);
        }
    }

    /// A request is open, and is answered in the same breath.
    fn observe_request(&mut self, happening: Happening, outputs: &[Output]) {
        let Happening::Request(user) = happening else { return };
        self.open[user] = true;
        let user = id(user);
        let answers = |output: &Output| {
            let Output::Command(command) = output else { return false };
            match command {
                Command::AskData { user: whom, .. }
                | Command::Wait { user: whom, .. }
                | Command::Refuse { user: whom, .. }
                | Command::Close { user: whom, .. } => *whom == user,
                Command::CallStaff { .. }
                | Command::Execute { .. }
                | Command::Stop { .. }
                | Command::NextRound => false,
            }
        };
        if !outputs.iter().any(answers) {
            self.wrong = Some(Wrong::RequestUnanswered);
        }
    }

    fn observe_command(&mut self, command: Command) {
        match command {
            Command::AskData { user, ask, .. } => self.asked[number(user)] = Some(ask),
            Command::Execute { execution, .. } => {
                if self.running.is_some() {
                    self.wrong = Some(Wrong::TwoActions);
                }
                self.running = Some(execution);
            }
            Command::Stop { execution } => {
                if self.running == Some(execution) {
                    self.running = None;
                }
            }
            Command::NextRound => self.round_due = true,
            Command::CallStaff { user: Some(_), .. } => self.seen = Some(Seen::Staff),
            Command::Close { user, .. } => self.forget(user),
            Command::Wait { .. } | Command::Refuse { .. } | Command::CallStaff { .. } => {}
        }
    }

    /// The request is closed; whatever was asked of the user is off.
    fn forget(&mut self, user: UserId) {
        let user = number(user);
        self.open[user] = false;
        self.may_be_held[user] = false;
        self.asked[user] = None;
    }

    fn observe_record(&mut self, happening: Happening, record: &Record, preempted: bool) {
        match record {
            Record::DataAccepted { user } => {
                self.may_be_held[number(*user)] = true;
            }
            Record::Deferred { user, .. } => {
                self.may_be_held[number(*user)] = false;
                self.asked[number(*user)] = None;
            }
            Record::GoalStarted { served, .. } => {
                if self.goal.is_some() {
                    self.wrong = Some(Wrong::TwoGoals);
                }
                if let (Served::Emergency(_), true, Happening::Emergency(..)) = (served, preempted, happening)
                {
                    self.seen = Some(Seen::GraverFirst);
                }
                self.goal = Some(*served);
            }
            Record::GoalEnded { .. } => self.goal = None,
            Record::IllegalTransition { .. } => self.wrong = Some(Wrong::IllegalTransition),
            Record::Wiped { left, .. } if *left > 0 => self.wrong = Some(Wrong::WipeLeftBytes),
            Record::NegotiationsDropped { why: Dropped::Emergency } if self.round_due => {
                self.seen = Some(Seen::NegotiationOverridden);
            }
            Record::Held { .. } => self.seen = Some(Seen::Held),
            Record::Decided { participants, served, .. } => {
                self.seen = Some(match (participants.len(), participants.first() == Some(served)) {
                    (3.., _) => Seen::ThreeNegotiated,
                    (_, true) => Seen::CurrentKept,
                    (_, false) => Seen::InterrupterServed,
                });
            }
            _ => {}
        }
        if let Record::NegotiationsDropped { .. } = record {
            self.round_due = false;
        }
    }
}
