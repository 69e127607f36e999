//! The whole mission once more, event by event: every reply that is not as recorded.
//!
//! The mission's state depends on the events alone, never on what is recorded of its replies;
//! so one false record does not hide what comes after it.

use super::finding::{Log, Place, conditions};
use super::property::Property;
use super::status::Status;
use super::turn::Turn;
use crate::mission::{Mission, MissionRules, Output};
use crate::trace::schema::evidence::{self, Verdict, record::Record, round, served};
use crate::trace::schema::personal;
use crate::trace::{EncodedOutput, Encoder, Entry, Open, Recording, ReplayError, Step, decode_event};

/// Of the replies to one event so many differences are told one by one.
const MOST_OF_A_TURN: u64 = 2;

/// Events with differences beyond so many are counted only: a run that went another way does so
/// to its end.
const MOST_TURNS: u64 = 8;

/// How far the mission could be run again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    /// To the last event.
    Whole,
    /// To this event, whose personal part is not there.
    Until(Place),
    /// To this event, which no program of this version wrote.
    Unknown(Place, String),
}

/// Runs the recorded events through a new mission, and compares. `erased` says that some
/// people's parts of replies are not there any more.
pub(super) fn check(
    recording: &Recording,
    rules: MissionRules,
    turns: &[Turn<'_>],
    erased: bool,
    log: &mut Log,
) -> Extent {
    let (mut mission, first) = Mission::new(rules);
    let mut encoder = Encoder::default();
    let mut first = Some(first);
    let mut differing = 0_u64;
    for turn in turns {
        let outputs = match turn.event {
            None => first.take().unwrap_or_default(),
            Some(entry) => {
                let Step::Event { open, personal } = &entry.step else { continue };
                let at = Place::entry(entry.index, entry.at);
                match decode_event(open, personal.as_ref()) {
                    Ok(event) => mission.handle(event),
                    Err(ReplayError::NoPersonal { .. }) => return Extent::Until(at),
                    Err(error) => return Extent::Unknown(at, error.to_string()),
                }
            }
        };
        let told = if differing < MOST_TURNS { MOST_OF_A_TURN } else { 0 };
        let comparison = Comparison { recording, erased, told };
        if !comparison.compare(turn, &outputs, &mut encoder, log) {
            differing = differing.saturating_add(1);
        }
    }
    if let Some(more) = differing.checked_sub(MOST_TURNS).filter(|&more| more > 0) {
        let what = format!("the replies to {more} more events are not as recorded");
        log.find(Property::Replay.status(), Place::WHOLE, what);
    }
    Extent::Whole
}

struct Comparison<'r> {
    recording: &'r Recording,
    erased: bool,
    /// How many differences to tell.
    told: u64,
}

impl Comparison<'_> {
    /// Holds a turn's replies against the mission's. Where they part, one more or one less
    /// here or there is looked for, so that a reply left out is not taken for many changed.
    fn compare(&self, turn: &Turn<'_>, outputs: &[Output], encoder: &mut Encoder, log: &mut Log) -> bool {
        let again: Vec<EncodedOutput> = outputs.iter().map(|output| encoder.output(output)).collect();
        let event_at = turn.event.map_or(Place::WHOLE, |event| Place::entry(event.index, event.at));
        let (mut recorded, mut again) = (turn.replies, again.as_slice());
        let mut at = event_at;
        let mut differences = 0_u64;
        let mut broken = |log: &mut Log, at, recorded: Option<&Open>, again: Option<&Open>| {
            differences = differences.saturating_add(1);
            if differences <= self.told {
                broken(log, at, recorded, again);
            }
        };
        loop {
            match (recorded, again) {
                ([], []) => break,
                ([], [missing, rest @ ..]) => {
                    if turn.may_be_cut {
                        break;
                    }
                    broken(log, at, None, Some(&missing.open));
                    again = rest;
                }
                ([extra, rest @ ..], []) => {
                    at = Place::entry(extra.index, extra.at);
                    broken(log, at, open_of(extra), None);
                    recorded = rest;
                }
                ([entry, recorded_rest @ ..], [output, again_rest @ ..]) => {
                    at = Place::entry(entry.index, entry.at);
                    let same = |entry: Option<&Entry>, output: Option<&EncodedOutput>| {
                        entry.zip(output).is_some_and(|(entry, output)| self.is_same(entry, output))
                    };
                    if same(Some(entry), Some(output)) {
                        log.held(Property::Replay);
                        (recorded, again) = (recorded_rest, again_rest);
                    } else if same(recorded_rest.first(), Some(output)) {
                        broken(log, at, open_of(entry), None);
                        recorded = recorded_rest;
                    } else if same(Some(entry), again_rest.first()) {
                        broken(log, at, None, Some(&output.open));
                        again = again_rest;
                    } else {
                        broken(log, at, open_of(entry), Some(&output.open));
                        (recorded, again) = (recorded_rest, again_rest);
                    }
                }
            }
        }
        if let Some(more) = differences.checked_sub(self.told).filter(|&more| more > 0) {
            if self.told > 0 {
                let what = format!("{more} more of the replies to this event are not as recorded");
                log.broken(Property::Replay, event_at, what);
            } else {
                log.not_held(Property::Replay);
            }
        }
        differences == 0
    }

    /// Whether a reply is the recorded one, but for its number, which one reply too few or too
    /// many shifts.
    fn is_same(&self, entry: &Entry, output: &EncodedOutput) -> bool {
        let Step::Reply { topic, open, personal } = &entry.step else { return false };
        if *topic != output.topic.name || *open != renumbered(&output.open, entry.index) {
            return false;
        }
        let again: Vec<personal::Reply> = output
            .personal
            .iter()
            .map(|(_, reply)| personal::Reply { index: entry.index, ..*reply })
            .collect();
        if self.erased || entry.index >= self.recording.personal_until {
            personal.iter().all(|reply| again.contains(reply))
        } else {
            *personal == again
        }
    }
}

