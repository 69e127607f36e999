//! Opens a trace: reads it, checks its seal, decrypts what the keys can, and puts it all
//! together again.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use prost::Message as _;
use prost::encoding::{DecodeContext, decode_key, skip_field};

use super::error::TraceError;
use super::reader::{Channel, Message};
use super::recording::Recording;
use super::scan::Scan;
use super::schema::Schema;
use super::schema::evidence::{Privacy, Sealed};
use super::schema::personal::{Inner, Segment};
use super::topic::PERSONAL;
use crate::seal::chain::ciphertext_digest;
use crate::seal::envelope::{self, EnvelopeError};
use crate::seal::verification::{SealState, head, verify};
use crate::seal::{AuditorKey, TraceId};

/// Most bytes of all segments opened, and beside them so many for each byte of the file.
const MAX_BYTES: usize = 1 << 30;
const MAX_RATIO: usize = 64;

/// No message in a segment is shorter: it names its topic and type.
const LEAST_INNER: usize = 32;

/// A trace, with what its seal proves and what of its personal part is there.
#[derive(Clone, Debug)]
pub struct Opened {
    /// What was recorded, with its personal part as far as it could be read.
    pub recording: Recording,
    /// What the seal proves.
    pub seal: SealState,
    /// Where the personal part is.
    pub privacy: PersonalPart,
    /// How many segments of a sealed trace hold something personal, opened or not. Those of a
    /// flush that was cut do not count.
    pub segments: usize,
    /// The subjects some of whose data were erased.
    pub erased: Vec<String>,
    /// Segments that should open and do not.
    pub unopened: Vec<Unopened>,
}

/// Where the personal part of a trace is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PersonalPart {
    /// In the open.
    Plain,
    /// Not in the trace.
    LeftOut,
    /// Sealed, and no key fits.
    Locked,
    /// Sealed, and opened.
    Open,
}

/// A segment that is not as the robot wrote it, or that the keys should open and do not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unopened {
    /// The message that holds it.
    pub sequence: u32,
    /// Whose it is said to be.
    pub subject: String,
    /// Its number within the subject, as said.
    pub segment: u64,
    /// What is wrong.
    pub what: String,
}

/// Opens a whole file in memory with the keys given. Of a damaged one everything before the
/// damage is read.
///
/// # Errors
/// [`TraceError`] if not even the header can be read, or the format is a newer one.
pub fn open(bytes: &[u8], identities: &[AuditorKey]) -> Result<Opened, TraceError> {
    let scan = Scan::of(bytes);
    let decrypted = decrypt(&scan, identities)?;
    let merged = merge(&scan, &decrypted.messages);
    let recording = Recording::of(&scan, merged.into_iter())?;
    let Decrypted { privacy, segments, erased, unopened, .. } = decrypted;
    Ok(Opened { recording, seal: verify(&scan), privacy, segments, erased, unopened })
}

/// All messages of a whole file in memory, those for viewers included, with what the keys open in
/// the place where it was written. Of a damaged file those before the damage.
///
/// # Errors
/// As for [`open`].
pub fn messages(bytes: &[u8], identities: &[AuditorKey]) -> Result<Vec<Message>, TraceError> {
    let scan = Scan::of(bytes);
    let decrypted = decrypt(&scan, identities)?;
    Ok(merge(&scan, &decrypted.messages).into_iter().cloned().collect())
}

/// What is in the segments of a trace.
#[derive(Debug)]
pub(super) struct Decrypted {
    /// In the order in which they were written.
    pub(super) messages: Vec<Message>,
    pub(super) privacy: PersonalPart,
    /// How many segments hold a ciphertext.
    pub(super) segments: usize,
    pub(super) erased: Vec<String>,
    pub(super) unopened: Vec<Unopened>,
}

/// A segment as it stands in the file.
struct Found {
    sequence: u32,
    sealed: Sealed,
}

