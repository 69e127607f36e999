//! What was recorded, by type.

use std::time::Duration;

use super::encode::Open;
use super::error::TraceError;
use super::format::FORMAT_MAJOR;
use super::reader::{Message, Reader};
use super::schema::{Schema, evidence, personal};

/// One event or reply, with its place and time.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its place among events and replies.
    pub index: u64,
    /// Simulated time since the run's begin.
    pub at: Duration,
    /// What it is.
    pub step: Step,
}

/// What happened, or what the mission replied.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// An event.
    Event {
        /// What is nobody's data.
        open: evidence::Event,
        /// What is somebody's, if there is such and it is there.
        personal: Option<personal::Input>,
    },
    /// A record or a command.
    Reply {
        /// The open half's topic.
        topic: String,
        /// What is nobody's data.
        open: Open,
        /// What is somebody's, as far as it is there.
        personal: Vec<personal::Reply>,
    },
}

/// A trace's evidence: what is for viewers is left out.
#[derive(Clone, Debug)]
pub struct Recording {
    /// What was fixed before the run.
    pub header: evidence::Header,
    /// What rules and specification name and rank.
    pub rules: Option<personal::Rules>,
    /// Who took part.
    pub participants: Vec<personal::Participant>,
    /// Events and replies, in order and without a gap.
    pub entries: Vec<Entry>,
    /// What the trace says that it holds, if it has an end.
    pub end: Option<evidence::End>,
    /// How many messages were read, those for viewers included.
    pub messages: u64,
    /// What is wrong behind the last entry; of a complete trace nothing.
    pub damage: Option<TraceError>,
}

impl Recording {
    /// Reads a whole file in memory. Of a damaged one everything before the damage is read.
    ///
    /// # Errors
    /// [`TraceError`] if not even the header can be read, or the format is a newer one.
    pub fn read(bytes: &[u8]) -> Result<Self, TraceError> {
        let mut reader = Reader::new(bytes);
        let first = reader.next().ok_or(TraceError::NotATrace("it has no message"))??;
        if reader.format().is_none() {
            return Err(TraceError::NotATrace("it does not say its format's version"));
        }
        if *first.schema != *Schema::Header.name() {
            return Err(TraceError::NotATrace("its first message is not the header"));
        }
        let header: evidence::Header = decoded(&first)?;
        if header.format_major > FORMAT_MAJOR {
            let found = format!("{}.{}", header.format_major, header.format_minor);
            return Err(TraceError::NewerMajor { found });
        }
        let mut recording = Self {
            header,
            rules: None,
            participants: Vec::new(),
            entries: Vec::new(),
            end: None,
            messages: 0,
            damage: None,
        };
        recording.damage = recording.number(&first).err();
        for message in reader.by_ref() {
            if recording.damage.is_some() {
                break;
            }
            let taken = message.and_then(|message| {
                recording.number(&message)?;
                recording.take(&message)
            });
            recording.damage = taken.err();
        }
        if recording.damage.is_none() && recording.end.is_none() {
            let at = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
            recording.damage = Some(TraceError::Truncated { at });
        }
        Ok(recording)
    }

    /// Whether nothing is missing, as far as the trace itself can tell.
    #[must_use]
    pub const fn is_complete(&self) -> bool {
        self.damage.is_none()
    }

    /// How many decisions are recorded: of negotiations, and emergencies found certain.
    #[must_use]
    pub fn decisions(&self) -> u64 {
        use evidence::record::Record::{Decided, EmergencyDecided};
        let is_decision = |entry: &&Entry| {
            matches!(
                &entry.step,
                Step::Reply { open: Open::Record(record), .. }
                    if matches!(record.record, Some(Decided(_) | EmergencyDecided(_)))
            )
        };
        count(self.entries.iter().filter(is_decision).count())
    }

    fn number(&mut self, message: &Message) -> Result<(), TraceError> {
        let found = u64::from(message.sequence);
        if found != self.messages {
            return Err(TraceError::Gap { expected: self.messages, found });
        }
        self.messages = self.messages.saturating_add(1);
        Ok(())
    }

    fn take(&mut self, message: &Message) -> Result<(), TraceError> {
        if self.end.is_some() {
            return Err(bad(message, "it comes after the end"));
        }
        let known = Schema::ALL.into_iter().find(|schema| *schema.name() == *message.schema);
        match known {
            Some(Schema::Header) => return Err(bad(message, "a second header")),
            Some(Schema::End) => {
                let end: evidence::End = decoded(message)?;
                self.check(&end)?;
                self.end = Some(end);
            }
            Some(Schema::Event) => {
                let open: evidence::Event = decoded(message)?;
                self.enter(message, open.index, Step::Event { open, personal: None })?;
            }
            Some(Schema::Record) => {
                let open: evidence::Record = decoded(message)?;
                self.enter_reply(message, open.index, Open::Record(open))?;
            }
            Some(Schema::Command) => {
                let open: evidence::Command = decoded(message)?;
                self.enter_reply(message, open.index, Open::Command(open))?;
            }
            Some(Schema::Rules) => self.rules = Some(decoded(message)?),
            Some(Schema::Participant) => self.participants.push(decoded(message)?),
            Some(Schema::Input) => {
                let input: personal::Input = decoded(message)?;
                match self.entries.last_mut() {
                    Some(Entry { index, step: Step::Event { personal, .. }, .. })
                        if *index == input.index && personal.is_none() =>
                    {
                        *personal = Some(input);
                    }
                    _ => return Err(bad(message, "it belongs to no event before it")),
                }
            }
            Some(Schema::Reply) => {
                let reply: personal::Reply = decoded(message)?;
                match self.entries.last_mut() {
                    Some(Entry { index, step: Step::Reply { personal, .. }, .. })
                        if *index == reply.index =>
                    {
                        personal.push(reply);
                    }
                    _ => return Err(bad(message, "it belongs to no reply before it")),
                }
            }
            // For viewers, or from a newer minor version.
            _ => {}
        }
        Ok(())
    }

    fn enter_reply(&mut self, message: &Message, index: u64, open: Open) -> Result<(), TraceError> {
        let topic = message.topic.to_string();
        self.enter(message, index, Step::Reply { topic, open, personal: Vec::new() })
    }

    fn enter(&mut self, message: &Message, index: u64, step: Step) -> Result<(), TraceError> {
        if index != count(self.entries.len()) {
            return Err(bad(message, "its index is not the next one"));
        }
        self.entries.push(Entry { index, at: Duration::from_nanos(message.log_time), step });
        Ok(())
    }

    fn check(&self, end: &evidence::End) -> Result<(), TraceError> {
        let events = self.entries.iter().filter(|entry| matches!(entry.step, Step::Event { .. })).count();
        let replies = self.entries.len().saturating_sub(events);
        for (what, stored, found) in [
            ("events", end.events, count(events)),
            ("replies", end.replies, count(replies)),
            ("decisions", end.decisions, self.decisions()),
            ("messages before it", end.messages, self.messages.saturating_sub(1)),
        ] {
            if stored != found {
                return Err(TraceError::Miscounted { what, stored, found });
            }
        }
        Ok(())
    }
}

fn count(number: usize) -> u64 {
    u64::try_from(number).unwrap_or(u64::MAX)
}

fn bad(message: &Message, what: &str) -> TraceError {
    TraceError::BadMessage {
        sequence: message.sequence,
        topic: message.topic.to_string(),
        what: what.to_owned(),
    }
}

fn decoded<M: prost::Message + Default>(message: &Message) -> Result<M, TraceError> {
    M::decode(message.data.as_slice()).map_err(|error| bad(message, &error.to_string()))
}
