//! `selfneg lint`: each kind of finding on a smallest case, through the program.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::path::Path;

use assert_cmd::Command;
use scaffold::folders::Place;
use scaffold::program::{document, negotiate, selfneg};
use serde_json::{Value, json};

/// Rules and a user of whom there is nothing to say.
fn clean() -> Place {
    let place = Place::of_letters();
    place
        .write("disposition_activation.json", r#"{"a": ["da"], "b": ["db"]}"#)
        .write("ethical_implications.json", r#"{"t1": ["da", "db"]}"#)
        .write("U/ethic_profiles.json", r#"{"here": {"da": 1, "db": 5}}"#)
        .write("U/user_status.json", r#"{"a": true, "b": false}"#)
        .write("U/context.json", r#"{"location": "here"}"#)
        .write("U/goal.json", r#"{"goal": "t1"}"#);
    place
}

fn lint(place: &Place) -> Command {
    let mut command = selfneg();
    command.current_dir(place.path()).args(["lint", "--rules", ".", "U"]);
    command
}

/// The findings as `file kind: names`, of the clean case with one file replaced.
fn findings_with(file: &str, text: &str) -> Vec<String> {
    let place = clean();
    place.write(file, text);
    findings(&place)
}

fn findings(place: &Place) -> Vec<String> {
    let code = lint(place).output().unwrap().status.code().unwrap();
    let report = document(&mut lint(place), code);
    let found = report["findings"].as_array().unwrap();
    assert_eq!(code, i32::from(!found.is_empty()));
    found.iter().map(told).collect()
}

fn told(finding: &Value) -> String {
    let names: Vec<&str> =
        finding["names"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let file = finding["file"].as_str().unwrap();
    let file = file.strip_prefix("./").unwrap_or(file);
    format!("{file} {}: {}", finding["kind"].as_str().unwrap(), names.join(", "))
}

#[test]
fn there_is_nothing_to_say_of_the_mall() {
    let mall = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/mall");
    selfneg()
        .current_dir(&mall)
        .args(["lint", "--rules", ".", "Alice", "Bob"])
        .assert()
        .code(0)
        .stdout("The rules and 2 users: nothing stands out.\n")
        .stderr("");
    let report = document(selfneg().current_dir(&mall).args(["lint", "--rules", ".", "Alice"]), 0);
    assert_eq!(report, json!({"users": 1, "findings": []}));
}

#[test]
fn there_is_nothing_to_say_of_the_clean_case() {
    assert_eq!(findings(&clean()), Vec::<String>::new());
}

#[test]
fn rules_alone_are_linted() {
    let place = clean();
    let rules_only = |place: &Place| {
        let mut command = selfneg();
        command.current_dir(place.path()).args(["lint", "--rules", "."]);
        command
    };
    rules_only(&place).assert().code(0).stdout("The rules and 0 users: nothing stands out.\n");
    place.write("ethical_implications.json", r#"{"t1": ["da"]}"#);
    rules_only(&place).assert().code(1);
}

#[test]
fn conditions_that_no_rule_activates() {
    let status = "U/user_status.json";
    let expected = ["U/user_status.json condition-not-activated: s1, s2"];
    assert_eq!(findings_with(status, r#"{"s1": false, "a": true, "s2": true}"#), expected);
    // What is withheld stays so, and "end of goal" has its own meaning.
    assert!(findings_with(status, r#"{"a": true, "s3": null, "end of goal": true}"#).is_empty());
}

#[test]
fn a_condition_listed_with_nothing_is_not_activated() {
    let place = clean();
    place
        .write("disposition_activation.json", r#"{"a": ["da"], "b": ["db"], "c": [], "end of goal": []}"#)
        .write("U/user_status.json", r#"{"a": true, "c": true, "end of goal": true}"#);
    assert_eq!(findings(&place), ["U/user_status.json condition-not-activated: c"]);
}

#[test]
fn dispositions_that_no_condition_activates() {
    let place = clean();
    place
        .write("ethical_implications.json", r#"{"t1": ["dz", "da"], "t2": ["db", "dz", "dy"]}"#)
        .write("U/ethic_profiles.json", r#"{"here": {"da": 1, "db": 5, "dy": 1, "dz": 1}}"#);
    assert_eq!(findings(&place), ["ethical_implications.json disposition-not-activated: dz, dy"]);
}

#[test]
fn dispositions_that_no_goal_implies() {
    assert_eq!(
        findings_with("ethical_implications.json", r#"{"t1": ["db"]}"#),
        ["disposition_activation.json disposition-not-implied: da"]
    );
}

#[test]
fn a_list_that_names_a_disposition_twice() {
    assert_eq!(
        findings_with("disposition_activation.json", r#"{"a": ["da", "db", "da"], "b": ["db"]}"#),
        ["disposition_activation.json disposition-repeated: a: da"]
    );
    assert_eq!(
        findings_with("ethical_implications.json", r#"{"t1": ["da", "db", "db"]}"#),
        ["ethical_implications.json disposition-repeated: t1: db"]
    );
}

#[test]
fn a_disposition_twice_under_a_goal_counts_twice_as_the_finding_says() {
    let place = Place::of_letters();
    place.user("C", "b", "a2 b3").user("I", "a", "a1");
    let value = |place: &Place| {
        let decision = document(&mut negotiate(place, &["C", "I"], &[]), 0);
        decision["negotiations"][0]["transcript"][0]["value"].as_u64().unwrap()
    };
    assert_eq!(value(&place), 2);
    place.write("ethical_implications.json", r#"{"t1": ["da", "db", "da"]}"#);
    assert_eq!(value(&place), 4);
    // In an activation list it does not.
    place.write("ethical_implications.json", r#"{"t1": ["da", "db"]}"#);
    place.write("disposition_activation.json", r#"{"a": ["da", "da"], "b": ["db"]}"#);
    assert_eq!(value(&place), 2);
}

#[test]
fn dispositions_missing_from_the_profile() {
    assert_eq!(
        findings_with("disposition_activation.json", r#"{"a": ["da", "dc"], "b": ["db"]}"#),
        [
            "disposition_activation.json disposition-not-implied: dc",
            "U/ethic_profiles.json disposition-not-ranked: dc"
        ]
    );
    assert_eq!(
        findings_with("U/ethic_profiles.json", r#"{"here": {"db": 5}}"#),
        ["U/ethic_profiles.json disposition-not-ranked: da"]
    );
}

#[test]
fn ranks_for_what_no_rule_names() {
    assert_eq!(
        findings_with("U/ethic_profiles.json", r#"{"here": {"da": 1, "typo": 2, "db": 5}}"#),
        ["U/ethic_profiles.json rank-without-rule: typo"]
    );
}

#[test]
fn all_ranks_equal() {
    assert_eq!(
        findings_with("U/ethic_profiles.json", r#"{"here": {"da": 3, "db": 3}}"#),
        ["U/ethic_profiles.json ranks-all-equal: 3"]
    );
}

#[test]
fn ranks_outside_the_scale() {
    assert_eq!(
        findings_with("U/ethic_profiles.json", r#"{"here": {"da": 0, "db": 6}}"#),
        ["U/ethic_profiles.json rank-outside-scale: da = 0, db = 6"]
    );
}

#[test]
fn only_the_active_profile_counts() {
    let profiles = r#"{"there": {"da": 0}, "here": {"da": 1, "db": 5}}"#;
    assert!(findings_with("U/ethic_profiles.json", profiles).is_empty());
}

#[test]
fn a_goal_that_is_not_listed() {
    assert_eq!(findings_with("U/goal.json", r#"{"goal": "moon"}"#), ["U/goal.json goal-not-listed: moon"]);
    let place = clean();
    std::fs::remove_file(place.of("U/goal.json")).unwrap();
    assert!(findings(&place).is_empty());
}

#[test]
fn a_user_with_nothing_to_offer() {
    for status in ["{}", r#"{"a": false, "b": null}"#, r#"{"end of goal": true}"#] {
        let expected = ["U/user_status.json nothing-to-offer: "];
        assert_eq!(findings_with("U/user_status.json", status), expected, "{status}");
    }
}

#[test]
fn findings_are_told_one_a_line_and_counted() {
    let place = clean();
    place.write("U/ethic_profiles.json", r#"{"here": {"da": 0, "db": 0}}"#);
    let output = lint(&place).assert().code(1).stderr("").get_output().clone();
    insta::assert_snapshot!("two_findings", String::from_utf8(output.stdout).unwrap());
    let report = document(&mut lint(&place), 1);
    assert_eq!(report["users"], 1);
    assert_eq!(
        report["findings"][1],
        json!({"file": "U/ethic_profiles.json", "kind": "ranks-all-equal", "names": ["0"],
               "message": "U/ethic_profiles.json: all ranks are equal, so the profile prefers nothing: 0"})
    );
}

#[test]
fn many_names_are_shortened() {
    let place = clean();
    let status: Vec<String> = (1..=9).map(|n| format!("\"s{n}\": true")).collect();
    place.write("U/user_status.json", &format!("{{{}}}", status.join(",")));
    let output = lint(&place).assert().code(1).get_output().clone();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("disclosed without effect: s1, s2, ... s9 (9 in all)\n"), "{text}");
    assert!(findings(&place)[0].ends_with("s1, s2, s3, s4, s5, s6, s7, s8, s9"));
}

#[test]
fn negotiate_warns_of_the_same() {
    let place = clean();
    place
        .write("U/user_status.json", r#"{"a": true, "s1": true}"#)
        .write("V/ethic_profiles.json", r#"{"here": {"da": 0, "db": 5}}"#)
        .write("V/user_status.json", r#"{"b": true}"#)
        .write("V/context.json", r#"{"location": "here"}"#)
        .write("V/goal.json", r#"{"goal": "t1"}"#);
    let linted = selfneg()
        .current_dir(place.path())
        .args(["lint", "--rules", ".", "U", "V"])
        .assert()
        .code(1)
        .get_output()
        .clone();
    let linted = String::from_utf8(linted.stdout).unwrap();
    let expected: String = linted
        .lines()
        .filter(|line| !line.starts_with("The rules and"))
        .map(|line| format!("warning: {line}\n"))
        .collect();
    assert_eq!(expected.lines().count(), 2);
    negotiate(&place, &["U", "V"], &[]).assert().code(0).stderr(expected);
}
