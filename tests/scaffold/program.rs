//! Ways to run the program.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

use super::folders::Place;

pub(crate) fn selfneg() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_selfneg"));
    // Help texts wrap to the terminal's width.
    command.env("COLUMNS", "100").env_remove("RUST_BACKTRACE");
    command
}

/// `selfneg negotiate` on users of a place, the current one first.
pub(crate) fn negotiate(place: &Place, users: &[&str], flags: &[&str]) -> Command {
    let mut command = selfneg();
    command.current_dir(place.path()).args(["negotiate", "--rules", ".", "--current", users[0]]);
    command.arg("--interrupting").args(&users[1..]).args(flags);
    command
}

/// The JSON document that a command prints, which must end with this exit code.
pub(crate) fn document(command: &mut Command, code: i32) -> Value {
    let output = command.arg("--json").assert().code(code).get_output().clone();
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The JSON document of a negotiation.
pub(crate) fn decided(place: &Place, users: &[&str], flags: &[&str]) -> Value {
    document(&mut negotiate(place, users, flags), 0)
}

/// What a command that must refuse its input says: exit code 2, nothing on standard
/// output, and one line on standard error, which is given back without its path to
/// `place`.
pub(crate) fn refusal(command: &mut Command, place: &Path) -> String {
    let output = command.assert().code(2).get_output().clone();
    assert_eq!(String::from_utf8_lossy(&output.stdout), "");
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert_eq!(complaint.lines().count(), 1, "not one line: {complaint}");
    let line = complaint.strip_prefix("error: ").and_then(|line| line.strip_suffix('\n'));
    let line = line.unwrap_or_else(|| panic!("not an error line: {complaint}"));
    assert!(!line.contains("panicked"), "{line}");
    line.replace(&format!("{}/", place.display()), "")
}
