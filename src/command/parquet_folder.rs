//! A fleet's tables as files: all there and whole, or as they were before.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use super::CommandError;
use crate::fleet::{RowCounts, TableError, Tables, TraceRows};

/// Tables that are being written, beside the files that they will replace.
pub(super) struct ParquetFolder {
    parts: Parts,
    tables: Tables<File>,
}

/// Files under names of their own; removed unless they got their final ones.
struct Parts {
    folder: PathBuf,
}

impl ParquetFolder {
    /// Makes the folder, if need be, and begins the tables.
    pub(super) fn create(folder: &Path) -> Result<Self, CommandError> {
        fs::create_dir_all(folder).map_err(|source| unwritable(folder, source))?;
        let parts = Parts { folder: folder.to_owned() };
        let [traces, decisions, rounds] = Tables::<File>::FILES.map(|name| {
            let part = parts.part(name);
            File::create(&part).map_err(|source| unwritable(&part, source))
        });
        let tables = Tables::new([traces?, decisions?, rounds?]).map_err(|source| failed(folder, source))?;
        Ok(Self { parts, tables })
    }

    /// Adds a trace.
    pub(super) fn push(&mut self, rows: TraceRows) -> Result<(), CommandError> {
        self.tables.push(rows).map_err(|source| failed(&self.parts.folder, source))
    }

    /// Ends the tables and gives them their names.
    pub(super) fn finish(self) -> Result<RowCounts, CommandError> {
        let Self { parts, tables } = self;
        let (files, counts) = tables.finish().map_err(|source| failed(&parts.folder, source))?;
        for (name, file) in Tables::<File>::FILES.into_iter().zip(files) {
            file.sync_all().map_err(|source| unwritable(&parts.part(name), source))?;
        }
        for name in Tables::<File>::FILES {
            let path = parts.folder.join(name);
            fs::rename(parts.part(name), &path).map_err(|source| unwritable(&path, source))?;
        }
        Ok(counts)
    }
}

impl Parts {
    fn part(&self, name: &str) -> PathBuf {
        self.folder.join(format!(".{name}.part"))
    }
}

impl Drop for Parts {
    fn drop(&mut self) {
        for name in Tables::<File>::FILES {
            // Gone already if all went well.
            let _ = fs::remove_file(self.part(name));
        }
    }
}

fn unwritable(file: &Path, source: std::io::Error) -> CommandError {
    CommandError::Unwritable { file: file.to_owned(), source }
}

fn failed(folder: &Path, source: TableError) -> CommandError {
    CommandError::Tables { folder: folder.to_owned(), source }
}