pub(super) fn decrypt(scan: &Scan, identities: &[AuditorKey]) -> Result<Decrypted, TraceError> {
    let privacy = match scan.header()?.privacy() {
        Privacy::Unspecified | Privacy::Plain => PersonalPart::Plain,
        Privacy::LeftOut => PersonalPart::LeftOut,
        Privacy::Sealed => PersonalPart::Locked,
    };
    let mut decrypted =
        Decrypted { messages: Vec::new(), privacy, segments: 0, erased: Vec::new(), unopened: Vec::new() };
    if privacy != PersonalPart::Locked {
        return Ok(decrypted);
    }
    let found = find(scan, &mut decrypted);
    let trace = head(scan).map(|head| head.trace);
    let mut locked = Vec::new();
    let mut inner = Vec::new();
    let length = usize::try_from(scan.length).unwrap_or(usize::MAX);
    let mut room = MAX_BYTES.saturating_add(length.saturating_mul(MAX_RATIO));
    for Found { sequence, sealed } in found {
        let Some(ciphertext) = sealed.ciphertext.as_deref() else { continue };
        decrypted.segments = decrypted.segments.saturating_add(1);
        let what = match opened(&sealed, ciphertext, trace, identities, &mut room) {
            Ok(messages) => {
                decrypted.privacy = PersonalPart::Open;
                inner.extend(messages.into_iter().map(|message| (sequence, message)));
                continue;
            }
            Err(Failed::NoKeyFits) => {
                locked.push(Unopened::new(sequence, &sealed, "it is not for the keys that fit the others"));
                continue;
            }
            Err(Failed::Otherwise(what)) => what,
        };
        decrypted.unopened.push(Unopened::new(sequence, &sealed, &what));
    }
    if decrypted.privacy == PersonalPart::Open {
        decrypted.unopened.append(&mut locked);
    }
    inner.sort_by_key(|(_, message)| message.order);
    let mut channels = BTreeMap::new();
    for (sequence, message) in inner {
        // Written before the segment, and on a personal topic.
        if message.after < sequence && message.topic.starts_with(PERSONAL) {
            decrypted.messages.push(placed(message, sequence, &mut channels));
        } else {
            let unopened = Unopened {
                sequence,
                subject: message.topic,
                segment: message.order,
                what: "a message in it does not belong there".to_owned(),
            };
            decrypted.unopened.push(unopened);
        }
    }
    decrypted.unopened.sort_by_key(|unopened| unopened.sequence);
    Ok(decrypted)
}

impl Unopened {
    fn new(sequence: u32, sealed: &Sealed, what: &str) -> Self {
        Self { sequence, subject: sealed.subject.clone(), segment: sealed.segment, what: what.to_owned() }
    }
}

/// The segments of complete flushes, and what is wrong with their numbers or digests.
fn find(scan: &Scan, decrypted: &mut Decrypted) -> Vec<Found> {
    let mut found = Vec::new();
    let mut complete = 0;
    let mut next: BTreeMap<String, u64> = BTreeMap::new();
    let mut erased = BTreeSet::new();
    for message in scan.messages.iter().filter(|message| *message.schema == *Schema::Sealed.name()) {
        let Ok(sealed) = Sealed::decode(message.data.as_slice()) else { continue };
        let expected = next.entry(sealed.subject.clone()).or_default();
        if sealed.segment != *expected {
            let what = format!("segment {expected} of this subject should come here");
            decrypted.unopened.push(Unopened::new(message.sequence, &sealed, &what));
        }
        *expected = sealed.segment.saturating_add(1);
        match &sealed.ciphertext {
            None => {
                erased.insert(sealed.subject.clone());
            }
            Some(ciphertext) if ciphertext_digest(ciphertext) != *sealed.digest => {
                let what = "its ciphertext is not the one of its digest";
                decrypted.unopened.push(Unopened::new(message.sequence, &sealed, what));
                continue;
            }
            Some(_) => {}
        }
        let last = sealed.last;
        found.push(Found { sequence: message.sequence, sealed });
        if last {
            complete = found.len();
        }
    }
    // Of a flush that was cut some people's part may be there and others' not.
    found.truncate(complete);
    decrypted.erased = erased.into_iter().collect();
    found
}

