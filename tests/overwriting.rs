//! What a command reads as evidence or as a key is never what it writes.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use scaffold::program::{refusal, selfneg};
use tempfile::TempDir;

fn within(folder: &TempDir) -> Command {
    let mut command = selfneg();
    command.current_dir(folder.path());
    command
}

/// A folder with keys, a scenario, and a sealed trace by several names.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mall = format!("{}/examples/scenarios/mall.toml", env!("CARGO_MANIFEST_DIR"));
    within(&folder).arg("keygen").assert().success();
    within(&folder)
        .args(["simulate", &mall, "--trace", "x.mcap", "--sign", "robot.key", "--seal", "auditor.pub"])
        .assert()
        .success();
    let here = |name: &str| folder.path().join(name);
    fs::create_dir(here("tables")).unwrap();
    fs::copy(here("x.mcap"), here("tables/rounds.parquet")).unwrap();
    fs::write(here("own.toml"), "not much of a scenario").unwrap();
    fs::hard_link(here("x.mcap"), here("hard.mcap")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("x.mcap", here("soft.mcap")).unwrap();
    folder
}

fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => files.extend(contents(&path)),
            false => files.push((path.display().to_string(), fs::read(&path).unwrap())),
        }
    }
    files.sort();
    files
}

#[test]
fn what_is_read_is_not_written() {
    let folder = folder();
    let before = contents(folder.path());
    let absolute = folder.path().join("x.mcap").display().to_string();
    let mut tried: Vec<Vec<&str>> = Vec::new();
    let mut outputs = vec!["x.mcap", "./tables/../x.mcap", &absolute, "hard.mcap", "auditor.key"];
    if cfg!(unix) {
        outputs.push("soft.mcap");
    }
    for output in outputs {
        tried.push(vec!["unseal", "x.mcap", "--identity", "auditor.key", "-o", output]);
        tried.push(vec!["report", "x.mcap", "--identity", "auditor.key", "-o", output]);
    }
    tried.push(vec!["report", "x.mcap", "--robot-key", "robot.pub", "-o", "robot.pub"]);
    tried.push(vec!["erase", "x.mcap", "Bob", "--identity", "auditor.key", "-o", "auditor.key"]);
    tried.push(vec!["simulate", "own.toml", "--trace", "own.toml"]);
    tried.push(vec!["simulate", "own.toml", "--picture", "own.toml"]);
    tried.push(vec!["simulate", "own.toml", "--trace", "robot.key", "--sign", "robot.key"]);
    tried.push(vec!["simulate", "own.toml", "--trace", "auditor.pub", "--seal", "auditor.pub"]);
    tried.push(vec!["audit", "x.mcap", "tables/rounds.parquet", "--parquet", "tables"]);
    for arguments in tried {
        let said = refusal(within(&folder).args(&arguments), Path::new("."));
        assert!(said.contains("it would be overwritten"), "{arguments:?}: {said}");
    }
    assert_eq!(contents(folder.path()), before);
}

#[test]
fn another_file_may_be_replaced_and_erasing_in_place_is_meant() {
    let folder = folder();
    fs::write(folder.path().join("old"), "old").unwrap();
    for command in ["unseal", "report"] {
        within(&folder)
            .args([command, "x.mcap", "--identity", "auditor.key", "-o", "old"])
            .assert()
            .success();
    }
    within(&folder).args(["erase", "x.mcap", "Bob", "--identity", "auditor.key"]).assert().success();
}
