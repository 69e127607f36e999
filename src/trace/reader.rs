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

use mcap::records::{Record, op};

use super::error::TraceError;
use super::format::{FORMAT_KEY, FORMAT_MAJOR, FORMAT_RECORD};

/// Most bytes of a decompressed chunk. Ours have about one megabyte.
const MAX_CHUNK_BYTES: u64 = 256 << 20;

const OPCODE_AND_LENGTH: usize = 9;

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
}

/// Reads a whole file in memory. After the first error it yields nothing more.
#[derive(Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    /// Where the next record begins.
    at: usize,
    section: Section,
    schemas: BTreeMap<u16, Arc<str>>,
    channels: BTreeMap<u16, (Arc<str>, Arc<str>)>,
    ready: VecDeque<Message>,
    format: Option<String>,
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
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            section: Section::Start,
            schemas: BTreeMap::new(),
            channels: BTreeMap::new(),
            ready: VecDeque::new(),
            format: None,
        }
    }

    /// The trace format's version, once the record that says it was read.
    #[must_use]
    pub fn format(&self) -> Option<&str> {
        self.format.as_deref()
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
            let (opcode, body) = self.record()?;
            match self.section {
                Section::Summary(begin) => self.summary(opcode, body, begin, at)?,
                _ => self.data(opcode, body, at)?,
            }
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
        match opcode {
            op::SCHEMA | op::CHANNEL | op::MESSAGE => self.content(opcode, body, at),
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
            // Header, indices, attachments, and what is not known: nothing to yield. They are
            // not parsed; mcap's parser of attachments panics on short ones.
            _ => Ok(()),
        }
    }

    fn summary(&mut self, opcode: u8, body: &[u8], begin: usize, at: usize) -> Result<(), TraceError> {
        if opcode != op::FOOTER {
            return Ok(());
        }
        if let Record::Footer(footer) = parse(opcode, body, at)? {
            // The sum covers the footer too, but for itself.
            let end = at.saturating_add(OPCODE_AND_LENGTH).saturating_add(16);
            let covered = self.bytes.get(begin..end).unwrap_or_default();
            check_crc("summary", begin, footer.summary_crc, covered)?;
        }
        let after = self.at;
        self.magic(malformed(after, "no magic bytes after the footer"))
            .map_err(|error| if self.bytes.len() == after { self.truncated() } else { error })?;
        if self.at < self.bytes.len() {
            return Err(malformed(self.at, "there is more after the end"));
        }
        self.section = Section::Done;
        Ok(())
    }

    fn metadata(&mut self, body: &[u8], at: usize) -> Result<(), TraceError> {
        let Record::Metadata(metadata) = parse(op::METADATA, body, at)? else { return Ok(()) };
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
        let Record::Chunk { header, data } = parse(op::CHUNK, body, at)? else { return Ok(()) };
        let size = header.uncompressed_size;
        if size > MAX_CHUNK_BYTES {
            let what = format!("a chunk of {size} bytes; expected at most {MAX_CHUNK_BYTES}");
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
        while !rest.is_empty() {
            let (opcode, body) =
                split_record(rest).ok_or_else(|| malformed(at, "a record leaves its chunk"))?;
            match opcode {
                op::SCHEMA | op::CHANNEL | op::MESSAGE => self.content(opcode, body, at)?,
                _ => {}
            }
            let length = OPCODE_AND_LENGTH.saturating_add(body.len());
            rest = rest.get(length..).unwrap_or_default();
        }
        Ok(())
    }

    fn content(&mut self, opcode: u8, body: &[u8], at: usize) -> Result<(), TraceError> {
        match parse(opcode, body, at)? {
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name.into());
            }
            Record::Channel(channel) => {
                let schema = match (channel.schema_id, self.schemas.get(&channel.schema_id)) {
                    (_, Some(schema)) => Arc::clone(schema),
                    (0, None) => "".into(),
                    (_, None) => return Err(malformed(at, "a channel without its schema")),
                };
                self.channels.insert(channel.id, (channel.topic.into(), schema));
            }
            Record::Message { header, data } => {
                let channel = self.channels.get(&header.channel_id);
                let (topic, schema) =
                    channel.cloned().ok_or_else(|| malformed(at, "a message without its channel"))?;
                self.ready.push_back(Message {
                    topic,
                    schema,
                    sequence: header.sequence,
                    log_time: header.log_time,
                    publish_time: header.publish_time,
                    data: data.into_owned(),
                    at: wide(at),
                });
            }
            _ => {}
        }
        Ok(())
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