enum Failed {
    NoKeyFits,
    Otherwise(String),
}

fn opened(
    sealed: &Sealed,
    ciphertext: &[u8],
    trace: Option<TraceId>,
    identities: &[AuditorKey],
    room: &mut usize,
) -> Result<Vec<Inner>, Failed> {
    let content = envelope::open(ciphertext, identities).map_err(|error| match error {
        EnvelopeError::NoKeyFits => Failed::NoKeyFits,
        error => Failed::Otherwise(error.to_string()),
    })?;
    let too_much = || Failed::Otherwise("the segments hold more than a reader takes".to_owned());
    *room = room.checked_sub(content.len()).ok_or_else(too_much)?;
    let segment = segment_in(&content).map_err(|error| Failed::Otherwise(error.to_string()))?;
    let is_here = trace.is_some_and(|trace| trace.0 == *segment.trace_id)
        && (&segment.subject, segment.segment) == (&sealed.subject, sealed.segment);
    if is_here {
        Ok(segment.messages)
    } else {
        Err(Failed::Otherwise("its content was sealed for another place or another trace".to_owned()))
    }
}

/// A segment, unless it is a list of messages with nothing in them, which takes fifty times as
/// much in memory.
fn segment_in(content: &[u8]) -> Result<Segment, prost::DecodeError> {
    let (mut rest, mut fields) = (content, 0_usize);
    while !rest.is_empty() {
        let (tag, wire_type) = decode_key(&mut rest)?;
        skip_field(wire_type, tag, &mut rest, DecodeContext::default())?;
        fields = fields.saturating_add(1);
    }
    // Beside the messages there are three fields.
    if fields.saturating_sub(3) > content.len() / LEAST_INNER {
        #[allow(deprecated, reason = "prost has no other way to say what is wrong")]
        return Err(prost::DecodeError::new("messages with nothing in them"));
    }
    Segment::decode(content)
}

fn placed(message: Inner, sequence: u32, channels: &mut BTreeMap<(String, String), Arc<Channel>>) -> Message {
    let channel = channels.entry((message.topic, message.schema)).or_insert_with_key(|(topic, schema)| {
        let descriptors = Schema::of_name(schema).map(Schema::descriptors).unwrap_or_default();
        Arc::new(Channel::protobuf(topic, schema, descriptors))
    });
    Message {
        topic: Arc::clone(&channel.topic),
        schema: Arc::clone(&channel.schema),
        sequence: message.after,
        log_time: message.log_time,
        publish_time: message.publish_time,
        data: message.data,
        at: u64::from(sequence),
        channel: Arc::clone(channel),
        is_inner: true,
    }
}

/// The messages in the open, each followed by what was written after it.
pub(super) fn merge<'m>(scan: &'m Scan, inner: &'m [Message]) -> Vec<&'m Message> {
    let mut inner = inner.iter().peekable();
    let mut merged = Vec::new();
    for message in &scan.messages {
        while let Some(before) = inner.next_if(|inner| inner.sequence < message.sequence) {
            merged.push(before);
        }
        merged.push(message);
    }
    merged.extend(inner);
    merged
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_with_nothing_in_them_are_not_made_room_for() {
        let inner = |topic: &str| Inner { topic: topic.to_owned(), ..Inner::default() };
        let of = |messages: Vec<Inner>| Segment { messages, ..Segment::default() }.encode_to_vec();
        assert!(segment_in(&of(vec![inner(""); 1_000])).is_err());
        let honest = of(vec![inner("/personal/event of selfneg.personal.v1.Input"); 1_000]);
        assert_eq!(segment_in(&honest).unwrap().messages.len(), 1_000);
        assert_eq!(segment_in(&[]).unwrap(), Segment::default());
    }
}
