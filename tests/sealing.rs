//! `selfneg keygen`, `simulate --sign --seal`, `unseal` and `erase`, through the program.
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
use selfneg::seal::{AuditorKey, RobotKey, RobotPublicKey, SealState};
use selfneg::trace::{PersonalPart, Recording, Scan, open};
use tempfile::TempDir;

/// A folder with keys.
fn keys() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    within(&folder).arg("keygen").assert().success().stderr("");
    folder
}

/// The program, run in a folder.
fn within(folder: &TempDir) -> Command {
    let mut command = selfneg();
    command.current_dir(folder.path());
    command
}

/// What the program prints, which must end well.
fn printed(command: &mut Command) -> String {
    String::from_utf8(command.assert().success().get_output().stdout.clone()).unwrap()
}

fn mall() -> String {
    format!("{}/examples/scenarios/mall.toml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn keygen_tells_what_each_key_is_for() {
    let folder = tempfile::tempdir().unwrap();
    insta::assert_snapshot!("keygen", printed(within(&folder).args(["keygen", "--out", "new/keys"])));
}

#[cfg(unix)]
#[test]
fn secret_keys_can_be_read_by_their_owner_alone() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = keys();
    for (name, private) in
        [("robot.key", true), ("robot.pub", false), ("auditor.key", true), ("auditor.pub", false)]
    {
        let mode = fs::metadata(folder.path().join(name)).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode == 0o600, private, "{name}: {mode:o}");
    }
}

#[test]
fn no_key_is_ever_replaced_and_no_half_set_written() {
    for there in ["robot.key", "robot.pub", "auditor.key", "auditor.pub"] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(there), "mine").unwrap();
        let told = refusal(within(&folder).arg("keygen"), folder.path());
        assert!(told.contains(there), "{told}");
        assert_eq!(fs::read_to_string(folder.path().join(there)).unwrap(), "mine");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "{there}");
    }
}

#[test]
fn one_pair_can_be_made_alone() {
    for (only, other) in [("robot", "auditor"), ("auditor", "robot")] {
        let folder = tempfile::tempdir().unwrap();
        within(&folder).args(["keygen", "--only", only]).assert().success();
        assert!(folder.path().join(format!("{only}.key")).exists());
        assert!(!folder.path().join(format!("{other}.key")).exists());
    }
}

#[test]
fn the_key_files_fit_together() {
    let folder = keys();
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let robot = RobotKey::from_pem(&read("robot.key")).unwrap();
    assert_eq!(robot.public(), RobotPublicKey::from_pem(&read("robot.pub")).unwrap());
    let auditor = AuditorKey::parse_all(&read("auditor.key")).unwrap();
    assert_eq!(auditor[0].public().to_string(), read("auditor.pub").trim());
}

/// If there is an OpenSSL to ask.
#[test]
fn openssl_reads_the_robots_keys() {
    let folder = keys();
    let openssl = |flags: &[&str]| {
        std::process::Command::new("openssl").arg("pkey").args(flags).current_dir(folder.path()).output()
    };
    let Ok(public) = openssl(&["-in", "robot.key", "-pubout"]) else { return };
    assert!(public.status.success(), "{}", String::from_utf8_lossy(&public.stderr));
    assert_eq!(public.stdout, fs::read(folder.path().join("robot.pub")).unwrap());
    let ours = openssl(&["-pubin", "-in", "robot.pub", "-noout"]).unwrap();
    assert!(ours.status.success());
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let folder = keys();
    let scenario = mall();
    for (flags, named) in [
        (&["--sign", "robot.key"][..], "--trace"),
        (&["--seal", "auditor.pub"], "--trace"),
        (&["--plaintext"], "--trace"),
        (&["--trace", "out.mcap", "--plaintext", "--seal", "auditor.pub"], "--plaintext"),
    ] {
        let output = within(&folder).args(["simulate", &scenario]).args(flags).assert().code(2);
        let told = String::from_utf8(output.get_output().stderr.clone()).unwrap();
        assert!(told.contains(named), "{told}");
    }
    fs::write(folder.path().join("empty.pub"), "# nobody\n").unwrap();
    for (flags, expected) in [
        (
            ["--sign", "robot.pub"],
            "robot.pub: not a robot's private key, expected an Ed25519 key as PKCS#8 PEM",
        ),
        (["--sign", "none.key"], "none.key: "),
        (["--seal", "auditor.key"], "auditor.key: line 2: not an auditor's public key, expected age1...: "),
        (["--seal", "robot.pub"], "robot.pub: line 1: not an auditor's public key"),
        (["--seal", "empty.pub"], "empty.pub: it holds no key, expected one a line"),
    ] {
        let mut command = within(&folder);
        let told =
            refusal(command.args(["simulate", &scenario, "--trace", "out.mcap"]).args(flags), folder.path());
        assert!(told.starts_with(expected), "{told}");
        assert!(!folder.path().join("out.mcap").exists());
    }
}

