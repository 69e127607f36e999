//! `selfneg negotiate`, through the program: the paper's example, what each option changes
//! on a smallest case, several interrupters, names and goals.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::collections::BTreeSet;

use scaffold::folders::Place;
use scaffold::program::{decided, negotiate, refusal, selfneg};
use serde_json::{Value, json};

/// Outcome, who is served, rounds.
fn ended(decision: &Value) -> (&str, &str, u64) {
    (
        decision["outcome"].as_str().unwrap(),
        decision["served"].as_str().unwrap(),
        decision["rounds"].as_u64().unwrap(),
    )
}

fn keys(object: &Value) -> BTreeSet<&str> {
    object.as_object().unwrap().keys().map(String::as_str).collect()
}

/// Everything that the transcripts disclose, in order.
fn disclosed(decision: &Value) -> Vec<&str> {
    let negotiations = decision["negotiations"].as_array().unwrap();
    let rounds = negotiations.iter().flat_map(|one| one["transcript"].as_array().unwrap());
    rounds.filter_map(|round| round["discloses"].as_str()).collect()
}

fn verdicts(decision: &Value) -> Vec<&str> {
    let rounds = decision["negotiations"][0]["transcript"].as_array().unwrap();
    rounds.iter().map(|round| round["verdict"].as_str().unwrap_or("-")).collect()
}

/// I offers a, C holds b. Neither would take the other's offer.
fn deadlock() -> Place {
    let place = Place::of_letters();
    place.user("C", "b", "a5 b5").user("I", "a", "a5 b1");
    place
}

/// Each would take the other's first offer; C gains `to_c` by it and I gains `to_i`.
fn mutual_deference(to_c: u8, to_i: u8) -> Place {
    let place = Place::of_letters();
    place.user("C", "b", &format!("a{to_c}")).user("I", "a", &format!("b{to_i}"));
    place
}

#[test]
fn alice_keeps_precedence_over_bob() {
    let place = Place::mall();
    let output = negotiate(&place, &["Alice", "Bob"], &["--json"]).assert().code(0).get_output().clone();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    let text = String::from_utf8(output.stdout).unwrap();
    let decision: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(ended(&decision), ("current", "Alice", 2));
    insta::assert_snapshot!("alice_and_bob_as_json", text);
}

#[test]
fn the_document_has_the_promised_keys() {
    let promised = ["outcome", "served", "rounds", "policy", "options", "negotiations"];
    let ours = ["variant", "candidates", "welfare"];
    let all: BTreeSet<&str> = promised.into_iter().chain(ours).collect();
    let agreement = decided(&Place::mall(), &["Alice", "Bob"], &[]);
    assert_eq!(keys(&agreement), all);
    let none = decided(&deadlock(), &["C", "I"], &[]);
    assert_eq!(keys(&none), all);
    assert_eq!(agreement["candidates"], serde_json::json!([]));
    assert_eq!(none["candidates"], serde_json::json!(["C", "I"]));
    for decision in [&agreement, &none] {
        assert_eq!(
            keys(&decision["options"]),
            BTreeSet::from(["quit", "aggregation", "tie", "fallback", "willingness"])
        );
        for negotiation in decision["negotiations"].as_array().unwrap() {
            assert_eq!(
                keys(negotiation),
                BTreeSet::from(["current", "interrupting", "outcome", "rounds", "transcript", "ending"])
            );
            for round in negotiation["transcript"].as_array().unwrap() {
                assert_eq!(
                    keys(round),
                    BTreeSet::from([
                        "round",
                        "sender",
                        "event",
                        "depth",
                        "discloses",
                        "value",
                        "threshold",
                        "verdict"
                    ])
                );
            }
        }
    }
    let quit = &none["negotiations"][0]["transcript"][2];
    assert_eq!(
        *quit,
        json!({"round": 3, "sender": "interrupting", "event": "quit", "depth": null, "discloses": null,
               "value": null, "threshold": null, "verdict": null})
    );
}

#[test]
fn literal_quit_ends_it_with_the_rejection() {
    let place = Place::of_letters();
    place.user("C", "b", "b1").user("I", "a", "b1");
    assert_eq!(ended(&decided(&place, &["C", "I"], &[])), ("current", "C", 2));
    let literal = decided(&place, &["C", "I"], &["--quit", "literal"]);
    assert_eq!(ended(&literal), ("no-agreement", "C", 1));
    assert_eq!(literal["variant"], "literal/per-condition/first-sender/first-come/w0");
}

