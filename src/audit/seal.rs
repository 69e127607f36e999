//! What the seal, the recipients and the commitments say.

use serde::Serialize;

use super::Keys;
use super::finding::{Log, Place};
use super::property::Property;
use super::status::Status;
use crate::seal::chain::rules_digest;
use crate::seal::{SealPlace, SealReport, SealState};
use crate::trace::{Commitment, Opened, PersonalPart, Recording, Whose};
use prost::Message as _;

/// What an audit says of a seal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SealAudit {
    /// The key that the trace names, as hexadecimal digits.
    pub key: String,
    /// Whether it is one of the robot keys given.
    pub trusted: bool,
    /// How many checkpoints this key has signed.
    pub checkpoints: u64,
    /// The first so many messages are as signed.
    pub covered_messages: u64,
    /// How many decisions are among them.
    pub covered_decisions: u64,
    /// Whether the signed end is there.
    pub complete: bool,
    /// Whom the personal data are sealed to.
    pub recipients: Vec<String>,
}

/// Checks the seal, and where the personal part is.
pub(super) fn check(opened: &Opened, keys: &Keys, log: &mut Log) -> Option<SealAudit> {
    let audit = match &opened.seal {
        SealState::Unsigned => {
            log.find(Status::Unsealed, Place::WHOLE, "nobody signed it: it may have been changed at will");
            None
        }
        SealState::Broken(fault) => {
            log.find(Status::Tampered, place(fault.at), format!("the seal is broken: {fault}"));
            None
        }
        SealState::Signed(report) => Some(signed(report, opened, keys, log)),
    };
    for unopened in &opened.unopened {
        let at = Place::message(u64::from(unopened.sequence));
        let what = format!("segment {} of {}: {}", unopened.segment, unopened.subject, unopened.what);
        log.find(Status::Tampered, at, what);
    }
    match opened.privacy {
        PersonalPart::Plain => {
            let what = "its personal data are in the open, for everybody who has the file";
            log.find(Status::Unsealed, Place::WHOLE, what);
        }
        PersonalPart::LeftOut => {
            log.find(Status::Incomplete, Place::WHOLE, "its personal data were left out");
        }
        PersonalPart::Locked if opened.segments == 0 => {
            // Where all of them are erased, that is said below.
            if opened.erased.is_empty() {
                let what = "its personal data are said to be sealed, and none are in it";
                log.find(Status::Incomplete, Place::WHOLE, what);
            }
        }
        PersonalPart::Locked if !keys.identities.is_empty() => {
            log.find(
                Status::Incomplete,
                Place::WHOLE,
                "its personal data are sealed to other keys than those given",
            );
        }
        PersonalPart::Locked | PersonalPart::Open => {}
    }
    for subject in &opened.erased {
        let what = match *subject == Whose::Several.to_string() {
            true => "the personal data that show several people at once are erased".to_owned(),
            false => format!("the personal data of {subject} are erased"),
        };
        log.find(Status::Incomplete, Place::WHOLE, what);
    }
    audit
}

fn signed(report: &SealReport, opened: &Opened, keys: &Keys, log: &mut Log) -> SealAudit {
    for fault in &report.faults {
        log.find(Status::Tampered, place(fault.at), format!("the seal does not fit: {fault}"));
    }
    let trusted = keys.robots.contains(&report.key);
    if keys.robots.is_empty() {
        let what = format!("signed by {}, and no robot key was given to trust", report.key);
        log.find(Status::Untrusted, Place::WHOLE, what);
    } else if !trusted {
        log.find(
            Status::Untrusted,
            Place::WHOLE,
            format!("signed by {}, which is none of the keys given", report.key),
        );
    }
    if opened.recording.is_complete() && !report.complete {
        let at = Place::message(report.covered_messages);
        log.find(Status::Tampered, at, "the end is there, and not the signed checkpoint of the end");
    }
    SealAudit {
        key: report.key.to_string(),
        trusted,
        checkpoints: report.checkpoints,
        covered_messages: report.covered_messages,
        covered_decisions: report.covered_decisions,
        complete: report.complete,
        recipients: report.recipients.iter().map(ToString::to_string).collect(),
    }
}

fn place(at: SealPlace) -> Place {
    match at {
        SealPlace::Seal | SealPlace::Checkpoint(_) => Place::WHOLE,
        SealPlace::Messages { first, .. } => Place::message(first),
        SealPlace::Byte(byte) => Place::byte(byte),
    }
}

/// Checks that rules and commitments are those that were fixed at the time.
pub(super) fn check_commitments(recording: &Recording, sealed: bool, log: &mut Log) {
    if let (Some(rules), Some(options)) = (&recording.rules, &recording.header.options)
        && !recording.header.rules_digest.is_empty()
    {
        let digest = rules_digest(options, &recording.header.policy, &rules.encode_to_vec());
        if digest == *recording.header.rules_digest {
            log.held(Property::Commitments);
        } else {
            let what = "the rules are not those that the header has a digest of";
            log.broken(Property::Commitments, Place::WHOLE, what);
        }
    }
    let digest_alone = recording.rules.is_none() && !recording.header.rules_digest.is_empty();
    let is_closed = |(.., commitment): &(u64, u32, _, Commitment)| matches!(commitment, Commitment::Closed);
    if digest_alone || recording.commitments().iter().any(is_closed) {
        log.not_checked(Property::Commitments);
    }
    if !sealed {
        return;
    }
    for (index, user, _, commitment) in recording.commitments() {
        let entry = usize::try_from(index).ok().and_then(|index| recording.entries.get(index));
        let at =
            entry.map_or(Place { entry: Some(index), ..Place::WHOLE }, |entry| Place::entry(index, entry.at));
        match commitment {
            Commitment::Holds => log.held(Property::Commitments),
            Commitment::Closed => {}
            Commitment::Fails => {
                let what = format!("what is recorded of user {user} is not what was committed to");
                log.broken(Property::Commitments, at, what);
            }
            Commitment::Missing => {
                let what = format!("nothing commits to what is recorded of user {user}");
                log.broken(Property::Commitments, at, what);
            }
        }
    }
}
