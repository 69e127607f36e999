//! What was recorded, by type.

use std::time::Duration;

use super::encode::Open;
use super::error::TraceError;
use super::format::MAX_MESSAGE_BYTES;
use super::reader::Message;
use super::scan::Scan;
use super::schema::{Schema, evidence, personal};
use super::setup;

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
    /// Of the entries before this index everything personal was written that there ever was.
    pub personal_until: u64,
    /// What the robot committed to, in a sealed trace.
    pub commitments: Vec<evidence::Commitment>,
    /// What opens the commitments, as far as it is there.
    pub openings: Vec<personal::Opening>,
    /// What is wrong behind the last entry; of a complete trace nothing.
    pub damage: Option<TraceError>,
}

impl Recording {
    /// Reads a whole file in memory, without a key. Of a damaged one everything before the
    /// damage is read.
    ///
    /// # Errors
    /// [`TraceError`] if not even the header can be read, or the format is a newer one.
    pub fn read(bytes: &[u8]) -> Result<Self, TraceError> {
        let scan = Scan::of(bytes);
        Self::of(&scan, scan.messages.iter())
    }

    /// Makes a recording of a file's messages, and of messages of its segments among them,
    /// each after the one in the open that it was written after.
    pub(super) fn of<'m>(
        scan: &'m Scan,
        messages: impl Iterator<Item = &'m Message>,
    ) -> Result<Self, TraceError> {
        let header = scan.header()?;
        let mut recording = Self {
            header,
            rules: None,
            participants: Vec::new(),
            entries: Vec::new(),
            end: None,
            messages: 0,
            personal_until: 0,
            commitments: Vec::new(),
            openings: Vec::new(),
            damage: None,
        };
        for message in messages {
            recording.damage = recording.number(message).and_then(|()| recording.take(message)).err();
            if recording.damage.is_some() {
                break;
            }
        }
        if recording.damage.is_none() {
            recording.damage.clone_from(&scan.damage);
        }
        if recording.damage.is_none() && recording.end.is_none() {
            recording.damage = Some(TraceError::Truncated { at: scan.length });
        }
        let entries = count(recording.entries.len());
        match (&recording.damage, recording.header.privacy()) {
            (None, _) => recording.personal_until = entries,
            // Between the halves of the last one.
            (Some(_), evidence::Privacy::Plain | evidence::Privacy::Unspecified) => {
                recording.personal_until = entries.saturating_sub(1);
            }
            // As the last segments say.
            (Some(_), _) => {}
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
        let decided = |entry: &&Entry| match &entry.step {
            Step::Reply { open: Open::Record(record), .. } => is_decision(record),
            _ => false,
        };
        count(self.entries.iter().filter(decided).count())
    }

    fn number(&mut self, message: &Message) -> Result<(), TraceError> {
        if message.is_inner {
            return Ok(());
        }
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
        match Schema::of_name(&message.schema) {
            // The first one was read before.
            Some(Schema::Header) if message.sequence == 0 => {}
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
            Some(Schema::Rules) => {
                if self.rules.is_some() {
                    return Err(bad(message, "a second set of rules"));
                }
                let rules: personal::Rules = decoded(message)?;
                let named = setup::name_header(&mut self.header, &rules, &message.data);
                named.map_err(|what| bad(message, what))?;
                self.rules = Some(rules);
            }
            Some(Schema::Sealed) => {
                let sealed: evidence::Sealed = decoded(message)?;
                if sealed.last {
                    self.personal_until = count(self.entries.len());
                }
            }
            Some(Schema::Commitment) => self.commitments.push(decoded(message)?),
            Some(Schema::Opening) => self.openings.push(decoded(message)?),
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

/// Whether the robot decided here: in a negotiation, or for an emergency.
pub(crate) fn is_decision(record: &evidence::Record) -> bool {
    use evidence::record::Record::{Decided, EmergencyDecided};
    matches!(record.record, Some(Decided(_) | EmergencyDecided(_)))
}

fn count(number: usize) -> u64 {
    u64::try_from(number).unwrap_or(u64::MAX)
}

pub(super) fn bad(message: &Message, what: &str) -> TraceError {
    TraceError::BadMessage {
        sequence: message.sequence,
        topic: message.topic.to_string(),
        what: what.to_owned(),
    }
}

pub(super) fn decoded<M: prost::Message + Default>(message: &Message) -> Result<M, TraceError> {
    if message.data.len() > MAX_MESSAGE_BYTES && *message.schema != *Schema::Sealed.name() {
        return Err(bad(message, &format!("more than {MAX_MESSAGE_BYTES} bytes")));
    }
    M::decode(message.data.as_slice()).map_err(|error| bad(message, &error.to_string()))
}
