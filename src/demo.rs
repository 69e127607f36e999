//! The paper's mall: Alice is being served, Bob interrupts.

use std::path::{Path, PathBuf};

use selfneg_sim::{Building, BuildingError};

use crate::input::{InputError, Rules, User};
use crate::scenario::{Folders, Scenario, ScenarioError};

macro_rules! example {
    ($file:literal) => {
        include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/mall/", $file))
    };
}

/// The mall's rules.
///
/// # Errors
/// None with the files that the program was built from.
pub fn rules() -> Result<Rules, InputError> {
    Rules::parse(
        ("disposition_activation.json", example!("disposition_activation.json")),
        ("ethical_implications.json", example!("ethical_implications.json")),
    )
}

/// Alice, with a small child and in urgency, wants the bathroom and is being served.
///
/// # Errors
/// None with the files that the program was built from.
pub fn alice() -> Result<User, InputError> {
    User::parse(
        "Alice",
        Path::new("Alice"),
        [
            example!("Alice/ethic_profiles.json"),
            example!("Alice/user_status.json"),
            example!("Alice/context.json"),
            example!("Alice/goal.json"),
        ],
    )
}

/// Bob, elderly, wants the pharmacy and interrupts.
///
/// # Errors
/// None with the files that the program was built from.
pub fn bob() -> Result<User, InputError> {
    User::parse(
        "Bob",
        Path::new("Bob"),
        [
            example!("Bob/ethic_profiles.json"),
            example!("Bob/user_status.json"),
            example!("Bob/context.json"),
            example!("Bob/goal.json"),
        ],
    )
}

/// The mall's story: `examples/scenarios/mall.toml`.
///
/// # Errors
/// None with the files that the program was built from.
pub fn scenario() -> Result<Scenario, ScenarioError> {
    let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenarios/mall.toml"));
    Scenario::parse(text, Path::new("mall.toml"), &BuiltIn)
}

/// The files above, under whatever folder.
struct BuiltIn;

impl Folders for BuiltIn {
    fn rules(&self, _: &Path) -> Result<Rules, InputError> {
        rules()
    }

    fn user(&self, folder: &Path) -> Result<User, InputError> {
        match folder.file_name().and_then(|name| name.to_str()) {
            Some("Alice") => alice(),
            Some("Bob") => bob(),
            _ => Err(InputError::Unreadable { file: folder.to_owned(), source: not_built_in() }),
        }
    }

    fn building(&self, file: &Path) -> Result<Building, BuildingError> {
        Err(BuildingError::Io { path: PathBuf::from(file), source: not_built_in() })
    }
}

fn not_built_in() -> std::io::Error {
    std::io::Error::new(std::io::ErrorKind::NotFound, "the program does not have it built in")
}
