//! The program as such: help, arguments, exit codes, and where its output goes.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::fs::{File, OpenOptions};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use scaffold::folders::Place;
use scaffold::program::selfneg;

/// What `selfneg` with these arguments prints, which must end with this exit code.
fn printed(arguments: &[&str], code: i32) -> (String, String) {
    let output = selfneg().args(arguments).assert().code(code).get_output().clone();
    (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn help_is_as_it_was() {
    for (name, arguments) in [
        ("help", &["--help"][..]),
        ("help_demo", &["demo", "--help"]),
        ("help_negotiate", &["negotiate", "--help"]),
        ("help_replicate", &["replicate", "--help"]),
        ("help_lint", &["lint", "--help"]),
        ("help_optimum", &["optimum", "--help"]),
        ("help_regret", &["regret", "--help"]),
        ("help_policies", &["policies", "--help"]),
        ("help_graph", &["graph", "--help"]),
        ("help_simulate", &["simulate", "--help"]),
        ("help_report", &["report", "--help"]),
        ("help_keygen", &["keygen", "--help"]),
        ("help_audit", &["audit", "--help"]),
        ("help_unseal", &["unseal", "--help"]),
        ("help_erase", &["erase", "--help"]),
        ("help_explain", &["explain", "--help"]),
    ] {
        let (text, complaint) = printed(arguments, 0);
        assert_eq!(complaint, "");
        insta::assert_snapshot!(name, text);
    }
}

#[test]
fn version_is_the_packages() {
    assert_eq!(printed(&["--version"], 0).0, format!("selfneg {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn without_arguments_it_shows_help_and_fails() {
    let (text, complaint) = printed(&[], 2);
    assert_eq!(text, "");
    assert!(complaint.contains("Usage: selfneg <COMMAND>"), "{complaint}");
}

#[test]
fn unusable_arguments_are_named() {
    for (arguments, named) in [
        (&["dance"][..], "dance"),
        (&["demo", "--loud"], "--loud"),
        (&["negotiate"], "--rules <DIR>"),
        (&["negotiate", "--rules", ".", "--current", "A"], "--interrupting <DIR>"),
        (&["replicate"], "<DIR>"),
        (&["lint"], "--rules <DIR>"),
        (&["negotiate", "--quit", "never"], "[possible values: exhausted, literal]"),
        (&["negotiate", "--aggregation", "none"], "[possible values: per-condition, per-disposition]"),
        (&["negotiate", "--tie", "toss"], "[possible values: first-sender, fallback, surplus]"),
        (&["negotiate", "--fallback", "none"], "[possible values: first-come, utilitarian]"),
        (&["negotiate", "--policy", "borda"], "[possible values: published, condorcet]"),
    ] {
        let (text, complaint) = printed(arguments, 2);
        assert_eq!(text, "", "{arguments:?}");
        assert!(complaint.contains(named), "{arguments:?}: {complaint}");
    }
}

fn into(stdout: Stdio, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_selfneg"))
        .args(arguments)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/mall"))
        .stdin(Stdio::null())
        .stdout(stdout)
        .stderr(Stdio::piped())
        .output()
        .unwrap()
}

const DECISION: [&str; 7] = ["negotiate", "--rules", ".", "--current", "Alice", "--interrupting", "Bob"];

#[test]
fn a_closed_pipe_is_no_error_and_keeps_the_exit_code() {
    let place = Place::mall();
    place.write("Alice/ethic_profiles.json", r#"{"mall": {}}"#);
    let rules = place.path().to_str().unwrap();
    let alice = place.of("Alice");
    for (arguments, code) in [
        (&DECISION[..], 0),
        (&["lint", "--rules", rules, alice.to_str().unwrap()], 1),
        (&["--help"], 0),
        (&["--version"], 0),
        (&["replicate", rules], 2),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = into(Stdio::from(writer), arguments);
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {complaint}");
        assert!(!complaint.contains("panicked") && !complaint.contains("Broken pipe"), "{complaint}");
    }
}

#[test]
fn a_full_disk_is_an_error() {
    let Ok(_) = File::open("/dev/full") else { return };
    for arguments in [&DECISION[..], &["lint", "--rules", "."], &["--help"], &["--version"]] {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = into(Stdio::from(full), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert!(complaint.starts_with("error: standard output: cannot be written: "), "{complaint}");
        assert_eq!(complaint.lines().count(), 1, "{complaint}");
    }
}

#[test]
fn a_closed_standard_error_changes_nothing() {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let place = Place::mall();
    place.write("Bob/user_status.json", r#"{"unheard of": true}"#);
    let output = Command::new(env!("CARGO_BIN_EXE_selfneg"))
        .args(DECISION)
        .current_dir(place.path())
        .stderr(Stdio::from(writer))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(String::from_utf8(output.stdout).unwrap().contains("unheard of"));
}
