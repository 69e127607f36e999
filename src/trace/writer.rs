//! Watches a run and writes the trace.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::time::Duration;

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use prost::Message;
use selfneg_sim::{Person, World};

use super::copying::{begin, into_io};
use super::encode::{Encoder, Open};
use super::format::{FORMAT_KEY, FORMAT_RECORD, MAX_MESSAGE_BYTES, version};
use super::reader::PROTOBUF;
use super::schema::Schema;
use super::schema::evidence::{self, Commitment, End};
use super::schema::foxglove::{Log, log};
use super::schema::personal::Opening;
use super::segments::Segments;
use super::sentence::{tell_event, tell_output};
use super::stamp::{nanos, timestamp};
use super::topic::{Topic, Whose};
use super::{committed, frames, layers, scene, setup};
use crate::mission::{Event, Output, Record, Specification, UserId};
use crate::run::{Setup, Watcher};
use crate::seal::chain::{Chain, Digest, channel_digest, leaf};
use crate::seal::checkpoint::{CHECKPOINT_RECORD, Checkpoint, SEAL_RECORD, SealHead};
use crate::seal::commitment::{Fact, commit};
use crate::seal::{AuditorPublicKey, Privacy, Random, RobotKey, Seal, TraceId};

/// Writes what it watches as MCAP.
///
/// A chunk is written whole, and everything so far is flushed to `W` with
/// [`Watcher::decided`]: of a run that is killed, every decision told can be read. Flushing is
/// not syncing; who wants the trace to survive a loss of power gives a `W` whose `flush` syncs.
///
/// Of a trace that is neither sealed nor signed the bytes are a function of what was watched:
/// times are simulated, and nothing else varies. Of a sealed one the ciphertexts, the
/// commitments and what is derived from them vary.
#[derive(Debug)]
pub struct TraceWriter<W: Write> {
    file: Pen<W>,
    privacy: PrivacyInForce,
    signature: Option<Signature>,
    random: Chance,
    channels: BTreeMap<Topic, (u16, Digest)>,
    schemas: BTreeMap<Schema, u16>,
    messages: u64,
    encoder: Encoder,
    events: u64,
    decisions: u64,
    /// Without names.
    specification: Specification,
    /// Names of users in the simulated world.
    users: BTreeMap<String, UserId>,
    bystanders: Vec<String>,
    /// Who was shown, and how.
    shown: BTreeMap<Whose, Person>,
    destination: Option<String>,
}

/// What becomes of what is personal.
#[derive(Debug)]
enum PrivacyInForce {
    Plain,
    LeftOut,
    /// Until the run begins.
    ToBeSealed(Vec<AuditorPublicKey>),
    Sealed(Segments),
}

/// The signing of a trace.
#[derive(Debug)]
struct Signature {
    key: RobotKey,
    /// Once the run has begun.
    head: Option<(TraceId, Digest, Chain)>,
    checkpoints: u64,
}

struct Chance(Box<dyn Random>);

