//! What the fuzz targets do with their input, and what must hold of it.
//!
//! Each function takes any bytes. It panics where a property is broken, and nowhere else.
//! `tests/fuzz_seeds.rs` runs the same functions on the committed seeds.

use std::collections::VecDeque;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

use mcap::records::{MessageHeader, Metadata};
use prost::Message as _;
use selfneg::audit::{Audit, Keys, Status, audit, audit_opened};
use selfneg::binding::{BoundRules, BoundUser, GoalChoice};
use selfneg::demo;
use selfneg::fleet::TraceRows;
use selfneg::input::{InputError, Rules, User};
use selfneg::precedence::{Policy, decide};
use selfneg::record::DecisionRecord;
use selfneg::scenario::{Folders, Scenario};
use selfneg::seal::{AuditorKey, RobotKey};
use selfneg::story;
use selfneg::trace::schema::{Schema, evidence};
use selfneg::trace::{
    FORMAT_KEY, FORMAT_MAJOR, FORMAT_MINOR, FORMAT_RECORD, Reader, Recording, TraceError, TraceWriter, erase,
    open, unseal,
};
use selfneg_core::Options;
use selfneg_sim::{Building, BuildingError};

/// What separates the texts of an input that stands for several files.
pub const SEPARATOR: &str = "\n=====\n";

/// The file of a trace: read by message and as a recording, and replayed.
///
/// Nothing is yielded after an error, entries are numbered without a gap, a recording has
/// no more than the reader yields, and a cut one is never complete.
pub fn trace(bytes: &[u8]) {
    let mut reader = Reader::new(bytes);
    let mut yielded = 0_u64;
    let failed = loop {
        match reader.next() {
            Some(Ok(_)) => yielded += 1,
            Some(Err(error)) => {
                one_line(&error);
                break true;
            }
            None => break false,
        }
    };
    assert!(reader.next().is_none(), "something comes after the end");
    let recording = match Recording::read(bytes) {
        Ok(recording) => recording,
        Err(error) => return one_line(&error),
    };
    assert!(recording.messages <= yielded, "the recording has messages from nowhere");
    assert!(!(failed && recording.is_complete()), "an error of the reader is lost");
    assert_eq!(recording.is_complete(), recording.damage.is_none());
    check(&recording);
}

/// Messages of a trace, in a file that is as it should be: what is behind the format. They are
/// read, replayed and audited; nobody signed them, so the audit is never content.
///
/// The input is a list of topic (one byte), length (two, the lower first) and content; where
/// the content can be decoded its numbering is made right.
pub fn messages(bytes: &[u8]) {
    let file = packed(bytes);
    match Recording::read(&file) {
        Ok(recording) => {
            let misread = matches!(
                recording.damage,
                Some(TraceError::CrcMismatch { .. } | TraceError::Malformed { .. } | TraceError::Gap { .. })
            );
            assert!(!misread, "the file is right, but {:?}", recording.damage);
            check(&recording);
        }
        Err(error) => one_line(&error),
    }
    let found = sound(audit(&file, &Keys::default()));
    assert!(found.status <= Status::Unsealed, "not signed, and {}", found.status);
}

/// A file, audited by somebody who has all keys, unsealed, and with a person's data erased.
///
/// No forgery passes: if the audit is content the file says what the committed trace says,
/// which is the only one that the key ever signed.
pub fn sealed(bytes: &[u8]) {
    static ORIGINAL: OnceLock<Recording> = OnceLock::new();
    let keys = keys();
    match open(bytes, &keys.identities) {
        Ok(opened) => {
            check(&opened.recording);
            let found = sound(audit_opened(&opened, &keys));
            let rows = TraceRows::of("trace", Some(&opened), &found);
            assert_eq!(rows.decisions.len(), found.decisions.len());
            if found.status == Status::Ok {
                let original = ORIGINAL
                    .get_or_init(|| open(SEALED, &keys.identities).expect("it is committed").recording);
                assert!(opened.recording.entries == original.entries, "a forgery passes");
                assert_eq!(opened.recording.header, original.header, "a forgery passes");
                assert_eq!(opened.recording.rules, original.rules, "a forgery passes");
                assert_eq!(opened.recording.participants, original.participants, "a forgery passes");
            }
        }
        Err(error) => one_line(&error),
    }
    // Each opens everything once more, which takes most of the time.
    if bytes.len().is_multiple_of(4) {
        match unseal(bytes, &keys.identities) {
            Ok(clear) => assert!(Recording::read(&clear.bytes).is_ok(), "what was unsealed is no trace"),
            Err(error) => one_line(&error),
        }
    }
    if bytes.len() % 4 == 1 {
        match erase(bytes, "user-1") {
            Ok(erased) => {
                let opened = open(&erased.bytes, &keys.identities);
                assert!(opened.is_ok_and(|opened| opened.erased.contains(&"user-1".to_owned())));
            }
            Err(error) => one_line(&error),
        }
    }
}

