//! `selfneg simulate --trace` and the demo's trace: complete, replayed without a difference,
//! the same twice, and readable when the run was killed, sealed or not.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use scaffold::program::selfneg;
use selfneg::seal::{AuditorKey, RobotPublicKey, SealState};
use selfneg::trace::{PersonalPart, Recording, open};
use serde_json::Value;

fn scenario(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/scenarios").join(format!("{name}.toml"))
}

fn complete(trace: &Path) -> Recording {
    let recording = Recording::read(&fs::read(trace).unwrap()).unwrap();
    assert!(recording.is_complete(), "{:?}", recording.damage);
    let replay = recording.replay().unwrap();
    assert!(replay.difference.is_none(), "{:?}", replay.difference);
    assert!(!replay.outputs.is_empty());
    recording
}

#[test]
fn every_scenario_leaves_a_trace_that_replays_and_is_the_same_twice() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["mall", "three_users", "emergency", "elevator", "withholding", "annotated"] {
        let traces = ["first", "second"].map(|which| folder.path().join(format!("{name}-{which}.mcap")));
        let mut decisions = 0;
        for trace in &traces {
            let output = selfneg()
                .arg("simulate")
                .arg(scenario(name))
                .args(["--json", "--plaintext", "--trace"])
                .arg(trace)
                .assert()
                .success()
                .get_output()
                .clone();
            let outcome: Value = serde_json::from_slice(&output.stdout).unwrap();
            decisions = outcome["decisions"].as_u64().unwrap();
        }
        assert_eq!(complete(&traces[0]).decisions(), decisions, "{name}");
        assert_eq!(fs::read(&traces[0]).unwrap(), fs::read(&traces[1]).unwrap(), "{name}");
    }
}

#[test]
fn the_demo_leaves_a_trace_of_its_decision() {
    let folder = tempfile::tempdir().unwrap();
    selfneg().args(["demo", "--out"]).arg(folder.path()).assert().success();
    let key = AuditorKey::parse_all(&fs::read_to_string(folder.path().join("auditor.key")).unwrap()).unwrap();
    let opened = open(&fs::read(folder.path().join("trace.mcap")).unwrap(), &key).unwrap();
    let replay = opened.recording.replay().unwrap();
    assert_eq!((opened.recording.decisions(), &opened.recording.damage, replay.difference), (1, &None, None));
    let SealState::Signed(report) = opened.seal else { panic!("{:?}", opened.seal) };
    assert_eq!((report.covered_decisions, report.complete, &report.faults[..]), (1, true, &[][..]));
    let robot = fs::read_to_string(folder.path().join("robot.pub")).unwrap();
    assert_eq!(report.key, RobotPublicKey::from_pem(&robot).unwrap());
}

/// The program is killed, without a chance to clean up, once the first decision can be read:
/// it can still be read then, and the trace does not pass for complete.
#[cfg(unix)]
#[test]
fn a_killed_run_leaves_the_decisions_made() {
    let folder = tempfile::tempdir().unwrap();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    // In real time: so Bob asks at once.
    let text = fs::read_to_string(scenario("mall"))
        .unwrap()
        .replace("when = { near = \"Bob\", within = 3.5 }", "when = { at = 1 }")
        .replace("answers-after = 1.5\n", "")
        .replace("\"../mall", &format!("\"{}/mall", examples.display()));
    let (file, trace) = (folder.path().join("hurried.toml"), folder.path().join("killed.mcap"));
    fs::write(&file, text).unwrap();
    selfneg().current_dir(folder.path()).arg("keygen").assert().success();
    let mut run = Command::new(assert_cmd::cargo::cargo_bin!("selfneg"))
        .arg("simulate")
        .arg(&file)
        .args(["--realtime", "--sign", "robot.key", "--seal", "auditor.pub", "--trace"])
        .arg(&trace)
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let key = AuditorKey::parse_all(&fs::read_to_string(folder.path().join("auditor.key")).unwrap()).unwrap();
    let readable = || fs::read(&trace).ok().and_then(|bytes| open(&bytes, &key).ok());
    let began = Instant::now();
    while readable().is_none_or(|opened| opened.recording.decisions() == 0) {
        assert!(began.elapsed() < Duration::from_secs(60), "no decision to be read within a minute");
        std::thread::sleep(Duration::from_millis(50));
    }
    run.kill().unwrap();
    run.wait().unwrap();
    let opened = readable().unwrap();
    let recording = &opened.recording;
    assert_eq!(recording.decisions(), 1);
    assert!(!recording.is_complete());
    assert_eq!((opened.privacy, recording.participants.len()), (PersonalPart::Open, 2));
    let replay = recording.replay().unwrap();
    assert!(replay.difference.is_none());
    assert!(replay.outputs.iter().any(|output| format!("{output:?}").contains("Decided {")));
    let SealState::Signed(report) = opened.seal else { panic!("{:?}", opened.seal) };
    assert_eq!((report.covered_decisions, report.complete, &report.faults[..]), (1, false, &[][..]));
}

/// A trace is not emptied for a scenario that cannot be run, and a trace that cannot be
/// written is an error.
#[test]
fn bad_input_costs_no_trace_and_a_full_disk_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let (trace, bad) = (folder.path().join("kept.mcap"), folder.path().join("bad.toml"));
    fs::write(&trace, "evidence").unwrap();
    fs::write(&bad, "name = 1").unwrap();
    selfneg().arg("simulate").arg(&bad).arg("--trace").arg(&trace).assert().code(2);
    assert_eq!(fs::read_to_string(&trace).unwrap(), "evidence");
    let nowhere = folder.path().join("bad.toml/trace.mcap");
    let output = selfneg()
        .arg("simulate")
        .arg(scenario("mall"))
        .arg("--trace")
        .arg(&nowhere)
        .assert()
        .code(2)
        .get_output()
        .clone();
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("trace.mcap: cannot be written"), "{told}");
    if Path::new("/dev/full").exists() {
        selfneg().arg("simulate").arg(scenario("mall")).args(["--trace", "/dev/full"]).assert().code(2);
    }
}
