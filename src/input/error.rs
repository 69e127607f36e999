//! What can be wrong with an input file.

use std::io;
use std::path::PathBuf;

/// An input that cannot be used: which file, which key, what was expected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InputError {
    /// The file is missing or cannot be read.
    #[error("{}: cannot be read: {source}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file is not JSON.
    #[error("{}: not valid JSON: {message}", file.display())]
    NotJson {
        /// The file.
        file: PathBuf,
        /// The parser's words, with the keys that lead to the place, line and column.
        message: String,
    },
    /// An object has the same key twice.
    #[error("{}: {key}this key stands here twice, expected each key once", file.display())]
    DuplicateKey {
        /// The file.
        file: PathBuf,
        /// The key after the keys that lead to it, each followed by a colon and a space.
        key: String,
    },
    /// A key is missing.
    #[error("{}: has no key {key:?}, expected {expected}", file.display())]
    MissingKey {
        /// The file.
        file: PathBuf,
        /// The key.
        key: String,
        /// What should be there.
        expected: &'static str,
    },
    /// A value is of the wrong kind or out of range.
    #[error("{}: {key}expected {expected}, found {found}", file.display())]
    Unexpected {
        /// The file.
        file: PathBuf,
        /// The keys that lead to the value, each followed by a colon and a space; empty for
        /// the whole document.
        key: String,
        /// What should be there.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// The context's location has no profile.
    #[error(
        "{}: location: {location:?} has no ethical profile, expected one of {} of {}",
        file.display(), listed(known), profiles.display()
    )]
    UnknownLocation {
        /// The context file.
        file: PathBuf,
        /// The location in force.
        location: String,
        /// The profiles file.
        profiles: PathBuf,
        /// Its context labels.
        known: Vec<String>,
    },
    /// The rules do not list the goal.
    #[error("{origin}: goal {goal:?} is not listed, expected one of {} of {}", listed(known), file.display())]
    UnlistedGoal {
        /// Where the goal comes from: a file or an option.
        origin: String,
        /// The goal.
        goal: String,
        /// The implications file.
        file: PathBuf,
        /// The goals that it lists.
        known: Vec<String>,
    },
    /// The user's goal is not known.
    #[error("{}: is missing, expected {{\"goal\": name}}, or the goal as an option", file.display())]
    NoGoal {
        /// The goal file.
        file: PathBuf,
    },
    /// A path that names no folder.
    #[error("{}: names no folder, expected a user folder", folder.display())]
    NoFolderName {
        /// The path.
        folder: PathBuf,
    },
    /// More than the engine takes.
    #[error("{}: more than {limit} {what}", file.display())]
    TooMany {
        /// The file.
        file: PathBuf,
        /// Of what.
        what: &'static str,
        /// The limit.
        limit: usize,
    },
}

/// Names in quotes, separated by commas.
fn listed(names: &[String]) -> String {
    if names.is_empty() {
        return "those (there are none)".to_owned();
    }
    names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
}