fn sound(found: Audit) -> Audit {
    let worst = found.findings.iter().map(|finding| finding.status).min();
    assert_eq!(found.status, worst.unwrap_or(Status::Ok));
    for finding in &found.findings {
        one_line(&finding.what);
    }
    found
}

/// The trace again, neither compressed nor summed: its seal is as good as before, and a fuzzer
/// that changes a byte is not stopped by a CRC.
#[must_use]
pub fn bare(trace: &[u8]) -> Vec<u8> {
    let mut reader = Reader::new(trace);
    let messages: Vec<_> = reader.by_ref().map_while(Result::ok).collect();
    let mut file = bare_file();
    for note in reader.notes() {
        let (name, metadata) = (note.name.clone(), note.entries.clone());
        file.write_metadata(&Metadata { name, metadata }).expect("memory takes it");
    }
    for message in messages {
        let said = &message.channel;
        let schema = file.add_schema(&said.schema, &said.schema_encoding, &said.schema_data);
        let channel =
            schema.and_then(|schema| file.add_channel(schema, &said.topic, &said.encoding, &said.metadata));
        let channel_id = channel.expect("a channel");
        let (sequence, log_time, publish_time) = (message.sequence, message.log_time, message.publish_time);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time };
        file.write_to_known_channel(&header, &message.data).expect("memory takes it");
    }
    file.finish().expect("memory takes it");
    file.into_inner().into_inner()
}

/// The one trace that [`robot`] signed.
pub const SEALED: &[u8] = include_bytes!("../seeds/sealed/room.mcap");

/// The robot key of the fuzz targets: it must never sign anything but their seed.
///
/// # Panics
/// Never: the bytes are a key.
#[must_use]
pub fn robot() -> RobotKey {
    RobotKey::generate(&mut |bytes: &mut [u8]| {
        bytes.fill(0x5e);
        Ok(())
    })
    .expect("the bytes are a key")
}

/// The auditor's key of the fuzz targets, which is public.
const IDENTITY: &str = "AGE-SECRET-KEY-1ZCLUWEYX67L9PFFMHGCH7NLC055A46UF87693T8ZNZ9PWY3XQF0Q6TK822";

/// What the auditor of the fuzz targets' seed brings along.
///
/// # Panics
/// Never: the key is one.
#[must_use]
pub fn keys() -> Keys {
    let identities = AuditorKey::parse_all(IDENTITY).expect("it is a key");
    Keys { robots: vec![robot().public()], identities }
}

fn check(recording: &Recording) {
    let mut index = 0_u64;
    for entry in &recording.entries {
        assert_eq!(entry.index, index, "a gap in the numbering");
        index += 1;
    }
    assert!(recording.decisions() <= index);
    match recording.replay() {
        Ok(replay) => assert!(replay.events <= index),
        Err(error) => one_line(&error),
    }
}

/// Topics of a trace, by the byte that stands for them.
const TOPICS: [(&str, Schema); 21] = [
    ("/mission/event", Schema::Event),
    ("/mission/lifecycle", Schema::Record),
    ("/mission/request", Schema::Record),
    ("/mission/data", Schema::Record),
    ("/mission/wipe", Schema::Record),
    ("/mission/goal", Schema::Record),
    ("/mission/negotiation", Schema::Record),
    ("/mission/decision", Schema::Record),
    ("/mission/emergency", Schema::Record),
    ("/mission/power", Schema::Record),
    ("/mission/command", Schema::Command),
    ("/personal/input", Schema::Input),
    ("/personal/reply", Schema::Reply),
    ("/personal/rules", Schema::Rules),
    ("/personal/participant", Schema::Participant),
    ("/mission/header", Schema::Header),
    ("/mission/end", Schema::End),
    ("/log", Schema::Log),
    ("/mission/commitment", Schema::Commitment),
    ("/personal/opening", Schema::Opening),
    ("/sealed/user-1", Schema::Sealed),
];

