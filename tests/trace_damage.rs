//! No bytes make the reader panic, and what it yields of a damaged trace is what was written.

#![expect(clippy::unwrap_used, clippy::indexing_slicing, reason = "it is a test")]

#[path = "../examples/scripted_trace/run.rs"]
#[allow(unreachable_pub, dead_code, reason = "shared with the example")]
mod run;

use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::OnceLock;
use std::time::Duration;

use proptest::prelude::*;
use selfneg::demo;
use selfneg::mission::{Event, GoalId, Mission, MissionRules, Place, UserId};
use selfneg::run::{Setup, Watcher};
use selfneg::trace::{
    FORMAT_KEY, FORMAT_MAJOR, FORMAT_RECORD, Message, Reader, Recording, TraceError, TraceWriter,
};
use selfneg_core::Options;
use selfneg_sim::{Building, Cell, Floor, OccupancyGrid, Point};

fn scripted() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let mut writer = TraceWriter::plain(Vec::new()).unwrap();
        run::play(&mut writer).unwrap();
        writer.into_inner().unwrap()
    })
}

fn whole() -> &'static [Message] {
    static MESSAGES: OnceLock<Vec<Message>> = OnceLock::new();
    MESSAGES.get_or_init(|| Reader::new(scripted()).collect::<Result<_, _>>().unwrap())
}

/// What is yielded before the first error, and the error.
fn read(bytes: &[u8]) -> (Vec<Message>, Option<TraceError>) {
    let mut messages = Vec::new();
    for message in Reader::new(bytes) {
        match message {
            Ok(message) => messages.push(message),
            Err(error) => return (messages, Some(error)),
        }
    }
    (messages, None)
}

/// Where each record of the file ends.
fn record_ends(bytes: &[u8]) -> Vec<usize> {
    let mut ends = vec![8];
    let mut at = 8;
    while at + 9 <= bytes.len() - 8 {
        at += 9 + usize::try_from(u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap())).unwrap();
        ends.push(at);
    }
    ends
}

#[test]
fn a_file_cut_at_any_record_or_near_it_is_truncated_and_yields_what_is_before() {
    let bytes = scripted();
    for end in record_ends(bytes) {
        for cut in [end.saturating_sub(1), end, end + 1, end + 8, end + 9] {
            if cut >= bytes.len() {
                continue;
            }
            let (messages, error) = read(&bytes[..cut]);
            assert!(whole().starts_with(&messages), "cut at {cut}");
            let is_truncated = matches!(error, Some(TraceError::Truncated { .. }))
                || (cut < 8 && error == Some(TraceError::NotMcap));
            assert!(is_truncated, "cut at {cut}: {error:?}");
        }
    }
}

#[test]
fn a_newer_major_version_is_refused_by_name() {
    let mut writer = mcap::WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
    let version = format!("{}.7", FORMAT_MAJOR + 1);
    let metadata = BTreeMap::from([(FORMAT_KEY.to_owned(), version.clone())]);
    writer.write_metadata(&mcap::records::Metadata { name: FORMAT_RECORD.to_owned(), metadata }).unwrap();
    writer.finish().unwrap();
    let bytes = writer.into_inner().into_inner();
    let error = Recording::read(&bytes).unwrap_err();
    assert_eq!(error, TraceError::NewerMajor { found: version });
    assert_eq!(error.to_string(), "format 2.7: written by a newer program; this one reads formats up to 1.x");
}

#[test]
fn another_mcap_file_is_no_trace() {
    let mut writer = mcap::WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
    writer.finish().unwrap();
    let bytes = writer.into_inner().into_inner();
    assert!(matches!(Recording::read(&bytes), Err(TraceError::NotATrace(_))));
    assert!(matches!(Recording::read(b"{}"), Err(TraceError::NotMcap)));
}

/// A trace without a map to speak of, so that every byte of it can have its turn.
fn small() -> Vec<u8> {
    let map = OccupancyGrid::new(2, 1, 1.0, Point::default(), vec![Cell::Free; 2]).unwrap();
    let floor = Floor { name: "ground".into(), map, places: Vec::new() };
    let building = Building::new("room".into(), vec![floor], Vec::new()).unwrap();
    let (rules, specification) = (demo::rules().unwrap(), run::specification());
    let options = Options::default();
    let mut writer = TraceWriter::plain(Vec::new()).unwrap();
    let setup = Setup {
        name: "small",
        building: &building,
        rules: &rules,
        specification: &specification,
        options,
        policy: None,
        participants: &[],
        places: &[],
    };
    writer.begin(&setup).unwrap();
    let rules = MissionRules::new(&rules, specification.clone(), options, None).unwrap();
    let (mut mission, mut outputs) = Mission::new(rules);
    for user in 0..3 {
        for output in outputs {
            writer.output(Duration::ZERO, &output).unwrap();
        }
        let event = Event::Request { user: UserId(user), goal: GoalId(0), place: Place(0) };
        writer.event(Duration::ZERO, &event).unwrap();
        outputs = mission.handle(event);
        writer.decided(Duration::ZERO).unwrap();
    }
    for output in outputs {
        writer.output(Duration::ZERO, &output).unwrap();
    }
    writer.end(Duration::ZERO).unwrap();
    writer.into_inner().unwrap()
}

