//! A new file of what was read of another.

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Compression, McapError, WriteOptions};

use super::format::PROGRAM;
use super::reader::{Channel, Message};
use crate::seal::chain::Digest;

/// An MCAP file as our traces are.
pub(super) fn begin<W: Write>(file: W) -> io::Result<mcap::Writer<NoSeek<W>>> {
    WriteOptions::new()
        .profile("")
        .library(PROGRAM)
        .compression(Some(Compression::Zstd))
        // More threads would not change what is read, but might change the bytes.
        .compression_threads(0)
        // A chunk that is not finished is not in the file at all.
        .disable_seeking(true)
        .calculate_chunk_crcs(true)
        .calculate_data_section_crc(true)
        .calculate_summary_section_crc(true)
        .create(NoSeek::new(file))
        .map_err(into_io)
}

pub(super) fn into_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}

/// Writes messages and metadata with their channels as they are.
pub(super) struct Copy {
    writer: mcap::Writer<NoSeek<Vec<u8>>>,
    channels: BTreeMap<Digest, u16>,
}

impl Copy {
    pub(super) fn begin() -> io::Result<Self> {
        Ok(Self { writer: begin(Vec::new())?, channels: BTreeMap::new() })
    }

    pub(super) fn note(&mut self, name: &str, metadata: BTreeMap<String, String>) -> io::Result<()> {
        self.writer.write_metadata(&Metadata { name: name.to_owned(), metadata }).map_err(into_io)
    }

    /// Writes the message with this number and these bytes in place of its own.
    pub(super) fn message(&mut self, message: &Message, sequence: u32, data: &[u8]) -> io::Result<()> {
        let channel_id = match self.channels.get(&message.channel.digest) {
            Some(id) => *id,
            None => {
                let id = self.channel(&message.channel).map_err(into_io)?;
                self.channels.insert(message.channel.digest, id);
                id
            }
        };
        let Message { log_time, publish_time, .. } = *message;
        let header = MessageHeader { channel_id, sequence, log_time, publish_time };
        self.writer.write_to_known_channel(&header, data).map_err(into_io)
    }

    fn channel(&mut self, channel: &Channel) -> Result<u16, McapError> {
        let schema = match &*channel.schema {
            "" => 0,
            name => self.writer.add_schema(name, &channel.schema_encoding, &channel.schema_data)?,
        };
        self.writer.add_channel(schema, &channel.topic, &channel.encoding, &channel.metadata)
    }

    pub(super) fn finish(mut self) -> io::Result<Vec<u8>> {
        self.writer.finish().map_err(into_io)?;
        Ok(self.writer.into_inner().into_inner())
    }
}