/// The input of [`messages`] that stands for a trace; messages for viewers are left out.
#[must_use]
pub fn unpacked(trace: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for message in Reader::new(trace).map_while(Result::ok) {
        let topic = TOPICS.iter().position(|(topic, _)| *topic == &*message.topic && *topic != "/log");
        if let (Some(topic), Ok(length)) = (topic, u16::try_from(message.data.len())) {
            bytes.push(u8::try_from(topic).unwrap_or(u8::MAX));
            bytes.extend(length.to_le_bytes());
            bytes.extend(message.data);
        }
    }
    bytes
}

/// The trace of an input of [`messages`], neither compressed nor summed: a fuzzer that changes
/// a byte of it is not stopped by a CRC.
#[must_use]
pub fn packed(mut bytes: &[u8]) -> Vec<u8> {
    let mut file = plain_file();
    let mut counts = Counts::default();
    let mut channels = [None; TOPICS.len()];
    while let Some((topic, length, rest)) = head(bytes) {
        let (content, rest) = rest.split_at(length.min(rest.len()));
        bytes = rest;
        let nth = usize::from(topic) % TOPICS.len();
        let (name, schema) = TOPICS[nth];
        let content = counts.numbered(schema, content);
        let channel_id = *channels[nth].get_or_insert_with(|| {
            let schema = file.add_schema(schema.name(), "protobuf", &[]).expect("a schema");
            file.add_channel(schema, name, "protobuf", &Default::default()).expect("a channel")
        });
        let sequence = counts.messages;
        let header = MessageHeader { channel_id, sequence, log_time: u64::from(sequence), publish_time: 0 };
        file.write_to_known_channel(&header, &content).expect("memory takes it");
        counts.messages += 1;
    }
    file.finish().expect("memory takes it");
    file.into_inner().into_inner()
}