/// One bit of every byte. What is read before the damage is as it was written, and damage is
/// always seen.
#[test]
fn every_byte_of_a_small_trace_counts() {
    let bytes = small();
    let entries = Recording::read(&bytes).unwrap().entries;
    assert!(entries.len() > 10);
    for at in 0..bytes.len() {
        let mut flipped = bytes.clone();
        flipped[at] ^= 1 << (at % 8);
        if let Ok(recording) = Recording::read(&flipped) {
            assert!(!recording.is_complete(), "byte {at} of {} unseen", bytes.len());
            assert!(entries.starts_with(&recording.entries), "byte {at}");
        }
    }
}

#[test]
fn a_small_trace_cut_at_every_length_replays_what_is_left() {
    let bytes = small();
    let entries = Recording::read(&bytes).unwrap().entries;
    let mut replayed = None;
    for cut in 0..bytes.len() {
        match Recording::read(&bytes[..cut]) {
            Ok(recording) => {
                assert!(matches!(recording.damage, Some(TraceError::Truncated { .. })), "cut at {cut}");
                assert!(entries.starts_with(&recording.entries), "cut at {cut}");
                if replayed != Some(recording.entries.len()) {
                    replayed = Some(recording.entries.len());
                    assert_eq!(recording.replay().unwrap().difference, None, "cut at {cut}");
                }
            }
            Err(error) => {
                assert!(
                    matches!(error, TraceError::Truncated { .. } | TraceError::NotMcap),
                    "cut at {cut}: {error}"
                );
            }
        }
    }
}

/// The reader passes over what it does not know; the numbering shows what is missing.
#[test]
fn a_chunk_that_is_no_chunk_any_more_leaves_a_gap() {
    let mut bytes = small();
    let chunks: Vec<usize> =
        record_ends(&bytes).into_iter().filter(|at| bytes.get(*at) == Some(&6)).collect();
    // The last but one declares no schema that the last one needs.
    bytes[chunks[chunks.len() - 2]] = 0x90;
    let damage = Recording::read(&bytes).unwrap().damage;
    assert!(matches!(damage, Some(TraceError::Gap { .. })), "{damage:?}");
}

/// mcap's own parser of attachments panics on this one.
#[test]
fn a_short_attachment_does_not_panic() {
    let mut bytes = mcap::MAGIC.to_vec();
    bytes.extend([9, 3, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3]);
    assert!(matches!(read(&bytes).1, Some(TraceError::Truncated { .. })));
}

/// The sums that mcap's readers skip unless asked.
#[test]
fn a_flipped_byte_in_each_part_is_a_crc_mismatch_or_malformed() {
    let bytes = scripted();
    let ends = record_ends(bytes);
    // The metadata record of the version: only the sum of the data section covers it.
    let mut flipped = bytes.to_vec();
    flipped[ends[1] + 9 + 4] ^= 1;
    let (messages, error) = read(&flipped);
    assert_eq!(messages.len(), whole().len());
    assert!(matches!(error, Some(TraceError::CrcMismatch { what: "data section", .. })), "{error:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 192, ..ProptestConfig::default() })]

    #[test]
    fn a_cut_yields_a_prefix(cut in 0..scripted().len()) {
        let bytes = &scripted()[..cut];
        let (messages, error) = read(bytes);
        prop_assert!(whole().starts_with(&messages));
        let is_cut = matches!(error, Some(TraceError::Truncated { .. } | TraceError::NotMcap));
        prop_assert!(is_cut, "{:?}", error);
        if let Ok(recording) = Recording::read(bytes) {
            prop_assert!(!recording.is_complete());
            prop_assert_eq!(recording.replay().map(|replay| replay.difference).unwrap_or(None), None);
        }
    }

    #[test]
    fn a_flipped_byte_is_found_and_yields_a_prefix(at in 0..scripted().len(), flip in 1..=255_u8) {
        let mut bytes = scripted().to_vec();
        bytes[at] ^= flip;
        let (messages, error) = read(&bytes);
        prop_assert!(error.is_some(), "byte {} unseen", at);
        // A record whose kind is not known any more is passed over.
        let mut written = whole().iter();
        prop_assert!(messages.iter().all(|message| written.any(|whole| whole == message)));
        let _no_panic = Recording::read(&bytes).map(|recording| recording.replay());
    }

    #[test]
    fn no_bytes_make_it_panic(tail in prop::collection::vec(any::<u8>(), 0..200)) {
        let mut bytes = mcap::MAGIC.to_vec();
        bytes.extend(tail);
        let _no_panic = Recording::read(&bytes);
    }

    #[test]
    fn no_records_make_it_panic(records in prop::collection::vec((0..=16_u8, prop::collection::vec(any::<u8>(), 0..60)), 0..20)) {
        let mut bytes = mcap::MAGIC.to_vec();
        for (opcode, body) in records {
            bytes.push(opcode);
            bytes.extend(u64::try_from(body.len()).unwrap().to_le_bytes());
            bytes.extend(body);
        }
        let _no_panic = Recording::read(&bytes);
    }
}