#[test]
fn without_a_word_on_privacy_what_is_personal_is_left_out_with_a_warning() {
    let folder = keys();
    let run = within(&folder).args(["simulate", &mall(), "--trace", "out.mcap"]).assert().success();
    let told = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    assert!(told.contains("--seal") && told.contains("--plaintext"), "{told}");
    let opened = open(&fs::read(folder.path().join("out.mcap")).unwrap(), &[]).unwrap();
    assert_eq!((opened.privacy, opened.seal), (PersonalPart::LeftOut, SealState::Unsigned));
}

/// Every name and number of this scenario occurs nowhere else.
fn canaries(folder: &TempDir) -> Vec<&'static str> {
    let write = |name: &str, text: &str| {
        let file = folder.path().join(name);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, text).unwrap();
    };
    write(
        "rules/disposition_activation.json",
        r#"{"canary-condition-one": ["canary-disposition-one"], "canary-condition-two": ["canary-disposition-two"]}"#,
    );
    write(
        "rules/ethical_implications.json",
        r#"{"canary-goal": ["canary-disposition-one", "canary-disposition-two"], "canary-aid": []}"#,
    );
    write(
        "scenario.toml",
        r#"
name = "canary-scenario"
about = "canary-about"
building = "mall"
start = "charging station"
rules = "rules"

[mission]
capabilities = ["canary-capability"]
[[mission.goals]]
name = "canary-goal"
needs = ["canary-capability"]
tasks = [{ name = "canary-task", interruptible = true, actions = ["canary-action", "canary-lead"] }]
implications = [{ attribute = "canary-attribute", value = "canary-value", dispositions = ["canary-disposition-one"] }]
[[mission.goals]]
name = "canary-aid"
tasks = [{ name = "canary-help", interruptible = false, actions = ["canary-action"] }]
[[mission.emergencies]]
name = "canary-emergency"
gravity = 5
proof = "sensed"
goal = "canary-aid"
[[mission.inferences]]
attribute = "canary-crowd"
value = "canary-dense"
condition = "canary-condition-two"
[mission.normative.canary-location]
"canary-disposition-two" = 3

[actions]
"canary-action" = "meet"
"canary-lead" = { say = "canary-speech" }

[[users]]
name = "canary-current"
stands = { x = 24.6, y = 3.4 }
profiles.canary-location = { "canary-disposition-one" = 201, "canary-disposition-two" = 202 }
context = { location = "canary-location" }
[users.status]
"canary-condition-one" = true
"canary-own-condition" = true

[[users]]
name = "canary-interrupter"
stands = { x = 12.4, y = 5.4 }
profiles.canary-location = { "canary-disposition-one" = 203, "canary-disposition-two" = 204 }
context = { location = "canary-location" }
[users.status]
"canary-condition-two" = true

[[people]]
name = "canary-passer-by"
stands = { x = 6.6, y = 7.4 }

[[requests]]
user = "canary-current"
goal = "canary-goal"
meet = "flowers"
when = { at = 1 }
[[requests]]
user = "canary-interrupter"
goal = "canary-goal"
meet = "information"
when = { at = 3 }
[[updates]]
user = "canary-interrupter"
context = { canary-crowd = "canary-dense" }
when = { at = 4 }
[[emergencies]]
category = "canary-emergency"
place = "bakery"
evidence = "claimed"
when = { at = 6 }
"#,
    );
    vec![
        "canary-condition-one",
        "canary-condition-two",
        "canary-own-condition",
        "canary-disposition-one",
        "canary-disposition-two",
        "canary-goal",
        "canary-aid",
        "canary-scenario",
        "canary-capability",
        "canary-task",
        "canary-action",
        "canary-attribute",
        "canary-value",
        "canary-help",
        "canary-emergency",
        "canary-crowd",
        "canary-dense",
        "canary-location",
        "canary-current",
        "canary-interrupter",
        "canary-passer-by",
        "flowers",
        "information",
        "bakery",
    ]
}

