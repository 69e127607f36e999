//! Viewers that seek read what a file's indices lead to. A trace whose indices lead elsewhere
//! than to what was signed shows them one thing and the auditor another: it is never ok.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    reason = "a test may panic"
)]

mod random_mission;

use mcap::records::op;
use random_mission::Choice;
use selfneg::audit::{Keys, Status, audit};
use selfneg::mission::Evidence;
use selfneg::seal::{AuditorKey, Privacy, RobotKey, Seal};
use selfneg::trace::TraceWriter;
use selfneg_core::Options;

const FALSE: &str = "Decided after 2 rounds, agreed: the robot serves user 2.";

fn random(bytes: &mut [u8]) -> std::io::Result<()> {
    bytes.fill_with(|| 7);
    Ok(())
}

fn signed() -> (Vec<u8>, Keys) {
    let (robot, auditor) = (RobotKey::generate(&mut random).unwrap(), AuditorKey::generate());
    let seal = Seal {
        privacy: Privacy::Sealed(vec![auditor.public()]),
        signer: Some(robot.clone()),
        random: Box::new(random),
    };
    let mut writer = TraceWriter::create(Vec::new(), seal).unwrap();
    let choices = vec![Choice::Request(1, 0), Choice::Emergency(0, Evidence::Sensed)];
    random_mission::play(choices, Options::default(), None, &mut writer);
    (writer.into_inner().unwrap(), Keys { robots: vec![robot.public()], identities: vec![auditor] })
}

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

fn text(text: &[u8]) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text].concat()
}

/// The records of a file: opcode, where they begin, and their bodies.
fn records(bytes: &[u8]) -> Vec<(u8, usize, &[u8])> {
    let (mut found, mut at) = (Vec::new(), mcap::MAGIC.len());
    while at < bytes.len() - mcap::MAGIC.len() {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        found.push((bytes[at], at, &bytes[at + 9..at + 9 + length]));
        at += 9 + length;
    }
    found
}

/// The file with a chunk of somebody else's hidden in a message index, and a summary that leads
/// there instead of to the data.
fn with_another_summary(bytes: &[u8]) -> Vec<u8> {
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    let log = summary.channels.values().find(|channel| channel.topic == "/log").unwrap();
    let schema = log.schema.as_ref().unwrap();
    let declared = [
        record(
            op::SCHEMA,
            &[
                &schema.id.to_le_bytes()[..],
                &text(schema.name.as_bytes()),
                &text(schema.encoding.as_bytes()),
                &text(&schema.data),
            ]
            .concat(),
        ),
        record(
            op::CHANNEL,
            &[
                &log.id.to_le_bytes()[..],
                &schema.id.to_le_bytes(),
                &text(b"/log"),
                &text(b"protobuf"),
                &[0; 4],
            ]
            .concat(),
        ),
    ]
    .concat();
    // `foxglove.Log.message` is field 3.
    let said = [&[3 << 3 | 2, FALSE.len() as u8][..], FALSE.as_bytes()].concat();
    let message = record(op::MESSAGE, &[&log.id.to_le_bytes()[..], &[0; 20], &said].concat());
    let content = [declared.clone(), message].concat();
    let chunk = record(
        op::CHUNK,
        &[
            &[0; 16][..],
            &(content.len() as u64).to_le_bytes(),
            &[0; 4],
            &text(b""),
            &(content.len() as u64).to_le_bytes(),
            &content,
        ]
        .concat(),
    );
    let data_end = records(bytes).iter().find(|(opcode, ..)| *opcode == op::DATA_END).unwrap().1;
    let mut forged = [&bytes[..data_end], &record(op::MESSAGE_INDEX, &chunk)].concat();
    let chunk_at = forged.len() - chunk.len();
    forged.extend(record(op::DATA_END, &[0; 4]));
    let summary_at = forged.len();
    forged.extend(declared);
    let index = [
        &[0; 16][..],
        &(chunk_at as u64).to_le_bytes(),
        &(chunk.len() as u64).to_le_bytes(),
        &[0; 12],
        &text(b""),
        &(content.len() as u64).to_le_bytes(),
        &(content.len() as u64).to_le_bytes(),
    ]
    .concat();
    forged.extend(record(op::CHUNK_INDEX, &index));
    forged.extend(record(op::FOOTER, &[&(summary_at as u64).to_le_bytes()[..], &[0; 12]].concat()));
    forged.extend(mcap::MAGIC);
    forged
}

