//! What is personal, kept for each subject until it is written as a segment.

use std::collections::BTreeMap;
use std::io;
use std::time::Duration;

use prost::Message as _;
use zeroize::{Zeroize as _, Zeroizing};

use super::schema::evidence::Sealed;
use super::schema::personal::{Inner, Segment};
use super::stamp::nanos;
use super::topic::{Topic, Whose};
use crate::seal::chain::ciphertext_digest;
use crate::seal::{AuditorPublicKey, TraceId, envelope};

/// So much of one subject is kept at most before it is written, about, in bytes.
const FULL: usize = 256 << 10;

/// `Segment.messages`, as the wire format begins it: field 4, length-delimited.
const MESSAGES_TAG: u8 = 4 << 3 | 2;

/// Keeps personal messages in memory, wiped when they are sealed.
#[derive(Debug)]
pub(super) struct Segments {
    trace: TraceId,
    recipients: Vec<AuditorPublicKey>,
    kept: BTreeMap<Whose, Kept>,
    order: u64,
}

#[derive(Debug, Default)]
struct Kept {
    segment: u64,
    /// The messages as the wire format has them.
    encoded: Zeroizing<Vec<u8>>,
}

impl Segments {
    pub(super) const fn new(trace: TraceId, recipients: Vec<AuditorPublicKey>) -> Self {
        Self { trace, recipients, kept: BTreeMap::new(), order: 0 }
    }

    /// Keeps a message, written after the one in the open with the number `after`.
    pub(super) fn keep(&mut self, whose: Whose, topic: &Topic, at: Duration, after: u32, data: Vec<u8>) {
        let mut inner = Inner {
            topic: topic.name.clone().into_owned(),
            schema: topic.schema.name().to_owned(),
            after,
            order: self.order,
            log_time: nanos(at),
            publish_time: nanos(at),
            data,
        };
        self.order = self.order.saturating_add(1);
        let mut encoded = Zeroizing::new(inner.encode_length_delimited_to_vec());
        inner.data.zeroize();
        let kept = self.kept.entry(whose).or_default();
        append(&mut kept.encoded, MESSAGES_TAG, &mut encoded);
    }

    /// Whether somebody's messages are many enough to be written now.
    pub(super) fn is_full(&self) -> bool {
        self.kept.values().any(|kept| kept.encoded.len() > FULL)
    }

    /// Seals all that is kept.
    pub(super) fn seal(&mut self) -> io::Result<Vec<(Whose, Sealed)>> {
        let mut sealed = Vec::new();
        for (whose, kept) in self.kept.iter_mut().filter(|(_, kept)| !kept.encoded.is_empty()) {
            let head = Segment {
                trace_id: self.trace.0.to_vec(),
                subject: whose.to_string(),
                segment: kept.segment,
                messages: Vec::new(),
            };
            let mut content = Zeroizing::new(Vec::with_capacity(kept.encoded.len().saturating_add(128)));
            content.extend(head.encode_to_vec());
            content.extend_from_slice(&kept.encoded);
            kept.encoded = Zeroizing::default();
            let ciphertext = envelope::seal(&content, &self.recipients)?;
            let segment = Sealed {
                segment: kept.segment,
                subject: whose.to_string(),
                digest: ciphertext_digest(&ciphertext).to_vec(),
                ciphertext: Some(ciphertext),
                last: false,
            };
            sealed.push((*whose, segment));
            kept.segment = kept.segment.saturating_add(1);
        }
        if let Some((_, segment)) = sealed.last_mut() {
            segment.last = true;
        }
        Ok(sealed)
    }
}

/// Appends without leaving a copy behind in memory that was outgrown.
fn append(to: &mut Zeroizing<Vec<u8>>, tag: u8, more: &mut Vec<u8>) {
    let needed = to.len().saturating_add(more.len()).saturating_add(1);
    if needed > to.capacity() {
        let mut larger = Zeroizing::new(Vec::with_capacity(needed.saturating_mul(2)));
        larger.extend_from_slice(to);
        *to = larger;
    }
    to.push(tag);
    to.append(more);
}
