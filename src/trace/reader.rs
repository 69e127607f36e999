//! Yields every complete message of a trace, however the file was cut or damaged.
//!
//! It scans the records one after the other and needs neither footer nor index. A chunk's
//! messages are yielded once its CRC is checked; the CRCs of the data section and of the
//! summary are checked where they stand. It never panics, and never holds more than one
//! decompressed chunk.
//!
//! A CRC tells accidents. Against somebody who changes a file on purpose it says nothing, and
//! a clean end does not prove that nothing is missing before it.

use std::collections::{BTreeMap, VecDeque};
use std::io::Read as _;
use std::sync::Arc;

use mcap::records::{ChunkIndex, MessageHeader, MessageIndex, Record, Statistics, SummaryOffset, op};

use super::error::TraceError;
use super::format::{FORMAT_KEY, FORMAT_MAJOR, FORMAT_RECORD};
use crate::seal::chain::{Digest, channel_digest};

/// Most bytes of a decompressed chunk. Ours have about one megabyte.
const MAX_CHUNK_BYTES: u64 = 256 << 20;

/// Most bytes of all chunks decompressed, and beside them so many for each byte of the file. A
/// forged file of a few kilobytes could ask for any amount.
const MAX_BYTES: u64 = 1 << 30;
const MAX_RATIO: u64 = 64;

const OPCODE_AND_LENGTH: usize = 9;

/// Most bytes of the name of the library that wrote the file: nobody signs it, and whoever writes
/// the file anew puts another one.
const MAX_LIBRARY_BYTES: usize = 64;

/// How messages and schemas are encoded.
pub(super) const PROTOBUF: &str = "protobuf";

/// A message of a trace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Where it was written to.
    pub topic: Arc<str>,
    /// The full name of its type; empty if the file gives none.
    pub schema: Arc<str>,
    /// Its place among all messages, from 0.
    pub sequence: u32,
    /// Simulated time since the run's begin, in nanoseconds.
    pub log_time: u64,
    /// The same in our traces.
    pub publish_time: u64,
    /// The protobuf message.
    pub data: Vec<u8>,
    /// Where the record that holds it, mostly a chunk, begins in the file.
    pub at: u64,
    /// All that the file says of its topic and type.
    pub channel: Arc<Channel>,
    /// Whether it comes from within a segment; `sequence` is then that of the message in the
    /// open that it was written after.
    pub is_inner: bool,
}

/// A topic with its schema, as the file describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// The topic.
    pub topic: Arc<str>,
    /// How messages are encoded: `protobuf`.
    pub encoding: String,
    /// What else is said of it: nothing in our traces.
    pub metadata: BTreeMap<String, String>,
    /// The schema's name; empty if there is none.
    pub schema: Arc<str>,
    /// How the schema is written: `protobuf`.
    pub schema_encoding: String,
    /// The schema.
    pub schema_data: Arc<[u8]>,
    /// A digest of all this.
    pub digest: Digest,
}

impl Channel {
    /// A channel of messages and a schema in protobuf.
    pub(super) fn protobuf(topic: &str, schema: &str, schema_data: &[u8]) -> Self {
        let metadata = BTreeMap::new();
        let digest = channel_digest(topic, PROTOBUF, &metadata, (schema, PROTOBUF, schema_data));
        Self {
            topic: topic.into(),
            encoding: PROTOBUF.to_owned(),
            metadata,
            schema: schema.into(),
            schema_encoding: PROTOBUF.to_owned(),
            schema_data: schema_data.into(),
            digest,
        }
    }
}

/// A metadata record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Its name.
    pub name: String,
    /// What it says.
    pub entries: BTreeMap<String, String>,
    /// Where it begins in the file.
    pub at: u64,
    /// How many messages are before it.
    pub messages: u64,
}

/// Something in a file that is neither a message nor a metadata record nor derived from them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Added {
    /// Where it begins in the file.
    pub at: u64,
    /// What it is.
    pub what: String,
}