fn open_of(entry: &Entry) -> Option<&Open> {
    match &entry.step {
        Step::Reply { open, .. } => Some(open),
        Step::Event { .. } => None,
    }
}

fn renumbered(open: &Open, index: u64) -> Open {
    let mut open = open.clone();
    match &mut open {
        Open::Record(record) => record.index = index,
        Open::Command(command) => command.index = index,
    }
    open
}

/// Where a round, an outcome or a decision has another content, the decision is wrong. Where
/// one side has none, the run went another way, which is a violation.
fn broken(log: &mut Log, at: Place, recorded: Option<&Open>, again: Option<&Open>) {
    let both = recorded.is_some_and(is_of_decision) && again.is_some_and(is_of_decision);
    let status = if both { Status::WrongDecision } else { Property::Replay.status() };
    let what = match (recorded.map(tell), again.map(tell)) {
        (Some(recorded), Some(again)) if recorded == again => {
            format!("run again, the mission replies otherwise: {recorded}, but not in every part of it")
        }
        (Some(recorded), Some(again)) => {
            format!("recorded is: {recorded}; run again, the mission replies: {again}")
        }
        (Some(recorded), None) => {
            format!("recorded is: {recorded}; run again, the mission does not reply so")
        }
        (None, Some(again)) => format!("not recorded is what the mission, run again, replies: {again}"),
        (None, None) => "the mission, run again, replies otherwise".to_owned(),
    };
    log.broken_as(Property::Replay, status, at, what);
}

fn is_of_decision(open: &Open) -> bool {
    let Open::Record(record) = open else { return false };
    matches!(
        record.record,
        Some(
            Record::NegotiationStarted(_)
                | Record::Round(_)
                | Record::NegotiationEnded(_)
                | Record::Decided(_)
        )
    )
}

/// A reply in a few words, of its open half alone.
fn tell(open: &Open) -> String {
    let user = |user: Option<u32>| user.map_or_else(|| "nobody".to_owned(), |user| format!("user {user}"));
    match open {
        Open::Command(command) => match &command.command {
            Some(command) => format!("the command {}", name_of(command)),
            None => "a command of an unknown kind".to_owned(),
        },
        Open::Record(record) => match &record.record {
            None => "a record of an unknown kind".to_owned(),
            Some(Record::Round(recorded)) => {
                let event = match &recorded.round {
                    Some(round::Round::Offer(offer)) => {
                        let verdict = match offer.verdict() {
                            Verdict::Accept => "accepted",
                            Verdict::Reject => "rejected",
                            Verdict::Hold => "held",
                            Verdict::Unspecified => "without a verdict",
                        };
                        format!("offers {}, {verdict}", conditions(offer.depth))
                    }
                    Some(round::Round::Quit(_)) => "quits".to_owned(),
                    None => "does nothing".to_owned(),
                };
                format!("round {}, user {} {event}", recorded.number, recorded.sender)
            }
            Some(Record::NegotiationStarted(started)) => format!(
                "a negotiation of user {} and user {} with willingness {}",
                started.current, started.interrupting, started.willingness
            ),
            Some(Record::NegotiationEnded(ended)) => format!(
                "a negotiation of user {} and user {} won by {} after {} rounds ({})",
                ended.current,
                ended.interrupting,
                user(ended.winner),
                ended.rounds,
                ended.ending
            ),
            Some(Record::Decided(decided)) => format!(
                "a decision among {}, precedence for {}, user {} served, {} rounds",
                decided.participants.len(),
                user(decided.agreement),
                decided.served,
                decided.rounds
            ),
            Some(Record::Wiped(wiped)) => {
                format!("a wipe of user {} that leaves {} bytes", wiped.user, wiped.left)
            }
            Some(Record::Lifecycle(change)) => {
                let (component, from, to) = (change.component(), change.from(), change.to());
                format!("{component:?} of {} from {from:?} to {to:?}", user(change.user))
            }
            Some(Record::GoalStarted(started)) => {
                format!("goal {} begins for {}", started.goal, served_in(started.served.as_ref()))
            }
            Some(Record::GoalEnded(ended)) => {
                let end = ended.end();
                format!("goal {} of {} ends ({end:?})", ended.goal, served_in(ended.served.as_ref()))
            }
            Some(Record::Deferred(deferred)) => {
                let why = deferred.why();
                format!("user {} is put off ({why:?}) (deferral {})", deferred.user, deferred.times)
            }
            Some(Record::EmergencyDecided(known)) => {
                let evidence = known.evidence();
                format!("an emergency of category {} ({evidence:?}) is certain", known.category)
            }
            Some(Record::EmergencyUnverified(known)) => {
                let evidence = known.evidence();
                format!("an emergency of category {} ({evidence:?}) is not certain", known.category)
            }
            Some(record) => format!("the record {}", name_of(record)),
        },
    }
}

fn served_in(served: Option<&evidence::Served>) -> String {
    match served.and_then(|served| served.served.as_ref()) {
        Some(served::Served::User(user)) => format!("user {user}"),
        Some(served::Served::Emergency(category)) => format!("an emergency of category {category}"),
        None => "nobody".to_owned(),
    }
}

/// The variant's name, with its content: numbers and pseudonyms.
fn name_of(open: &impl std::fmt::Debug) -> String {
    format!("{open:?}")
}
