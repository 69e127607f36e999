//! All that a file holds, in one pass.

use super::error::TraceError;
use super::format::FORMAT_MAJOR;
use super::reader::{Added, Message, Note, Reader};
use super::recording::decoded;
use super::schema::{Schema, evidence};

/// What was read of a file before its end or its damage.
#[derive(Clone, Debug)]
pub struct Scan {
    /// The messages in the open.
    pub messages: Vec<Message>,
    /// The metadata records.
    pub notes: Vec<Note>,
    /// What else there is.
    pub added: Vec<Added>,
    /// The format's version, if the file says it.
    pub format: Option<String>,
    /// What ended the reading, but for the end.
    pub damage: Option<TraceError>,
    /// The file's length in bytes.
    pub length: u64,
}

impl Scan {
    /// Reads a file's bytes as far as they go.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        let mut reader = Reader::new(bytes);
        let (mut messages, mut damage) = (Vec::new(), None);
        for message in reader.by_ref() {
            match message {
                Ok(message) => messages.push(message),
                Err(error) => damage = Some(error),
            }
        }
        let mut added = reader.added().to_vec();
        // In a file that goes on they may be used later.
        if damage.is_none() {
            added.extend(reader.unused());
        }
        Self {
            messages,
            notes: reader.notes().to_vec(),
            added,
            format: reader.format().map(str::to_owned),
            damage,
            length: u64::try_from(bytes.len()).unwrap_or(u64::MAX),
        }
    }

    /// The header, which is the first message.
    ///
    /// # Errors
    /// If there is none, or one of a newer major version.
    pub fn header(&self) -> Result<evidence::Header, TraceError> {
        let no_trace = |what| Err(self.damage.clone().unwrap_or(TraceError::NotATrace(what)));
        let Some(first) = self.messages.first() else { return no_trace("it has no message") };
        if self.format.is_none() {
            return Err(TraceError::NotATrace("it does not say its format's version"));
        }
        if *first.schema != *Schema::Header.name() {
            return Err(TraceError::NotATrace("its first message is not the header"));
        }
        let header: evidence::Header = decoded(first)?;
        if header.format_major > FORMAT_MAJOR {
            let found = format!("{}.{}", header.format_major, header.format_minor);
            return Err(TraceError::NewerMajor { found });
        }
        Ok(header)
    }
}
