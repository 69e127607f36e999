//! What a decision was made from: what the mission's memory held of everybody who took part.
//!
//! Each user's part is made again from what this user said, apart from everybody else's; so
//! where one person's data are erased, decisions without that person can still be made again.

use std::collections::BTreeMap;
use std::sync::Arc;

use selfneg_core::{Condition, Disclosure, Options};

use super::recorded::RecordedDecision;
use crate::binding::{BoundRules, BoundUser};
use crate::mission::{Disclosed, Event, GoalId, MissionRules, Recollection, Snapshot, UserData, UserId};
use crate::precedence::{Decision, Policy, PrecedenceError, decide};
use crate::trace::schema::evidence::{self, event::Event as OpenEvent, record::Record};
use crate::trace::{Open, Recording, ReplayError, Step, decode_event};

/// Everything that a decision depends on.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// The rules, with the names of conditions that only these users name.
    pub rules: Arc<BoundRules>,
    /// Who takes part, by arrival: as the robot's memory held them, true conditions in their
    /// order of disclosure, those that follow from the context included. Their names are
    /// those of the trace's participants, or `user 3` where these are not there.
    pub users: Vec<BoundUser>,
    /// The variant; the willingness is the one in force for the first user at that time.
    pub options: Options,
    /// The policy in force for so many.
    pub policy: Policy,
    /// How many conditions the rules list.
    listed: usize,
    /// For each user: where among its own conditions the one is that only it names.
    unlisted: Vec<BTreeMap<u16, u16>>,
}

/// Why a recorded decision cannot be made again.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CaseError {
    /// The rules are not in the trace (any more), or refused.
    #[error("{0}")]
    Rules(String),
    /// What a user said is not in the trace (any more), or not usable.
    #[error("what user {0} said is not there")]
    NotSaid(u32),
    /// The trace does not show that a user took part in a negotiation.
    #[error("no negotiation of user {0} is recorded")]
    NotNegotiated(u32),
    /// More conditions than the engine takes.
    #[error("user {0} has more conditions than the engine takes")]
    TooMany(u32),
}

impl Inputs {
    /// Decides the case, in one go and without a mission.
    ///
    /// # Errors
    /// [`PrecedenceError`] for fewer than two users.
    pub fn decide(&self) -> Result<Decision, PrecedenceError> {
        decide(&self.rules, &self.users, self.options, self.policy)
    }

    /// A disclosure of the user at this place, as the trace numbers it.
    #[must_use]
    pub fn disclosed(&self, user: usize, disclosure: Disclosure) -> Disclosed {
        let Disclosure::Condition(condition) = disclosure else { return Disclosed::Willingness };
        match self.unlisted.get(user).and_then(|places| places.get(&condition.0)) {
            Some(&place) if usize::from(condition.0) >= self.listed => Disclosed::Unlisted(place),
            _ => Disclosed::Listed(condition.0),
        }
    }
}

/// The rules of a recorded mission, if they are there. What a robot takes as its limits is what
/// is run again, and no more: [`MissionRules::new`] bounds the memory that they may ask for.
///
/// # Errors
/// Why not, in words.
pub(crate) fn rules_to_run(recording: &Recording) -> Result<MissionRules, String> {
    recording.mission_rules().map_err(|error| error.to_string())
}

/// For each decision, in their order, what it was made from.
pub(super) fn of_decisions(
    recording: &Recording,
    decisions: &[RecordedDecision],
) -> Vec<Result<Inputs, CaseError>> {
    let rules = match rules_to_run(recording) {
        Ok(rules) => rules,
        Err(error) => return decisions.iter().map(|_| Err(CaseError::Rules(error.clone()))).collect(),
    };
    let mut listener = Listener {
        bound: Arc::new(rules.bound().clone()),
        names: recording.participants.iter().map(|who| (UserId(who.user), who.name.as_str())).collect(),
        rules: &rules,
        goals: BTreeMap::new(),
        said: None,
        heard: BTreeMap::new(),
        snapshots: BTreeMap::new(),
    };
    let mut inputs = Vec::with_capacity(decisions.len());
    let mut next = decisions.iter().peekable();
    for entry in &recording.entries {
        match &entry.step {
            Step::Event { open, personal } => {
                listener.hear(open, || decode_event(open, personal.as_ref()));
            }
            Step::Reply { open: Open::Record(open), .. } => {
                if let Some(decision) = next.next_if(|decision| decision.index == entry.index) {
                    inputs.push(listener.inputs(decision));
                }
                if let Some(record) = &open.record {
                    listener.note(record);
                }
            }
            Step::Reply { .. } => {}
        }
    }
    inputs
}

/// Hears what users say, and keeps of it what the mission keeps.
struct Listener<'r> {
    rules: &'r MissionRules,
    bound: Arc<BoundRules>,
    names: BTreeMap<UserId, &'r str>,
    goals: BTreeMap<UserId, GoalId>,
    /// The data of the last event, until the mission has said what it makes of them.
    said: Option<(UserId, Option<UserData>)>,
    /// `None`: something that the user said is not in the trace.
    heard: BTreeMap<UserId, Option<Recollection>>,
    snapshots: BTreeMap<UserId, Option<Snapshot>>,
}