#[test]
fn a_summary_that_leads_to_other_messages_is_tampered_with() {
    let (bytes, keys) = signed();
    assert_eq!(audit(&bytes, &keys).status, Status::Ok);
    let forged = with_another_summary(&bytes);
    // What a reader that seeks would show.
    let summary = mcap::Summary::read(&forged).unwrap().unwrap();
    let shown: Vec<u8> = summary
        .chunk_indexes
        .iter()
        .flat_map(|index| summary.stream_chunk(&forged, index).unwrap())
        .flat_map(|message| message.unwrap().data.into_owned())
        .collect();
    assert!(String::from_utf8_lossy(&shown).contains(FALSE));
    let found = audit(&forged, &keys);
    assert_eq!(found.status, Status::Tampered, "{:?}", found.findings);
}

/// Changes the body of the first record of a kind, and takes the sums away that would show it.
fn forged(bytes: &[u8], kind: u8, change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut out = mcap::MAGIC.to_vec();
    let mut done = false;
    for (opcode, _, body) in records(bytes) {
        let mut body = body.to_vec();
        if opcode == kind && !done {
            change(&mut body);
            done = true;
        }
        match opcode {
            op::DATA_END => body = vec![0; 4],
            op::FOOTER => body[16..].fill(0),
            _ => {}
        }
        out.extend(record(opcode, &body));
    }
    assert!(done);
    out.extend(mcap::MAGIC);
    out
}

/// What is changed, in the body of which record, and how.
type Change = (&'static str, u8, fn(&mut Vec<u8>));

#[test]
fn every_index_leads_to_what_is_there() {
    let (bytes, keys) = signed();
    let same = forged(&bytes, op::MESSAGE_INDEX, |_| ());
    assert_eq!(audit(&same, &keys).status, Status::Ok);
    let changes: [Change; 12] = [
        ("a message index to another place", op::MESSAGE_INDEX, |body| body[14] ^= 1),
        ("a message index of another channel", op::MESSAGE_INDEX, |body| body[0] ^= 1),
        ("a time in a message index", op::MESSAGE_INDEX, |body| body[6] ^= 1),
        ("a chunk index to another place", op::CHUNK_INDEX, |body| body[16] ^= 1),
        ("a chunk index to more", op::CHUNK_INDEX, |body| body[24] ^= 1),
        ("the time from which a chunk is read", op::CHUNK_INDEX, |body| body[0] ^= 1),
        ("a metadata index to another place", op::METADATA_INDEX, |body| body[0] ^= 1),
        ("the times that a chunk says", op::CHUNK, |body| body[0] ^= 1),
        ("the footer leads elsewhere", op::FOOTER, |body| body[0] ^= 1),
        ("the footer leads to other offsets", op::FOOTER, |body| body[8] ^= 1),
        ("a name that writes lines", op::HEADER, |body| body[8] = b'\n'),
        ("more than a name in the header", op::HEADER, |body| body[4] -= 1),
    ];
    for (name, kind, change) in changes {
        let found = audit(&forged(&bytes, kind, change), &keys);
        assert_eq!(found.status, Status::Tampered, "{name}: {:?}", found.findings);
        assert_eq!(found.decisions.len(), 1, "{name}");
    }
}

#[test]
fn statistics_and_summary_offsets_are_of_what_is_there() {
    let (bytes, keys) = signed();
    for (kind, name) in [(op::STATISTICS, "statistics"), (op::SUMMARY_OFFSET, "summary offset")] {
        let (_, _, body) = records(&bytes).into_iter().find(|(opcode, ..)| *opcode == kind).unwrap();
        for at in 0..body.len() {
            let found = audit(&forged(&bytes, kind, |body| body[at] ^= 1), &keys);
            assert_eq!(found.status, Status::Tampered, "{name}, byte {at}: {:?}", found.findings);
            assert_eq!(found.decisions.len(), 1, "{name}, byte {at}");
        }
    }
}
