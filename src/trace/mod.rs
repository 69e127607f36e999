//! A run as evidence: an MCAP file that says what happened and why, and shows it.
//!
//! [`TraceWriter`] watches a run and writes; [`Reader`] yields every complete message of a
//! file, however it was cut or damaged; [`Recording`] is what was recorded, by type; and
//! [`Recording::replay`] runs the recorded events through a new mission and compares.
//!
//! Everything personal is on topics that begin with [`PERSONAL`], in messages about one
//! person each, written through one place (`TraceWriter::personal`); the messages elsewhere
//! hold pseudonyms. See `docs/trace.md` for all topics.

mod encode;
mod error;
mod format;
mod frames;
mod layers;
mod reader;
mod recording;
mod replay;
mod scene;
pub mod schema;
mod sentence;
mod setup;
mod stamp;
mod topic;
mod writer;

pub use encode::{EncodedEvent, EncodedOutput, Encoder, Open};
pub use error::TraceError;
pub use format::{FORMAT_KEY, FORMAT_MAJOR, FORMAT_MINOR, FORMAT_RECORD, PROGRAM};
pub use reader::{Message, Reader};
pub use recording::{Entry, Recording, Step};
pub(crate) use replay::decode_event;
pub use replay::{Difference, Replay, ReplayError};
pub use sentence::{tell_event, tell_output};
pub use topic::{PERSONAL, Topic, Whose};
pub use writer::TraceWriter;
