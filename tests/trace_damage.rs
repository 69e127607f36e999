//! No bytes make the reader panic, and what it yields of a damaged trace is what was written.

#[path = "../examples/scripted_trace/run.rs"]
#[allow(unreachable_pub, dead_code, reason = "shared with the example")]
mod run;

use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::OnceLock;

use proptest::prelude::*;
use selfneg::trace::{
    FORMAT_KEY, FORMAT_MAJOR, FORMAT_RECORD, Message, Reader, Recording, TraceError, TraceWriter,
};

fn scripted() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let mut writer = TraceWriter::new(Vec::new()).unwrap();
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
        prop_assert!(whole().starts_with(&messages) || messages.len() == whole().len());
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
