//! What happened, in sentences with their times.

use std::time::Duration;

use prost::Message as _;

use crate::trace::schema::Schema;
use crate::trace::schema::evidence::{self, event, record};
use crate::trace::schema::foxglove::Log;
use crate::trace::{Message, Topic};

/// Everything that is told, by the second.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Timeline {
    /// In order; no two of the same second.
    pub moments: Vec<Moment>,
    /// Told with names, as the robot's story; else by pseudonyms.
    pub named: bool,
}

/// What happened within one second.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moment {
    /// Of the first sentence, since the run's begin.
    pub at: Duration,
    /// In order; at least one.
    pub sentences: Vec<Sentence>,
}

/// One sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sentence {
    /// Since the run's begin.
    pub at: Duration,
    /// What it is about.
    pub kind: Kind,
    /// As recorded.
    pub text: String,
}

/// What a sentence tells of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Something else.
    #[default]
    Other,
    /// Somebody, or an emergency, asks for the robot while it serves.
    Interruption,
    /// A round of the negotiations of this decision.
    Round {
        /// From 1.
        decision: u64,
    },
    /// A decision.
    Decision {
        /// From 1.
        decision: u64,
    },
}

impl Timeline {
    /// The story with names if the trace has it, else the log with pseudonyms, as far as it is
    /// for people.
    #[must_use]
    pub fn of(messages: &[Message]) -> Self {
        let mut teller = Teller::default();
        for message in messages {
            teller.hear(message);
        }
        let named = !teller.story.is_empty();
        let sentences = if named { teller.story } else { teller.log };
        let mut moments: Vec<Moment> = Vec::new();
        for sentence in sentences {
            match moments.last_mut() {
                Some(moment) if moment.at.as_secs() == sentence.at.as_secs() => {
                    moment.sentences.push(sentence);
                }
                _ => moments.push(Moment { at: sentence.at, sentences: vec![sentence] }),
            }
        }
        Self { moments, named }
    }

    /// All sentences of a kind that `wanted` says yes to.
    pub fn sentences(&self, wanted: impl Fn(Kind) -> bool) -> impl Iterator<Item = &Sentence> {
        let all = self.moments.iter().flat_map(|moment| &moment.sentences);
        all.filter(move |sentence| wanted(sentence.kind))
    }
}

/// Follows the steps to know what a sentence is about: in a trace it comes after them.
#[derive(Default)]
struct Teller {
    story: Vec<Sentence>,
    log: Vec<Sentence>,
    serving: bool,
    decisions: u64,
    /// Of the last step, for the next sentence of the story.
    next: Kind,
    /// The same for the log, if the last step is for people.
    next_logged: Option<Kind>,
}

impl Teller {
    fn hear(&mut self, message: &Message) {
        if *message.schema == *Schema::Event.name() {
            if let Ok(event) = evidence::Event::decode(message.data.as_slice()) {
                self.event(event.event.as_ref());
            }
        } else if *message.schema == *Schema::Record.name() {
            if let Ok(record) = evidence::Record::decode(message.data.as_slice()) {
                self.record(record.record.as_ref());
            }
        } else if *message.schema == *Schema::Command.name() {
            self.next_logged = None;
        } else if *message.schema == *Schema::Log.name() {
            self.sentence(message);
        }
    }

    fn sentence(&mut self, message: &Message) {
        let Ok(log) = Log::decode(message.data.as_slice()) else { return };
        let at = Duration::from_nanos(message.log_time);
        if *message.topic == *Topic::STORY.name {
            let kind = std::mem::take(&mut self.next);
            self.story.push(Sentence { at, kind, text: log.message });
        } else if let Some(kind) = self.next_logged.take() {
            self.log.push(Sentence { at, kind, text: log.message });
        }
    }

    fn event(&mut self, event: Option<&event::Event>) {
        use event::Event;
        let interrupts = match event {
            Some(Event::Request(_)) => self.serving,
            Some(Event::Emergency(_)) => true,
            _ => false,
        };
        self.next = if interrupts { Kind::Interruption } else { Kind::Other };
        let silent = matches!(event, None | Some(Event::NextRound(_) | Event::ActionDone(_)));
        self.next_logged = (!silent).then_some(self.next);
    }

    fn record(&mut self, record: Option<&record::Record>) {
        use record::Record;
        let kind = match record {
            Some(Record::GoalStarted(_)) => {
                self.serving = true;
                Kind::Other
            }
            Some(Record::GoalEnded(_)) => {
                self.serving = false;
                Kind::Other
            }
            Some(Record::Round(_)) => Kind::Round { decision: self.decisions.saturating_add(1) },
            Some(Record::Decided(_) | Record::EmergencyDecided(_)) => {
                self.decisions = self.decisions.saturating_add(1);
                Kind::Decision { decision: self.decisions }
            }
            _ => Kind::Other,
        };
        // A record without a sentence of its own leaves what the next sentence is about.
        if kind != Kind::Other || matches!(record, Some(Record::GoalStarted(_) | Record::GoalEnded(_))) {
            self.next = kind;
        }
        let silent = matches!(
            record,
            None | Some(
                Record::Lifecycle(_)
                    | Record::ProfileActivated(_)
                    | Record::ProfileKept(_)
                    | Record::DataAccepted(_)
                    | Record::Admitted(_)
            )
        );
        let component_wiped = matches!(
            record,
            Some(Record::Wiped(wiped)) if wiped.component() != evidence::Component::ContextEthicsManager
        );
        self.next_logged = (!silent && !component_wiped).then_some(kind);
    }
}

/// An interruption or a decision: what the map marks, and what has a button beside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeyMoment {
    /// From 1, in order of time.
    pub number: usize,
    /// Since the run's begin.
    pub at: Duration,
    /// The decision, if it is one.
    pub decision: Option<u64>,
    /// As recorded.
    pub text: String,
}

impl Timeline {
    /// Interruptions and decisions, in order of time.
    #[must_use]
    pub fn key_moments(&self) -> Vec<KeyMoment> {
        let key = |kind| matches!(kind, Kind::Interruption | Kind::Decision { .. });
        let moment = |(nth, sentence): (usize, &Sentence)| KeyMoment {
            number: nth.saturating_add(1),
            at: sentence.at,
            decision: match sentence.kind {
                Kind::Decision { decision } => Some(decision),
                _ => None,
            },
            text: sentence.text.clone(),
        };
        self.sentences(key).enumerate().map(moment).collect()
    }
}