fn head(bytes: &[u8]) -> Option<(u8, usize, &[u8])> {
    let (&topic, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk::<2>()?;
    Some((topic, usize::from(u16::from_le_bytes(*length)), rest))
}

fn plain_file() -> mcap::Writer<io::Cursor<Vec<u8>>> {
    let mut file = bare_file();
    let version = format!("{FORMAT_MAJOR}.{FORMAT_MINOR}");
    let metadata = [(FORMAT_KEY.to_owned(), version)].into();
    file.write_metadata(&Metadata { name: FORMAT_RECORD.to_owned(), metadata }).expect("memory takes it");
    file
}

fn bare_file() -> mcap::Writer<io::Cursor<Vec<u8>>> {
    mcap::WriteOptions::new()
        .compression(None)
        .profile("")
        .library("")
        .calculate_chunk_crcs(false)
        .calculate_data_section_crc(false)
        .calculate_summary_section_crc(false)
        .emit_summary_records(false)
        .emit_summary_offsets(false)
        .emit_message_indexes(false)
        .create(io::Cursor::new(Vec::new()))
        .expect("memory takes it")
}

#[derive(Default)]
struct Counts {
    messages: u32,
    events: u64,
    replies: u64,
}

impl Counts {
    /// The same message with the number that is its turn, if it is one that has a number.
    fn numbered(&mut self, schema: Schema, content: &[u8]) -> Vec<u8> {
        self.renumbered(schema, content).unwrap_or_else(|_| content.to_vec())
    }

    fn renumbered(&mut self, schema: Schema, content: &[u8]) -> Result<Vec<u8>, prost::DecodeError> {
        use selfneg::trace::schema::personal;
        let next = self.events + self.replies;
        Ok(match schema {
            Schema::Event => {
                self.events += 1;
                evidence::Event { index: next, ..evidence::Event::decode(content)? }.encode_to_vec()
            }
            Schema::Record => {
                self.replies += 1;
                evidence::Record { index: next, ..evidence::Record::decode(content)? }.encode_to_vec()
            }
            Schema::Command => {
                self.replies += 1;
                evidence::Command { index: next, ..evidence::Command::decode(content)? }.encode_to_vec()
            }
            Schema::Input => {
                let index = next.saturating_sub(1);
                personal::Input { index, ..personal::Input::decode(content)? }.encode_to_vec()
            }
            Schema::Reply => {
                let index = next.saturating_sub(1);
                personal::Reply { index, ..personal::Reply::decode(content)? }.encode_to_vec()
            }
            Schema::End => {
                let messages = u64::from(self.messages);
                let (events, replies) = (self.events, self.replies);
                evidence::End { events, replies, messages, ..evidence::End::decode(content)? }.encode_to_vec()
            }
            _ => content.to_vec(),
        })
    }
}

/// The four documents of a user folder.
pub fn user(bytes: &[u8]) {
    let Some(texts) = texts::<4>(bytes) else { return };
    match User::parse("Ann", Path::new("Ann"), texts) {
        Ok(user) => assert!(user.true_conditions().count() <= user.status.len()),
        Err(error) => one_line(&error),
    }
}

/// The two documents of a rules folder.
pub fn rules(bytes: &[u8]) {
    let Some([activation, implications]) = texts(bytes) else { return };
    let bound = Rules::parse(("activation.json", activation), ("implications.json", implications)).and_then(
        |rules| {
            let goals = rules.goals();
            let bound = BoundRules::new(rules)?;
            Ok((goals, bound))
        },
    );
    if let Err(error) = bound {
        one_line(&error);
    }
}

/// A whole decision: options and policy, the rules' two documents, and four documents for
/// each user, the current one first.
///
/// Every negotiation ends within its bound, who has an agreement is served, telling it does
/// not fail, and deciding again gives the same.
pub fn decision(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let mut texts = text.split(SEPARATOR);
    let Some((options, policy)) = texts.next().and_then(variant) else { return };
    let (Some(activation), Some(implications)) = (texts.next(), texts.next()) else { return };
    let texts: Vec<&str> = texts.collect();
    let (users, _) = texts.as_chunks::<4>();
    // Nobody negotiates with thousands, and the policies are quadratic.
    let users = users.get(..users.len().min(5)).unwrap_or_default();
    if let Err(error) = decided(options, policy, [activation, implications], users) {
        one_line(&error);
    }
}

fn decided(
    options: Options,
    policy: Option<Policy>,
    [activation, implications]: [&str; 2],
    users: &[[&str; 4]],
) -> Result<(), InputError> {
    let rules = Rules::parse(("activation.json", activation), ("implications.json", implications))?;
    let mut rules = BoundRules::new(rules)?;
    let users: Vec<BoundUser> = (1..)
        .zip(users)
        .map(|(nth, texts): (u32, _)| {
            let name = format!("user-{nth}");
            let user = User::parse(&name, Path::new(&name), *texts)?;
            rules.bind(&user, &GoalChoice::OwnFile)
        })
        .collect::<Result<_, _>>()?;
    let policy = policy.unwrap_or_else(|| Policy::default_for(users.len().saturating_sub(1)));
    let decision = match decide(&rules, &users, options, policy) {
        Ok(decision) => decision,
        Err(error) => {
            one_line(&error);
            return Ok(());
        }
    };
    for held in &decision.negotiations {
        let own =
            |user: usize, willingness: u8| users[user].conditions().len() + usize::from(willingness > 0);
        let most = own(held.current, held.options.willingness) + own(held.interrupting, 0) + 2;
        assert!(usize::try_from(held.conclusion.rounds).is_ok_and(|rounds| rounds <= most));
        assert_eq!(usize::try_from(held.conclusion.rounds).ok(), Some(held.rounds.len()));
    }
    assert!(decision.agreement.is_none_or(|user| user == decision.served));
    assert!(decision.served < users.len());
    let told = story::tell(&decision, &users, &rules);
    let again = decide(&rules, &users, options, policy).expect("it was decided before");
    assert_eq!(told, story::tell(&again, &users, &rules));
    let _record = DecisionRecord::new(&decision, &users, &rules);
    Ok(())
}

/// `quit aggregation tie fallback willingness policy`; the policy may be `-`.
fn variant(text: &str) -> Option<(Options, Option<Policy>)> {
    let mut words = text.split_whitespace();
    let options = Options {
        quit: words.next()?.parse().ok()?,
        aggregation: words.next()?.parse().ok()?,
        tie: words.next()?.parse().ok()?,
        fallback: words.next()?.parse().ok()?,
        willingness: words.next()?.parse().ok()?,
    };
    let policy = match words.next()? {
        "-" => None,
        name => Some(name.parse().ok()?),
    };
    Some((options, policy))
}

/// A scenario file, with the folders of the mall wherever it names one.
pub fn scenario(bytes: &[u8]) {
    if let Some(scenario) = parsed(bytes) {
        assert_eq!(scenario.participants.len(), scenario.behaviours.len());
    }
}

/// A scenario file that is run, for a while, and recorded: what is recorded replays.
pub fn run(bytes: &[u8]) {
    let Some(mut scenario) = parsed(bytes) else { return };
    scenario.until = scenario.until.min(Duration::from_secs(20));
    let mut trace = TraceWriter::plain(Vec::new()).expect("memory takes it");
    let outcome = selfneg::run::run(&scenario, &mut [&mut trace]).expect("memory takes it");
    let trace = trace.into_inner().expect("it was written");
    let recording = Recording::read(&trace).expect("it was written as a trace");
    assert!(recording.is_complete(), "{:?}", recording.damage);
    assert_eq!(usize::try_from(recording.decisions()).ok(), usize::try_from(outcome.decisions).ok());
    let replay = recording.replay().expect("what was run can be run again");
    assert!(replay.difference.is_none(), "{:?}", replay.difference);
}

/// The scenario of an input of [`scenario`] or [`run`], if it is one.
#[must_use]
pub fn parsed(bytes: &[u8]) -> Option<Scenario> {
    let text = str::from_utf8(bytes).ok()?;
    match Scenario::parse(text, Path::new("scenario.toml"), &InMemory) {
        Ok(scenario) => Some(scenario),
        Err(error) => {
            one_line(&error);
            None
        }
    }
}

/// The rules of the mall or of the other scenarios, the mall's users, and a small room.
pub struct InMemory;

impl Folders for InMemory {
    fn rules(&self, folder: &Path) -> Result<Rules, InputError> {
        match folder.ends_with("rules") {
            true => Rules::parse(
                (
                    "disposition_activation.json",
                    include_str!("../../examples/scenarios/rules/disposition_activation.json"),
                ),
                (
                    "ethical_implications.json",
                    include_str!("../../examples/scenarios/rules/ethical_implications.json"),
                ),
            ),
            false => demo::rules(),
        }
    }

    fn user(&self, folder: &Path) -> Result<User, InputError> {
        if folder.ends_with("Bob") { demo::bob() } else { demo::alice() }
    }

    fn building(&self, _: &Path) -> Result<Building, BuildingError> {
        room()
    }
}

/// A room with a charging station and two desks.
///
/// # Errors
/// None.
pub fn room() -> Result<Building, BuildingError> {
    let [building, map, image] = ROOM;
    Building::from_memory(building, |file| {
        Ok(if file.extension().is_some_and(|kind| kind == "yaml") { map } else { image }.into())
    })
}

/// The room's three files: building, map, image.
pub const ROOM: [&str; 3] = [
    include_str!("../../examples/room/building.yaml"),
    include_str!("../../examples/room/map.yaml"),
    include_str!("../../examples/room/map.pgm"),
];

/// A building file, the map that it names, and the map's image.
///
/// What is accepted has floors, and its places lie on free cells of them.
pub fn building(bytes: &[u8]) {
    let mut parts = bytes_split(bytes);
    let (Some(building), Some(map), Some(image)) = (parts.pop_front(), parts.pop_front(), parts.pop_front())
    else {
        return;
    };
    let Ok(text) = str::from_utf8(building) else { return };
    let read = Building::from_memory(text, |file| {
        Ok(if file.extension().is_some_and(|kind| kind == "yaml") { map } else { image }.to_vec())
    });
    match read {
        Ok(building) => {
            assert!(!building.floors().is_empty());
            for (floor, place) in building.places() {
                let cell = building.floors()[floor].map.cell_at(place.position);
                assert_eq!(cell, Some(selfneg_sim::Cell::Free));
            }
        }
        Err(error) => one_line(&error),
    }
}

fn bytes_split(mut bytes: &[u8]) -> VecDeque<&[u8]> {
    let mut parts = VecDeque::new();
    while let Some(at) = bytes.windows(SEPARATOR.len()).position(|window| window == SEPARATOR.as_bytes()) {
        parts.push_back(&bytes[..at]);
        bytes = &bytes[at + SEPARATOR.len()..];
    }
    parts.push_back(bytes);
    parts
}

fn texts<const N: usize>(bytes: &[u8]) -> Option<[&str; N]> {
    let texts: Vec<&str> = str::from_utf8(bytes).ok()?.split(SEPARATOR).collect();
    texts.try_into().ok()
}

/// Errors are told to people, on one line.
fn one_line(error: &impl Display) {
    let told = error.to_string();
    assert!(!told.trim().is_empty(), "an error without words");
}

/// A target's name and function.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [Target; 9] = [
    ("building", building),
    ("decision", decision),
    ("messages", messages),
    ("rules", rules),
    ("run", run),
    ("scenario", scenario),
    ("sealed", sealed),
    ("trace", trace),
    ("user", user),
];

/// The path of a target's seeds, below the project's root.
#[must_use]
pub fn seeds_of(target: &str) -> PathBuf {
    Path::new("fuzz/seeds").join(target)
}
