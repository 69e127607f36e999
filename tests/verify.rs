//! `selfneg verify`: its document, its counterexamples run again, and what it refuses.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use scaffold::program::selfneg;
use serde_json::Value;

fn verified(arguments: &[&str]) -> Value {
    let output =
        selfneg().arg("verify").args(arguments).arg("--json").assert().success().get_output().clone();
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The published figures of the paper's domain, found by running the engine.
#[test]
fn the_papers_domain_is_counted_exactly() {
    let document = verified(&["termination", "--random", "0"]);
    assert_eq!(document["domain"]["dispositions"], 6);
    assert_eq!(document["domain"]["ranks"], serde_json::json!([1, 5]));
    assert_eq!(document["domain"]["pairs"], "1000000000000");
    for (count, figure) in [
        ("agreement_current", "414054505704"),
        ("agreement_interrupting", "449419405176"),
        ("no_agreement", "136526089120"),
        ("role_dependent", "35364899472"),
        ("suboptimal", "71439792922"),
    ] {
        assert_eq!(document["counts"][count], figure, "{count}");
    }
    assert_eq!(document["counts"]["max_regret"], 24);
    assert_eq!(document["counts"]["max_regret_agreed"], 18);
}

#[test]
fn every_variant_has_a_row_with_verdict_evidence_and_counterexample() {
    let document =
        verified(&["role-symmetry", "condorcet/unbeaten-service", "--dispositions", "3", "--ranks", "1..=2"]);
    assert_eq!(document["as_expected"], true);
    let rows = document["properties"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * 72);
    for row in rows {
        assert_eq!(row["verdict"], row["expected"], "{row}");
        assert!(row["cases"].as_str().unwrap().parse::<u128>().unwrap() > 0);
        assert!(!row["evidence"].as_array().unwrap().is_empty());
        assert_eq!(row["counterexample"].is_null(), row["verdict"] == "holds", "{row}");
    }
    let of = |variant: &str| rows.iter().find(|row| row["variant"] == variant).unwrap();
    assert_eq!(of("exhausted/per-condition/first-sender/first-come/w0")["verdict"], "fails");
    assert_eq!(of("exhausted/per-condition/surplus/first-come/w0")["verdict"], "holds");
    let engines: Vec<&str> = of("exhausted/per-condition/surplus/first-come/w0")["evidence"]
        .as_array()
        .unwrap()
        .iter()
        .map(|evidence| evidence["engine"].as_str().unwrap())
        .collect();
    assert_eq!(engines, ["sweep", "sweep", "enumeration", "random"]);
}

/// What refutes hide-proofness, written as folders and negotiated by the program: the user
/// who hides does not win at first, and wins then.
#[test]
fn a_written_counterexample_can_be_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let output = selfneg()
        .args([
            "verify",
            "hide-proofness",
            "--dispositions",
            "2",
            "--ranks",
            "0..=1",
            "--random",
            "0",
            "--write",
        ])
        .arg(folder.path())
        .assert()
        .success()
        .get_output()
        .clone();
    let told = String::from_utf8(output.stdout).unwrap();
    let commands: Vec<Vec<&str>> = told
        .lines()
        .filter_map(|line| line.trim().strip_prefix("selfneg negotiate "))
        .map(|arguments| arguments.split(' ').collect())
        .collect();
    assert_eq!(commands.len(), 2, "{told}");
    let outcome = |arguments: &[&str]| -> String {
        let output =
            selfneg().arg("negotiate").args(arguments).arg("--json").assert().success().get_output().clone();
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        document["outcome"].as_str().unwrap().to_owned()
    };
    let hider = if commands[1].iter().any(|word| word.ends_with("interrupting_altered")) {
        "interrupting"
    } else {
        "current"
    };
    assert_ne!(outcome(&commands[0]), hider, "{told}");
    assert_eq!(outcome(&commands[1]), hider, "{told}");
}

#[test]
fn the_table_says_what_was_established_how() {
    let output = selfneg()
        .args(["verify", "unanimity", "published/unbeaten-service", "--random", "0"])
        .args(["--dispositions", "3", "--ranks", "0..=2"])
        .assert()
        .success()
        .get_output()
        .clone();
    let told = String::from_utf8(output.stdout).unwrap();
    let steady = without_seconds(&told);
    insta::assert_snapshot!("two_properties", steady);
}

/// The text with every number of seconds replaced: they differ from run to run.
fn without_seconds(text: &str) -> String {
    text.lines()
        .map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            let steady: Vec<String> = words
                .iter()
                .enumerate()
                .map(|(nth, word)| {
                    let before_s = words.get(nth + 1).is_some_and(|next| next.trim_end_matches('.') == "s");
                    if before_s { "_".to_owned() } else { (*word).to_owned() }
                })
                .collect();
            format!("{}\n", steady.join(" "))
        })
        .collect()
}

#[test]
fn what_cannot_be_verified_is_refused() {
    for (arguments, words) in [
        (&["no-such-property"][..], "selfneg verify --list"),
        (&["--dispositions", "0"], "at least one disposition"),
        (&["--dispositions", "17"], "at most 16"),
        (&["--dispositions", "16", "--ranks", "0..=255"], "2^64 users"),
        (&["--ranks", "5..=1"], "expected A..=B"),
        (&["--ranks", "1-5"], "expected A..=B"),
        (&["--ranks", "1..=256"], "expected A..=B"),
    ] {
        let output = selfneg().arg("verify").args(arguments).assert().code(2).get_output().clone();
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.contains(words), "{arguments:?}: {told}");
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn the_list_names_every_property_once() {
    let output = selfneg().args(["verify", "--list"]).assert().success().get_output().clone();
    let told = String::from_utf8(output.stdout).unwrap();
    let names: Vec<&str> = told.lines().filter(|line| !line.starts_with(' ')).collect();
    assert_eq!(names.len(), 20 + 2 * 3);
    assert!(names.contains(&"decision-locality") && names.contains(&"published/unbeaten-service"));
}
