//! The recorded events once more, through a new mission: does it reply as recorded?

use std::time::Duration;

use super::encode::Encoder;
use super::recording::{Entry, Recording, Step};
use super::schema::evidence::{self, event};
use super::schema::personal::{self, input};
use super::setup::{mission_rules, small};
use crate::input::Truth;
use crate::mission::{
    AskId, CategoryId, Event, Evidence, ExecutionId, GoalId, Mission, MissionRules, Output, Place, Profile,
    SpecificationError, Stated, Text, UserData, UserId,
};

/// Why the events cannot be run once more.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The recorded rules or specification are refused.
    #[error("recorded rules: {0}")]
    Rules(#[from] SpecificationError),
    /// Something has no value, or one that this program does not know.
    #[error("{0}: missing, or with a value that this program does not know")]
    Unknown(&'static str),
    /// The personal half of something is not in the trace (any more).
    #[error("the personal part of {what} is missing")]
    NoPersonal {
        /// Of what.
        what: String,
    },
}

/// What came of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// How many events were replayed.
    pub events: u64,
    /// What the new mission replied.
    pub outputs: Vec<Output>,
    /// Where it first replied something else than recorded; the replay ends there.
    pub difference: Option<Difference>,
}

/// A reply that is not as recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The place among events and replies.
    pub index: u64,
    /// The recorded time, if something is recorded there.
    pub at: Option<Duration>,
    /// What the new mission replies, if anything: it may be personal.
    pub replayed: Option<Output>,
    /// What is recorded, if anything: it may be personal.
    pub recorded: Option<Entry>,
}

impl Recording {
    /// The rules of the recorded mission.
    ///
    /// # Errors
    /// [`ReplayError`] if they are not in the trace, or refused.
    pub fn mission_rules(&self) -> Result<MissionRules, ReplayError> {
        let missing = || ReplayError::NoPersonal { what: "the rules".to_owned() };
        mission_rules(&self.header, self.rules.as_ref().ok_or_else(missing)?)
    }

    /// The recorded events, with their times.
    pub fn events(&self) -> impl Iterator<Item = Result<(Duration, Event), ReplayError>> + '_ {
        self.entries.iter().filter_map(|entry| match &entry.step {
            Step::Event { open, personal } => {
                Some(decode_event(open, personal.as_ref()).map(|event| (entry.at, event)))
            }
            Step::Reply { .. } => None,
        })
    }

    /// Runs the recorded events through a new mission and compares its replies with the
    /// recorded ones, personal halves included. Replies that a damaged trace has lost after
    /// its last entry are no difference.
    ///
    /// # Errors
    /// [`ReplayError`] if the recorded rules or an event cannot be made again.
    pub fn replay(&self) -> Result<Replay, ReplayError> {
        let (mut mission, first) = Mission::new(self.mission_rules()?);
        let mut encoder = Encoder::default();
        let mut entries = self.entries.iter();
        let mut replay = Replay { events: 0, outputs: Vec::new(), difference: None };
        replay.difference = self.compare(first, &mut encoder, &mut entries, &mut replay.outputs);
        while replay.difference.is_none() {
            let Some(entry) = entries.next() else { break };
            let Step::Event { open, personal } = &entry.step else {
                replay.difference = Some(difference(entry.index, None, Some(entry)));
                break;
            };
            let event = match decode_event(open, personal.as_ref()) {
                // Cut between the halves of an event.
                Err(ReplayError::NoPersonal { .. }) if self.is_cut_after(entry) => break,
                event => event?,
            };
            let _counted = encoder.event(&event);
            replay.events = replay.events.saturating_add(1);
            let outputs = mission.handle(event);
            replay.difference = self.compare(outputs, &mut encoder, &mut entries, &mut replay.outputs);
        }
        Ok(replay)
    }

    /// Whether what belongs to this entry may be lost.
    fn is_cut_after(&self, entry: &Entry) -> bool {
        self.damage.is_some() && entry.index >= self.personal_until
    }

    fn compare<'r>(
        &'r self,
        outputs: Vec<Output>,
        encoder: &mut Encoder,
        entries: &mut impl Iterator<Item = &'r Entry>,
        replayed: &mut Vec<Output>,
    ) -> Option<Difference> {
        for output in outputs {
            let index = encoder.count();
            let encoded = encoder.output(&output);
            let Some(entry) = entries.next() else {
                let lost = self.damage.is_some();
                return if lost { None } else { Some(difference(index, Some(output), None)) };
            };
            let may_be_cut = self.is_cut_after(entry);
            let same = match &entry.step {
                Step::Reply { topic, open, personal } => {
                    let said: Vec<&personal::Reply> =
                        encoded.personal.iter().map(|(_, reply)| reply).collect();
                    let recorded: Vec<&personal::Reply> = personal.iter().collect();
                    *topic == encoded.topic.name
                        && *open == encoded.open
                        && (said == recorded || (may_be_cut && said.starts_with(&recorded)))
                }
                Step::Event { .. } => false,
            };
            if !same {
                return Some(difference(index, Some(output), Some(entry)));
            }
            replayed.push(output);
        }
        None
    }
}

