//! What the seal of a read trace proves.

use std::fmt;

use prost::Message as _;

use super::TraceId;
use super::chain::{Chain, ciphertext_digest, leaf};
use super::checkpoint::{CHECKPOINT_RECORD, Checkpoint, SEAL_RECORD, SealHead, SignedCheckpoint};
use super::keys::{AuditorPublicKey, RobotPublicKey};
use crate::trace::schema::Schema;
use crate::trace::schema::evidence::{Header, Record, Sealed};
use crate::trace::{FORMAT_RECORD, Message, Note, Scan, is_decision};

/// Whether a trace is signed, and how well.
#[derive(Clone, Debug, PartialEq, Eq)]
#[expect(clippy::large_enum_variant, reason = "there is one a trace")]
pub enum SealState {
    /// It does not claim to be.
    Unsigned,
    /// It claims to be, and does not say by whom: what should say it was changed.
    Broken(SealFault),
    /// It is signed by some key. Whether that key is to be trusted is not known here.
    Signed(SealReport),
}

/// What a seal proves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SealReport {
    /// The key that the trace names, and that all checkpoints were checked with.
    pub key: RobotPublicKey,
    /// Whom the trace says that it is sealed to.
    pub recipients: Vec<AuditorPublicKey>,
    /// What tells the trace from all others.
    pub trace_id: TraceId,
    /// How many checkpoints have the key's signature.
    pub checkpoints: u64,
    /// The first so many messages of the file are as signed.
    pub covered_messages: u64,
    /// How many decisions are among them.
    pub covered_decisions: u64,
    /// Whether the checkpoint of the run's end is there, and nothing behind it.
    pub complete: bool,
    /// The chain's value after the covered messages, as hexadecimal digits.
    pub chain: String,
    /// What is not as signed; empty if all is, as far as it is covered.
    pub faults: Vec<SealFault>,
}

/// Something that is not as it was signed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SealFault {
    /// Where.
    pub at: SealPlace,
    /// What.
    pub what: String,
}

impl fmt::Display for SealFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.at, self.what)
    }
}

/// A place in a sealed trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SealPlace {
    /// The record that begins the seal.
    Seal,
    /// A checkpoint, by its place among those in the file, from 0.
    Checkpoint(u64),
    /// Between two checkpoints: these messages, by their place in the file from 0, the last
    /// one included.
    Messages {
        /// The first.
        first: u64,
        /// The last.
        last: u64,
    },
    /// An offset in the file.
    Byte(u64),
}

impl fmt::Display for SealPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Seal => f.write_str("seal"),
            Self::Checkpoint(number) => write!(f, "checkpoint {number}"),
            Self::Messages { first, last } if first == last => write!(f, "message {first}"),
            Self::Messages { first, last } => write!(f, "messages {first} to {last}"),
            Self::Byte(at) => write!(f, "byte {at}"),
        }
    }
}

/// Who sealed a trace, for whom, if it says so as a writer does.
pub(crate) fn head(scan: &Scan) -> Option<SealHead> {
    notes(scan, SEAL_RECORD).next().and_then(|note| SealHead::from_map(&note.entries))
}

fn notes<'s>(scan: &'s Scan, name: &'s str) -> impl Iterator<Item = &'s Note> {
    scan.notes.iter().filter(move |note| note.name == name)
}

/// What the seal of a file proves.
#[must_use]
pub fn verify(scan: &Scan) -> SealState {
    let broken = |what: &str| SealState::Broken(SealFault { at: SealPlace::Seal, what: what.to_owned() });
    let is_marked = notes(scan, CHECKPOINT_RECORD).next().is_some();
    if notes(scan, SEAL_RECORD).next().is_none() {
        return if is_marked { broken("it is missing") } else { SealState::Unsigned };
    }
    let Some(head) = head(scan) else { return broken("it is not as a writer writes it") };
    match head.robot {
        Some(key) => SealState::Signed(Verification::new(scan, head, key).report()),
        None if is_marked => broken("it names no key, but there are checkpoints"),
        None => SealState::Unsigned,
    }
}

struct Verification<'s> {
    scan: &'s Scan,
    head: SealHead,
    report: SealReport,
    /// Over the messages before `done`, or as last signed.
    chain: Chain,
    done: usize,
    decisions: u64,
    /// Whether everything before `done` is as signed.
    intact: bool,
}

impl<'s> Verification<'s> {
    fn new(scan: &'s Scan, head: SealHead, key: RobotPublicKey) -> Self {
        let format = scan.format.as_deref().unwrap_or_default();
        let chain = Chain::begin(head.trace, format, &key, &head.recipients, &head.rules);
        let report = SealReport {
            key,
            recipients: head.recipients.clone(),
            trace_id: head.trace,
            checkpoints: 0,
            covered_messages: 0,
            covered_decisions: 0,
            complete: false,
            chain: String::new(),
            faults: Vec::new(),
        };
        Self { scan, head, report, chain, done: 0, decisions: 0, intact: true }
    }

    fn fault(&mut self, at: SealPlace, what: impl Into<String>) {
        self.report.faults.push(SealFault { at, what: what.into() });
    }