impl std::fmt::Debug for Chance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Chance")
    }
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
    /// Begins a trace that everybody can read, personal data and all, and nobody signs: for
    /// fictional data.
    ///
    /// # Errors
    /// As for [`create`](Self::create).
    pub fn plain(file: W) -> io::Result<Self> {
        let never = |_: &mut [u8]| Err(io::Error::other("a plain trace needs no randomness"));
        Self::create(file, Seal { privacy: Privacy::Plain, signer: None, random: Box::new(never) })
    }

    /// Begins a trace. What is written goes through no further buffer, in pieces of whole
    /// chunks and records.
    ///
    /// # Errors
    /// What `W` fails with, or the seal is to be for nobody.
    pub fn create(file: W, seal: Seal) -> io::Result<Self> {
        let privacy = match seal.privacy {
            Privacy::Plain => PrivacyInForce::Plain,
            Privacy::LeftOut => PrivacyInForce::LeftOut,
            Privacy::Sealed(recipients) if recipients.is_empty() => {
                return Err(io::Error::other("a sealed trace needs an auditor to be sealed to"));
            }
            Privacy::Sealed(recipients) => PrivacyInForce::ToBeSealed(recipients),
        };
        let mut writer = begin(file)?;
        let metadata = Metadata {
            name: FORMAT_RECORD.to_owned(),
            metadata: BTreeMap::from([(FORMAT_KEY.to_owned(), version())]),
        };
        writer.write_metadata(&metadata).map_err(into_io)?;
        Ok(Self {
            file: Pen::Writing(Box::new(writer)),
            privacy,
            signature: seal.signer.map(|key| Signature { key, head: None, checkpoints: 0 }),
            random: Chance(seal.random),
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

    /// Writes a message with personal data, as the trace's privacy has it. Everything personal
    /// comes through here, with the person whom it is about.
    fn personal(
        &mut self,
        whose: Whose,
        topic: Topic,
        at: Duration,
        message: &impl Message,
    ) -> io::Result<()> {
        debug_assert!(topic.is_personal());
        readable(&topic, message)?;
        let after = self.messages.saturating_sub(1);
        match &mut self.privacy {
            PrivacyInForce::Plain => self.put(topic, at, &message.encode_to_vec()),
            PrivacyInForce::LeftOut => Ok(()),
            PrivacyInForce::ToBeSealed(_) => Err(io::Error::other("the run has not begun")),
            PrivacyInForce::Sealed(segments) => {
                let after = u32::try_from(after).map_err(io::Error::other)?;
                segments.keep(whose, &topic, at, after, message.encode_to_vec());
                Ok(())
            }
        }
    }

    fn put(&mut self, topic: Topic, at: Duration, data: &[u8]) -> io::Result<()> {
        let Pen::Writing(writer) = &mut self.file else {
            return Err(io::Error::other("the trace has ended"));
        };
        let schema = topic.schema;
        let (channel_id, digest) = match self.channels.get(&topic) {
            Some(channel) => *channel,
            None => {
                let (name, descriptors) = (schema.name(), schema.descriptors());
                let id = match self.schemas.get(&schema) {
                    Some(id) => *id,
                    None => {
                        let id = writer.add_schema(name, PROTOBUF, descriptors).map_err(into_io)?;
                        self.schemas.insert(schema, id);
                        id
                    }
                };
                let channel = writer.add_channel(id, &topic.name, PROTOBUF, &BTreeMap::new());
                let described = (name, PROTOBUF, descriptors);
                let digest = channel_digest(&topic.name, PROTOBUF, &BTreeMap::new(), described);
                let channel = (channel.map_err(into_io)?, digest);
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
        if let Some((_, _, chain)) = self.signature.as_mut().and_then(|signature| signature.head.as_mut()) {
            chain.extend(&leaf(&digest, schema.name(), sequence, time, time, data));
        }
        Ok(())
    }

    fn note(&mut self, name: &str, metadata: BTreeMap<String, String>) -> io::Result<()> {
        match &mut self.file {
            Pen::Writing(writer) => {
                writer.write_metadata(&Metadata { name: name.to_owned(), metadata }).map_err(into_io)
            }
            Pen::Ended(_) => Err(io::Error::other("the trace has ended")),
        }
    }

    /// Says who seals the trace for whom, before its first message.
    fn seal(&mut self, rules: Digest) -> io::Result<()> {
        let recipients = match &self.privacy {
            PrivacyInForce::ToBeSealed(recipients) => recipients.clone(),
            _ if self.signature.is_none() => return Ok(()),
            _ => Vec::new(),
        };
        let mut trace = TraceId([0; 32]);
        self.random.0.fill(&mut trace.0)?;
        let robot = self.signature.as_ref().map(|signature| signature.key.public());
        let head = SealHead { trace, robot, recipients, rules };
        self.note(SEAL_RECORD, head.to_map())?;
        if let (Some(signature), Some(robot)) = (&mut self.signature, robot) {
            let chain = Chain::begin(trace, &version(), &robot, &head.recipients, &rules);
            signature.head = Some((trace, rules, chain));
        }
        if !head.recipients.is_empty() {
            self.privacy = PrivacyInForce::Sealed(Segments::new(trace, head.recipients));
        }
        Ok(())
    }

    /// Writes what is personal so far.
    fn segments(&mut self, at: Duration) -> io::Result<()> {
        let PrivacyInForce::Sealed(segments) = &mut self.privacy else { return Ok(()) };
        for (whose, sealed) in segments.seal()? {
            self.open(Topic::sealed(whose), at, &sealed)?;
        }
        Ok(())
    }

    /// The same, if it is much. Only between two steps of the run, so that what belongs to one
    /// step is in one batch.
    fn relieve(&mut self, at: Duration) -> io::Result<()> {
        match &self.privacy {
            PrivacyInForce::Sealed(segments) if segments.is_full() => self.segments(at),
            _ => Ok(()),
        }
    }

    /// Signs everything so far.
    fn checkpoint(&mut self, end: bool) -> io::Result<()> {
        let Some(signature) = &mut self.signature else { return Ok(()) };
        let Some((trace, rules, chain)) = signature.head else { return Ok(()) };
        let checkpoint = Checkpoint {
            number: signature.checkpoints,
            messages: self.messages,
            decisions: self.decisions,
            chain,
            rules,
            end,
        };
        signature.checkpoints = signature.checkpoints.saturating_add(1);
        let signed = checkpoint.sign(trace, &signature.key);
        self.note(CHECKPOINT_RECORD, signed.to_map())
    }

    /// Binds the robot to something personal, in a sealed trace.
    fn commit(&mut self, at: Duration, fact: &Fact<'_>) -> io::Result<()> {
        if !matches!(self.privacy, PrivacyInForce::Sealed(_)) {
            return Ok(());
        }
        let mut salt = [0; 32];
        self.random.0.fill(&mut salt)?;
        let (index, user, what) = (fact.index, fact.user, fact.what.into());
        let commitment = Commitment { index, user, what, commitment: commit(fact, &salt).to_vec() };
        self.open(Topic::COMMITMENT, at, &commitment)?;
        let opening = Opening { index, user, what, salt: salt.to_vec() };
        self.personal(Whose::User(UserId(user)), Topic::OPENING, at, &opening)
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.file {
            Pen::Writing(writer) => writer.flush().map_err(into_io),
            Pen::Ended(_) => Ok(()),
        }
    }

    /// Writes, signs and flushes everything so far.
    fn persist(&mut self, at: Duration) -> io::Result<()> {
        self.segments(at)?;
        self.checkpoint(false)?;
        self.flush()
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
            let shape = scene::person(at, &whose.to_string(), person, is_user);
            self.personal(whose, Topic::person_scene(whose), at, &shape)?;
            let pose = frames::pose_in(at, person.floor, person.position, person.heading);
            self.personal(whose, Topic::person_pose(whose), at, &pose)?;
            self.shown.insert(whose, person.clone());
        }
        let gone: Vec<Whose> = self.shown.keys().filter(|whose| !present.contains(whose)).copied().collect();
        for whose in gone {
            self.shown.remove(&whose);
            self.personal(whose, Topic::person_scene(whose), at, &scene::gone(at, &whose.to_string()))?;
        }
        Ok(())
    }

    fn destination(&mut self, at: Duration, world: &World) -> io::Result<()> {
        let destination = world.progress().map(|progress| progress.place);
        if destination == self.destination {
            return Ok(());
        }
        let whose = self.encoder.served().map_or(Whose::Several, Whose::User);
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
        let rules = setup::rules(setup);
        let privacy = match self.privacy {
            PrivacyInForce::Plain => evidence::Privacy::Plain,
            PrivacyInForce::LeftOut => evidence::Privacy::LeftOut,
            PrivacyInForce::ToBeSealed(_) | PrivacyInForce::Sealed(_) => evidence::Privacy::Sealed,
        };
        let header = setup::header(setup, &rules, privacy);
        let digest = header.rules_digest.as_slice().try_into().map_err(io::Error::other)?;
        readable(&Topic::HEADER, &header)?;
        self.seal(digest)?;
        self.open(Topic::HEADER, at, &header)?;
        self.personal(Whose::Everyone, Topic::RULES, at, &rules)?;
        for participant in setup.participants {
            let whose = Whose::User(participant.pseudonym);
            self.personal(whose, Topic::PARTICIPANT, at, &setup::participant(participant))?;
            self.users.insert(participant.person.clone(), participant.pseudonym);
        }
        self.specification = setup::anonymous(setup.specification);
        self.open(Topic::FRAMES, at, &frames::floors(setup.building))?;
        for (index, floor) in setup.building.floors().iter().enumerate() {
            self.open(Topic::map(index), at, &layers::grid(index, floor))?;
            self.open(Topic::walls(index), at, &layers::walls(index, floor))?;
        }
        self.open(Topic::BUILDING, at, &scene::building(setup.building))?;
        self.personal(Whose::Everyone, Topic::PLACES, at, &scene::places(setup.building))?;
        self.persist(at)
    }

    fn event(&mut self, at: Duration, event: &Event) -> io::Result<()> {
        self.relieve(at)?;
        let encoded = self.encoder.event(event);
        self.events = self.events.saturating_add(1);
        self.open(Topic::EVENT, at, &encoded.open)?;
        if let Some((whose, input)) = encoded.personal {
            self.personal(whose, Topic::INPUT, at, &input)?;
            for fact in committed::of_input(&input) {
                self.commit(at, &fact.as_fact())?;
            }
        }
        let sentence = tell_event(event, &self.specification);
        self.log(at, sentence)
    }

    fn output(&mut self, at: Duration, output: &Output) -> io::Result<()> {
        self.relieve(at)?;
        let encoded = self.encoder.output(output);
        match &encoded.open {
            Open::Record(record) => self.open(encoded.topic, at, record)?,
            Open::Command(command) => self.open(encoded.topic, at, command)?,
        }
        for (whose, reply) in &encoded.personal {
            self.personal(*whose, Topic::REPLY, at, reply)?;
        }
        for (_, reply) in &encoded.personal {
            if let Some(fact) = committed::of_reply(reply) {
                self.commit(at, &fact.as_fact())?;
            }
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
        self.relieve(at)?;
        if !self.channels.contains_key(&Topic::ROBOT) {
            self.open(Topic::ROBOT, at, &scene::robot(&world.settings().model))?;
        }
        let robot = world.robot();
        self.personal(Whose::Several, Topic::ROBOT_FRAMES, at, &frames::robot(at, world))?;
        let pose = frames::pose_in(at, robot.floor, robot.pose.position, robot.pose.heading);
        self.personal(Whose::Several, Topic::ROBOT_POSE, at, &pose)?;
        self.destination(at, world)?;
        self.people(at, world)
    }

    fn sentence(&mut self, at: Duration, sentence: &str) -> io::Result<()> {
        self.personal(Whose::Several, Topic::STORY, at, &log_message(at, sentence.to_owned()))
    }

    fn decided(&mut self, at: Duration) -> io::Result<()> {
        self.persist(at)
    }

    fn end(&mut self, at: Duration) -> io::Result<()> {
        self.segments(at)?;
        let replies = self.encoder.count().saturating_sub(self.events);
        let (events, decisions, messages) = (self.events, self.decisions, self.messages);
        self.open(Topic::END, at, &End { events, replies, decisions, messages })?;
        self.checkpoint(true)?;
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

/// What no reader would take is not written.
fn readable(topic: &Topic, message: &impl Message) -> io::Result<()> {
    match message.encoded_len() {
        0..=MAX_MESSAGE_BYTES => Ok(()),
        length => {
            let topic = &topic.name;
            let most = MAX_MESSAGE_BYTES;
            let what = format!("a message of {length} bytes on {topic}; a trace holds at most {most} in one");
            Err(io::Error::other(what))
        }
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