fn difference(index: u64, replayed: Option<Output>, recorded: Option<&Entry>) -> Difference {
    Difference { index, at: recorded.map(|entry| entry.at), replayed, recorded: recorded.cloned() }
}

/// The event whose halves these are.
pub(crate) fn decode_event(
    open: &evidence::Event,
    personal: Option<&personal::Input>,
) -> Result<Event, ReplayError> {
    use event::Event as Open;
    let recorded = open.event.as_ref().ok_or(ReplayError::Unknown("event"))?;
    let missing = || ReplayError::NoPersonal { what: format!("event {}", open.index) };
    let input = || personal.and_then(|personal| personal.input.as_ref()).ok_or_else(missing);
    let place = || match input()? {
        input::Input::Place(place) => Ok(Place(*place)),
        _ => Err(missing()),
    };
    let execution = |recorded: &evidence::Execution| ExecutionId(recorded.execution);
    Ok(match recorded {
        Open::Request(request) => Event::Request {
            user: UserId(request.user),
            goal: GoalId(small(request.goal, "goal")?),
            place: place()?,
        },
        Open::Data(answer) => match input()? {
            input::Input::Data(data) => {
                Event::Data { user: UserId(answer.user), ask: AskId(answer.ask), data: user_data(data)? }
            }
            _ => return Err(missing()),
        },
        Open::DataTimeout(answer) => Event::DataTimeout { user: UserId(answer.user), ask: AskId(answer.ask) },
        Open::Context(about) => match input()? {
            input::Input::Context(attribute) => Event::Context {
                user: UserId(about.user),
                attribute: attribute.name.as_str().into(),
                value: attribute.value.as_str().into(),
            },
            _ => return Err(missing()),
        },
        Open::Status(about) => match input()? {
            input::Input::Status(said) => {
                let Stated { condition, truth } = stated(said)?;
                Event::Status { user: UserId(about.user), condition, truth }
            }
            _ => return Err(missing()),
        },
        Open::ActionDone(done) => Event::ActionDone { execution: execution(done) },
        Open::ActionFailed(failed) => Event::ActionFailed { execution: execution(failed) },
        Open::NextRound(_) => Event::NextRound,
        Open::Emergency(claim) => Event::Emergency {
            category: CategoryId(small(claim.category, "category")?),
            place: place()?,
            evidence: match claim.evidence() {
                evidence::Evidence::Claimed => Evidence::Claimed,
                evidence::Evidence::Sensed => Evidence::Sensed,
                evidence::Evidence::Verified => Evidence::Verified,
                evidence::Evidence::Unspecified => return Err(ReplayError::Unknown("evidence")),
            },
        },
        Open::Withdraw(about) => Event::Withdraw { user: UserId(about.user) },
        Open::Shutdown(_) => Event::Shutdown,
    })
}

fn user_data(data: &personal::UserData) -> Result<UserData, ReplayError> {
    let rank = |rank: &personal::Rank| Ok((Text::from(rank.disposition.as_str()), small(rank.rank, "rank")?));
    let profile = |profile: &personal::Profile| {
        Ok(Profile {
            label: profile.label.as_str().into(),
            ranks: profile.ranks.iter().map(rank).collect::<Result<_, ReplayError>>()?,
        })
    };
    let attribute = |attribute: &personal::Attribute| {
        (Text::from(attribute.name.as_str()), Text::from(attribute.value.as_str()))
    };
    Ok(UserData {
        profiles: data.profiles.iter().map(profile).collect::<Result<_, ReplayError>>()?,
        status: data.status.iter().map(stated).collect::<Result<_, ReplayError>>()?,
        context: data.context.iter().map(attribute).collect(),
    })
}

fn stated(said: &personal::Stated) -> Result<Stated, ReplayError> {
    let truth = match said.truth() {
        personal::Truth::True => Truth::True,
        personal::Truth::False => Truth::False,
        personal::Truth::Withheld => Truth::Withheld,
        personal::Truth::Unspecified => return Err(ReplayError::Unknown("truth")),
    };
    Ok(Stated { condition: said.condition.as_str().into(), truth })
}
