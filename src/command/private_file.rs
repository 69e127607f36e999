//! Files that only their owner may read: keys, and what keys open.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use super::CommandError;

/// Who may read a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Readers {
    /// Its owner.
    Owner,
    /// Whoever the system lets.
    Anybody,
}

/// Makes a new file; if there is one, it stays as it is and this is an error.
pub(super) fn create_new(path: &Path, text: &[u8], readers: Readers) -> Result<(), CommandError> {
    let unwritable = |source| CommandError::Unwritable { file: path.to_owned(), source };
    let mut file = options(readers).create_new(true).open(path).map_err(unwritable)?;
    write(&mut file, text).map_err(|source| {
        let _ = fs::remove_file(path);
        unwritable(source)
    })
}

/// Writes a whole file that is on the disk then, or leaves what was there. Folders are made if
/// need be.
pub(super) fn replace(path: &Path, bytes: &[u8], readers: Readers) -> Result<(), CommandError> {
    let unwritable = |file: &Path| {
        let file = file.to_owned();
        move |source| CommandError::Unwritable { file, source }
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    if !folder.as_os_str().is_empty() {
        fs::create_dir_all(folder).map_err(unwritable(folder))?;
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let part: PathBuf = folder.join(format!(".{name}.part"));
    // One that a killed run has left may have other readers.
    let _ = fs::remove_file(&part);
    create_new(&part, bytes, readers)?;
    let kept = match (fs::metadata(path), readers) {
        (Ok(there), Readers::Anybody) => fs::set_permissions(&part, there.permissions()),
        _ => Ok(()),
    };
    kept.and_then(|()| fs::rename(&part, path)).map_err(|source| {
        let _ = fs::remove_file(&part);
        unwritable(path)(source)
    })
}

fn write(file: &mut File, bytes: &[u8]) -> io::Result<()> {
    file.write_all(bytes)?;
    file.sync_all()
}

fn options(readers: Readers) -> OpenOptions {
    let mut options = OpenOptions::new();
    options.write(true);
    #[cfg(unix)]
    if readers == Readers::Owner {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.mode(0o600);
    }
    #[cfg(not(unix))]
    let _ = readers;
    options
}
