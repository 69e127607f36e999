//! Keeps what a command reads from being replaced by what it writes.

use std::fs;
use std::path::Path;

use super::CommandError;

/// Refuses to write a file that is also read: evidence or a key would be gone.
pub(super) fn refuse<'p>(
    written: &Path,
    read: impl IntoIterator<Item = &'p Path>,
) -> Result<(), CommandError> {
    match read.into_iter().find(|read| is_same(written, read)) {
        None => Ok(()),
        Some(read) => Err(CommandError::Arguments(format!(
            "{}: it would be overwritten, and is read as {}; expected another file to write",
            written.display(),
            read.display()
        ))),
    }
}

/// Whether both are one file, by whatever path or link.
fn is_same(one: &Path, other: &Path) -> bool {
    let whole = |path| fs::canonicalize(path).ok();
    whole(one).is_some_and(|one| whole(other).is_some_and(|other| one == other || is_linked(&one, &other)))
}

#[cfg(unix)]
fn is_linked(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let place = |path: &Path| fs::metadata(path).ok().map(|file| (file.dev(), file.ino()));
    place(one).is_some_and(|file| place(other) == Some(file))
}

#[cfg(not(unix))]
const fn is_linked(_: &Path, _: &Path) -> bool {
    false
}
