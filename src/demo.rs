//! The paper's mall: Alice is being served, Bob interrupts.

use std::path::Path;

use crate::input::{InputError, Rules, User};

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