#[test]
fn per_disposition_counts_a_disposition_once() {
    let place = Place::of_letters();
    place
        .write("disposition_activation.json", r#"{"a": ["da"], "b": ["da"], "c": ["dc"]}"#)
        .user("C", "c", "a2 c3")
        .user("I", "ab", "a1");
    assert_eq!(ended(&decided(&place, &["C", "I"], &[])), ("interrupting", "I", 3));
    let once = decided(&place, &["C", "I"], &["--aggregation", "per-disposition"]);
    assert_eq!(ended(&once), ("no-agreement", "C", 5));
    assert_eq!(once["negotiations"][0]["transcript"][2]["value"], 2);
}

#[test]
fn a_tie_goes_to_the_first_sender_or_to_nobody() {
    let place = mutual_deference(1, 1);
    assert_eq!(ended(&decided(&place, &["C", "I"], &[])), ("interrupting", "I", 1));
    let tie = decided(&place, &["C", "I"], &["--tie", "fallback"]);
    assert_eq!(ended(&tie), ("no-agreement", "C", 2));
    assert_eq!(verdicts(&tie), ["hold", "accept"]);
}

#[test]
fn a_tie_goes_to_the_offer_whose_receiver_gains_more() {
    let surplus = ["--tie", "surplus"];
    for (to_c, to_i, expected) in
        [(1, 2, ("current", "C", 2)), (2, 1, ("interrupting", "I", 2)), (2, 2, ("no-agreement", "C", 2))]
    {
        let place = mutual_deference(to_c, to_i);
        assert_eq!(ended(&decided(&place, &["C", "I"], &surplus)), expected, "{to_c} {to_i}");
    }
}

#[test]
fn a_held_offer_stands_if_the_reply_is_rejected() {
    let place = mutual_deference(1, 0);
    for tie in ["fallback", "surplus"] {
        let decision = decided(&place, &["C", "I"], &["--tie", tie]);
        assert_eq!(ended(&decision), ("interrupting", "I", 2), "{tie}");
        assert_eq!(verdicts(&decision), ["hold", "reject"], "{tie}");
        assert_eq!(decision["negotiations"][0]["ending"], "held-offer-stands");
    }
}

#[test]
fn the_utilitarian_fallback_serves_the_greater_welfare() {
    let place = deadlock();
    assert_eq!(ended(&decided(&place, &["C", "I"], &[])), ("no-agreement", "C", 4));
    let utilitarian = decided(&place, &["C", "I"], &["--fallback", "utilitarian"]);
    assert_eq!(ended(&utilitarian), ("no-agreement", "I", 4));
    assert_eq!(utilitarian["candidates"], json!(["C", "I"]));
}

#[test]
fn willingness_is_one_more_offer_and_n_on_the_own_one() {
    let place = Place::of_letters();
    place.user("C", "b", "a3 b1").user("I", "a", "a1");
    assert_eq!(ended(&decided(&place, &["C", "I"], &["--willingness", "1"])), ("interrupting", "I", 1));
    let two = decided(&place, &["C", "I"], &["--willingness", "2"]);
    assert_eq!(ended(&two), ("no-agreement", "C", 5));
    assert_eq!(disclosed(&two), ["a", "b", "end of goal"]);
    assert_eq!(two["negotiations"][0]["transcript"][0]["threshold"], 3);
    assert_eq!(two["options"]["willingness"], 2);
}

/// The current user of `willingness_is_one_more_offer_...` with a status of its own.
fn close_to_goal(status: &str) -> Place {
    let place = Place::of_letters();
    place.user_with_status("C", status, "a2 b1").user("I", "a", "a1");
    place
}

#[test]
fn end_of_goal_is_willingness_1_of_the_current_user() {
    let place = close_to_goal(r#"{"end of goal": true, "b": true}"#);
    let decision = decided(&place, &["C", "I"], &[]);
    assert_eq!(decision["options"]["willingness"], 1);
    assert_eq!(ended(&decision), ("no-agreement", "C", 5));
    assert_eq!(disclosed(&decision), ["a", "b", "end of goal"]);

    let told_otherwise = decided(&place, &["C", "I"], &["--willingness", "0"]);
    assert_eq!(told_otherwise["options"]["willingness"], 0);
    assert_eq!(ended(&told_otherwise), ("interrupting", "I", 1));
    let more = decided(&place, &["C", "I"], &["--willingness", "7"]);
    assert_eq!(more["options"]["willingness"], 7);
}

#[test]
fn end_of_goal_that_is_false_or_withheld_is_nothing() {
    for status in [r#"{"b": true, "end of goal": false}"#, r#"{"b": true, "end of goal": null}"#] {
        let decision = decided(&close_to_goal(status), &["C", "I"], &[]);
        assert_eq!(decision["options"]["willingness"], 0);
        assert_eq!(ended(&decision), ("interrupting", "I", 1));
    }
}

#[test]
fn an_interrupters_end_of_goal_is_left_out() {
    let place = Place::of_letters();
    place.user("C", "b", "a5 b5").user("I", "a", "a5 b1").user_with_status(
        "Iend",
        r#"{"a": true, "end of goal": true}"#,
        "a5 b1",
    );
    let without = decided(&place, &["C", "I"], &[]);
    let with = decided(&place, &["C", "Iend"], &[]);
    assert_eq!(with["negotiations"][0]["transcript"], without["negotiations"][0]["transcript"]);
    assert_eq!(with["options"]["willingness"], 0);
}

#[test]
fn among_three_only_the_current_user_has_willingness() {
    let place = Place::of_letters();
    // Both interrupters beat A, so B and C negotiate: B is current, and close to its goal.
    place
        .user("A", "a", "a1 b3 c3")
        .user_with_status("B", r#"{"b": true, "end of goal": true}"#, "b1")
        .user("C", "c", "c1");
    for flags in [&[][..], &["--willingness", "1"]] {
        let decision = decided(&place, &["A", "B", "C"], flags);
        assert_eq!(decision["negotiations"].as_array().unwrap().len(), 3);
        assert!(!disclosed(&decision).contains(&"end of goal"), "{flags:?}");
        let thresholds: Vec<u64> = (0..3)
            .map(|nth| decision["negotiations"][nth]["transcript"][0]["threshold"].as_u64().unwrap())
            .collect();
        let of_a = if flags.is_empty() { 1 } else { 2 };
        assert_eq!(thresholds, [of_a, of_a, 1], "{flags:?}");
        assert_eq!(decision["negotiations"][2]["rounds"], 4, "{flags:?}");
    }
}

#[test]
fn end_of_goal_is_ordinary_only_where_the_rules_activate_something_by_it() {
    let place = close_to_goal(r#"{"end of goal": true, "b": true}"#);
    place.write("disposition_activation.json", r#"{"a": ["da"], "b": ["db"], "end of goal": []}"#);
    assert_eq!(decided(&place, &["C", "I"], &[])["options"]["willingness"], 1);
    place.write("disposition_activation.json", r#"{"a": ["da"], "b": ["db"], "end of goal": ["dc"]}"#);
    let ordinary = decided(&place, &["C", "I"], &[]);
    assert_eq!(ordinary["options"]["willingness"], 0);
    place.write("disposition_activation.json", r#"{"a": ["da"], "b": ["db"], "end of goal": ["da"]}"#);
    assert_eq!(disclosed(&decided(&place, &["C", "I"], &[])), ["a", "end of goal", "b"]);
}

#[test]
fn what_is_withheld_is_never_disclosed() {
    let place = Place::of_letters();
    place.user_with_status("C", r#"{"secret": null, "b": true, "c": null}"#, "b5 c5").user_with_status(
        "I",
        r#"{"a": true, "e": null, "f": false}"#,
        "a5 e5",
    );
    let decision = decided(&place, &["C", "I"], &[]);
    assert_eq!(disclosed(&decision), ["a", "b"]);
    assert_eq!(decision["negotiations"][0]["transcript"][0]["threshold"], 5);
    let output = negotiate(&place, &["C", "I"], &[]).assert().code(0).get_output().clone();
    let said = [output.stdout, output.stderr].concat();
    assert!(!String::from_utf8(said).unwrap().contains("secret"));
}

#[test]
fn a_condition_without_a_rule_is_disclosed_and_worth_nothing() {
    let place = Place::of_letters();
    place.user_with_status("C", r#"{"b": true}"#, "b1").user_with_status("I", r#"{"tall": true}"#, "b0");
    let decision = decided(&place, &["C", "I"], &[]);
    assert_eq!(ended(&decision), ("no-agreement", "C", 4));
    assert_eq!(disclosed(&decision), ["tall", "b"]);
    let output = negotiate(&place, &["C", "I"], &[]).assert().code(0).get_output().clone();
    let warnings = String::from_utf8(output.stderr).unwrap();
    let expected =
        "warning: I/user_status.json: conditions that no rule activates, disclosed without effect: tall\n";
    assert!(warnings.contains(expected), "{warnings}");
}

#[test]
fn an_empty_status_quits_at_once() {
    let place = Place::of_letters();
    place.user("Nil", "", "a1").user("Nix", "", "").user("C", "b", "b1").user("I", "a", "a1");
    for (users, expected) in [
        (["C", "Nil"], ("no-agreement", "C", 3)),
        (["Nil", "I"], ("interrupting", "I", 1)),
        (["Nix", "I"], ("no-agreement", "Nix", 3)),
        (["Nil", "Nix"], ("no-agreement", "Nil", 2)),
    ] {
        let decision = decided(&place, &users, &[]);
        assert_eq!(ended(&decision), expected, "{users:?}");
    }
    let quits = decided(&place, &["C", "Nil"], &[]);
    assert_eq!(quits["negotiations"][0]["transcript"][0]["event"], "quit");
    assert_eq!(ended(&decided(&place, &["C", "Nil"], &["--quit", "literal"])), ("no-agreement", "C", 1));
}

/// Nobody decides between A and B, C beats A, B beats C.
fn chain() -> Place {
    let place = Place::of_letters();
    place.user("A", "a", "a1 c2").user("B", "b", "b1").user("C", "c", "b1");
    place
}

#[test]
fn three_users_are_decided_by_the_published_policy() {
    let decision = decided(&chain(), &["A", "B", "C"], &[]);
    assert_eq!(decision["policy"], "published");
    // A and B: four rounds without agreement. A and C: A accepts at once.
    assert_eq!(ended(&decision), ("interrupting_2", "C", 5));
    assert_eq!(decision["negotiations"].as_array().unwrap().len(), 2);
}

#[test]
fn condorcet_does_not_serve_whom_somebody_beats() {
    let decision = decided(&chain(), &["A", "B", "C"], &["--policy", "condorcet"]);
    assert_eq!(decision["policy"], "condorcet");
    assert_eq!(decision["candidates"], json!(["B"]));
    assert_eq!(ended(&decision), ("no-agreement", "B", 7));
}

#[test]
fn five_users_are_decided_by_condorcet() {
    let place = Place::of_letters();
    // Everybody defers to D, and D to nobody.
    place
        .user("A", "a", "a1 d2")
        .user("B", "b", "b1 d2")
        .user("C", "c", "c1 d2")
        .user("D", "d", "d1")
        .user("E", "e", "e1 d2");
    let users = ["A", "B", "C", "D", "E"];
    let decision = decided(&place, &users, &[]);
    assert_eq!(decision["policy"], "condorcet");
    assert_eq!(
        (decision["outcome"].as_str(), decision["served"].as_str()),
        (Some("interrupting_3"), Some("D"))
    );
    assert_eq!(decision["negotiations"].as_array().unwrap().len(), 10);
    let told = refusal(&mut negotiate(&place, &users, &["--policy", "published"]), place.path());
    assert!(told.contains("published") && told.contains("found 4") && told.contains("condorcet"), "{told}");
}

#[test]
fn either_policy_decides_between_two() {
    for policy in ["published", "condorcet"] {
        let decision = decided(&Place::mall(), &["Alice", "Bob"], &["--policy", policy]);
        assert_eq!(ended(&decision), ("current", "Alice", 2), "{policy}");
    }
}

#[test]
fn users_of_one_name_are_refused() {
    let place = deadlock();
    place.user("elsewhere/C", "b", "b1");
    for other in ["elsewhere/C", "C", "C/", "./C"] {
        let told = refusal(&mut negotiate(&place, &["C", other], &[]), place.path());
        assert!(told.contains(other) && told.contains("\"C\"") && told.contains("different names"), "{told}");
    }
}

#[test]
fn a_folder_is_named_by_its_own_name_however_it_is_given() {
    let place = deadlock();
    for (current, interrupting) in [("C/", "I/"), ("./C", "./I"), ("I/../C", "C/../I")] {
        let decision = decided(&place, &[current, interrupting], &[]);
        assert_eq!(decision["served"], "C");
        assert_eq!(decision["negotiations"][0]["interrupting"], "I");
    }
    let output = selfneg()
        .current_dir(place.of("C"))
        .args(["negotiate", "--rules", "..", "--current", ".", "--interrupting", "../I", "--json"])
        .assert()
        .code(0)
        .get_output()
        .clone();
    let decision: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(decision["served"], "C");
}

#[test]
fn an_unlisted_goal_is_an_error_that_lists_the_listed_ones() {
    let place = deadlock();
    place.write("C/goal.json", r#"{"goal": "tea"}"#);
    let told = refusal(&mut negotiate(&place, &["C", "I"], &[]), place.path());
    assert_eq!(
        told,
        "C/goal.json: goal \"tea\" is not listed, expected one of \"t1\", \"t2\" of ./ethical_implications.json"
    );
    let told = refusal(&mut negotiate(&place, &["I", "C"], &["--interrupting-goal", "soup"]), place.path());
    assert!(told.starts_with("--interrupting-goal: goal \"soup\" is not listed, expected one of"), "{told}");
    let told = refusal(&mut negotiate(&place, &["C", "I"], &["--current-goal", ""]), place.path());
    assert!(told.starts_with("--current-goal: goal \"\" is not listed"), "{told}");
}

#[test]
fn options_override_the_goals_files() {
    let place = Place::of_letters();
    // Only t2 implies what C would accept.
    place
        .write("ethical_implications.json", r#"{"t1": ["db"], "t2": ["da", "db"]}"#)
        .user("C", "b", "a2 b1")
        .user("I", "a", "a1")
        .user("J", "a", "a1");
    assert_eq!(ended(&decided(&place, &["C", "I"], &[])).0, "no-agreement");
    assert_eq!(ended(&decided(&place, &["C", "I"], &["--interrupting-goal", "t2"])).0, "interrupting");
    // C's own offer is worth nothing to anyone under a goal that implies nothing of it.
    place.write("ethical_implications.json", r#"{"t1": ["db"], "t2": ["da", "db"], "t3": []}"#);
    let flags = ["--current-goal", "t3", "--interrupting-goal", "t2"];
    assert_eq!(decided(&place, &["C", "I"], &flags)["negotiations"][0]["transcript"][0]["threshold"], 0);

    let one_for_all = ["--interrupting-goal", "t2"];
    assert_eq!(ended(&decided(&place, &["C", "I", "J"], &one_for_all)).2, 6);
    let one_each = ["--interrupting-goal", "t1", "--interrupting-goal", "t2"];
    assert_eq!(ended(&decided(&place, &["C", "I", "J"], &one_each)).0, "interrupting_2");
    let three = ["--interrupting-goal", "t1", "--interrupting-goal", "t1", "--interrupting-goal", "t1"];
    let told = refusal(&mut negotiate(&place, &["C", "I", "J"], &three), place.path());
    assert!(told.contains("given 3 times for 2 interrupters"), "{told}");
}

#[test]
fn a_missing_goal_file_is_made_up_for_by_the_option() {
    let place = deadlock();
    std::fs::remove_file(place.of("C/goal.json")).unwrap();
    let told = refusal(&mut negotiate(&place, &["C", "I"], &[]), place.path());
    assert!(told.starts_with("C/goal.json: is missing, expected {\"goal\": name}"), "{told}");
    assert_eq!(ended(&decided(&place, &["C", "I"], &["--current-goal", "t2"])).0, "no-agreement");
}

#[test]
fn willingness_is_from_0_to_255() {
    let place = deadlock();
    assert_eq!(decided(&place, &["C", "I"], &["--willingness", "255"])["options"]["willingness"], 255);
    for wrong in ["256", "-1", "1.5", "much"] {
        negotiate(&place, &["C", "I"], &["--willingness", wrong]).assert().code(2);
    }
}
