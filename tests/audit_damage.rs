//! A small sealed trace, changed and cut in every way: never a panic, never ok where the content
//! changed, and every decision that is intact before a cut is still reported.
//!
//! By default one byte or message in so many is tried; all of them with
//! `cargo test --release --test audit_damage -- --ignored`.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::print_stdout,
    reason = "a test may panic"
)]

mod random_mission;
mod rewriting;

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::rc::Rc;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use random_mission::Choice;
use rayon::prelude::*;
use rewriting::Pieces;
use selfneg::audit::{Audit, Keys, Status, audit};
use selfneg::input::Truth;
use selfneg::mission::{Event, Evidence, LOCATION, Output, Profile, Stated, UserData};
use selfneg::run::{Setup, Watcher};
use selfneg::seal::{AuditorKey, Privacy, RobotKey, Seal};
use selfneg::trace::{Message, Scan, TraceWriter};
use selfneg_core::Options;

/// By default every so many-th byte and length.
const STRIDE: usize = 449;

/// By default every so many-th message.
const MESSAGE_STRIDE: usize = 9;

struct Sealed {
    bytes: Vec<u8>,
    keys: Keys,
    signer: RobotKey,
    /// How long the file was when each decision had been flushed.
    flushed: Vec<usize>,
}

fn system_random(bytes: &mut [u8]) -> io::Result<()> {
    getrandom::fill(bytes).map_err(io::Error::other)
}