/// Reads a whole file in memory. After the first error it yields nothing more.
#[derive(Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    /// Where the next record begins.
    at: usize,
    section: Section,
    /// Where the zeros begin that end the file, as a loss of power may leave it.
    zeros: usize,
    schemas: BTreeMap<u16, SchemaText>,
    channels: BTreeMap<u16, Arc<Channel>>,
    ready: VecDeque<Message>,
    found: u64,
    format: Option<String>,
    notes: Vec<Note>,
    added: Vec<Added>,
    /// Channels that no message has used yet, by their digests, and where they are declared.
    unused: BTreeMap<Digest, (u64, Arc<str>)>,
    /// The chunks of the data, by where they begin.
    chunks: BTreeMap<u64, Chunk>,
    /// The messages of the last chunk, if nothing but its indices has come since.
    last_chunk: Option<(u64, Places)>,
    /// How many chunks the summary leads to.
    indexed: usize,
    /// The bytes of the chunks so far, decompressed.
    unpacked: u64,
    /// How many messages each channel has.
    counts: BTreeMap<u16, u64>,
    /// The least and the largest time of all messages.
    times: Option<(u64, u64)>,
    /// The records of the summary before its offsets.
    groups: Groups,
}

/// Where the records of each kind are in the summary: their begin and end.
#[derive(Debug, Default)]
struct Groups {
    of_kind: BTreeMap<u8, (u64, u64)>,
    last: Option<u8>,
    /// Kinds whose records are in several places.
    scattered: bool,
    /// Where the offsets begin.
    offsets: Option<u64>,
}

/// Times and offsets of a chunk's messages, by channel.
type Places = BTreeMap<u16, Vec<(u64, u64)>>;

/// What an index may say of a chunk.
#[derive(Clone, Debug)]
struct Chunk {
    length: u64,
    /// The least and the largest time of its messages; 0 without any.
    times: (u64, u64),
    /// Where its message indices begin, by channel.
    indices: BTreeMap<u16, u64>,
}

#[derive(Clone, Debug)]
struct SchemaText {
    at: u64,
    is_used: bool,
    name: Arc<str>,
    encoding: String,
    data: Arc<[u8]>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Section {
    Start,
    Data,
    /// Behind the data; with where it begins.
    Summary(usize),
    Done,
}

impl<'a> Reader<'a> {
    /// A reader of a file's bytes.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        let zeros = bytes.iter().rposition(|byte| *byte != 0).map_or(0, |last| last.saturating_add(1));
        Self {
            bytes,
            at: 0,
            section: Section::Start,
            zeros,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            ready: VecDeque::new(),
            found: 0,
            format: None,
            notes: Vec::new(),
            added: Vec::new(),
            unused: BTreeMap::new(),
            chunks: BTreeMap::new(),
            last_chunk: None,
            indexed: 0,
            unpacked: 0,
            counts: BTreeMap::new(),
            times: None,
            groups: Groups::default(),
        }
    }

    /// The metadata records read so far, in the file's order.
    #[must_use]
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// What was found so far that no trace of ours holds.
    #[must_use]
    pub fn added(&self) -> &[Added] {
        &self.added
    }

    /// The trace format's version, once the record that says it was read.
    #[must_use]
    pub fn format(&self) -> Option<&str> {
        self.format.as_deref()
    }

    /// Schemas and channels declared so far that nothing uses.
    #[must_use]
    pub fn unused(&self) -> Vec<Added> {
        let channels = self.unused.values();
        let channels = channels.map(|(at, topic)| Added { at: *at, what: format!("a channel {topic:?}") });
        self.schemas.values().filter_map(SchemaText::unused).chain(channels).collect()
    }

    /// Reads on until there is a message or the end.
    fn advance(&mut self) -> Result<(), TraceError> {
        while self.ready.is_empty() && self.section != Section::Done {
            if self.section == Section::Start {
                self.magic(TraceError::NotMcap)?;
                self.section = Section::Data;
                continue;
            }
            let at = self.at;
            if at >= self.zeros {
                return Err(self.truncated());
            }
            let (opcode, body) = self.record()?;
            let read = match self.section {
                Section::Summary(begin) => self.summary(opcode, body, begin, at),
                _ => self.data(opcode, body, at),
            };
            // A record of which the disk never got the rest.
            let is_cut = self.at > self.zeros && self.section != Section::Done;
            read.map_err(|error| if is_cut { TraceError::Truncated { at: wide(at) } } else { error })?;
        }
        Ok(())
    }

