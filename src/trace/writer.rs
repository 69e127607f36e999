//! Watches a run and writes the trace.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::time::Duration;

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Compression, McapError, WriteOptions};
use prost::Message;
use selfneg_sim::{Person, World};

use super::encode::{Encoder, Open};
use super::format::{FORMAT_KEY, FORMAT_MAJOR, FORMAT_MINOR, FORMAT_RECORD, PROGRAM};
use super::schema::Schema;
use super::schema::evidence::End;
use super::schema::foxglove::{Log, log};
use super::sentence::{tell_event, tell_output};
use super::stamp::{nanos, timestamp};
use super::topic::{Topic, Whose, id};
use super::{frames, layers, scene, setup};
use crate::mission::{Event, Output, Record, Specification, UserId};
use crate::run::{Setup, Watcher};

/// Writes what it watches as MCAP.
///
/// A chunk is written whole, and everything so far is flushed to `W` with
/// [`Watcher::decided`]: of a run that is killed, every decision told can be read. Flushing is
/// not syncing; who wants the trace to survive a loss of power gives a `W` whose `flush` syncs.
///
/// The bytes are a function of what was watched: times are simulated, and nothing else varies.
#[derive(Debug)]
pub struct TraceWriter<W: Write> {
    file: Pen<W>,
    channels: BTreeMap<Topic, u16>,
    schemas: BTreeMap<Schema, u16>,
    messages: u64,
    encoder: Encoder,
    events: u64,
    decisions: u64,
    specification: Specification,
    /// Names of users in the simulated world.
    users: BTreeMap<String, UserId>,
    bystanders: Vec<String>,
    /// Who was shown, and how.
    shown: BTreeMap<Whose, Person>,
    destination: Option<String>,
}

/// The MCAP writer, until the end.
enum Pen<W: Write> {
    Writing(Box<mcap::Writer<NoSeek<W>>>),
    Ended(Option<W>),
}

impl<W: Write> std::fmt::Debug for Pen<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Writing(_) => "Writing",
            Self::Ended(_) => "Ended",
        })
    }
}

impl<W: Write> TraceWriter<W> {
    /// Begins a trace. What is written goes through no further buffer, in pieces of whole
    /// chunks and records.
    ///
    /// # Errors
    /// What `W` fails with.
    pub fn new(file: W) -> io::Result<Self> {
        let mut writer = WriteOptions::new()
            .profile("")
            .library(PROGRAM)
            .compression(Some(Compression::Zstd))
            // More threads would not change what is read, but might change the bytes.
            .compression_threads(0)
            // A chunk that is not finished is not in the file at all.
            .disable_seeking(true)
            .calculate_chunk_crcs(true)
            .calculate_data_section_crc(true)
            .calculate_summary_section_crc(true)
            .create(NoSeek::new(file))
            .map_err(into_io)?;
        let version = format!("{FORMAT_MAJOR}.{FORMAT_MINOR}");
        let metadata = Metadata {
            name: FORMAT_RECORD.to_owned(),
            metadata: BTreeMap::from([(FORMAT_KEY.to_owned(), version)]),
        };
        writer.write_metadata(&metadata).map_err(into_io)?;
        Ok(Self {
            file: Pen::Writing(Box::new(writer)),
            channels: BTreeMap::new(),
            schemas: BTreeMap::new(),
            messages: 0,
            encoder: Encoder::default(),
            events: 0,
            decisions: 0,
            specification: Specification::default(),
            users: BTreeMap::new(),
            bystanders: Vec::new(),
            shown: BTreeMap::new(),
            destination: None,
        })
    }

    /// What was written to. Before [`Watcher::end`] it holds a cut trace.
    #[must_use]
    pub fn into_inner(self) -> Option<W> {
        match self.file {
            Pen::Writing(writer) => Some(writer.into_inner().into_inner()),
            Pen::Ended(file) => file,
        }
    }

    /// How many messages the trace has.
    #[must_use]
    pub const fn messages(&self) -> u64 {
        self.messages
    }