/// The whole file as it is, and everything in it decompressed.
fn everything(bytes: &[u8]) -> Vec<u8> {
    let scan = Scan::of(bytes);
    assert_eq!(scan.damage, None);
    let mut all = bytes.to_vec();
    all.extend(format!("{:?}", scan.notes).into_bytes());
    for message in scan.messages {
        all.extend(message.topic.as_bytes());
        all.extend(format!("{:?}", message.channel.metadata).into_bytes());
        all.extend(message.data);
    }
    all
}

fn holds(all: &[u8], what: &str) -> bool {
    all.windows(what.len()).any(|window| window == what.as_bytes())
}

#[test]
fn no_canary_is_found_in_a_sealed_trace_and_every_one_in_the_clear_copy() {
    let folder = keys();
    let canaries = canaries(&folder);
    let simulate = |flags: &[&str]| {
        let mut command = within(&folder);
        command.args(["simulate", "scenario.toml", "--json"]).args(flags).assert().success();
    };
    simulate(&["--trace", "sealed.mcap", "--sign", "robot.key", "--seal", "auditor.pub"]);
    simulate(&["--trace", "left-out.mcap", "--sign", "robot.key"]);
    simulate(&["--trace", "plain.mcap", "--plaintext"]);
    let unseal = ["unseal", "sealed.mcap", "--identity", "auditor.key", "--out", "clear.mcap"];
    within(&folder).args(unseal).assert().success().stderr("");
    let read = |name: &str| everything(&fs::read(folder.path().join(name)).unwrap());
    for name in ["sealed.mcap", "left-out.mcap"] {
        let all = read(name);
        assert!(!holds(&all, "canary"), "{name}");
        for canary in &canaries {
            assert!(!holds(&all, canary), "{canary} in {name}");
        }
    }
    for name in ["plain.mcap", "clear.mcap"] {
        let all = read(name);
        for canary in &canaries {
            assert!(holds(&all, canary), "{canary} not in {name}");
        }
    }
    // Ranks are numbers: none of the four is the value of any field in the open.
    let sealed = fs::read(folder.path().join("sealed.mcap")).unwrap();
    let ranks = |messages: Vec<selfneg::trace::Message>| {
        let bytes = |rank: u8| [0x10, rank | 0x80, 1];
        let texts = messages.into_iter().filter(|one| one.schema.contains("selfneg"));
        let texts: Vec<_> = texts.filter(|one| !one.topic.starts_with("/sealed/")).collect();
        let found =
            |rank: &u8| texts.iter().any(|one| one.data.windows(3).any(|window| window == bytes(*rank)));
        [201, 202, 203, 204].into_iter().filter(found).count()
    };
    assert_eq!(ranks(Scan::of(&sealed).messages), 0);
    assert_eq!(ranks(Scan::of(&fs::read(folder.path().join("clear.mcap")).unwrap()).messages), 4);
}

