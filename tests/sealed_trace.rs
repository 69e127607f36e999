//! What a sealed trace shows to whom, and what its seal proves.

#![expect(clippy::unwrap_used, clippy::indexing_slicing, reason = "it is a test")]

#[path = "../examples/scripted_trace/run.rs"]
#[allow(unreachable_pub, dead_code, reason = "shared with the example")]
mod run;

use std::sync::OnceLock;

use selfneg::seal::{AuditorKey, Privacy, RobotKey, Seal, SealReport, SealState};
use selfneg::trace::{Commitment, PersonalPart, Reader, Recording, TraceWriter, open};

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