    fn magic(&mut self, or: TraceError) -> Result<(), TraceError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        if rest.starts_with(mcap::MAGIC) {
            self.at = self.at.saturating_add(mcap::MAGIC.len());
            Ok(())
        } else if !rest.is_empty() && rest.len() < mcap::MAGIC.len() && mcap::MAGIC.starts_with(rest) {
            Err(self.truncated())
        } else {
            Err(or)
        }
    }

    fn truncated(&self) -> TraceError {
        TraceError::Truncated { at: wide(self.at) }
    }

    /// The next record of the file: its opcode and body.
    fn record(&mut self) -> Result<(u8, &'a [u8]), TraceError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let (opcode, body) = split_record(rest).ok_or_else(|| self.truncated())?;
        self.at = self.at.saturating_add(OPCODE_AND_LENGTH).saturating_add(body.len());
        Ok((opcode, body))
    }

    fn data(&mut self, opcode: u8, body: &[u8], at: usize) -> Result<(), TraceError> {
        if opcode != op::MESSAGE_INDEX {
            self.last_chunk = None;
        }
        match opcode {
            op::SCHEMA | op::CHANNEL | op::MESSAGE => self.content(opcode, body, at).map(|_| ()),
            op::CHUNK => self.chunk(body, at),
            op::METADATA => self.metadata(body, at),
            op::DATA_END => {
                if let Record::DataEnd(end) = parse(opcode, body, at)? {
                    let covered = self.bytes.get(..at).unwrap_or_default();
                    check_crc("data section", 0, end.data_section_crc, covered)?;
                }
                self.section = Section::Summary(self.at);
                Ok(())
            }
            // A footer without an end of the data is no file that a writer finished.
            op::FOOTER => Err(malformed(at, "a footer before the end of the data")),
            op::HEADER if at == mcap::MAGIC.len() => self.header(body, at),
            op::MESSAGE_INDEX => self.message_index(body, at),
            // Attachments, and what is not known: nothing to yield. They are not parsed;
            // mcap's parser of attachments panics on short ones.
            _ => {
                self.add(opcode, at);
                Ok(())
            }
        }
    }

    /// Nothing but the name of a library that wrote the file.
    fn header(&mut self, body: &[u8], at: usize) -> Result<(), TraceError> {
        let Record::Header(header) = parse(op::HEADER, body, at)? else { return Ok(()) };
        let (profile, library) = (&header.profile, &header.library);
        let short = library.len() <= MAX_LIBRARY_BYTES && !library.chars().any(char::is_control);
        let exact = body.len() == profile.len().saturating_add(library.len()).saturating_add(8);
        if !profile.is_empty() || !short || !exact {
            let what = "more than a library's name in the header".to_owned();
            self.added.push(Added { at: wide(at), what });
        }
        Ok(())
    }

    fn summary(&mut self, opcode: u8, body: &[u8], begin: usize, at: usize) -> Result<(), TraceError> {
        self.groups.note(opcode, wide(at), wide(self.at));
        match opcode {
            op::FOOTER => {}
            // Viewers that seek go where it leads.
            op::CHUNK_INDEX => return self.chunk_index(body, at),
            op::METADATA_INDEX => return self.metadata_index(body, at),
            op::STATISTICS => return self.statistics(body, at),
            op::SUMMARY_OFFSET => return self.summary_offset(body, at),
            // Viewers that seek take them from here.
            op::SCHEMA | op::CHANNEL => return self.repeated(opcode, body, at),
            _ => {
                self.add(opcode, at);
                return Ok(());
            }
        }
        if let Record::Footer(footer) = parse(opcode, body, at)? {
            // The sum covers the footer too, but for itself.
            let end = at.saturating_add(OPCODE_AND_LENGTH).saturating_add(16);
            let covered = self.bytes.get(begin..end).unwrap_or_default();
            check_crc("summary", begin, footer.summary_crc, covered)?;
            // 0 is no summary at all.
            if footer.summary_start != 0 && footer.summary_start != wide(begin) {
                self.leads_elsewhere(at, "a footer that leads to another summary");
            }
            if footer.summary_offset_start != 0 && self.groups.offsets != Some(footer.summary_offset_start) {
                self.leads_elsewhere(at, "a footer that leads to other offsets of the summary");
            }
            if self.indexed != 0 && self.indexed != self.chunks.len() {
                self.leads_elsewhere(at, "a summary that leads to some chunks and not to all");
            }
        }
        let after = self.at;
        self.magic(malformed(after, "no magic bytes after the footer"))
            .map_err(|error| if after >= self.zeros { self.truncated() } else { error })?;
        if self.at < self.bytes.len() {
            return Err(malformed(self.at, "there is more after the end"));
        }
        self.section = Section::Done;
        Ok(())
    }

    fn metadata(&mut self, body: &[u8], at: usize) -> Result<(), TraceError> {
        let Record::Metadata(metadata) = parse(op::METADATA, body, at)? else { return Ok(()) };
        let string = |text: &String| text.len().saturating_add(4);
        let entries = metadata.metadata.iter().map(|(key, value)| string(key).saturating_add(string(value)));
        if body.len() != entries.sum::<usize>().saturating_add(string(&metadata.name)).saturating_add(4) {
            self.added
                .push(Added { at: wide(at), what: "more than the metadata in their record".to_owned() });
        }
        let note = Note {
            name: metadata.name.clone(),
            entries: metadata.metadata.clone(),
            at: wide(at),
            messages: self.found,
        };
        self.notes.push(note);
        if metadata.name != FORMAT_RECORD {
            return Ok(());
        }
        let found = metadata.metadata.get(FORMAT_KEY).cloned().unwrap_or_default();
        let major = found.split('.').next().and_then(|major| major.parse::<u32>().ok());
        match major {
            None => Err(malformed(at, "the format's version is not major.minor")),
            Some(major) if major > FORMAT_MAJOR => Err(TraceError::NewerMajor { found }),
            Some(_) => {
                self.format = Some(found);
                Ok(())
            }
        }
    }

    fn chunk(&mut self, body: &[u8], at: usize) -> Result<(), TraceError> {
        let body_length = body.len();
        let Record::Chunk { header, data } = parse(op::CHUNK, body, at)? else { return Ok(()) };
        let size = header.uncompressed_size;
        if size > MAX_CHUNK_BYTES {
            let what = format!("a chunk of {size} bytes; expected at most {MAX_CHUNK_BYTES}");
            return Err(TraceError::Unsupported { at: wide(at), what });
        }
        self.unpacked = self.unpacked.saturating_add(size);
        let most = MAX_BYTES.saturating_add(wide(self.bytes.len()).saturating_mul(MAX_RATIO));
        if self.unpacked > most {
            let what = format!("chunks of more than {most} bytes together");
            return Err(TraceError::Unsupported { at: wide(at), what });
        }
        let content = match header.compression.as_str() {
            "" => data.into_owned(),
            "zstd" => decompressed(&data, size).map_err(|what| malformed(at, &what))?,
            other => {
                let what = format!("the compression {other:?}; expected zstd or none");
                return Err(TraceError::Unsupported { at: wide(at), what });
            }
        };
        if wide(content.len()) != size {
            return Err(malformed(at, "the chunk has another length than it says"));
        }
        check_crc("chunk", at, header.uncompressed_crc, &content)?;
        let mut rest = content.as_slice();
        let mut messages = Places::new();
        while !rest.is_empty() {
            let (opcode, body) =
                split_record(rest).ok_or_else(|| malformed(at, "a record leaves its chunk"))?;
            match opcode {
                op::SCHEMA | op::CHANNEL | op::MESSAGE => {
                    if let Some(header) = self.content(opcode, body, at)? {
                        let offset = wide(content.len().saturating_sub(rest.len()));
                        messages.entry(header.channel_id).or_default().push((header.log_time, offset));
                    }
                }
                _ => self.add(opcode, at),
            }
            let length = OPCODE_AND_LENGTH.saturating_add(body.len());
            rest = rest.get(length..).unwrap_or_default();
        }
        messages.values_mut().for_each(|of_channel| of_channel.sort_unstable());
        let times = || messages.values().flatten().map(|(time, _)| *time);
        let times = (times().min().unwrap_or_default(), times().max().unwrap_or_default());
        if times != (header.message_start_time, header.message_end_time) {
            self.leads_elsewhere(at, "a chunk with other times than those of its messages");
        }
        let length = wide(OPCODE_AND_LENGTH.saturating_add(body_length));
        self.chunks.insert(wide(at), Chunk { length, times, indices: BTreeMap::new() });
        self.last_chunk = Some((wide(at), messages));
        Ok(())
    }

    /// It leads to the messages of the chunk before it, and to all of its channel.
    fn message_index(&mut self, body: &[u8], at: usize) -> Result<(), TraceError> {
        let Record::MessageIndex(index) = parse(op::MESSAGE_INDEX, body, at)? else { return Ok(()) };
        let MessageIndex { channel_id, records } = index;
        let mut entries: Vec<(u64, u64)> =
            records.iter().map(|entry| (entry.log_time, entry.offset)).collect();
        entries.sort_unstable();
        let exact = body.len() == records.len().saturating_mul(16).saturating_add(6);
        let Some((chunk, messages)) = &self.last_chunk else {
            self.leads_elsewhere(at, "a message index without its chunk");
            return Ok(());
        };
        if !exact || messages.get(&channel_id).map_or(&[][..], Vec::as_slice) != entries {
            self.leads_elsewhere(at, "a message index that is not of the messages of its chunk");
            return Ok(());
        }
        if let Some(chunk) = self.chunks.get_mut(chunk) {
            chunk.indices.insert(channel_id, wide(at));
        }
        Ok(())
    }

    /// It leads to a chunk of the data, and says of it what is so.
    fn chunk_index(&mut self, body: &[u8], at: usize) -> Result<(), TraceError> {
        let Record::ChunkIndex(index) = parse(op::CHUNK_INDEX, body, at)? else { return Ok(()) };
        let ChunkIndex { message_start_time, message_end_time, message_index_offsets, .. } = &index;
        let same = self.chunks.get(&index.chunk_start_offset).is_some_and(|chunk| {
            chunk.length == index.chunk_length
                && chunk.times == (*message_start_time, *message_end_time)
                && (message_index_offsets.is_empty() || chunk.indices == *message_index_offsets)
        });
        if same {
            self.indexed = self.indexed.saturating_add(1);
        } else {
            self.leads_elsewhere(at, "a chunk index that is of no chunk of the data");
        }
        Ok(())
    }

    /// It leads to a metadata record of the data.
    fn metadata_index(&mut self, body: &[u8], at: usize) -> Result<(), TraceError> {
        let Record::MetadataIndex(index) = parse(op::METADATA_INDEX, body, at)? else { return Ok(()) };
        if !self.notes.iter().any(|note| note.at == index.offset && note.name == index.name) {
            self.leads_elsewhere(at, "a metadata index that is of no metadata record of the data");
        }
        Ok(())
    }

    /// It counts what is there.
    fn statistics(&mut self, body: &[u8], at: usize) -> Result<(), TraceError> {
        let Record::Statistics(said) = parse(op::STATISTICS, body, at)? else { return Ok(()) };
        let exact = body.len() == said.channel_message_counts.len().saturating_mul(10).saturating_add(46);
        let (message_start_time, message_end_time) = self.times.unwrap_or_default();
        let narrow = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        let counted = Statistics {
            message_count: self.found,
            schema_count: u16::try_from(self.schemas.len()).unwrap_or(u16::MAX),
            channel_count: narrow(self.channels.len()),
            // An attachment is none of ours, and found fault with by itself.
            attachment_count: 0,
            metadata_count: narrow(self.notes.len()),
            chunk_count: narrow(self.chunks.len()),
            message_start_time,
            message_end_time,
            channel_message_counts: self.counts.clone(),
        };
        let mut said = said;
        said.channel_message_counts.retain(|_, count| *count != 0);
        if !exact || said != counted {
            self.leads_elsewhere(at, "statistics that are not of the data");
        }
        Ok(())
    }

    /// It leads to all records of one kind in the summary.
    fn summary_offset(&mut self, body: &[u8], at: usize) -> Result<(), TraceError> {
        let Record::SummaryOffset(offset) = parse(op::SUMMARY_OFFSET, body, at)? else { return Ok(()) };
        let SummaryOffset { group_opcode, group_start, group_length } = offset;
        let group = self.groups.of_kind.get(&group_opcode);
        let same = group == Some(&(group_start, group_start.saturating_add(group_length)));
        if !same || self.groups.scattered {
            self.leads_elsewhere(at, "an offset of the summary that leads to other records");
        }
        Ok(())
    }

    /// Reading goes on: an index is for viewers that seek, and nothing is read by it here.
    fn leads_elsewhere(&mut self, at: usize, what: &str) {
        self.added.push(Added { at: wide(at), what: what.to_owned() });
    }

    /// Takes a schema, channel or message; of a message it gives the header.
    fn content(&mut self, opcode: u8, body: &[u8], at: usize) -> Result<Option<MessageHeader>, TraceError> {
        match parse(opcode, body, at)? {
            Record::Schema { header, data } => {
                let text = SchemaText {
                    at: wide(at),
                    is_used: false,
                    name: header.name.into(),
                    encoding: header.encoding,
                    data: data.as_ref().into(),
                };
                let replaced = self.schemas.insert(header.id, text);
                self.added.extend(replaced.as_ref().and_then(SchemaText::unused));
            }
            Record::Channel(channel) => {
                let described = self.channel(&channel, at)?;
                if let Some(schema) = self.schemas.get_mut(&channel.schema_id) {
                    schema.is_used = true;
                }
                if self.channels.get(&channel.id).is_none_or(|known| known.digest != described.digest) {
                    self.unused.insert(described.digest, (wide(at), Arc::clone(&described.topic)));
                }
                self.channels.insert(channel.id, described.into());
            }
            Record::Message { header, data } => {
                let channel = self.channels.get(&header.channel_id);
                let channel = channel.ok_or_else(|| malformed(at, "a message without its channel"))?;
                self.unused.remove(&channel.digest);
                self.ready.push_back(Message {
                    topic: Arc::clone(&channel.topic),
                    schema: Arc::clone(&channel.schema),
                    sequence: header.sequence,
                    log_time: header.log_time,
                    publish_time: header.publish_time,
                    data: data.into_owned(),
                    at: wide(at),
                    channel: Arc::clone(channel),
                    is_inner: false,
                });
                self.found = self.found.saturating_add(1);
                let count = self.counts.entry(header.channel_id).or_default();
                *count = count.saturating_add(1);
                let time = header.log_time;
                let (first, last) = self.times.unwrap_or((time, time));
                self.times = Some((first.min(time), last.max(time)));
                return Ok(Some(header));
            }
            _ => {}
        }
        Ok(None)
    }

    fn channel(&self, channel: &mcap::records::Channel, at: usize) -> Result<Channel, TraceError> {
        let none =
            SchemaText { at: 0, is_used: true, name: "".into(), encoding: String::new(), data: Arc::new([]) };
        let schema = match (channel.schema_id, self.schemas.get(&channel.schema_id)) {
            (0, _) => none,
            (_, Some(schema)) => schema.clone(),
            (_, None) => return Err(malformed(at, "a channel without its schema")),
        };
        let described = (&*schema.name, schema.encoding.as_str(), &*schema.data);
        let digest = channel_digest(&channel.topic, &channel.message_encoding, &channel.metadata, described);
        Ok(Channel {
            topic: channel.topic.as_str().into(),
            encoding: channel.message_encoding.clone(),
            metadata: channel.metadata.clone(),
            schema: schema.name,
            schema_encoding: schema.encoding,
            schema_data: schema.data,
            digest,
        })
    }

    /// What the summary says again of schemas and channels is what the data says.
    fn repeated(&self, opcode: u8, body: &[u8], at: usize) -> Result<(), TraceError> {
        let same = match parse(opcode, body, at)? {
            Record::Schema { header, data } => self.schemas.get(&header.id).is_some_and(|schema| {
                *schema.name == *header.name && schema.encoding == header.encoding && *schema.data == *data
            }),
            Record::Channel(channel) => {
                let again = self.channel(&channel, at)?;
                self.channels.get(&channel.id).is_some_and(|known| known.digest == again.digest)
            }
            _ => true,
        };
        if same { Ok(()) } else { Err(malformed(at, "the summary's channels are not those of the data")) }
    }

    fn add(&mut self, opcode: u8, at: usize) {
        let what = match opcode {
            op::HEADER => "a second header".to_owned(),
            op::ATTACHMENT => "an attachment".to_owned(),
            opcode => format!("a record of kind {opcode:#04x}"),
        };
        self.added.push(Added { at: wide(at), what });
    }
}

