//! The chain over a trace's messages, and the digests that go into it.
//!
//! A message's leaf is a digest of what it says: its channel, its number, its times and its
//! bytes. Chunks, compression, identifiers and indices of the file are not in it, so that a
//! file that is written anew by other programs keeps its chain. Every digest is BLAKE3 in its
//! key derivation mode, with a context of its own: no digest can stand for one of another kind.

use std::collections::BTreeMap;

use blake3::Hasher;
use prost::Message as _;

use super::TraceId;
use super::keys::{AuditorPublicKey, RobotPublicKey};
use crate::trace::schema::Schema;
use crate::trace::schema::evidence::{Options, Sealed};

/// A BLAKE3 digest.
pub type Digest = [u8; 32];

const CHANNEL: &str = "selfneg trace 1 channel";
const LEAF: &str = "selfneg trace 1 message";
const BEGIN: &str = "selfneg trace 1 chain begin";
const LINK: &str = "selfneg trace 1 chain link";
const RULES: &str = "selfneg trace 1 rules";

/// Collects what a digest is over; every part after its length.
pub(super) struct Parts(Hasher);

impl Parts {
    pub(super) fn of(context: &str) -> Self {
        Self(Hasher::new_derive_key(context))
    }

    pub(super) fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        self.number(wide(bytes.len()));
        self.0.update(bytes);
        self
    }

    pub(super) fn number(&mut self, number: u64) -> &mut Self {
        self.0.update(&number.to_le_bytes());
        self
    }

    pub(super) fn digest(&self) -> Digest {
        *self.0.finalize().as_bytes()
    }
}

/// What a channel is, whatever its number in the file.
#[must_use]
pub fn channel_digest(
    topic: &str,
    encoding: &str,
    metadata: &BTreeMap<String, String>,
    schema: (&str, &str, &[u8]),
) -> Digest {
    let mut parts = Parts::of(CHANNEL);
    parts.bytes(topic.as_bytes()).bytes(encoding.as_bytes()).number(wide(metadata.len()));
    for (key, value) in metadata {
        parts.bytes(key.as_bytes()).bytes(value.as_bytes());
    }
    let (name, encoding, data) = schema;
    parts.bytes(name.as_bytes()).bytes(encoding.as_bytes()).bytes(data);
    parts.digest()
}

/// What is signed of a message, whatever is erased of it later.
#[must_use]
pub fn leaf(
    channel: &Digest,
    schema: &str,
    sequence: u32,
    log_time: u64,
    publish_time: u64,
    data: &[u8],
) -> Digest {
    let mut parts = Parts::of(LEAF);
    parts.bytes(channel).number(u64::from(sequence)).number(log_time).number(publish_time);
    match canonical_sealed(schema, data) {
        Some(without) => parts.number(1).bytes(&without),
        None => parts.number(0).bytes(data),
    };
    parts.digest()
}

/// A segment without its ciphertext, whose digest stays. Only of bytes that are the one
/// encoding of what they say: else something could be hidden in them.
fn canonical_sealed(schema: &str, data: &[u8]) -> Option<Vec<u8>> {
    if schema != Schema::Sealed.name() {
        return None;
    }
    let sealed = Sealed::decode(data).ok()?;
    (sealed.encode_to_vec() == data).then(|| Sealed { ciphertext: None, ..sealed }.encode_to_vec())
}

/// A ciphertext's digest, as its segment names it.
#[must_use]
pub fn ciphertext_digest(ciphertext: &[u8]) -> Digest {
    *blake3::hash(ciphertext).as_bytes()
}

/// The rules in force: protocol variant, policy, and the bytes of the message
/// `selfneg.personal.v1.Rules`.
#[must_use]
pub fn rules_digest(options: &Options, policy: &str, rules: &[u8]) -> Digest {
    let mut parts = Parts::of(RULES);
    for name in [&options.quit, &options.aggregation, &options.tie, &options.fallback] {
        parts.bytes(name.as_bytes());
    }
    parts.number(u64::from(options.willingness)).bytes(policy.as_bytes()).bytes(rules);
    parts.digest()
}

/// The chain: after `n` messages its value stands for all of them, their order, and the seal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chain(pub Digest);

impl Chain {
    /// Before the first message.
    #[must_use]
    pub fn begin(
        trace: TraceId,
        format: &str,
        robot: &RobotPublicKey,
        recipients: &[AuditorPublicKey],
        rules: &Digest,
    ) -> Self {
        let mut parts = Parts::of(BEGIN);
        parts.bytes(&trace.0).bytes(format.as_bytes()).bytes(robot.as_bytes());
        parts.number(wide(recipients.len()));
        for recipient in recipients {
            parts.bytes(recipient.to_string().as_bytes());
        }
        parts.bytes(rules);
        Self(parts.digest())
    }

    /// After one more message.
    pub fn extend(&mut self, leaf: &Digest) {
        let mut parts = Parts::of(LINK);
        parts.bytes(&self.0).bytes(leaf);
        self.0 = parts.digest();
    }
}

fn wide(length: usize) -> u64 {
    u64::try_from(length).unwrap_or(u64::MAX)
}