    /// Writes a message that holds nothing personal.
    fn open(&mut self, topic: Topic, at: Duration, message: &impl Message) -> io::Result<()> {
        debug_assert!(!topic.is_personal());
        self.put(topic, at, &message.encode_to_vec())
    }

    /// Writes a message with personal data. Everything personal comes through here, with the
    /// person whom it is about: the place to seal it.
    fn personal(
        &mut self,
        _whose: Whose,
        topic: Topic,
        at: Duration,
        message: &impl Message,
    ) -> io::Result<()> {
        debug_assert!(topic.is_personal());
        self.put(topic, at, &message.encode_to_vec())
    }

    fn put(&mut self, topic: Topic, at: Duration, data: &[u8]) -> io::Result<()> {
        let Pen::Writing(writer) = &mut self.file else {
            return Err(io::Error::other("the trace has ended"));
        };
        let channel_id = match self.channels.get(&topic) {
            Some(channel) => *channel,
            None => {
                let schema = match self.schemas.get(&topic.schema) {
                    Some(schema) => *schema,
                    None => {
                        let name = topic.schema.name();
                        let id = writer.add_schema(name, "protobuf", &topic.schema.descriptors());
                        let id = id.map_err(into_io)?;
                        self.schemas.insert(topic.schema, id);
                        id
                    }
                };
                let channel = writer.add_channel(schema, &topic.name, "protobuf", &BTreeMap::new());
                let channel = channel.map_err(into_io)?;
                self.channels.insert(topic, channel);
                channel
            }
        };
        let sequence = u32::try_from(self.messages)
            .map_err(|_| io::Error::other("more messages than a trace can number"))?;
        let time = nanos(at);
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, data).map_err(into_io)?;
        self.messages = self.messages.saturating_add(1);
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.file {
            Pen::Writing(writer) => writer.flush().map_err(into_io),
            Pen::Ended(_) => Ok(()),
        }
    }

    fn log(&mut self, at: Duration, message: String) -> io::Result<()> {
        self.open(Topic::LOG, at, &log_message(at, message))
    }

    fn whose(&mut self, person: &str) -> Whose {
        if let Some(user) = self.users.get(person) {
            return Whose::User(*user);
        }
        let known = self.bystanders.iter().position(|name| name == person);
        let place = known.unwrap_or_else(|| {
            self.bystanders.push(person.to_owned());
            self.bystanders.len().saturating_sub(1)
        });
        Whose::Bystander(u32::try_from(place).map_or(u32::MAX, |place| place.saturating_add(1)))
    }

    /// People who have moved, come or gone since they were last shown.
    fn people(&mut self, at: Duration, world: &World) -> io::Result<()> {
        let mut present = BTreeSet::new();
        for person in world.people() {
            let whose = self.whose(&person.name);
            present.insert(whose);
            let same = |shown: &Person| {
                (shown.floor, shown.position, shown.heading)
                    == (person.floor, person.position, person.heading)
            };
            if self.shown.get(&whose).is_some_and(same) {
                continue;
            }
            let is_user = matches!(whose, Whose::User(_));
            let shape = scene::person(at, &id(whose), person, is_user);
            self.personal(whose, Topic::person_scene(whose), at, &shape)?;
            let pose = frames::pose_in(at, person.floor, person.position, person.heading);
            self.personal(whose, Topic::person_pose(whose), at, &pose)?;
            self.shown.insert(whose, person.clone());
        }
        let gone: Vec<Whose> = self.shown.keys().filter(|whose| !present.contains(whose)).copied().collect();
        for whose in gone {
            self.shown.remove(&whose);
            self.personal(whose, Topic::person_scene(whose), at, &scene::gone(at, &id(whose)))?;
        }
        Ok(())
    }

    fn destination(&mut self, at: Duration, world: &World) -> io::Result<()> {
        let destination = world.progress().map(|progress| progress.place);
        if destination == self.destination {
            return Ok(());
        }
        let whose = self.encoder.served().map_or(Whose::Everyone, Whose::User);
        let place = destination.as_deref().and_then(|name| world.building().place(name));
        let shape = match place {
            Some((floor, place)) => scene::destination(at, floor, place.position, &place.name),
            None => scene::gone(at, scene::DESTINATION),
        };
        self.destination = destination;
        self.personal(whose, Topic::DESTINATION, at, &shape)
    }
}

