//! The seal and its signed checkpoints, as MCAP metadata records.

use std::collections::BTreeMap;

use super::TraceId;
use super::chain::{Chain, Digest};
use super::keys::{AuditorPublicKey, RobotKey, RobotPublicKey, from_hex, hex};

/// The name of the metadata record that begins a seal.
pub const SEAL_RECORD: &str = "selfneg.seal";

/// The name of the metadata records that hold checkpoints.
pub const CHECKPOINT_RECORD: &str = "selfneg.checkpoint";

/// What keeps a checkpoint's signature from being one of anything else.
const CONTEXT: &[u8] = b"selfneg trace 1 checkpoint\0";

/// Who sealed a trace, for whom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SealHead {
    /// What tells the trace from all others.
    pub trace: TraceId,
    /// Whose signature the checkpoints have; `None` of a trace that is sealed but not signed.
    pub robot: Option<RobotPublicKey>,
    /// Who can read what is personal.
    pub recipients: Vec<AuditorPublicKey>,
    /// The rules in force.
    pub rules: Digest,
}

impl SealHead {
    /// As a metadata record's map.
    #[must_use]
    pub fn to_map(&self) -> BTreeMap<String, String> {
        let recipients: Vec<String> = self.recipients.iter().map(ToString::to_string).collect();
        map([
            ("trace", self.trace.to_string()),
            ("robot", self.robot.map_or_else(String::new, |key| key.to_string())),
            ("recipients", recipients.join(" ")),
            ("rules", hex(&self.rules)),
        ])
    }

    /// Of a metadata record's map; `None` if it is not exactly as written.
    #[must_use]
    pub fn from_map(map: &BTreeMap<String, String>) -> Option<Self> {
        let robot = match map.get("robot")?.as_str() {
            "" => None,
            key => Some(RobotPublicKey::from_hex(key)?),
        };
        let recipients = match map.get("recipients")?.as_str() {
            "" => Vec::new(),
            keys => AuditorPublicKey::parse_all(&keys.replace(' ', "\n")).ok()?,
        };
        let rules = from_hex(map.get("rules")?)?;
        let head = Self { trace: TraceId(from_hex(map.get("trace")?)?), robot, recipients, rules };
        (head.to_map() == *map).then_some(head)
    }
}

/// What the robot signs: so many messages and decisions, and the chain over them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checkpoint {
    /// From 0 without gaps.
    pub number: u64,
    /// Messages covered: the first so many of the trace.
    pub messages: u64,
    /// Decisions among them.
    pub decisions: u64,
    /// The chain after them.
    pub chain: Chain,
    /// The rules in force.
    pub rules: Digest,
    /// Whether the run has ended and nothing follows.
    pub end: bool,
}

impl Checkpoint {
    /// The bytes that are signed.
    fn signed(&self, trace: TraceId) -> Vec<u8> {
        let mut bytes = CONTEXT.to_vec();
        bytes.extend(trace.0);
        for number in [self.number, self.messages, self.decisions] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(self.chain.0);
        bytes.extend(self.rules);
        bytes.push(u8::from(self.end));
        bytes
    }

    /// Signed by the robot.
    #[must_use]
    pub fn sign(self, trace: TraceId, key: &RobotKey) -> SignedCheckpoint {
        SignedCheckpoint { checkpoint: self, signature: key.sign(&self.signed(trace)) }
    }
}

/// A checkpoint with a signature, right or wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignedCheckpoint {
    /// What is signed.
    pub checkpoint: Checkpoint,
    /// The signature.
    pub signature: [u8; 64],
}

impl SignedCheckpoint {
    /// Whether the robot signed it for this trace.
    #[must_use]
    pub fn is_signed_by(&self, robot: &RobotPublicKey, trace: TraceId) -> bool {
        robot.has_signed(&self.checkpoint.signed(trace), &self.signature)
    }

    /// As a metadata record's map.
    #[must_use]
    pub fn to_map(&self) -> BTreeMap<String, String> {
        let checkpoint = &self.checkpoint;
        map([
            ("number", checkpoint.number.to_string()),
            ("messages", checkpoint.messages.to_string()),
            ("decisions", checkpoint.decisions.to_string()),
            ("chain", hex(&checkpoint.chain.0)),
            ("rules", hex(&checkpoint.rules)),
            ("end", checkpoint.end.to_string()),
            ("signature", hex(&self.signature)),
        ])
    }

    /// Of a metadata record's map; `None` if it is not exactly as written.
    #[must_use]
    pub fn from_map(map: &BTreeMap<String, String>) -> Option<Self> {
        let number = |key| map.get(key)?.parse().ok();
        let checkpoint = Checkpoint {
            number: number("number")?,
            messages: number("messages")?,
            decisions: number("decisions")?,
            chain: Chain(from_hex(map.get("chain")?)?),
            rules: from_hex(map.get("rules")?)?,
            end: map.get("end")?.parse().ok()?,
        };
        let signed = Self { checkpoint, signature: from_hex(map.get("signature")?)? };
        (signed.to_map() == *map).then_some(signed)
    }
}

fn map<const N: usize>(entries: [(&str, String); N]) -> BTreeMap<String, String> {
    entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}
