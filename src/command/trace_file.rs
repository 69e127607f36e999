//! Reads a trace for the commands that work on one.

use std::fs;
use std::path::Path;

use super::CommandError;
use crate::input::InputError;

/// A whole file.
pub(super) fn read(file: &Path) -> Result<Vec<u8>, CommandError> {
    let unreadable = |source| InputError::Unreadable { file: file.to_owned(), source };
    Ok(fs::read(file).map_err(unreadable)?)
}
