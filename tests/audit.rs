//! `selfneg audit`, through the program.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::fs;
use std::io::Read as _;
use std::path::Path;
use std::process::Stdio;

use assert_cmd::Command;
use scaffold::program::{refusal, selfneg};
use serde_json::Value;
use tempfile::TempDir;

/// A folder with keys and three sealed traces of the example scenarios.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    within(&folder).arg("keygen").assert().success();
    for scenario in ["mall", "three_users", "emergency"] {
        simulate(
            &folder,
            scenario,
            &format!("{scenario}.mcap"),
            &["--sign", "robot.key", "--seal", "auditor.pub"],
        );
    }
    folder
}

fn within(folder: &TempDir) -> Command {
    let mut command = selfneg();
    command.current_dir(folder.path());
    command
}

fn simulate(folder: &TempDir, scenario: &str, trace: &str, flags: &[&str]) {
    let file = format!("{}/examples/scenarios/{scenario}.toml", env!("CARGO_MANIFEST_DIR"));
    within(folder).args(["simulate", &file, "--json", "--trace", trace]).args(flags).assert().success();
}

const KEYS: [&str; 4] = ["--robot-key", "robot.pub", "--identity", "auditor.key"];

fn audit(folder: &TempDir, arguments: &[&str], code: i32) -> Value {
    let output =
        within(folder).arg("audit").args(arguments).arg("--json").assert().code(code).get_output().clone();
    serde_json::from_slice(&output.stdout).unwrap()
}

/// What people read of a trace that is not ok.
fn told(folder: &TempDir, arguments: &[&str]) -> String {
    let output = within(folder).arg("audit").args(arguments).assert().code(1).get_output().clone();
    String::from_utf8(output.stdout).unwrap()
}

/// What came of a property of the only trace.
fn result(found: &Value, name: &str) -> String {
    let properties = found["traces"][0]["properties"].as_array().unwrap();
    let property = properties.iter().find(|property| property["name"] == name).unwrap();
    property["result"].as_str().unwrap().to_owned()
}

/// The status of the only trace.
fn status(folder: &TempDir, arguments: &[&str]) -> String {
    let found = audit(folder, arguments, 1);
    assert_eq!(found["traces"].as_array().unwrap().len(), 1);
    found["traces"][0]["status"].as_str().unwrap().to_owned()
}

