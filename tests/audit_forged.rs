//! Unsigned traces made to deceive: what nobody signed is still held against itself, and what
//! it says cannot write lines of the auditor's.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod random_mission;
mod rewriting;

use prost::Message as _;
use random_mission::{Choice, data};
use rewriting::Pieces;
use selfneg::audit::{Audit, Keys, Status, audit};
use selfneg::trace::schema::evidence::{self, Verdict, record::Record, round};
use selfneg::trace::schema::personal::{self, input, reply};
use selfneg::trace::{PERSONAL, Scan, TraceError};
use selfneg_core::Options;

/// User 1 is being served; user 2 takes over after four rounds.
fn honest() -> Pieces {
    let choices = vec![
        Choice::Request(1, 0),
        Choice::Answer(data([0, 5, 0, 1, 0, 0], &["of nobody's rules"])),
        Choice::Request(2, 1),
        Choice::Answer(data([0, 5, 0, 1, 0, 0], &["of nobody's rules", "elderly"])),
        Choice::Rounds(60),
    ];
    Pieces::of(&random_mission::trace(choices, Options::default(), None))
}

fn audited(pieces: &Pieces) -> Audit {
    audit(&pieces.to_bytes(), &Keys::default())
}

fn openly_pieces() -> Pieces {
    let mut pieces = honest();
    pieces.messages.retain(|message| !message.topic.starts_with(PERSONAL));
    pieces.renumber();
    pieces
}

fn openly(mut pieces: Pieces) -> Audit {
    pieces.messages.retain(|message| !message.topic.starts_with(PERSONAL));
    pieces.renumber();
    audited(&pieces)
}

fn record(message: &selfneg::trace::Message) -> Option<Record> {
    let is = &*message.schema == "selfneg.v1.Record";
    is.then(|| evidence::Record::decode(message.data.as_slice()).unwrap().record.unwrap())
}

#[test]
fn the_honest_trace_is_found_right() {
    for found in [audited(&honest()), openly(honest())] {
        assert_eq!(found.status, Status::Unsealed);
        assert_eq!((found.decisions.len(), found.decisions[0].rounds), (1, 3), "{:?}", found.decisions);
        assert_eq!(found.decisions[0].outcome, "interrupting");
    }
}

#[test]
fn nobody_takes_the_robot_without_a_decision() {
    let mut pieces = honest();
    pieces.messages.retain(|message| {
        !matches!(
            record(message),
            Some(
                Record::NegotiationStarted(_)
                    | Record::Round(_)
                    | Record::NegotiationEnded(_)
                    | Record::Decided(_)
            )
        )
    });
    let found = openly(pieces);
    assert_eq!(found.status, Status::WrongDecision, "{:#?}", found.findings);
}

#[test]
fn two_users_negotiate_once_for_a_decision() {
    let mut pieces = honest();
    pieces.messages.retain(|message| !message.topic.starts_with(PERSONAL));
    let first = pieces
        .messages
        .iter()
        .position(|message| matches!(record(message), Some(Record::NegotiationStarted(_))))
        .unwrap();
    // Before the true one there is one that the current user wins in the second round.
    let mut won = Vec::new();
    for message in &pieces.messages {
        let Some(mut is) = record(message) else { continue };
        match &mut is {
            Record::NegotiationStarted(_) => {}
            Record::Round(round) if round.number <= 2 => {
                let Some(round::Round::Offer(offer)) = &mut round.round else { panic!("no offer") };
                let verdict = if round.number == 1 { Verdict::Reject } else { Verdict::Accept };
                offer.set_verdict(verdict);
            }
            Record::NegotiationEnded(ended) => (ended.winner, ended.rounds) = (Some(1), 2),
            _ => continue,
        }
        let data = evidence::Record { index: 0, record: Some(is) }.encode_to_vec();
        won.push(selfneg::trace::Message { data, ..message.clone() });
    }
    pieces.messages.splice(first..first, won);
    for message in &mut pieces.messages {
        if let Some(Record::Decided(mut decided)) = record(message) {
            decided.rounds += 2;
            decided.agreement = Some(1);
            decided.served = 1;
            let decided = evidence::Record { index: 0, record: Some(Record::Decided(decided)) };
            message.data = decided.encode_to_vec();
        }
    }
    let found = openly(pieces);
    let what = "two negotiations of user 1 and user 2";
    assert!(found.findings.iter().any(|finding| finding.what.contains(what)), "{:#?}", found.findings);
    assert_eq!(found.status, Status::WrongDecision);
}

