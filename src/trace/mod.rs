//! A run as evidence: an MCAP file that says what happened and why, and shows it.
//!
//! [`TraceWriter`] watches a run and writes; [`Reader`] yields every complete message of a
//! file, however it was cut or damaged; [`Recording`] is what was recorded, by type; and
//! [`Recording::replay`] runs the recorded events through a new mission and compares.
//!
//! Everything personal is on topics that begin with [`PERSONAL`], written through one place
//! (`TraceWriter::personal`) with the person whom it is about; the messages elsewhere hold
//! pseudonyms. In a sealed trace the personal messages are encrypted, on topics that begin
//! with [`SEALED`]; [`open`] reads any trace, with the keys that there are, and says what its
//! seal proves. See `docs/trace.md` for all topics and `docs/seal.md` for the seal.

mod committed;
mod copying;
mod encode;
mod erasing;
mod error;
mod format;
mod frames;
mod layers;
mod opening;
mod reader;
mod recording;
mod replay;
mod scan;
mod scene;
pub mod schema;
mod segments;
mod sentence;
mod setup;
mod stamp;
mod topic;
mod unsealing;
mod writer;

pub use committed::Commitment;
pub use encode::{EncodedEvent, EncodedOutput, Encoder, Open};
pub use erasing::{EraseError, Erased, erase};
pub use error::TraceError;
pub use format::{FORMAT_KEY, FORMAT_MAJOR, FORMAT_MINOR, FORMAT_RECORD, PROGRAM, UNSEALED_RECORD};
pub use opening::{Opened, PersonalPart, Unopened, messages, open};
pub use reader::{Added, Channel, Message, Note, Reader};
pub(crate) use recording::is_decision;
pub use recording::{Entry, Recording, Step};
pub(crate) use replay::decode_event;
pub use replay::{Difference, Replay, ReplayError};
pub use scan::Scan;
pub use sentence::{tell_event, tell_output};
pub use topic::{PERSONAL, SEALED, Topic, Whose};
pub use unsealing::{UnsealError, Unsealed, unseal};
pub use writer::TraceWriter;
