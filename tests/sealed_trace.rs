//! What a sealed trace shows to whom, and what its seal proves.

#![expect(clippy::unwrap_used, clippy::panic, reason = "it is a test")]

#[path = "../examples/scripted_trace/run.rs"]
#[allow(unreachable_pub, dead_code, reason = "shared with the example")]
mod run;

use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::OnceLock;
use std::time::Duration;

use mcap::records::{MessageHeader, Metadata};
use prost::Message as _;
use selfneg::mission::{Event, Output};
use selfneg::run::{Setup, Watcher};
use selfneg::seal::checkpoint::{CHECKPOINT_RECORD, SEAL_RECORD, SignedCheckpoint};
use selfneg::seal::commitment::{Fact, verify};
use selfneg::seal::{AuditorKey, Privacy, RobotKey, Seal, SealPlace, SealReport, SealState};
use selfneg::trace::schema::evidence::{Committed, Sealed};
use selfneg::trace::{
    Commitment, EraseError, Message, Note, PersonalPart, Reader, Recording, Scan, Step, TraceError,
    TraceWriter, UnsealError, erase, open, unseal,
};

/// Not random at all, but never the same twice.
fn counting() -> impl FnMut(&mut [u8]) -> std::io::Result<()> {
    let mut next = 0_u8;
    move |bytes| {
        bytes.fill(next);
        next = next.wrapping_add(1);
        Ok(())
    }
}

fn robot() -> RobotKey {
    RobotKey::generate(&mut counting()).unwrap()
}

fn auditor() -> &'static AuditorKey {
    static KEY: OnceLock<AuditorKey> = OnceLock::new();
    KEY.get_or_init(AuditorKey::generate)
}

fn scripted(privacy: Privacy, signer: Option<RobotKey>) -> Vec<u8> {
    let seal = Seal { privacy, signer, random: Box::new(counting()) };
    let mut writer = TraceWriter::create(Vec::new(), seal).unwrap();
    run::play(&mut writer).unwrap();
    writer.into_inner().unwrap()
}

fn sealed() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| scripted(Privacy::Sealed(vec![auditor().public()]), Some(robot())))
}

fn plain() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| scripted(Privacy::Plain, None))
}