#[test]
fn a_verdict_against_the_receivers_own_totals_shows_though_the_senders_data_are_gone() {
    let without_sender = |swap: bool| {
        let mut pieces = honest();
        pieces.messages.retain(|message| {
            let is = &*message.schema == "selfneg.personal.v1.Input";
            let input = is.then(|| personal::Input::decode(message.data.as_slice()).unwrap());
            !input.is_some_and(|input| {
                input.user == Some(2) && matches!(input.input, Some(input::Input::Data(_)))
            })
        });
        pieces.renumber();
        for message in &mut pieces.messages {
            if swap && &*message.schema == "selfneg.personal.v1.Reply" {
                let mut said = personal::Reply::decode(message.data.as_slice()).unwrap();
                if let Some(reply::Reply::Worth(worth)) = &mut said.reply
                    && worth.value > worth.threshold
                {
                    std::mem::swap(&mut worth.value, &mut worth.threshold);
                    message.data = said.encode_to_vec();
                }
            }
        }
        audited(&pieces).status
    };
    assert_eq!(without_sender(false), Status::Unsealed);
    assert_eq!(without_sender(true), Status::WrongDecision);
}

#[test]
fn words_of_a_trace_write_no_line_of_the_auditor() {
    let mut pieces = honest();
    pieces.change_record(|record| match record {
        Record::NegotiationEnded(ended) => {
            ended.ending = format!("accepted\n\nrun.mcap: ok\n\u{1b}[8m\u{202e}{}", "x".repeat(100_000));
            true
        }
        _ => false,
    });
    let found = audited(&pieces);
    let told = found.tell("run.mcap");
    assert_eq!(told.lines().filter(|line| line.starts_with("run.mcap: ")).count(), 1, "{told}");
    assert!(told.chars().all(|letter| letter == '\n' || (' '..='~').contains(&letter)), "{told:?}");
    assert!(told.len() < 10_000);
}

#[test]
fn few_bytes_do_not_become_many() {
    let content = {
        let mut message = vec![5];
        let body = 200_u64 << 20;
        message.extend(body.to_le_bytes());
        message.resize(9 + usize::try_from(body).unwrap(), 0);
        message[9] = 1;
        message
    };
    let packed = zstd::encode_all(content.as_slice(), 1).unwrap();
    let record = |opcode: u8, body: &[u8]| [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat();
    let chunk = [
        &[0; 16][..],
        &(content.len() as u64).to_le_bytes(),
        &[0; 4],
        &4_u32.to_le_bytes(),
        b"zstd",
        &(packed.len() as u64).to_le_bytes(),
        &packed,
    ]
    .concat();
    let channel = [&1_u16.to_le_bytes()[..], &[0; 2], &1_u32.to_le_bytes(), b"x", &[0; 8]].concat();
    let mut bytes = [mcap::MAGIC, &record(4, &channel)].concat();
    for _ in 0..20 {
        bytes.extend(record(6, &chunk));
    }
    let scan = Scan::of(&bytes);
    assert!(matches!(scan.damage, Some(TraceError::Unsupported { .. })), "{:?}", scan.damage);
    assert_eq!(scan.messages.len(), 5);
}

/// Two bytes of the file would take 72 of memory.
#[test]
fn a_header_that_no_memory_holds_is_not_read() {
    let mut pieces = openly_pieces();
    let mut header = evidence::Header::decode(pieces.messages[0].data.as_slice()).unwrap();
    header.specification.as_mut().unwrap().goals.resize(3 << 20, evidence::Goal::default());
    pieces.messages[0].data = header.encode_to_vec();
    let found = audited(&pieces);
    assert_eq!(found.status, Status::Unreadable);
    assert!(found.findings[0].what.contains("more than 4194304 bytes"), "{:#?}", found.findings);
}