    fn report(mut self) -> SealReport {
        self.additions();
        let mut ended = false;
        for (number, note) in (0..).zip(notes(self.scan, CHECKPOINT_RECORD)) {
            let at = SealPlace::Checkpoint(number);
            let signed = SignedCheckpoint::from_map(&note.entries);
            let Some(signed) = signed.filter(|signed| signed.is_signed_by(&self.report.key, self.head.trace))
            else {
                self.fault(at, "it is not signed by the key that the seal names");
                continue;
            };
            self.report.checkpoints = self.report.checkpoints.saturating_add(1);
            let checkpoint = signed.checkpoint;
            if checkpoint.number != number {
                self.fault(at, format!("it is number {}", checkpoint.number));
            }
            if ended {
                self.fault(at, "it follows the end");
            }
            ended |= checkpoint.end;
            self.check(at, &checkpoint);
        }
        let total = wide(self.scan.messages.len());
        if ended && self.report.covered_messages < total && self.intact {
            let first = self.report.covered_messages;
            self.fault(SealPlace::Messages { first, last: total.saturating_sub(1) }, "added after the end");
        }
        self.report.complete = ended && self.scan.damage.is_none();
        self.ciphertexts();
        self.report
    }

    /// What no writer of ours puts into a trace, where it would be taken for a part of it.
    fn additions(&mut self) {
        let scan = self.scan;
        for added in &scan.added {
            self.fault(SealPlace::Byte(added.at), format!("{} was added", added.what));
        }
        let (mut formats, mut seals) = (0_u32, 0_u32);
        for note in &scan.notes {
            let is_known = match note.name.as_str() {
                FORMAT_RECORD => {
                    formats = formats.saturating_add(1);
                    formats == 1 && note.entries.len() == 1
                }
                SEAL_RECORD => {
                    seals = seals.saturating_add(1);
                    seals == 1
                }
                CHECKPOINT_RECORD => true,
                _ => false,
            };
            if !is_known {
                let what = format!("a metadata record {:?} was added", note.name);
                self.fault(SealPlace::Byte(note.at), what);
            }
        }
        let header = scan.messages.first().and_then(|first| Header::decode(first.data.as_slice()).ok());
        if header.is_some_and(|header| header.rules_digest != self.head.rules) {
            self.fault(SealPlace::Seal, "its rules are not those of the header");
        }
    }

    fn check(&mut self, at: SealPlace, checkpoint: &Checkpoint) {
        let scan = self.scan;
        let upto = usize::try_from(checkpoint.messages).unwrap_or(usize::MAX);
        let Some(messages) = scan.messages.get(self.done..upto) else {
            if upto < self.done {
                self.fault(at, "it covers less than the one before");
            } else if scan.damage.is_none() {
                let found = scan.messages.len();
                self.fault(at, format!("it covers {upto} messages, the file has {found}"));
            }
            self.intact = false;
            return;
        };
        for message in messages {
            self.chain.extend(&leaf_of(message));
            self.decisions = self.decisions.saturating_add(u64::from(decides(message)));
        }
        let mut good = true;
        if self.chain != checkpoint.chain {
            let (first, last) = (wide(self.done), checkpoint.messages.saturating_sub(1));
            self.fault(SealPlace::Messages { first, last }, "not what was signed");
            // What follows is judged by what was signed, not by what was changed before it.
            self.chain = checkpoint.chain;
            good = false;
        }
        if self.decisions != checkpoint.decisions {
            let what = format!("it counts {} decisions, there are {}", checkpoint.decisions, self.decisions);
            self.fault(at, what);
            self.decisions = checkpoint.decisions;
            good = false;
        }
        if self.head.rules != checkpoint.rules {
            self.fault(at, "its rules are not those of the seal");
            good = false;
        }
        self.done = upto;
        self.intact &= good;
        if self.intact {
            self.report.covered_messages = checkpoint.messages;
            self.report.covered_decisions = checkpoint.decisions;
            self.report.chain = super::hex(&checkpoint.chain.0);
        }
    }

    fn ciphertexts(&mut self) {
        let scan = self.scan;
        for (place, message) in (0..).zip(&scan.messages) {
            if *message.schema != *Schema::Sealed.name() {
                continue;
            }
            let at = SealPlace::Messages { first: place, last: place };
            match Sealed::decode(message.data.as_slice()) {
                Ok(Sealed { ciphertext: Some(ciphertext), digest, .. })
                    if ciphertext_digest(&ciphertext) != *digest =>
                {
                    self.fault(at, "the ciphertext is not the one of its digest");
                }
                Ok(_) => {}
                Err(_) => self.fault(at, "it is no segment"),
            }
        }
    }
}

fn leaf_of(message: &Message) -> super::chain::Digest {
    let Message { sequence, log_time, publish_time, .. } = *message;
    leaf(&message.channel.digest, &message.schema, sequence, log_time, publish_time, &message.data)
}

fn decides(message: &Message) -> bool {
    *message.schema == *Schema::Record.name()
        && Record::decode(message.data.as_slice()).is_ok_and(|record| is_decision(&record))
}

fn wide(number: usize) -> u64 {
    u64::try_from(number).unwrap_or(u64::MAX)
}