impl<W: Write> Watcher for TraceWriter<W> {
    fn begin(&mut self, setup: &Setup<'_>) -> io::Result<()> {
        let at = Duration::ZERO;
        self.open(Topic::HEADER, at, &setup::header(setup))?;
        self.personal(Whose::Everyone, Topic::RULES, at, &setup::rules(setup))?;
        for participant in setup.participants {
            let whose = Whose::User(participant.pseudonym);
            self.personal(whose, Topic::PARTICIPANT, at, &setup::participant(participant))?;
            self.users.insert(participant.person.clone(), participant.pseudonym);
        }
        self.specification = setup.specification.clone();
        self.open(Topic::FRAMES, at, &frames::floors(setup.building))?;
        for (index, floor) in setup.building.floors().iter().enumerate() {
            self.open(Topic::map(index), at, &layers::grid(index, floor))?;
            self.open(Topic::walls(index), at, &layers::walls(index, floor))?;
        }
        self.open(Topic::BUILDING, at, &scene::building(setup.building))?;
        self.flush()
    }

    fn event(&mut self, at: Duration, event: &Event) -> io::Result<()> {
        let encoded = self.encoder.event(event);
        self.events = self.events.saturating_add(1);
        self.open(Topic::EVENT, at, &encoded.open)?;
        if let Some((whose, input)) = encoded.personal {
            self.personal(whose, Topic::INPUT, at, &input)?;
        }
        let sentence = tell_event(event, &self.specification);
        self.log(at, sentence)
    }

    fn output(&mut self, at: Duration, output: &Output) -> io::Result<()> {
        let encoded = self.encoder.output(output);
        match &encoded.open {
            Open::Record(record) => self.open(encoded.topic, at, record)?,
            Open::Command(command) => self.open(encoded.topic, at, command)?,
        }
        for (whose, reply) in encoded.personal {
            self.personal(whose, Topic::REPLY, at, &reply)?;
        }
        if let Output::Record(Record::Decided { .. } | Record::EmergencyDecided { .. }) = output {
            self.decisions = self.decisions.saturating_add(1);
        }
        match tell_output(output, &self.specification) {
            Some(sentence) => self.log(at, sentence),
            None => Ok(()),
        }
    }

    fn world(&mut self, at: Duration, world: &World) -> io::Result<()> {
        if !self.channels.contains_key(&Topic::ROBOT) {
            self.open(Topic::ROBOT, at, &scene::robot(&world.settings().model))?;
        }
        let robot = world.robot();
        self.open(Topic::FRAMES, at, &frames::robot(at, world))?;
        let pose = frames::pose_in(at, robot.floor, robot.pose.position, robot.pose.heading);
        self.open(Topic::ROBOT_POSE, at, &pose)?;
        self.destination(at, world)?;
        self.people(at, world)
    }

    fn sentence(&mut self, at: Duration, sentence: &str) -> io::Result<()> {
        self.personal(Whose::Everyone, Topic::STORY, at, &log_message(at, sentence.to_owned()))
    }

    fn decided(&mut self, _at: Duration) -> io::Result<()> {
        self.flush()
    }

    fn end(&mut self, at: Duration) -> io::Result<()> {
        let replies = self.encoder.count().saturating_sub(self.events);
        let (events, decisions, messages) = (self.events, self.decisions, self.messages);
        self.open(Topic::END, at, &End { events, replies, decisions, messages })?;
        let pen = std::mem::replace(&mut self.file, Pen::Ended(None));
        if let Pen::Writing(mut writer) = pen {
            writer.finish().map_err(into_io)?;
            let mut file = writer.into_inner().into_inner();
            file.flush()?;
            self.file = Pen::Ended(Some(file));
        }
        Ok(())
    }
}

fn log_message(at: Duration, message: String) -> Log {
    Log {
        timestamp: timestamp(at),
        level: log::Level::Info.into(),
        message,
        name: "mission".to_owned(),
        ..Log::default()
    }
}

fn into_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