#[test]
fn a_sealed_trace_is_unsealed_and_a_person_erased() {
    let folder = keys();
    let run = ["simulate", &mall(), "--trace", "out.mcap", "--sign", "robot.key", "--seal", "auditor.pub"];
    within(&folder).args(run).assert().success().stderr("");
    let told = refusal(
        within(&folder).args(["unseal", "out.mcap", "--identity", "robot.key", "-o", "clear.mcap"]),
        folder.path(),
    );
    assert!(
        told.starts_with("robot.key: line 1: not an auditor's private key, expected AGE-SECRET-KEY-1"),
        "{told}"
    );
    within(&folder).args(["keygen", "--only", "auditor", "--out", "other"]).assert().success();
    let told = refusal(
        within(&folder).args(["unseal", "out.mcap", "--identity", "other/auditor.key", "-o", "clear.mcap"]),
        folder.path(),
    );
    assert!(told.starts_with("out.mcap: none of the keys given opens it; it is sealed to age1"), "{told}");
    assert!(!folder.path().join("clear.mcap").exists());
    let unseal = ["unseal", "out.mcap", "--identity", "auditor.key", "-o", "clear.mcap"];
    insta::assert_snapshot!("unseal", printed(within(&folder).args(unseal)));
    let clear = Recording::read(&fs::read(folder.path().join("clear.mcap")).unwrap()).unwrap();
    assert!(clear.is_complete() && clear.replay().unwrap().difference.is_none());
    let told = refusal(
        within(&folder).args(["unseal", "clear.mcap", "--identity", "auditor.key", "-o", "x"]),
        folder.path(),
    );
    assert_eq!(told, "clear.mcap: it is not sealed: what is personal is in the open");

    let told = refusal(within(&folder).args(["erase", "out.mcap", "Bob"]), folder.path());
    assert_eq!(told, "out.mcap: Bob: nobody's data here are under this name, expected one of user-1, user-2");
    let told = refusal(within(&folder).args(["erase", "clear.mcap", "2"]), folder.path());
    assert!(told.starts_with("clear.mcap: it is not sealed, so nobody's data can be erased"), "{told}");
    let before = fs::read(folder.path().join("out.mcap")).unwrap();
    within(&folder).args(["erase", "out.mcap", "2", "--out", "apart.mcap"]).assert().success();
    assert_eq!(fs::read(folder.path().join("out.mcap")).unwrap(), before);
    let erase = ["erase", "out.mcap", "Bob", "--identity", "auditor.key"];
    insta::assert_snapshot!("erase", printed(within(&folder).args(erase)));
    let key = AuditorKey::parse_all(&fs::read_to_string(folder.path().join("auditor.key")).unwrap()).unwrap();
    for name in ["out.mcap", "apart.mcap"] {
        let opened = open(&fs::read(folder.path().join(name)).unwrap(), &key).unwrap();
        assert_eq!(opened.erased, ["several", "user-2"]);
        let SealState::Signed(report) = opened.seal else { panic!() };
        assert_eq!((report.complete, &report.faults[..]), (true, &[][..]));
    }
    insta::assert_snapshot!("erase_again", printed(within(&folder).args(["erase", "out.mcap", "user-2"])));
    let run = within(&folder).args(unseal).assert().success();
    let told = String::from_utf8(run.get_output().stderr.clone()).unwrap();
    assert_eq!(told, "warning: out.mcap: erased: what shows several people at once, user-2\n");
}

/// What can be read of a cut trace is unsealed, and the exit code says that it is not all.
#[test]
fn a_cut_trace_is_unsealed_with_a_warning() {
    let folder = keys();
    let run = ["simulate", &mall(), "--trace", "out.mcap", "--sign", "robot.key", "--seal", "auditor.pub"];
    within(&folder).args(run).assert().success();
    let file = folder.path().join("out.mcap");
    let bytes = fs::read(&file).unwrap();
    fs::write(&file, &bytes[..bytes.len() - bytes.len() / 4]).unwrap();
    let unseal = ["unseal", "out.mcap", "--identity", "auditor.key", "-o", "clear.mcap"];
    let output = within(&folder).args(unseal).assert().code(1).get_output().clone();
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.starts_with("warning: out.mcap: truncated: "), "{told}");
    let clear = Recording::read(&fs::read(folder.path().join("clear.mcap")).unwrap()).unwrap();
    assert!(!clear.is_complete() && clear.participants.len() == 2);
    within(&folder).args(["erase", "out.mcap", "1"]).assert().success();
}

#[cfg(unix)]
#[test]
fn the_clear_copy_is_its_owners() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = keys();
    within(&folder)
        .args(["simulate", &mall(), "--trace", "out.mcap", "--seal", "auditor.pub"])
        .assert()
        .success();
    let clear = folder.path().join("clear.mcap");
    fs::write(&clear, "of everybody").unwrap();
    within(&folder)
        .args(["unseal", "out.mcap", "--identity", "auditor.key", "-o", "clear.mcap"])
        .assert()
        .success();
    assert_eq!(fs::metadata(&clear).unwrap().permissions().mode() & 0o777, 0o600);
    assert!(!Path::new(&folder.path().join(".clear.mcap.part")).exists());
}
