//! The trace format's version and fixed words.

/// The major version: a reader of an older one cannot read this.
pub const FORMAT_MAJOR: u32 = 1;

/// The minor version: a reader of the same major version can, and ignores what it does not know.
pub const FORMAT_MINOR: u32 = 1;

/// The name of the MCAP metadata record, first in the file, that says the version, so that it
/// is known before any message is.
pub const FORMAT_RECORD: &str = "selfneg.format";

/// The key in it; the value is `major.minor`.
pub const FORMAT_KEY: &str = "version";

/// This program, as traces name it.
pub const PROGRAM: &str = concat!("selfneg ", env!("CARGO_PKG_VERSION"));

/// The version as traces say it.
pub(super) fn version() -> String {
    format!("{FORMAT_MAJOR}.{FORMAT_MINOR}")
}

/// The name of the metadata record of a clear copy that says what it is a copy of.
pub const UNSEALED_RECORD: &str = "selfneg.unsealed";

/// Most bytes of a message of the evidence, but for one that holds a segment. A list of empty
/// things takes some forty times as much in memory as in the file.
pub(super) const MAX_MESSAGE_BYTES: usize = 4 << 20;