impl Groups {
    fn note(&mut self, opcode: u8, begin: u64, end: u64) {
        match opcode {
            op::FOOTER => {}
            op::SUMMARY_OFFSET => self.offsets = self.offsets.or(Some(begin)),
            _ if self.last == Some(opcode) => {
                self.of_kind.entry(opcode).and_modify(|group| group.1 = end);
            }
            _ => self.scattered |= self.of_kind.insert(opcode, (begin, end)).is_some(),
        }
        self.last = Some(opcode);
    }
}

impl SchemaText {
    fn unused(&self) -> Option<Added> {
        (!self.is_used).then(|| Added { at: self.at, what: format!("a schema {:?}", self.name) })
    }
}

impl Iterator for Reader<'_> {
    type Item = Result<Message, TraceError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(message) = self.ready.pop_front() {
            return Some(Ok(message));
        }
        match self.advance() {
            Ok(()) => self.ready.pop_front().map(Ok),
            Err(error) => {
                // A chunk that goes wrong in its midst has passed its CRC: what it had before is
                // not yielded all the same.
                self.ready.clear();
                self.section = Section::Done;
                Some(Err(error))
            }
        }
    }
}

/// Opcode and body of the record at the begin of `bytes`, if it is all there.
fn split_record(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let (&opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    Some((opcode, rest.get(..length)?))
}

fn parse(opcode: u8, body: &[u8], at: usize) -> Result<Record<'_>, TraceError> {
    mcap::parse_record(opcode, body).map_err(|error| malformed(at, &error.to_string()))
}

fn decompressed(data: &[u8], size: u64) -> Result<Vec<u8>, String> {
    let decoder = zstd::stream::read::Decoder::new(data).map_err(|error| error.to_string())?;
    let mut content = Vec::new();
    // One byte more shows content that is longer than said.
    decoder.take(size.saturating_add(1)).read_to_end(&mut content).map_err(|error| error.to_string())?;
    Ok(content)
}

/// As in MCAP, 0 is no sum at all.
fn check_crc(what: &'static str, at: usize, stored: u32, covered: &[u8]) -> Result<(), TraceError> {
    let computed = crc32fast::hash(covered);
    if stored == 0 || stored == computed {
        return Ok(());
    }
    Err(TraceError::CrcMismatch { what, at: wide(at), stored, computed })
}

fn malformed(at: usize, what: &str) -> TraceError {
    TraceError::Malformed { at: wide(at), what: what.to_owned() }
}

fn wide(offset: usize) -> u64 {
    u64::try_from(offset).unwrap_or(u64::MAX)
}