fn data(rank: u8, conditions: &[&'static str]) -> UserData {
    let stated = |&condition: &&'static str| Stated { condition: condition.into(), truth: Truth::True };
    UserData {
        profiles: vec![Profile {
            label: "mall".into(),
            ranks: vec![("elderly people".into(), rank), ("people in urgency".into(), 3)],
        }],
        status: conditions.iter().map(stated).collect(),
        context: vec![(LOCATION.into(), "mall".into())],
    }
}

/// Three decisions, one of them an emergency's.
fn story() -> Vec<Choice> {
    vec![
        Choice::Request(1, 0),
        Choice::Answer(data(2, &["in urgency"])),
        Choice::Request(2, 1),
        Choice::Answer(data(4, &["elderly"])),
        Choice::Rounds(60),
        Choice::Emergency(0, Evidence::Sensed),
        Choice::Done,
        Choice::Done,
        Choice::Done,
        Choice::Done,
        Choice::Done,
        Choice::Done,
        Choice::Answer(data(4, &["elderly"])),
        Choice::Request(3, 0),
        Choice::Answer(data(1, &["in urgency", "of nobody's rules"])),
        Choice::Rounds(60),
    ]
}

#[derive(Clone, Default)]
struct Shared(Rc<RefCell<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Notes how long the file is after each decision.
struct Measured {
    writer: TraceWriter<Shared>,
    file: Shared,
    flushed: Vec<usize>,
}

impl Watcher for Measured {
    fn begin(&mut self, setup: &Setup<'_>) -> io::Result<()> {
        self.writer.begin(setup)
    }
    fn event(&mut self, at: Duration, event: &Event) -> io::Result<()> {
        self.writer.event(at, event)
    }
    fn output(&mut self, at: Duration, output: &Output) -> io::Result<()> {
        self.writer.output(at, output)
    }
    fn decided(&mut self, at: Duration) -> io::Result<()> {
        self.writer.decided(at)?;
        self.flushed.push(self.file.0.borrow().len());
        Ok(())
    }
    fn end(&mut self, at: Duration) -> io::Result<()> {
        self.writer.end(at)
    }
}

fn made(robot: &RobotKey, auditor: &AuditorKey) -> Sealed {
    let seal = Seal {
        privacy: Privacy::Sealed(vec![auditor.public()]),
        signer: Some(robot.clone()),
        random: Box::new(system_random),
    };
    let file = Shared::default();
    let writer = TraceWriter::create(file.clone(), seal).unwrap();
    let mut measured = Measured { writer, file, flushed: Vec::new() };
    random_mission::play(story(), Options::default(), None, &mut measured);
    let bytes = measured.file.0.borrow().clone();
    let keys = Keys { robots: vec![robot.public()], identities: vec![auditor.clone()] };
    Sealed { bytes, keys, signer: robot.clone(), flushed: measured.flushed }
}

fn keys() -> (RobotKey, AuditorKey) {
    (RobotKey::generate(&mut system_random).unwrap(), AuditorKey::generate())
}

fn sealed() -> &'static Sealed {
    static SEALED: OnceLock<Sealed> = OnceLock::new();
    SEALED.get_or_init(|| {
        let (robot, auditor) = keys();
        made(&robot, &auditor)
    })
}

fn audited(bytes: &[u8]) -> Audit {
    audit(bytes, &sealed().keys)
}

type Metadata = (String, BTreeMap<String, String>);

/// Messages and metadata: what a trace says, whatever the container around it.
fn content(bytes: &[u8]) -> (Vec<Message>, Vec<Metadata>) {
    let scan = Scan::of(bytes);
    let mut messages = scan.messages;
    for message in &mut messages {
        message.at = 0;
    }
    (messages, scan.notes.into_iter().map(|note| (note.name, note.entries)).collect())
}

fn assert_ok(audit: &Audit) {
    assert_eq!(audit.status, Status::Ok, "{:#?}", audit.findings);
    assert_eq!((audit.decisions.len(), audit.redecided()), (3, 3));
}

fn flip_every(stride: usize) -> BTreeMap<Status, usize> {
    let sealed = sealed();
    let original = content(&sealed.bytes);
    let places: Vec<usize> = (0..sealed.bytes.len()).step_by(stride).collect();
    let found: Vec<Status> = places
        .par_iter()
        .map(|&at| {
            let mut bytes = sealed.bytes.clone();
            bytes[at] ^= [0x01, 0x80, 0xff][at % 3];
            let found = audited(&bytes);
            if found.status == Status::Ok {
                assert!(content(&bytes) == original, "byte {at} changes the content, and nobody minds");
            }
            found.status
        })
        .collect();
    let mut counts = BTreeMap::new();
    for status in found {
        *counts.entry(status).or_insert(0) += 1;
    }
    counts
}

fn cut_at_every(stride: usize) -> BTreeMap<Status, usize> {
    let sealed = sealed();
    let whole = audited(&sealed.bytes);
    let places: Vec<usize> = (0..sealed.bytes.len()).step_by(stride).collect();
    let found: Vec<Status> = places
        .par_iter()
        .map(|&length| {
            let found = audited(&sealed.bytes[..length]);
            assert!(
                [Status::Truncated, Status::Unreadable].contains(&found.status),
                "cut at {length}: {:#?}",
                found.findings
            );
            let intact = sealed.flushed.iter().filter(|&&flushed| flushed <= length).count();
            assert!(
                found.decisions.len() >= intact,
                "cut at {length}: {} of {intact}",
                found.decisions.len()
            );
            for (found, whole) in found.decisions.iter().zip(&whole.decisions).take(intact) {
                assert_eq!(found, whole, "cut at {length}");
            }
            if intact > 0 {
                assert_eq!(found.status, Status::Truncated, "cut at {length}");
                assert!(found.seal.unwrap().covered_decisions >= intact as u64);
            }
            found.status
        })
        .collect();
    let mut counts = BTreeMap::new();
    for status in found {
        *counts.entry(status).or_insert(0) += 1;
    }
    counts
}

#[test]
fn the_trace_itself_is_ok_however_it_is_packed() {
    let sealed = sealed();
    assert_ok(&audited(&sealed.bytes));
    let pieces = Pieces::of(&sealed.bytes);
    for chunk in [64, 1 << 10, 1 << 20] {
        assert_ok(&audited(&pieces.with_chunks_of(chunk)));
    }
}

#[test]
fn flipped_bytes() {
    let counts = flip_every(STRIDE);
    assert!(counts[&Status::Tampered] > 0, "{counts:?}");
}

#[test]
fn cut_files() {
    let counts = cut_at_every(STRIDE);
    assert!(counts[&Status::Truncated] > 0, "{counts:?}");
}

#[test]
#[ignore = "minutes in debug; cargo test --release --test audit_damage -- --ignored --nocapture"]
fn every_byte_every_length_and_every_message() {
    println!("{} bytes", sealed().bytes.len());
    let began = Instant::now();
    println!("flipped: {:?} in {:.1?}", flip_every(1), began.elapsed());
    let began = Instant::now();
    println!("cut: {:?} in {:.1?}", cut_at_every(1), began.elapsed());
    let began = Instant::now();
    disturb_every(1);
    splice_at_every(1);
    cut_between_every(1);
    println!("messages disturbed, spliced and cut in {:.1?}", began.elapsed());
}

/// What is done to the messages is seen without the auditor's key.
fn tampered(what: &str, pieces: &Pieces) {
    let keys = Keys { identities: Vec::new(), ..sealed().keys.clone() };
    let found = audit(&pieces.to_bytes(), &keys);
    assert!(
        [Status::Tampered, Status::Unreadable].contains(&found.status),
        "{what}: {} {:#?}",
        found.status,
        found.findings
    );
}

#[test]
fn messages_dropped_repeated_swapped_and_changed() {
    disturb_every(MESSAGE_STRIDE);
}

fn disturb_every(stride: usize) {
    let original = Pieces::of(&sealed().bytes);
    let messages = original.messages.len();
    (0..messages).into_par_iter().step_by(stride).for_each(|at| {
        let renumbered = |mut pieces: Pieces| {
            for (sequence, message) in (0..).zip(&mut pieces.messages) {
                message.sequence = sequence;
            }
            pieces
        };
        let mut dropped = original.clone();
        dropped.messages.remove(at);
        if at + 1 < messages {
            // Dropping the end alone is a cut.
            tampered(&format!("message {at} dropped"), &dropped);
            tampered(&format!("message {at} dropped, numbers mended"), &renumbered(dropped));
        }
        let mut repeated = original.clone();
        repeated.messages.insert(at, repeated.messages[at].clone());
        tampered(&format!("message {at} repeated"), &repeated);
        tampered(&format!("message {at} repeated, numbers mended"), &renumbered(repeated));
        if at + 1 < messages {
            let mut swapped = original.clone();
            swapped.messages.swap(at, at + 1);
            tampered(&format!("messages {at} and {} swapped", at + 1), &swapped);
            tampered(&format!("messages {at} and {} swapped, numbers mended", at + 1), &renumbered(swapped));
        }
        let mut later = original.clone();
        later.messages[at].log_time += 1;
        tampered(&format!("message {at} at another time"), &later);
        let mut longer = original.clone();
        longer.messages[at].data.push(0);
        tampered(&format!("message {at} with a byte more"), &longer);
    });
}

#[test]
fn cut_between_messages_and_mended() {
    cut_between_every(MESSAGE_STRIDE);
}

fn cut_between_every(stride: usize) {
    let original = Pieces::of(&sealed().bytes);
    let checkpoints = original.notes.iter().filter(|(name, _)| name == "selfneg.checkpoint").count();
    assert_eq!(checkpoints, 5);
    (1..original.messages.len()).into_par_iter().step_by(stride).for_each(|messages| {
        let mut cut = original.clone();
        cut.messages.truncate(messages);
        let found = audited(&cut.to_bytes());
        assert_ne!(found.status, Status::Ok, "cut after {messages} messages");
        // The checkpoints of what is gone taken out as well: a whole file of an earlier moment.
        cut.notes.retain(|(name, entries)| {
            name != "selfneg.checkpoint"
                || entries["messages"].parse::<usize>().is_ok_and(|covered| covered <= messages)
        });
        let found = audited(&cut.to_bytes());
        assert_eq!(found.status, Status::Truncated, "{messages}: {:#?}", found.findings);
    });
}

#[test]
fn checkpoints_and_seal_taken_out_or_changed() {
    let original = Pieces::of(&sealed().bytes);
    for at in 0..original.notes.len() {
        let mut without = original.clone();
        let (name, _) = without.notes.remove(at);
        let found = audited(&without.to_bytes());
        assert_ne!(found.status, Status::Ok, "without {name} ({at})");
        let mut twice = original.clone();
        twice.notes.insert(at, twice.notes[at].clone());
        assert_ne!(audited(&twice.to_bytes()).status, Status::Ok, "{name} twice");
        for key in original.notes[at].1.keys() {
            let mut changed = original.clone();
            let value = changed.notes[at].1.get_mut(key).unwrap();
            let last = value.pop().unwrap_or('0');
            value.push(if last == '1' { '2' } else { '1' });
            assert_ne!(audited(&changed.to_bytes()).status, Status::Ok, "{name}: {key} changed");
        }
    }
    let mut unsigned = original;
    unsigned.notes.retain(|(name, _)| name == "selfneg.format");
    let found = audited(&unsigned.to_bytes());
    assert_ne!(found.status, Status::Ok, "{:#?}", found.findings);
}

#[test]
fn signed_by_another_key_it_is_untrusted() {
    let sealed = sealed();
    let (robot, _) = keys();
    let auditor = &sealed.keys.identities[0];
    let forged = made(&robot, auditor);
    let found = audited(&forged.bytes);
    assert_eq!(found.status, Status::Untrusted, "{:#?}", found.findings);
    assert_eq!(found.redecided(), 3);
    let trusting = Keys { robots: vec![robot.public(), sealed.signer.public()], ..sealed.keys.clone() };
    assert_ok(&audit(&forged.bytes, &trusting));
    assert_ok(&audit(&sealed.bytes, &trusting));
    let nobody = Keys { robots: Vec::new(), ..sealed.keys.clone() };
    assert_eq!(audit(&sealed.bytes, &nobody).status, Status::Untrusted);
    // Its checkpoints under the other one's name.
    let mut named = Pieces::of(&forged.bytes);
    for (name, entries) in &mut named.notes {
        if name == "selfneg.seal" {
            entries.insert("robot-key".to_owned(), sealed.signer.public().to_string());
            entries.insert("key".to_owned(), sealed.signer.public().to_string());
        }
    }
    tampered("another key's checkpoints", &named);
}

#[test]
fn two_traces_of_one_robot_spliced() {
    splice_at_every(MESSAGE_STRIDE);
}

fn splice_at_every(stride: usize) {
    let sealed = sealed();
    let other = made(&sealed.signer, &sealed.keys.identities[0]);
    assert_ok(&audited(&other.bytes));
    let (ours, theirs) = (Pieces::of(&sealed.bytes), Pieces::of(&other.bytes));
    assert_eq!(ours.messages.len(), theirs.messages.len());
    (1..ours.messages.len()).into_par_iter().step_by(stride).for_each(|at| {
        let mut spliced = ours.clone();
        spliced.messages[at..].clone_from_slice(&theirs.messages[at..]);
        if spliced.messages != ours.messages {
            tampered(&format!("spliced before message {at}"), &spliced);
        }
        let mut theirs_checked = spliced.clone();
        theirs_checked.notes.clone_from(&theirs.notes);
        if theirs_checked.messages != theirs.messages {
            tampered(&format!("spliced before message {at}, their checkpoints"), &theirs_checked);
        }
    });
    // One person's segment in another trace, and one file after the other.
    let whole: Vec<u8> = sealed.bytes.iter().chain(&other.bytes).copied().collect();
    assert_ne!(audited(&whole).status, Status::Ok);
}

#[test]
fn without_the_identity_a_sealed_trace_is_ok_and_nothing_was_made_again() {
    let sealed = sealed();
    let keys = Keys { identities: Vec::new(), ..sealed.keys.clone() };
    let found = audit(&sealed.bytes, &keys);
    assert_eq!((found.status, found.redecided(), found.decisions.len()), (Status::Ok, 0, 3));
    assert!(!found.unchecked.is_empty());
    let (_, another) = self::keys();
    let keys = Keys { identities: vec![another], ..keys };
    assert_eq!(audit(&sealed.bytes, &keys).status, Status::Incomplete);
}

#[test]
fn after_an_erasure_the_rest_is_checked() {
    let sealed = sealed();
    let erased = selfneg::trace::erase(&sealed.bytes, "user-3").unwrap();
    let found = audited(&erased.bytes);
    assert_eq!(found.status, Status::Incomplete, "{:#?}", found.findings);
    assert!(
        found.findings.iter().all(|finding| finding.status == Status::Incomplete),
        "{:#?}",
        found.findings
    );
    assert!(found.erased.contains(&"user-3".to_owned()), "{:?}", found.erased);
    // The decision without user 3, and the emergency.
    assert_eq!(found.redecided(), 2, "{:?}", found.unchecked);
}