fn with<'a>(trace: &'a str, keys: &[&'a str]) -> Vec<&'a str> {
    [&[trace], keys].concat()
}

#[test]
fn the_whole_way() {
    let folder = folder();
    told_and_counted(&folder);
    json_has_its_shape(&folder);
    what_is_missing_is_told_apart(&folder);
    paths(&folder);
    a_closed_pipe_is_no_error(&folder);
}

/// What people read, but for the key, which is another one every time.
fn told_and_counted(folder: &TempDir) {
    let told = |arguments: &[&str], code: i32| {
        let output =
            within(folder).arg("audit").args(arguments).assert().code(code).stderr("").get_output().clone();
        let text = String::from_utf8(output.stdout).unwrap();
        let key = text.split("signed by ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
        text.replace(key, "KEY")
    };
    insta::assert_snapshot!("ok", told(&with("three_users.mcap", &KEYS), 0));
    insta::assert_snapshot!("without_identity", told(&with("three_users.mcap", &KEYS[..2]), 0));
    insta::assert_snapshot!("untrusted", told(&["emergency.mcap", "mall.mcap"], 1));
}

fn json_has_its_shape(folder: &TempDir) {
    let found = audit(folder, &[&["emergency.mcap", "mall.mcap"][..], &KEYS].concat(), 0);
    let traces = found["traces"].as_array().unwrap();
    assert_eq!(traces.len(), 2);
    let emergency = &traces[0];
    assert_eq!(emergency["file"], "emergency.mcap");
    assert_eq!(emergency["status"], "ok");
    assert_eq!((&emergency["decisions"], &emergency["redecided"]), (&Value::from(2), &Value::from(2)));
    assert_eq!(emergency["findings"], Value::Array(Vec::new()));
    assert_eq!(emergency["each_decision"][0]["outcome"], "emergency");
    let decision = &emergency["each_decision"][1];
    assert_eq!(decision["redecided"], "same");
    assert_eq!(decision["served"], "user-1");
    let welfare = &decision["welfare"];
    let number = |key: &str| welfare[key].as_u64().unwrap();
    assert_eq!(number("optimum") - number("served"), number("regret"));
    assert_eq!(emergency["seal"]["trusted"], true);
    assert!(emergency["properties"].as_array().unwrap().iter().all(|property| property["result"] == "held"));
    let without = audit(folder, &with("mall.mcap", &KEYS[..2]), 0);
    let mall = &without["traces"][0];
    assert_eq!((&mall["status"], &mall["redecided"]), (&Value::from("ok"), &Value::from(0)));
    assert_eq!(mall["each_decision"][0]["welfare"], Value::Null);
    assert_eq!(mall["unchecked"].as_array().unwrap().len(), 1);
}

fn what_is_missing_is_told_apart(folder: &TempDir) {
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    let whole = read("mall.mcap");
    write("cut.mcap", &whole[..whole.len() - 100]);
    assert_eq!(status(folder, &with("cut.mcap", &KEYS)), "truncated");
    let mut changed = whole.clone();
    let middle = changed.len() / 2;
    changed[middle] ^= 1;
    write("changed.mcap", &changed);
    assert_eq!(status(folder, &with("changed.mcap", &KEYS)), "tampered");
    simulate(folder, "mall", "plain.mcap", &["--plaintext"]);
    assert_eq!(status(folder, &with("plain.mcap", &KEYS)), "unsealed");
    simulate(folder, "mall", "signed.mcap", &["--sign", "robot.key", "--plaintext"]);
    assert_eq!(status(folder, &with("signed.mcap", &KEYS)), "unsealed");
    simulate(folder, "mall", "left-out.mcap", &["--sign", "robot.key"]);
    assert_eq!(status(folder, &with("left-out.mcap", &KEYS)), "incomplete");
    within(folder).args(["keygen", "--out", "others"]).assert().success();
    let other_auditor = ["--robot-key", "robot.pub", "--identity", "others/auditor.key"];
    assert_eq!(status(folder, &with("mall.mcap", &other_auditor)), "incomplete");
    assert_eq!(status(folder, &with("mall.mcap", &["--robot-key", "others/robot.pub"])), "untrusted");
    let said = told(folder, &with("mall.mcap", &other_auditor));
    assert!(said.contains("the identity given does not open the personal data"), "{said}");
    assert!(!said.contains("no identity was given"), "{said}");
    // Several keys: the right ones among them.
    let all = [&KEYS[..], &["--robot-key", "others/robot.pub", "--identity", "others/auditor.key"]].concat();
    audit(folder, &with("mall.mcap", &all), 0);
    write("erased.mcap", &whole);
    within(folder).args(["erase", "erased.mcap", "user-2"]).assert().success();
    let found = audit(folder, &with("erased.mcap", &KEYS), 1);
    assert_eq!(result(&found, "replay"), "held-in-part");
    assert_eq!(result(&found, "redecision"), "not-checked");
    assert_eq!(result(&found, "hard-ethics"), "nothing-to-check");
    let said = told(folder, &with("erased.mcap", &KEYS));
    assert!(said.contains("erased: what shows several people at once, user-2"), "{said}");
    assert!(said.contains("the personal data that show several people at once are erased"), "{said}");
    assert!(said.contains("\n  held as far as it could be checked: replay, commitments\n"), "{said}");
    assert_eq!(found["traces"][0]["status"], "incomplete");
    assert!(found["traces"][0]["erased"].as_array().unwrap().contains(&Value::from("user-2")));
    within(folder)
        .args(["unseal", "mall.mcap", "--identity", "auditor.key", "-o", "clear.mcap"])
        .assert()
        .success();
    let found = audit(folder, &with("clear.mcap", &KEYS), 1);
    assert_eq!(found["traces"][0]["status"], "unsealed");
    assert_eq!(found["traces"][0]["redecided"], 1);
}

fn paths(folder: &TempDir) {
    let here = |path: &str| folder.path().join(path);
    fs::create_dir_all(here("all/below")).unwrap();
    fs::create_dir_all(here("empty")).unwrap();
    for (from, to) in
        [("mall", "all/b.mcap"), ("emergency", "all/below/c.mcap"), ("three_users", "all/a.mcap")]
    {
        fs::copy(here(&format!("{from}.mcap")), here(to)).unwrap();
    }
    // Whatever the case of the ending.
    fs::copy(here("mall.mcap"), here("all/below/d.MCAP")).unwrap();
    fs::write(here("all/notes.txt"), "no trace").unwrap();
    fs::write(here("other.mcap"), "no trace").unwrap();
    let files = |found: &Value| -> Vec<String> {
        let traces = found["traces"].as_array().unwrap();
        traces.iter().map(|trace| trace["file"].as_str().unwrap().to_owned()).collect()
    };
    // A folder sorted, arguments in their order.
    let found = audit(folder, &[&["mall.mcap", "all"][..], &KEYS].concat(), 0);
    assert_eq!(
        files(&found),
        ["mall.mcap", "all/a.mcap", "all/b.mcap", "all/below/c.mcap", "all/below/d.MCAP"]
    );
    // What is no trace among traces is a failure; alone it is unusable.
    let found = audit(folder, &[&["other.mcap", "mall.mcap"][..], &KEYS].concat(), 1);
    assert_eq!(found["traces"][0]["status"], "unreadable");
    let found = audit(folder, &with("other.mcap", &KEYS), 2);
    assert_eq!(found["traces"][0]["status"], "unreadable");
    // What is not there is told, and the rest audited all the same.
    let arguments = [&["audit", "nowhere.mcap", "mall.mcap", "--json"][..], &KEYS].concat();
    let output = within(folder).args(&arguments).assert().code(2).get_output().clone();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(files(&found), ["nowhere.mcap", "mall.mcap"]);
    assert_eq!(
        (&found["traces"][0]["status"], &found["traces"][1]["status"]),
        (&"unreadable".into(), &"ok".into())
    );
    let what = found["traces"][0]["findings"][0]["what"].as_str().unwrap();
    assert!(what.starts_with("cannot be read: "), "{what}");
    let found = audit(folder, &["nowhere.mcap", "empty"], 2);
    assert_eq!(files(&found), ["nowhere.mcap", "empty"]);
    assert!(String::from_utf8(output.stderr).unwrap().starts_with("warning: nowhere.mcap"), "no warning");
    // Their names are no lines of ours.
    if cfg!(unix) {
        let name = "x\n1 trace: 1 ok\u{1b}[8m\u{202e}.mcap";
        fs::copy(here("other.mcap"), here(name)).unwrap();
        let output = within(folder).args(["audit", "mall.mcap", name, "nor\u{202e}.mcap"]).output().unwrap();
        for said in [output.stdout, output.stderr] {
            let said = String::from_utf8(said).unwrap();
            assert!(said.contains(r"\u{202e}.mcap"), "{said}");
            assert!(!said.contains(['\u{1b}', '\u{202e}']) && !said.contains("\n1 trace: 1 ok"), "{said}");
        }
        fs::remove_file(here(name)).unwrap();
    }
    let refused = |arguments: &[&str]| refusal(within(folder).arg("audit").args(arguments), Path::new("."));
    assert!(refused(&["nowhere.mcap"]).starts_with("nowhere.mcap"));
    assert!(refused(&["empty"]).starts_with("empty: no trace in this folder"));
    assert!(refused(&["mall.mcap", "--robot-key", "auditor.pub"]).starts_with("auditor.pub: not a robot's"));
    assert!(
        refused(&["mall.mcap", "--identity", "robot.key"]).starts_with("robot.key: line 1: not an auditor's")
    );
    within(folder).arg("audit").assert().code(2);
}

fn a_closed_pipe_is_no_error(folder: &TempDir) {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_selfneg"));
    command.current_dir(folder.path()).args(["audit", "all"]).args(KEYS);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let mut complaint = String::new();
    child.stderr.take().unwrap().read_to_string(&mut complaint).unwrap();
    assert_eq!((child.wait().unwrap().code(), complaint.as_str()), (Some(0), ""));
}
