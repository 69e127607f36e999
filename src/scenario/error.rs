//! What can be wrong with a scenario.

use std::io;
use std::path::PathBuf;

use selfneg_sim::{BuildingError, WorldError};

use crate::input::InputError;
use crate::mission::SpecificationError;

/// A scenario that cannot be run: which file, which key, what was expected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The file is missing or cannot be read.
    #[error("{}: cannot be read: {source}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file is not TOML, or a key is unknown, missing or of the wrong kind.
    #[error("{}:{line}: {key}{message}", file.display())]
    NotAsDocumented {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The key, followed by a colon and a space; empty for the whole document.
        key: String,
        /// The parser's words.
        message: String,
    },
    /// A value is out of range or does not go with another.
    #[error("{}: {key}: expected {expected}, found {found}", file.display())]
    Unexpected {
        /// The file.
        file: PathBuf,
        /// The key.
        key: String,
        /// What should be there.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// A name that is not defined anywhere.
    #[error("{}: {key}: there is no {what} {name:?}, expected one of {}", file.display(), listed(known))]
    Unknown {
        /// The file.
        file: PathBuf,
        /// The key.
        key: String,
        /// What kind of thing.
        what: &'static str,
        /// The name.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
    /// Two things of one name.
    #[error("{}: {key}: {name:?} is there already, expected different names", file.display())]
    Twice {
        /// The file.
        file: PathBuf,
        /// The key of the second.
        key: String,
        /// The name.
        name: String,
    },
    /// A file that the scenario names cannot be used.
    #[error("{}: {key}: {source}", file.display())]
    Input {
        /// The scenario.
        file: PathBuf,
        /// The key.
        key: String,
        /// What is wrong.
        source: Box<InputError>,
    },
    /// The building cannot be used.
    #[error("{}: building: {source}", file.display())]
    Building {
        /// The scenario.
        file: PathBuf,
        /// What is wrong.
        source: Box<BuildingError>,
    },
    /// The robot or a person cannot be where the scenario has them.
    #[error("{}: {key}: {source}", file.display())]
    World {
        /// The scenario.
        file: PathBuf,
        /// The key.
        key: String,
        /// What is wrong.
        source: Box<WorldError>,
    },
    /// The mission's specification contradicts itself or the rules.
    #[error("{}: mission: {source}", file.display())]
    Mission {
        /// The scenario.
        file: PathBuf,
        /// What is wrong.
        source: Box<SpecificationError>,
    },
}

/// Names in quotes, separated by commas.
fn listed(names: &[String]) -> String {
    if names.is_empty() {
        return "those (there are none)".to_owned();
    }
    names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
}
