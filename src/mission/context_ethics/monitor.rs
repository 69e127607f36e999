//! *Monitor*: takes in what the user, a device or a sensor says, and nothing more.

use super::super::record::Unusable;
use super::super::specification::MissionRules;
use super::super::user_data::UserData;
use super::memory::UserMemory;
use crate::input::Truth;

/// Something new about a user.
#[derive(Clone, Copy)]
pub(in super::super) enum Update<'a> {
    /// All data, at the start.
    Data(&'a UserData),
    /// The value of an attribute of the context.
    Context(&'a str, &'a str),
    /// What the user says of a condition.
    Status(&'a str, Truth),
}

/// Notes an update.
pub(super) fn monitor(
    memory: &mut UserMemory,
    update: Update<'_>,
    rules: &MissionRules,
) -> Result<(), Unusable> {
    match update {
        Update::Data(data) => memory.take(data, rules),
        Update::Context(attribute, value) => memory.set(attribute, value),
        Update::Status(condition, truth) => memory.state(condition, truth, rules),
    }
}
