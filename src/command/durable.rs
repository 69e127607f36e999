//! A file that is on the disk when it says so.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use super::CommandError;

/// A file whose `flush` syncs: what was flushed survives a killed program, and a loss of power
/// as far as the disk keeps its word.
#[derive(Debug)]
pub(super) struct Durable(File);

impl Durable {
    /// Makes the file, or empties it, and the folders that lead to it.
    pub(super) fn create(path: &Path) -> Result<Self, CommandError> {
        let made = || {
            if let Some(folder) = path.parent() {
                fs::create_dir_all(folder)?;
            }
            File::create(path)
        };
        made().map(Self).map_err(|source| CommandError::Unwritable { file: path.to_owned(), source })
    }
}

impl Write for Durable {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.0.sync_data() {
            // A pipe or a device: there is nothing to sync.
            Err(error) if error.kind() == io::ErrorKind::InvalidInput => Ok(()),
            done => done,
        }
    }
}
