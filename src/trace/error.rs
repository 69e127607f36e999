//! What can be wrong with a trace.

use super::format::FORMAT_MAJOR;

/// Why a trace, or the rest of it, cannot be read. Offsets are bytes from the file's begin.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// The file does not begin like an MCAP file.
    #[error("not an MCAP file")]
    NotMcap,
    /// The file ends before its end: everything before the offset is intact.
    #[error("truncated: the file ends within a record, or without its end, at byte {at}")]
    Truncated {
        /// Where what is intact ends.
        at: u64,
    },
    /// What is there is not what was written.
    #[error(
        "CRC mismatch of the {what} at byte {at}: {stored:08x} is stored, the content has {computed:08x}"
    )]
    CrcMismatch {
        /// The checked part.
        what: &'static str,
        /// Where it begins.
        at: u64,
        /// The sum in the file.
        stored: u32,
        /// The sum of what is there.
        computed: u32,
    },
    /// A record is not as the MCAP format has it.
    #[error("malformed at byte {at}: {what}")]
    Malformed {
        /// Where the record, or the chunk around it, begins.
        at: u64,
        /// What is wrong.
        what: String,
    },
    /// More than this reader is willing to hold in memory, or a compression that it lacks.
    #[error("not supported at byte {at}: {what}")]
    Unsupported {
        /// Where the record begins.
        at: u64,
        /// What is not.
        what: String,
    },
    /// The format's major version is newer than this program.
    #[error("format {found}: written by a newer program; this one reads formats up to {FORMAT_MAJOR}.x")]
    NewerMajor {
        /// The version as found.
        found: String,
    },
    /// The file is MCAP, but no trace of ours.
    #[error("an MCAP file, but not a trace of selfneg: {0}")]
    NotATrace(&'static str),
    /// A message is not what its topic promises.
    #[error("message {sequence} on {topic}: {what}")]
    BadMessage {
        /// The message's place in the trace.
        sequence: u32,
        /// Its topic.
        topic: String,
        /// What is wrong.
        what: String,
    },
    /// The messages' numbering has a gap: something is missing.
    #[error("message {found} follows where message {expected} should")]
    Gap {
        /// The number that should be there.
        expected: u64,
        /// The one that is.
        found: u64,
    },
    /// The end record counts something else than the trace holds.
    #[error("the end record counts {stored} {what}, the trace has {found}")]
    Miscounted {
        /// What is counted.
        what: &'static str,
        /// The end record's figure.
        stored: u64,
        /// The trace's.
        found: u64,
    },
}
