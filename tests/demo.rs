//! `selfneg demo`, through the program.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::fs;

use scaffold::folders::Place;
use scaffold::program::{negotiate, refusal, selfneg};

/// The demo's standard output.
fn demo_in(folder: &std::path::Path, flags: &[&str]) -> String {
    let mut command = selfneg();
    let output =
        command.current_dir(folder).arg("demo").args(flags).assert().code(0).stderr("").get_output().clone();
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn it_tells_the_mall() {
    let folder = tempfile::tempdir().unwrap();
    insta::assert_snapshot!("mall", demo_in(folder.path(), &[]));
    assert!(folder.path().join("selfneg-demo/decision.json").is_file());
    let drawn = fs::read_to_string(folder.path().join("selfneg-demo/run.svg")).unwrap();
    assert!(drawn.starts_with("<svg") && drawn.contains("Alice keeps precedence"));
}

#[test]
fn decision_json_is_what_json_prints() {
    let folder = tempfile::tempdir().unwrap();
    let printed = demo_in(folder.path(), &["--json", "--out", "new/and/nested"]);
    let written = folder.path().join("new/and/nested/decision.json");
    assert_eq!(fs::read_to_string(written).unwrap(), printed);
    assert!(printed.ends_with("}\n"));
}

#[test]
fn it_decides_as_negotiate_does_on_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    let demo = demo_in(folder.path(), &["--json"]);
    negotiate(&Place::mall(), &["Alice", "Bob"], &["--json"]).assert().code(0).stdout(demo);
}

#[test]
fn an_existing_decision_is_replaced_whole() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("decision.json");
    fs::write(&file, "x".repeat(100_000)).unwrap();
    let printed = demo_in(folder.path(), &["--json", "--out", "."]);
    assert_eq!(fs::read_to_string(&file).unwrap(), printed);
    let mut files: Vec<_> =
        fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    files.sort();
    let keys = ["auditor.key", "auditor.pub", "robot.key", "robot.pub"];
    assert_eq!(
        files,
        [&keys[..2], &["decision.json", "report.html"], &keys[2..], &["run.svg", "trace.mcap"]].concat()
    );
}

#[test]
fn keys_that_are_there_are_used_again_and_missing_public_ones_made() {
    let folder = tempfile::tempdir().unwrap();
    demo_in(folder.path(), &["--out", "."]);
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let names = ["auditor.key", "auditor.pub", "robot.key", "robot.pub"];
    let keys = names.map(read);
    for name in ["auditor.pub", "robot.pub"] {
        fs::remove_file(folder.path().join(name)).unwrap();
    }
    demo_in(folder.path(), &["--out", "."]);
    assert_eq!(names.map(read), keys);
    let other = tempfile::tempdir().unwrap();
    selfneg().args(["keygen", "--out"]).arg(other.path()).assert().success();
    for name in ["auditor.pub", "robot.pub"] {
        let mine = read(name);
        fs::copy(other.path().join(name), folder.path().join(name)).unwrap();
        let told = refusal(selfneg().current_dir(folder.path()).args(["demo", "--out", "."]), folder.path());
        assert!(told.contains(&format!("{name}: it is not the public key of ")), "{told}");
        fs::write(folder.path().join(name), mine).unwrap();
    }
    fs::write(folder.path().join("robot.key"), "no key").unwrap();
    let told = refusal(selfneg().current_dir(folder.path()).args(["demo", "--out", "."]), folder.path());
    assert!(told.contains("robot.key: not a robot's private key"), "{told}");
}

#[test]
fn where_nothing_can_be_written_it_says_so() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("taken"), "").unwrap();
    for out in ["taken", "taken/below"] {
        let told = refusal(selfneg().current_dir(folder.path()).args(["demo", "--out", out]), folder.path());
        assert!(told.starts_with(&format!("{out}: cannot be written: ")), "{told}");
    }
    fs::create_dir_all(folder.path().join("out/decision.json")).unwrap();
    let told = refusal(selfneg().current_dir(folder.path()).args(["demo", "--out", "out"]), folder.path());
    assert!(told.starts_with("out/decision.json: cannot be written: "), "{told}");
    assert_eq!(fs::read_dir(folder.path().join("out")).unwrap().count(), 1, "a part is left over");
}