impl Listener<'_> {
    fn hear(&mut self, open: &evidence::Event, event: impl FnOnce() -> Result<Event, ReplayError>) {
        self.said = None;
        match &open.event {
            Some(OpenEvent::Data(answer)) => {
                let data = match event() {
                    Ok(Event::Data { data, .. }) => Some(data),
                    _ => None,
                };
                self.said = Some((UserId(answer.user), data));
            }
            Some(OpenEvent::Context(about) | OpenEvent::Status(about)) => {
                let Some(heard) = self.heard.get_mut(&UserId(about.user)) else { return };
                let Some(recollection) = heard else { return };
                // What cannot be used is recorded, and may have been noted in part; so it is here.
                let _ = match event() {
                    Ok(Event::Context { attribute, value, .. }) => {
                        recollection.hear_context(attribute.as_str(), value.as_str(), self.rules)
                    }
                    Ok(Event::Status { condition, truth, .. }) => {
                        recollection.hear_status(condition.as_str(), truth, self.rules)
                    }
                    _ => {
                        *heard = None;
                        return;
                    }
                };
            }
            _ => {}
        }
    }

    fn note(&mut self, record: &Record) {
        match record {
            Record::Admitted(admitted) => {
                if let Ok(goal) = u16::try_from(admitted.goal) {
                    self.goals.insert(UserId(admitted.user), GoalId(goal));
                }
            }
            Record::DataAccepted(subject) => {
                let user = UserId(subject.user);
                if let Some((_, data)) = self.said.take_if(|(whose, _)| *whose == user) {
                    // The mission holds no more users than its limits say; nor is more kept here.
                    let users = usize::from(self.rules.specification().limits.users);
                    let has_room = self.heard.len() < users || self.heard.contains_key(&user);
                    let data = data.filter(|_| has_room);
                    let recollection = data.and_then(|data| Recollection::of(user, &data, self.rules).ok());
                    self.heard.insert(user, recollection);
                }
            }
            Record::NegotiationStarted(started) => {
                for user in [UserId(started.current), UserId(started.interrupting)] {
                    self.snapshot(user);
                }
            }
            Record::Wiped(wiped) => {
                let user = UserId(wiped.user);
                self.snapshots.remove(&user);
                if wiped.component() == evidence::Component::ContextEthicsManager {
                    self.heard.remove(&user);
                }
            }
            Record::Decided(_) | Record::NegotiationsDropped(_) => self.snapshots.clear(),
            _ => {}
        }
    }

    fn snapshot(&mut self, user: UserId) {
        let (Some(heard), Some(&goal)) = (self.heard.get(&user), self.goals.get(&user)) else { return };
        let rules = self.rules;
        self.snapshots
            .entry(user)
            .or_insert_with(|| heard.as_ref().map(|recollection| recollection.snapshot(goal, rules)));
    }

    fn inputs(&self, decision: &RecordedDecision) -> Result<Inputs, CaseError> {
        let listed = self.rules.bound().conditions();
        let mut rules = Arc::clone(&self.bound);
        let (mut users, mut unlisted) = (Vec::new(), Vec::new());
        for &user in &decision.participants {
            let snapshot = self.snapshots.get(&user).ok_or(CaseError::NotNegotiated(user.0))?;
            let snapshot = snapshot.as_ref().ok_or(CaseError::NotSaid(user.0))?;
            let mut places = BTreeMap::new();
            let mut conditions = Vec::with_capacity(snapshot.conditions.len());
            for (condition, name) in &snapshot.conditions {
                let Some(name) = name else {
                    conditions.push(*condition);
                    continue;
                };
                let too_many = CaseError::TooMany(user.0);
                let learnt = Arc::make_mut(&mut rules).learn(name).ok_or_else(|| too_many.clone())?;
                let place = usize::from(condition.0).checked_sub(listed);
                let place = place.and_then(|place| u16::try_from(place).ok()).ok_or(too_many)?;
                places.insert(learnt.0, place);
                conditions.push(learnt);
            }
            users.push(self.bound_user(user, snapshot, conditions));
            unlisted.push(places);
        }
        let willingness = decision
            .negotiations
            .iter()
            .filter(|negotiation| Some(&negotiation.current) == decision.participants.first())
            .map(|negotiation| negotiation.willingness)
            .max();
        let willingness = u8::try_from(willingness.unwrap_or(0)).unwrap_or(u8::MAX);
        let options = Options { willingness, ..self.rules.options() };
        let policy = policy_for(self.rules.policy(), users.len());
        Ok(Inputs { rules, users, options, policy, listed, unlisted })
    }

    fn bound_user(&self, user: UserId, snapshot: &Snapshot, conditions: Vec<Condition>) -> BoundUser {
        let goals = &self.rules.specification().goals;
        let goal = goals.get(usize::from(snapshot.goal.0)).map_or_else(String::new, |goal| goal.name.clone());
        let name = match self.names.get(&user) {
            Some(name) => (*name).to_owned(),
            None => format!("user {}", user.0),
        };
        BoundUser::from_parts(name, goal, snapshot.ranks.clone(), conditions, snapshot.mentions.clone())
    }
}

/// The policy among so many: the one asked for, if it has a rule for them.
pub(crate) fn policy_for(asked: Option<Policy>, participants: usize) -> Policy {
    match asked {
        Some(Policy::Condorcet) => Policy::Condorcet,
        Some(Policy::Published) | None => Policy::default_for(participants.saturating_sub(1)),
    }
}