fn report(state: &SealState) -> &SealReport {
    match state {
        SealState::Signed(report) => report,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_sealed_and_signed_run_opens_with_the_key_to_what_a_plain_one_holds() {
    let opened = open(sealed(), &[auditor().clone()]).unwrap();
    let plain = Recording::read(plain()).unwrap();
    assert_eq!(opened.recording.damage, None);
    assert_eq!(opened.privacy, PersonalPart::Open);
    assert_eq!((&opened.erased[..], &opened.unopened[..]), (&[][..], &[][..]));
    assert_eq!(opened.recording.entries, plain.entries);
    assert_eq!(opened.recording.rules, plain.rules);
    assert_eq!(opened.recording.participants, plain.participants);
    assert_eq!(opened.recording.header.specification, plain.header.specification);
    assert_eq!(opened.recording.replay().unwrap().difference, None);
    let report = report(&opened.seal);
    assert_eq!(report.faults, []);
    assert!(report.complete);
    assert_eq!(report.covered_messages, opened.recording.messages);
    assert_eq!(report.covered_decisions, opened.recording.decisions());
    assert_eq!(report.key, robot().public());
    let commitments = opened.recording.commitments();
    assert!(commitments.len() > 5);
    assert!(commitments.iter().all(|commitment| commitment.3 == Commitment::Holds), "{commitments:?}");
}

#[test]
fn without_the_key_the_seal_and_what_is_open_can_be_read() {
    for keys in [&[][..], &[AuditorKey::generate()]] {
        let opened = open(sealed(), keys).unwrap();
        assert_eq!(opened.privacy, PersonalPart::Locked);
        assert_eq!(opened.recording.damage, None);
        assert!(opened.recording.rules.is_none() && opened.recording.participants.is_empty());
        assert!(report(&opened.seal).complete && report(&opened.seal).faults.is_empty());
        assert!(opened.recording.decisions() >= 2);
    }
    assert!(Reader::new(sealed()).all(|message| !message.unwrap().topic.starts_with("/personal/")));
}

/// Tells a long story about every reply.
struct Talkative(TraceWriter<Vec<u8>>);

impl Watcher for Talkative {
    fn begin(&mut self, setup: &Setup<'_>) -> std::io::Result<()> {
        self.0.begin(setup)
    }
    fn event(&mut self, at: Duration, event: &Event) -> std::io::Result<()> {
        self.0.event(at, event)
    }
    fn output(&mut self, at: Duration, output: &Output) -> std::io::Result<()> {
        self.0.output(at, output)?;
        self.0.sentence(at, &"and then ".repeat(4_000))
    }
    fn decided(&mut self, at: Duration) -> std::io::Result<()> {
        self.0.decided(at)
    }
    fn end(&mut self, at: Duration) -> std::io::Result<()> {
        self.0.end(at)
    }
}

/// Much of one subject is written before the next decision, and only between two steps, so
/// that a cut leaves no step with half of its personal part.
#[test]
fn a_long_story_is_sealed_in_pieces() {
    let seal = Seal {
        privacy: Privacy::Sealed(vec![auditor().public()]),
        signer: Some(robot()),
        random: Box::new(counting()),
    };
    let mut talkative = Talkative(TraceWriter::create(Vec::new(), seal).unwrap());
    run::play(&mut talkative).unwrap();
    let bytes = talkative.0.into_inner().unwrap();
    let scan = Scan::of(&bytes);
    let segments = scan.messages.iter().filter(|one| &*one.topic == "/sealed/several").count();
    let checkpoints = scan.notes.iter().filter(|note| note.name == CHECKPOINT_RECORD).count();
    assert!(segments > checkpoints, "{segments} segments, {checkpoints} checkpoints");
    let opened = open(&bytes, &[auditor().clone()]).unwrap();
    assert_eq!(opened.recording.entries, Recording::read(plain()).unwrap().entries);
    assert!(report(&opened.seal).complete && report(&opened.seal).faults.is_empty());
    // As if the file ended near each segment.
    let content = Content::of(&bytes);
    let is_segment = |message: &Message| message.topic.starts_with("/sealed/");
    let near = |end: &usize| content.messages[end - 2..].iter().take(3).any(is_segment);
    for end in (2..content.messages.len()).filter(near) {
        let mut cut = content.clone();
        cut.messages.truncate(end);
        cut.notes.retain(|note| note.messages <= u64::try_from(end).unwrap());
        let opened = cut.opened();
        assert_eq!((&report(&opened.seal).faults[..], &opened.unopened[..]), (&[][..], &[][..]), "{end}");
        if opened.recording.rules.is_some() {
            assert_eq!(opened.recording.replay().unwrap().difference, None, "{end}");
        }
    }
}

#[test]
fn without_the_random_parts_two_sealed_runs_are_the_same() {
    let again = scripted(Privacy::Sealed(vec![auditor().public()]), Some(robot()));
    let messages = |bytes: &[u8]| -> Vec<_> {
        let messages = Scan::of(bytes).messages.into_iter();
        messages.map(|message| (message.topic, message.sequence, message.log_time, message.data)).collect()
    };
    let same = messages(sealed()).into_iter().zip(messages(&again));
    for (one, other) in same {
        assert_eq!((&one.0, one.1, one.2), (&other.0, other.1, other.2));
        assert!(one.3 == other.3 || one.0.starts_with("/sealed/"), "{}", one.0);
    }
}

#[test]
fn a_run_that_leaves_out_what_is_personal_has_the_same_bytes_twice_and_opens_without() {
    let bytes = scripted(Privacy::LeftOut, None);
    assert_eq!(bytes, scripted(Privacy::LeftOut, None));
    let opened = open(&bytes, &[auditor().clone()]).unwrap();
    assert_eq!((opened.privacy, opened.seal), (PersonalPart::LeftOut, SealState::Unsigned));
    assert_eq!(opened.recording.damage, None);
    assert!(opened.recording.decisions() >= 2 && opened.recording.rules.is_none());
    let signed = open(&scripted(Privacy::LeftOut, Some(robot())), &[]).unwrap();
    assert!(report(&signed.seal).complete && report(&signed.seal).faults.is_empty());
}

/// All that the script's users say, and the scene's names.
const NAMES: [&str; 14] = [
    "Alice",
    "Bob",
    "Carla",
    "small child",
    "elderly",
    "urgency",
    "crowd",
    "dense",
    "people",
    "bathroom",
    "pharmacy",
    "scripted",
    "information",
    "fall",
];

#[test]
fn no_name_is_in_a_sealed_trace_outside_its_schemas() {
    let found = |bytes: &[u8]| -> Vec<&str> {
        let scan = Scan::of(bytes);
        let notes = format!("{:?}", scan.notes).into_bytes();
        let messages = scan.messages.into_iter().flat_map(|one| [one.data, one.topic.as_bytes().to_vec()]);
        let all = messages.chain([notes]).collect::<Vec<_>>();
        let holds = |name: &&str| {
            all.iter().any(|bytes| bytes.windows(name.len()).any(|window| window == name.as_bytes()))
        };
        NAMES.into_iter().filter(holds).collect()
    };
    assert_eq!(found(sealed()), [] as [&str; 0]);
    assert_eq!(found(&scripted(Privacy::LeftOut, None)), [] as [&str; 0]);
    assert_eq!(found(plain()), NAMES);
}

#[test]
fn each_auditor_opens_a_trace_sealed_to_two_and_old_keys_open_old_traces() {
    let (old, new) = (AuditorKey::generate(), AuditorKey::generate());
    let both = scripted(Privacy::Sealed(vec![old.public(), new.public()]), None);
    for key in [&old, &new] {
        let opened = open(&both, std::slice::from_ref(key)).unwrap();
        assert_eq!((opened.privacy, &opened.seal), (PersonalPart::Open, &SealState::Unsigned));
        assert_eq!(opened.recording.replay().unwrap().difference, None);
    }
    let before = scripted(Privacy::Sealed(vec![old.public()]), None);
    assert_eq!(open(&before, std::slice::from_ref(&new)).unwrap().privacy, PersonalPart::Locked);
    assert_eq!(open(&before, &[new, old]).unwrap().privacy, PersonalPart::Open);
}

#[test]
fn an_unsealed_run_holds_the_messages_of_the_plain_one() {
    let unsealed = unseal(sealed(), &[auditor().clone()]).unwrap();
    let messages = |bytes: &[u8]| -> Vec<_> {
        let messages = Reader::new(bytes).map(Result::unwrap);
        let other =
            |message: &Message| !["/mission/commitment", "/personal/opening"].contains(&&*message.topic);
        let end = |message: &Message| &*message.topic != "/mission/end";
        let messages = messages.filter(other).filter(end);
        messages
            .map(|message| (message.topic, message.log_time, message.data, message.channel.digest))
            .collect()
    };
    assert_eq!(messages(&unsealed.bytes), messages(plain()));
    let clear = Recording::read(&unsealed.bytes).unwrap();
    assert_eq!((&clear.damage, clear.end.is_some()), (&None, true));
    assert_eq!(clear.replay().unwrap().difference, None);
    let note = Scan::of(&unsealed.bytes).notes.into_iter().find(|note| note.name == "selfneg.unsealed");
    let SealReport { trace_id, chain, .. } = report(&unsealed.opened.seal);
    let entries = note.unwrap().entries;
    assert_eq!((&entries["trace"], &entries["chain"]), (&trace_id.to_string(), chain));
    assert!(matches!(open(&unsealed.bytes, &[]).unwrap().seal, SealState::Unsigned));

    assert!(matches!(unseal(sealed(), &[AuditorKey::generate()]), Err(UnsealError::Locked(_))));
    assert!(matches!(unseal(plain(), &[auditor().clone()]), Err(UnsealError::NotSealed(_))));
}

#[test]
fn erasing_one_person_leaves_the_seal_and_the_others() {
    let erased = erase(sealed(), "user-2").unwrap();
    assert!(erased.own > 1 && erased.several > 1);
    let opened = open(&erased.bytes, &[auditor().clone()]).unwrap();
    let report = report(&opened.seal);
    assert_eq!((&report.faults[..], report.complete), (&[][..], true));
    assert_eq!(report.covered_messages, opened.recording.messages);
    assert_eq!(opened.erased, ["several", "user-2"]);
    assert_eq!((opened.privacy, &opened.unopened[..]), (PersonalPart::Open, &[][..]));
    let people: Vec<_> = opened.recording.participants.iter().map(|one| one.person.as_str()).collect();
    assert_eq!(people, ["Alice"]);
    assert!(opened.recording.replay().is_err(), "Bob's data are needed to decide again");
    for (_, user, _, state) in opened.recording.commitments() {
        assert_eq!(state, if user == 2 { Commitment::Closed } else { Commitment::Holds });
    }
    // Nothing of Bob's is left in the file, not even encrypted.
    let ciphertexts = |bytes: &[u8]| -> Vec<(String, Vec<u8>)> {
        let messages = Scan::of(bytes).messages.into_iter().filter(|one| one.topic.starts_with("/sealed/"));
        let sealed = messages.map(|one| Sealed::decode(one.data.as_slice()).unwrap());
        sealed.filter_map(|one| Some((one.subject, one.ciphertext?))).collect()
    };
    let left = ciphertexts(&erased.bytes);
    let gone = ciphertexts(sealed()).into_iter().filter(|one| !left.contains(one));
    let mut gone: Vec<String> = gone.map(|one| one.0).collect();
    gone.dedup();
    gone.sort();
    gone.dedup();
    assert_eq!(gone, ["several", "user-2"]);
    // Again it changes nothing; and others go the same way.
    assert_eq!(erase(&erased.bytes, "user-2").unwrap().own, 0);
    assert!(erase(&erased.bytes, "bystander-1").unwrap().own > 0);
}

#[test]
fn who_is_not_there_and_what_is_not_sealed_cannot_be_erased() {
    let Err(EraseError::Unknown { known, .. }) = erase(sealed(), "user-7") else { panic!() };
    assert_eq!(known, ["bystander-1", "user-1", "user-2"]);
    for subject in ["everyone", "several", "", "Alice"] {
        assert!(matches!(erase(sealed(), subject), Err(EraseError::Unknown { .. })), "{subject}");
    }
    assert!(matches!(erase(plain(), "user-1"), Err(EraseError::NotSealed(_))));
    assert!(matches!(erase(&scripted(Privacy::LeftOut, None), "user-1"), Err(EraseError::NotSealed(_))));
    assert!(matches!(erase(b"nothing", "user-1"), Err(EraseError::Trace(TraceError::NotMcap))));
}

type McapWriter = mcap::Writer<Cursor<Vec<u8>>>;

/// What a file holds, to be written anew: what is in `notes` at the place of a message comes
/// before it.
#[derive(Clone)]
struct Content {
    messages: Vec<Message>,
    notes: Vec<Note>,
}

impl Content {
    fn of(bytes: &[u8]) -> Self {
        let scan = Scan::of(bytes);
        Self { messages: scan.messages, notes: scan.notes }
    }

    /// All sums and indices are right; numbers are as given.
    fn written(&self, options: mcap::WriteOptions) -> Vec<u8> {
        let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
        self.write(&mut writer);
        writer.into_inner().into_inner()
    }

    fn write(&self, writer: &mut McapWriter) {
        let mut notes = self.notes.iter().peekable();
        for (place, message) in (0..).zip(&self.messages) {
            while let Some(note) = notes.next_if(|note| note.messages <= place) {
                write_note(writer, note);
            }
            let channel = &message.channel;
            let schema = writer.add_schema(&channel.schema, &channel.schema_encoding, &channel.schema_data);
            let id =
                writer.add_channel(schema.unwrap(), &channel.topic, &channel.encoding, &channel.metadata);
            let header = MessageHeader {
                channel_id: id.unwrap(),
                sequence: message.sequence,
                log_time: message.log_time,
                publish_time: message.publish_time,
            };
            writer.write_to_known_channel(&header, &message.data).unwrap();
        }
        notes.for_each(|note| write_note(writer, note));
        writer.finish().unwrap();
    }

    fn renumbered(mut self) -> Self {
        for (sequence, message) in (0..).zip(&mut self.messages) {
            message.sequence = sequence;
        }
        self
    }

    fn opened(&self) -> selfneg::trace::Opened {
        open(&self.written(mcap::WriteOptions::new()), &[auditor().clone()]).unwrap()
    }

    fn position(&self, topic: &str) -> usize {
        self.messages.iter().position(|message| &*message.topic == topic).unwrap()
    }

    fn checkpoints(&mut self) -> Vec<&mut Note> {
        self.notes.iter_mut().filter(|note| note.name == CHECKPOINT_RECORD).collect()
    }
}

fn write_note<W: std::io::Write + std::io::Seek>(writer: &mut mcap::Writer<W>, note: &Note) {
    let metadata = Metadata { name: note.name.clone(), metadata: note.entries.clone() };
    writer.write_metadata(&metadata).unwrap();
}

/// As other programs write it: other chunks, other compression, metadata first, or all last.
#[test]
fn a_trace_written_anew_keeps_its_seal() {
    let small = || mcap::WriteOptions::new().compression(None).chunk_size(Some(1_000));
    let content = Content::of(sealed());
    let mut first = content.clone();
    first.notes.iter_mut().for_each(|note| note.messages = 0);
    let mut last = content.clone();
    for note in &mut last.notes {
        note.messages = if note.name == "selfneg.format" { 0 } else { u64::MAX };
    }
    let unchunked = mcap::WriteOptions::new().use_chunks(false);
    let files =
        [content.written(small()), content.written(unchunked), first.written(small()), last.written(small())];
    for bytes in files {
        assert_ne!(bytes, sealed());
        let opened = open(&bytes, &[auditor().clone()]).unwrap();
        let report = report(&opened.seal);
        assert_eq!((&report.faults[..], report.complete), (&[][..], true));
        assert_eq!(report.covered_messages, opened.recording.messages);
        assert_eq!(opened.recording.replay().unwrap().difference, None);
    }
}

/// Every single change of a message is seen, between the checkpoints around it, and nothing of
/// it is covered.
#[test]
fn a_changed_message_is_found_between_its_checkpoints() {
    let content = Content::of(sealed());
    let at = content.position("/mission/negotiation");
    let ends: Vec<u64> = content.clone().checkpoints().iter().map(|note| note.messages).collect();
    let place = u64::try_from(at).unwrap();
    let first = ends.iter().rev().find(|end| **end <= place).copied().unwrap();
    let last = ends.iter().find(|end| **end > place).copied().unwrap();
    let other = Content::of(&scripted(Privacy::LeftOut, None)).messages[2].channel.clone();
    let changes: [&dyn Fn(&mut Message); 6] = [
        &|message| message.data[1] ^= 1,
        &|message| message.data.push(0),
        &|message| message.log_time += 1,
        &|message| message.publish_time += 1,
        &|message| message.sequence += 1,
        &|message| message.channel = other.clone(),
    ];
    for (nth, change) in changes.iter().enumerate() {
        let mut changed = content.clone();
        change(&mut changed.messages[at]);
        let opened = changed.opened();
        let report = report(&opened.seal);
        let places: Vec<_> = report.faults.iter().map(|fault| fault.at).collect();
        assert_eq!(places, [SealPlace::Messages { first, last: last - 1 }], "change {nth}");
        assert_eq!(report.covered_messages, first, "change {nth}");
    }
}

#[test]
fn moved_dropped_repeated_and_foreign_messages_are_found() {
    let content = Content::of(sealed());
    let at = content.position("/mission/negotiation");
    let is_found = |content: &Content, what: &str| {
        let opened = content.opened();
        assert!(!report(&opened.seal).faults.is_empty(), "{what}");
    };
    let mut swapped = content.clone();
    swapped.messages.swap(at, at + 1);
    is_found(&swapped, "swapped");
    is_found(&swapped.clone().renumbered(), "swapped and renumbered");
    let mut dropped = content.clone();
    dropped.messages.remove(at);
    is_found(&dropped, "dropped");
    is_found(&dropped.clone().renumbered(), "dropped and renumbered");
    let mut repeated = content.clone();
    repeated.messages.insert(at, content.messages[at].clone());
    is_found(&repeated, "repeated");
    is_found(&repeated.clone().renumbered(), "repeated and renumbered");
    let mut added = content.clone();
    added.messages.push(content.messages[at].clone());
    is_found(&added.renumbered(), "added after the end");
}

#[test]
fn segments_of_another_place_or_trace_do_not_open() {
    let content = Content::of(sealed());
    let places = |topic: &str| -> Vec<usize> {
        let messages = content.messages.iter().enumerate();
        messages.filter(|(_, message)| &*message.topic == topic).map(|(place, _)| place).collect()
    };
    let put = |into: usize, ciphertext: Option<Vec<u8>>, digest: Vec<u8>| {
        let mut changed = content.clone();
        let message = &mut changed.messages[into];
        let sealed = Sealed::decode(message.data.as_slice()).unwrap();
        message.data = Sealed { ciphertext, digest, ..sealed }.encode_to_vec();
        changed.opened()
    };
    let sealed_at = |at: usize| Sealed::decode(content.messages[at].data.as_slice()).unwrap();
    let (bob, alice) = (places("/sealed/user-2"), places("/sealed/user-1"));
    // With the digest that belongs to it: only the binding inside tells.
    for foreign in [sealed_at(bob[1]), sealed_at(alice[0])] {
        let opened = put(bob[0], foreign.ciphertext, foreign.digest);
        assert_eq!(opened.unopened.len(), 1);
        assert!(opened.unopened[0].what.contains("another place"), "{:?}", opened.unopened);
        assert!(!report(&opened.seal).faults.is_empty());
    }
    let mut mine = 100;
    let random = move |bytes: &mut [u8]| {
        mine += 1;
        bytes.fill(mine);
        Ok(())
    };
    let seal = Seal {
        privacy: Privacy::Sealed(vec![auditor().public()]),
        signer: Some(robot()),
        random: Box::new(random),
    };
    let mut writer = TraceWriter::create(Vec::new(), seal).unwrap();
    run::play(&mut writer).unwrap();
    let bytes = writer.into_inner().unwrap();
    let other = Content::of(&bytes);
    let foreign = Sealed::decode(other.messages[bob[0]].data.as_slice()).unwrap();
    let opened = put(bob[0], foreign.ciphertext, foreign.digest);
    assert!(opened.unopened[0].what.contains("another trace"), "{:?}", opened.unopened);
    // Without its digest even nobody with a key has to look.
    let opened = put(bob[0], sealed_at(alice[0]).ciphertext, sealed_at(bob[0]).digest);
    assert!(report(&opened.seal).faults.iter().any(|fault| fault.what.contains("digest")));
    assert!(opened.unopened[0].what.contains("digest"), "{:?}", opened.unopened);
    // The checkpoints of one trace say nothing in another.
    let mut spliced = content.clone();
    for (note, other) in spliced.checkpoints().into_iter().zip(Content::of(&bytes).checkpoints()) {
        note.entries = other.entries.clone();
    }
    assert_eq!(report(&spliced.opened().seal).checkpoints, 0);
}

/// A segment's bytes have one encoding: nothing can be hidden beside what is signed of it.
#[test]
fn nothing_can_be_hidden_in_a_segment() {
    let content = Content::of(sealed());
    let at = content.position("/sealed/user-2");
    let mut changed = content.clone();
    // An unknown field, which decoding passes over.
    changed.messages[at].data.extend([0x78, 1]);
    assert!(!report(&changed.opened().seal).faults.is_empty());
    let mut emptied = content.clone();
    let segment = Sealed::decode(content.messages[at].data.as_slice()).unwrap();
    emptied.messages[at].data = Sealed { ciphertext: Some(Vec::new()), ..segment }.encode_to_vec();
    assert!(!report(&emptied.opened().seal).faults.is_empty());
}

#[test]
fn changed_checkpoints_and_seals_are_found() {
    let content = Content::of(sealed());
    let checkpoint = |nth: usize| {
        let mut content = content.clone();
        let note = content.checkpoints().remove(nth).clone();
        SignedCheckpoint::from_map(&note.entries).unwrap()
    };
    let last = content.clone().checkpoints().len() - 1;
    assert!(last >= 2);
    for key in ["number", "messages", "decisions", "chain", "rules", "end", "signature"] {
        let mut changed = content.clone();
        let value = match key {
            "end" => "true".to_owned(),
            "number" | "messages" | "decisions" => "7".to_owned(),
            "signature" => "00".repeat(64),
            _ => "00".repeat(32),
        };
        changed.checkpoints()[1].entries.insert(key.to_owned(), value);
        let opened = changed.opened();
        assert!(!report(&opened.seal).faults.is_empty(), "{key}");
        assert_eq!(usize::try_from(report(&opened.seal).checkpoints).unwrap(), last, "{key}");
    }
    // Without one the others still cover everything, and its absence shows.
    let mut without = content.clone();
    let place = without.notes.iter().position(|note| note.entries.get("number").is_some_and(|n| n == "1"));
    without.notes.remove(place.unwrap());
    let opened = without.opened();
    assert!(!report(&opened.seal).faults.is_empty());
    // Without the last one the run has no end: cut, not changed.
    let mut cut = content.clone();
    cut.notes.retain(|note| note.entries.get("end").is_none_or(|end| end != "true"));
    let opened = cut.opened();
    assert_eq!((&report(&opened.seal).faults[..], report(&opened.seal).complete), (&[][..], false));
    assert_eq!(report(&opened.seal).covered_messages, checkpoint(last - 1).checkpoint.messages);
    // Somebody else's signature under the same checkpoints.
    let other = RobotKey::generate(&mut |bytes: &mut [u8]| {
        bytes.fill(9);
        Ok(())
    });
    let mut signed = content.clone();
    let head = report(&content.opened().seal).clone();
    for note in signed.checkpoints() {
        let checkpoint = SignedCheckpoint::from_map(&note.entries).unwrap().checkpoint;
        note.entries = checkpoint.sign(head.trace_id, other.as_ref().unwrap()).to_map();
    }
    assert_eq!(report(&signed.opened().seal).checkpoints, 0);
    // And the seal naming that key: the chain begins with the key, so nothing fits.
    for note in signed.notes.iter_mut().filter(|note| note.name == SEAL_RECORD) {
        note.entries.insert("robot".to_owned(), other.as_ref().unwrap().public().to_string());
    }
    let opened = signed.opened();
    assert_eq!(report(&opened.seal).key, other.unwrap().public());
    assert_eq!(report(&opened.seal).covered_messages, 0);
    // No seal, no key, or another seal.
    let mut without = content.clone();
    without.notes.retain(|note| note.name != SEAL_RECORD);
    assert!(matches!(without.opened().seal, SealState::Broken(_)));
    for (key, value) in [("robot", ""), ("robot", "0"), ("rules", "0"), ("more", "0"), ("recipients", "age1")]
    {
        let mut changed = content.clone();
        for note in changed.notes.iter_mut().filter(|note| note.name == SEAL_RECORD) {
            note.entries.insert(key.to_owned(), value.to_owned());
        }
        assert!(matches!(changed.opened().seal, SealState::Broken(_)), "{key} {value}");
    }
    let mut twice = content.clone();
    let seal = content.notes.iter().find(|note| note.name == SEAL_RECORD).unwrap();
    twice.notes.push(Note { messages: u64::MAX, ..seal.clone() });
    assert!(!report(&twice.opened().seal).faults.is_empty());
    let mut unknown = content.clone();
    unknown.notes.push(Note { name: "verdict".to_owned(), messages: u64::MAX, ..seal.clone() });
    assert!(!report(&unknown.opened().seal).faults.is_empty());
}

/// What nobody signs: an attachment, a channel without messages, a schema without channels.
#[test]
fn what_is_added_beside_the_messages_is_found() {
    let content = Content::of(sealed());
    let added = |add: &dyn Fn(&mut McapWriter)| {
        let mut writer = mcap::WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
        add(&mut writer);
        content.write(&mut writer);
        let bytes = writer.into_inner().into_inner();
        let opened = open(&bytes, &[auditor().clone()]).unwrap();
        assert_eq!(opened.recording.damage, None);
        report(&opened.seal).faults.iter().map(|fault| fault.what.clone()).collect::<Vec<_>>()
    };
    assert_eq!(added(&|_| {}), [] as [&str; 0]);
    let attachment = |writer: &mut McapWriter| {
        let attachment = mcap::Attachment {
            log_time: 0,
            create_time: 0,
            name: "verdict".to_owned(),
            media_type: "text/plain".to_owned(),
            data: std::borrow::Cow::Borrowed(b"guilty"),
        };
        writer.attach(&attachment).unwrap();
    };
    assert_eq!(added(&attachment)[0], "an attachment was added");
    let schema = |writer: &mut McapWriter| {
        writer.add_schema("verdict", "protobuf", b"guilty").unwrap();
    };
    assert_eq!(added(&schema), ["a schema \"verdict\" was added"]);
    let channel = |writer: &mut McapWriter| {
        writer.add_channel(0, "/guilty", "protobuf", &BTreeMap::new()).unwrap();
    };
    assert_eq!(added(&channel), ["a channel \"/guilty\" was added"]);
}

/// Cut behind every record: what was decided before is there, and decided the same again.
#[test]
fn a_cut_trace_keeps_every_decision_before_with_its_personal_part() {
    let bytes = sealed();
    let mut at = mcap::MAGIC.len();
    let mut covered = 0;
    while at + 9 < bytes.len() - mcap::MAGIC.len() {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
        at += 9 + usize::try_from(length).unwrap();
        let Ok(opened) = open(&bytes[..at], &[auditor().clone()]) else { continue };
        let SealState::Signed(report) = &opened.seal else { panic!("{:?}", opened.seal) };
        assert_eq!((&report.faults[..], &opened.unopened[..]), (&[][..], &[][..]), "cut at {at}");
        assert!(report.covered_decisions >= covered);
        covered = report.covered_decisions;
        if covered > 0 {
            let replay = opened.recording.replay().unwrap();
            assert_eq!(replay.difference, None, "cut at {at}");
            let decided = replay.outputs.iter().filter(|output| format!("{output:?}").contains("Decided {"));
            assert!(u64::try_from(decided.count()).unwrap() >= covered, "cut at {at}");
        }
        // As a loss of power may leave it: the file has its length, and no content.
        let mut zeros = bytes[..at].to_vec();
        zeros.extend([0; 300]);
        let opened = open(&zeros, &[]).unwrap();
        assert!(matches!(opened.recording.damage, Some(TraceError::Truncated { .. })), "zeros at {at}");
        let SealState::Signed(report) = &opened.seal else { panic!() };
        assert_eq!(report.faults, [], "zeros at {at}");
    }
    assert!(covered >= 2);
}

#[test]
fn one_condition_can_be_shown_without_the_others() {
    let opened = open(sealed(), &[auditor().clone()]).unwrap();
    let recording = &opened.recording;
    let commitment = recording.commitments.iter().find(|one| one.what() == Committed::Condition).unwrap();
    let opening = recording.openings.iter().find(|one| {
        (one.index, one.user, one.what()) == (commitment.index, commitment.user, commitment.what())
    });
    let salt: [u8; 32] = opening.unwrap().salt.as_slice().try_into().unwrap();
    let data = recording.entries.iter().find_map(|entry| match &entry.step {
        Step::Reply { personal, .. } if entry.index == commitment.index => {
            personal.iter().find_map(|reply| match &reply.reply {
                Some(selfneg::trace::schema::personal::reply::Reply::Disclosed(one)) => {
                    Some(one.encode_to_vec())
                }
                _ => None,
            })
        }
        _ => None,
    });
    let data = data.unwrap();
    let (index, user, what) = (commitment.index, commitment.user, Committed::Condition);
    let fact = Fact { index, user, what, data: &data };
    assert!(verify(&commitment.commitment, &fact, &salt));
    assert!(!verify(&commitment.commitment, &fact, &[0xFF; 32]));
    for other in [
        Fact { index: index + 1, ..fact },
        Fact { user: user + 1, ..fact },
        Fact { what: Committed::Status, ..fact },
        Fact { data: b"", ..fact },
    ] {
        assert!(!verify(&commitment.commitment, &other, &salt));
    }
}

/// A trace of 1.0, as the last version of this program but one wrote it: names in its header,
/// nothing of seals.
#[test]
fn a_trace_of_format_1_0_is_read() {
    let mut content = Content::of(plain());
    let recording = Recording::read(plain()).unwrap();
    let header = selfneg::trace::schema::evidence::Header {
        format_minor: 0,
        rules_digest: Vec::new(),
        privacy: 0,
        ..recording.header.clone()
    };
    content.messages[0].data = header.encode_to_vec();
    let rules = recording.rules.unwrap();
    content.messages[1].data = selfneg::trace::schema::personal::Rules {
        scenario: String::new(),
        building: String::new(),
        floors: Vec::new(),
        places: Vec::new(),
        specification: None,
        ..rules
    }
    .encode_to_vec();
    content.notes[0].entries = BTreeMap::from([("version".to_owned(), "1.0".to_owned())]);
    let opened = content.opened();
    assert_eq!((opened.privacy, opened.seal), (PersonalPart::Plain, SealState::Unsigned));
    assert_eq!(opened.recording.header.scenario, "scripted");
    assert_eq!(opened.recording.replay().unwrap().difference, None);
}
