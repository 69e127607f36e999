//! `selfneg replicate`, through the program, on small packages of the published layout with
//! invented users. What their logs say comes from the naive simulation in `scaffold`, or is
//! worked out by hand where a test says so.
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
use scaffold::folders::{LETTERS, Place};
use scaffold::naive::{self, Naive};
use scaffold::program::{document, refusal, selfneg};
use serde_json::{Value, json};

const VALIDATION: &str = "results/validation-without_gazebo.log";
const SCALABILITY: &str = "results/scalability.log";
const WILLINGNESS: &str = "results/willingness_tb_interrupted.log";
const MULTI_LATERAL: &str = "results/results-multi_lateral.log";
const TRUTH: &str = "results/ground_truth.csv";

fn replicate(package: &Place) -> Command {
    let mut command = selfneg();
    command.current_dir(package.path()).args(["replicate", "."]);
    command
}

/// The report on one dataset.
fn dataset<'r>(report: &'r Value, name: &str) -> &'r Value {
    let datasets = report["datasets"].as_array().unwrap();
    datasets.iter().find(|dataset| dataset["name"] == name).unwrap()
}

/// Standard output and standard error of a rerun that ends with this exit code.
fn said(package: &Place, code: i32) -> (String, String) {
    let output = replicate(package).assert().code(code).get_output().clone();
    (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
}

/// Copies the rules of a `Place` into a folder of it, beside the users.
fn rules_in(package: &Place, folder: &str) {
    for file in ["disposition_activation.json", "ethical_implications.json"] {
        let text = fs::read_to_string(package.of(file)).unwrap();
        package.write(&format!("{folder}/{file}"), &text);
    }
}

fn ranks_text(user: &Naive) -> String {
    let rank = |letter: char| user.ranks.get(&letter).copied().unwrap_or(0);
    LETTERS.chars().map(|letter| format!("{letter}{}", rank(letter))).collect::<Vec<_>>().join(" ")
}

fn status_text(user: &Naive) -> String {
    let mut entries: Vec<String> =
        user.conditions.chars().map(|letter| format!("\"{letter}\": true")).collect();
    entries.push(format!("\"end of goal\": {}", user.end_of_goal));
    format!("{{{}}}", entries.join(", "))
}

fn user_in(package: &Place, folder: &str, user: &Naive) {
    package.user_with_status(&format!("{folder}/{}", user.name), &status_text(user), &ranks_text(user));
    // The published system asks for t1 and t2, whatever the file says.
    package.write(&format!("{folder}/{}/goal.json", user.name), r#"{"goal": "another one"}"#);
}

fn line(users: &str, (outcome, rounds): (&str, u64)) -> String {
    format!(
        "Users: {users}. Gazebo: False. Negotiation rounds: {rounds}. Preparation time: 1.047 seconds. \
         Negotiation time: 0.024 seconds. Result: {outcome}\n"
    )
}

/// Every two different users, in order.
fn pairs(users: &[Naive]) -> Vec<(&Naive, &Naive)> {
    let all = users.iter().flat_map(|current| users.iter().map(move |other| (current, other)));
    all.filter(|(current, other)| current.name != other.name).collect()
}

fn log_of_pairs(users: &[Naive]) -> String {
    let line = |(current, other): (&Naive, &Naive)| {
        line(&format!("{}{}", current.name, other.name), naive::negotiate(current, &without_end(other)))
    };
    pairs(users).into_iter().map(line).collect()
}

/// As an interrupter: the end of its goal is left out.
fn without_end(user: &Naive) -> Naive {
    Naive { end_of_goal: false, ..user.clone() }
}

fn truth_of(users: &[Naive]) -> String {
    let names: Vec<&str> = users.iter().map(|user| user.name.as_str()).collect();
    let mut text = format!(",{}\n", names.join(","));
    for current in users {
        let cells: Vec<&str> = users
            .iter()
            .map(|other| match naive::negotiate(current, other).0 {
                _ if current.name == other.name => "--",
                "current" => current.name.as_str(),
                "interrupting" => other.name.as_str(),
                _ => "--",
            })
            .collect();
        text.push_str(&format!("{},{}\n", current.name, cells.join(",")));
    }
    text
}

/// Users of many kinds, from a counter.
fn invented(names: &[&str], seed: u64) -> Vec<Naive> {
    let mut state = seed;
    let mut next = |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let user = |name: &&str| {
        let conditions: String = LETTERS.chars().filter(|_| next(2) == 0).collect();
        let ranks: Vec<String> = LETTERS.chars().map(|letter| format!("{letter}{}", next(6))).collect();
        Naive::new(name, &conditions, &ranks.join(" "))
    };
    names.iter().map(user).collect()
}

/// A package with all four datasets.
fn package() -> Place {
    let package = Place::of_letters();
    let usecases = "run/validation/usecases";
    rules_in(&package, usecases);
    let users = invented(&["Ann", "Bo", "Cyd", "Di", "Em"], 7);
    users.iter().for_each(|user| user_in(&package, usecases, user));
    package.write(VALIDATION, &log_of_pairs(&users)).write(TRUTH, &truth_of(&users));

    let mut log = String::new();
    for (a, b) in pairs(&users) {
        for c in users.iter().filter(|c| c.name != a.name && c.name != b.name) {
            log.push_str(&line(
                &[a, b, c].map(|user| user.name.as_str()).concat(),
                naive::negotiate_three(a, b, c),
            ));
        }
    }
    package.write(MULTI_LATERAL, &log);

    let usecases = "run/willingness_tb_interrupted/usecases";
    rules_in(&package, usecases);
    let mut users = users;
    users.iter_mut().for_each(|user| user.end_of_goal = user.name != "Bo");
    users.iter().for_each(|user| user_in(&package, usecases, user));
    package.write(WILLINGNESS, &log_of_pairs(&users));

    let cases = "run/scalability/test_cases";
    rules_in(&package, cases);
    package
        .write(&format!("{cases}/context.json"), r#"{"location": "here"}"#)
        .write(&format!("{cases}/goal.json"), r#"{"goal": "another one"}"#);
    let mut log = String::new();
    for (size, share) in [(6, 50), (6, 75), (12, 50)] {
        let users = invented(&["1", "2", "3", "4"], size * 100 + share);
        for user in &users {
            // Written as a user folder, then filed as the generator does.
            user_in(&package, "made", user);
            let made =
                |file: &str| fs::read_to_string(package.of("made").join(&user.name).join(file)).unwrap();
            let profile = format!("{cases}/{size}/profiles/ethic_profiles_{size}-{}.json", user.name);
            let status =
                format!("{cases}/{size}/statuses/{share}/user_status_{size}_{share}-{}.json", user.name);
            // Profiles belong to the size, statuses to the share.
            if share == 50 {
                package.write(&profile, &made("ethic_profiles.json"));
            }
            package.write(&status, &made("user_status.json"));
        }
        let ranked = invented(&["1", "2", "3", "4"], size * 100 + 50);
        let seated: Vec<Naive> = users
            .into_iter()
            .zip(ranked)
            .map(|(user, ranked)| Naive { ranks: ranked.ranks, ..user })
            .collect();
        for (nth, (current, other)) in pairs(&seated).into_iter().enumerate() {
            let (outcome, rounds) = naive::negotiate(current, other);
            log.push_str(&format!(
                "Gazebo: False. Negotiation rounds: {rounds}. Negotiation time: 0.027 seconds. Result: {outcome}. \
                 Goal: {{\"goal\": \"Scalability test! {size} dispositions, {share} activated conditions, \
                 ethicprofile no. {}. Test counter: {}\"}}\n",
                current.name,
                nth + 1
            ));
        }
    }
    package.write(SCALABILITY, &log);
    package
}

/// A package with the validation dataset alone.
fn validation_of(users: &[Naive]) -> Place {
    let package = Place::of_letters();
    rules_in(&package, "run/validation/usecases");
    users.iter().for_each(|user| user_in(&package, "run/validation/usecases", user));
    package.write(VALIDATION, &log_of_pairs(users)).write(TRUTH, &truth_of(users));
    package
}

/// I offers a first; C takes nothing, I takes b. The paper's literal rule ends it with C's
/// rejection.
fn two_users() -> Vec<Naive> {
    vec![Naive::new("C", "b", "b1"), Naive::new("I", "a", "b1")]
}

#[test]
fn all_four_datasets_are_reproduced() {
    let package = package();
    let report = document(&mut replicate(&package), 0);
    for (name, cases) in [("validation", 20), ("scalability", 36), ("willingness", 20), ("multi-lateral", 60)]
    {
        let dataset = dataset(&report, name);
        assert_eq!(dataset["cases"], cases, "{name}");
        assert_eq!(dataset["outcome_mismatches"], 0, "{name}");
        assert_eq!(dataset["round_mismatches"], 0, "{name}");
        assert_eq!(dataset["mismatches"], json!([]), "{name}");
    }
    assert_eq!(report["missing"], json!([]));
    let truth = &dataset(&report, "validation")["ground_truth"];
    assert_eq!((&truth["cases"], &truth["agree"]), (&json!(20), &json!(20)));
    assert_eq!(dataset(&report, "scalability")["ground_truth"], Value::Null);
    let (table, _) = said(&package, 0);
    insta::assert_snapshot!("four_datasets", table);
}

#[test]
fn the_invented_users_end_in_every_way() {
    let package = package();
    for (log, outcomes) in [
        (VALIDATION, &["current", "interrupting", "no-agreement"][..]),
        (SCALABILITY, &["current", "interrupting", "no-agreement"]),
        (MULTI_LATERAL, &["current", "interrupting_1", "interrupting_2", "no-agreement"]),
    ] {
        let text = fs::read_to_string(package.of(log)).unwrap();
        for outcome in outcomes {
            assert!(text.contains(&format!("Result: {outcome}")), "{log}: {outcome}");
        }
    }
    let plain = fs::read_to_string(package.of(VALIDATION)).unwrap();
    let willing = fs::read_to_string(package.of(WILLINGNESS)).unwrap();
    assert_ne!(plain, willing);
}

#[test]
fn a_wrong_number_of_rounds_is_named() {
    let package = validation_of(&two_users());
    package.write(VALIDATION, &[line("CI", ("current", 3)), line("IC", ("interrupting", 1))].concat());
    let (table, _) = said(&package, 1);
    assert!(
        table.contains(&format!(
            "./{VALIDATION}:1: C, I: logged current in 3 rounds, decided current in 2 rounds\n"
        )),
        "{table}"
    );
    assert!(table.ends_with("Not every run of these logs is reproduced.\n"), "{table}");
    let report = document(&mut replicate(&package), 1);
    let dataset = dataset(&report, "validation");
    assert_eq!((&dataset["outcome_mismatches"], &dataset["round_mismatches"]), (&json!(0), &json!(1)));
    assert_eq!(
        dataset["mismatches"],
        json!([{"line": 1, "users": "C, I", "logged": {"outcome": "current", "rounds": 3},
                "decided": {"outcome": "current", "rounds": 2}}])
    );
}

#[test]
fn a_wrong_outcome_is_named() {
    let package = validation_of(&two_users());
    package.write(VALIDATION, &[line("CI", ("current", 2)), line("IC", ("no-agreement", 1))].concat());
    let (table, _) = said(&package, 1);
    assert!(
        table.contains(&format!(
            "./{VALIDATION}:2: I, C: logged no-agreement in 1 round, decided interrupting in 1 round\n"
        )),
        "{table}"
    );
    let report = document(&mut replicate(&package), 1);
    let dataset = dataset(&report, "validation");
    assert_eq!((&dataset["outcome_mismatches"], &dataset["round_mismatches"]), (&json!(1), &json!(0)));
}

#[test]
fn an_outcome_of_another_number_of_users_is_wrong() {
    let package = validation_of(&two_users());
    package.write(VALIDATION, &[line("CI", ("current", 2)), line("IC", ("interrupting_1", 1))].concat());
    assert!(
        said(&package, 1).0.contains("logged interrupting_1 in 1 round, decided interrupting in 1 round")
    );
}

#[test]
fn a_wrong_cell_of_the_ground_truth_is_named() {
    let package = validation_of(&two_users());
    assert_eq!(truth_of(&two_users()), ",C,I\nC,--,C\nI,C,--\n");
    package.write(TRUTH, ",C,I\nC,--,I\nI,--,--\n");
    let (table, _) = said(&package, 1);
    assert!(table.contains(&format!("./{TRUTH}:2: C, I: expected I, decided C\n")), "{table}");
    assert!(table.contains(&format!("./{TRUTH}:3: I, C: expected no agreement, decided C\n")), "{table}");
    assert!(table.contains("0/2"), "{table}");
    assert!(
        table.ends_with("Every run of these logs is reproduced, but not as the ground truth expects.\n"),
        "{table}"
    );
    let report = document(&mut replicate(&package), 1);
    let truth = &dataset(&report, "validation")["ground_truth"];
    assert_eq!(
        truth["disagreements"][0],
        json!({"line": 2, "users": "C, I", "expected": "I", "decided": "C"})
    );
    assert_eq!(truth["disagreements"][1]["expected"], Value::Null);
}

/// A table that says nothing of a run does not vouch for it.
#[test]
fn a_ground_truth_that_leaves_runs_out_does_not_pass() {
    let package = validation_of(&two_users());
    package.write(TRUTH, ",C,I\nC,--,C\n");
    let (table, _) = said(&package, 1);
    assert!(table.contains("1/2"), "{table}");
    let report = document(&mut replicate(&package), 1);
    let truth = &dataset(&report, "validation")["ground_truth"];
    assert_eq!((&truth["cases"], &truth["uncovered"]), (&json!(1), &json!(1)));
}

/// What a package should hold can be demanded: fewer runs, or none, do not pass.
#[test]
fn too_few_runs_do_not_pass_where_a_number_is_demanded() {
    let package = validation_of(&two_users());
    replicate(&package).args(["--runs", "validation=2"]).assert().code(0);
    for (demand, complaint) in [
        ("validation=90", "warning: validation: found 2 runs, expected 90"),
        ("scalability=450", "warning: scalability: found 0 runs, expected 450"),
    ] {
        let output = replicate(&package).args(["--runs", demand]).assert().code(1).get_output().clone();
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.contains(complaint), "{told}");
    }
    for nonsense in ["validation", "validation=many", "nothing=1"] {
        replicate(&package).args(["--runs", nonsense]).assert().code(2);
    }
}

#[test]
fn a_ground_truth_that_is_no_table_of_users_is_refused() {
    let package = validation_of(&two_users());
    for (text, expected) in [
        (",C,I\nC,--\nI,C,--\n", "2: has 1 cells, expected 2"),
        (",C,I\nC,--,C\nI,Eve,--\n", "3: expected I, C or --, found \"Eve\""),
        ("", "1: is empty, expected user names"),
        (",C,I\nC,--,C\nC,--,C\n", "3: C and I stand here twice, expected each pair once"),
    ] {
        package.write(TRUTH, text);
        let told = refusal(&mut replicate(&package), package.path());
        assert_eq!(told, format!("./{TRUTH}:{expected}"));
    }
}

#[test]
fn an_unreadable_line_is_named() {
    let package = validation_of(&two_users());
    let log = [
        &line("CI", ("current", 2)),
        "\nTraceback (most recent call last):\n",
        &line("IC", ("interrupting", 1)),
    ];
    package.write(VALIDATION, &log.concat());
    let (table, _) = said(&package, 1);
    assert!(table.contains(&format!("./{VALIDATION}:3: is no run of the published form\n")), "{table}");
    let report = document(&mut replicate(&package), 1);
    assert_eq!(dataset(&report, "validation")["unreadable_lines"], json!([3]));
    assert_eq!(dataset(&report, "validation")["cases"], 2);
}

#[test]
fn of_many_differences_the_first_are_shown() {
    let users = invented(&["Ann", "Bo", "Cyd", "Di", "Em"], 7);
    let package = validation_of(&users);
    let wrong: String =
        pairs(&users).iter().map(|(a, b)| line(&format!("{}{}", a.name, b.name), ("current", 99))).collect();
    package.write(VALIDATION, &wrong);
    let (table, _) = said(&package, 1);
    assert_eq!(table.lines().filter(|line| line.contains("logged current in 99 rounds")).count(), 10);
    assert!(table.contains("validation: and 10 more mismatches (all of them with --json)\n"), "{table}");
    let report = document(&mut replicate(&package), 1);
    assert_eq!(dataset(&report, "validation")["mismatches"].as_array().unwrap().len(), 20);
}

#[test]
fn users_that_are_not_there_are_refused() {
    let package = validation_of(&two_users());
    let log = fs::read_to_string(package.of(VALIDATION)).unwrap();
    package.write(VALIDATION, &[log, line("CZ", ("current", 2))].concat());
    let told = refusal(&mut replicate(&package), package.path());
    let usecases = "./run/validation/usecases";
    assert_eq!(told, format!("./{VALIDATION}:3: users \"CZ\" do not name 2 user folders of {usecases}"));
    fs::remove_dir_all(package.of("run/validation/usecases/I")).unwrap();
    let told = refusal(&mut replicate(&package), package.path());
    assert_eq!(told, format!("./{VALIDATION}:1: users \"CI\" do not name 2 user folders of {usecases}"));
    fs::remove_dir_all(package.of("run")).unwrap();
    let told = refusal(&mut replicate(&package), package.path());
    assert!(told.starts_with(&format!("{usecases}/disposition_activation.json: cannot be read")), "{told}");
}

#[test]
fn names_that_can_be_read_in_two_ways_are_refused() {
    let users = ["A", "AB", "BA"].map(|name| Naive::new(name, "a", "a1"));
    let package = validation_of(&users);
    package.write(VALIDATION, &line("ABA", ("no-agreement", 4)));
    let told = refusal(&mut replicate(&package), package.path());
    assert!(told.contains(":1: users \"ABA\" can be read in several ways as 2 user folders"), "{told}");
}

#[test]
fn a_counter_that_belongs_to_another_profile_is_refused() {
    let package = package();
    let log = fs::read_to_string(package.of(SCALABILITY)).unwrap();
    for (from, to, said) in [
        (
            "no. 1. Test counter: 2\"",
            "no. 1. Test counter: 4\"",
            "counter 4 belongs to profile 2, found profile 1",
        ),
        ("no. 1. Test counter: 2\"", "no. 1. Test counter: 0\"", "counter 0 with 4 profiles"),
        ("no. 1. Test counter: 2\"", "no. 5. Test counter: 13\"", "counter 13 belongs to profile 5"),
        ("6 dispositions", "7 dispositions", "counter 1 with 0 profiles"),
    ] {
        package.write(SCALABILITY, &log.replacen(from, to, 1));
        let told = refusal(&mut replicate(&package), package.path());
        assert!(told.starts_with(&format!("./{SCALABILITY}:")) && told.contains(said), "{told}");
    }
}

#[test]
fn one_dataset_alone_is_rerun_and_the_others_reported_missing() {
    let package = validation_of(&two_users());
    let report = document(&mut replicate(&package), 0);
    assert_eq!(report["datasets"].as_array().unwrap().len(), 1);
    let missing: Vec<&str> =
        report["missing"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(missing, ["scalability", "willingness", "multi-lateral"]);
    let (table, _) = said(&package, 0);
    assert!(table.contains(&format!("multi-lateral not there: ./{MULTI_LATERAL}\n")), "{table}");
    assert!(table.ends_with("Every run of these logs is reproduced: outcome and rounds.\n"), "{table}");
}

#[test]
fn a_folder_without_logs_is_refused() {
    let empty = Place::of_letters();
    let told = refusal(&mut replicate(&empty), empty.path());
    for log in [VALIDATION, SCALABILITY, WILLINGNESS, MULTI_LATERAL] {
        assert!(
            told.starts_with(".: holds no published log, expected at least one of ") && told.contains(log),
            "{told}"
        );
    }
    let told = refusal(selfneg().args(["replicate", "/nowhere/to/be/found"]), empty.path());
    assert!(told.starts_with("/nowhere/to/be/found: cannot be read"), "{told}");
}

#[test]
fn a_log_without_runs_is_refused() {
    let package = validation_of(&two_users());
    package.write(VALIDATION, "\n\n");
    let told = refusal(&mut replicate(&package), package.path());
    assert_eq!(told, format!("./{VALIDATION}: holds no run, expected one in each line"));
}

#[test]
fn mutual_deference_depends_on_the_order() {
    // By hand: each takes the other's first offer, so whoever interrupts wins in round 1.
    let users = [Naive::new("X", "a", "b1"), Naive::new("Y", "b", "a1"), Naive::new("Z", "c", "c5")];
    let package = validation_of(&users);
    let report = document(&mut replicate(&package), 0);
    let dataset = dataset(&report, "validation");
    assert_eq!((&dataset["pairs"], &dataset["order_dependent_pairs"]), (&json!(3), &json!(1)));
    let log = fs::read_to_string(package.of(VALIDATION)).unwrap();
    assert!(log.contains(&line("XY", ("interrupting", 1))) && log.contains(&line("YX", ("interrupting", 1))));
}

#[test]
fn order_dependence_is_found_from_one_logged_order() {
    let users = [Naive::new("X", "a", "b1"), Naive::new("Y", "b", "a1")];
    let package = validation_of(&users);
    package.write(VALIDATION, &line("YX", ("interrupting", 1)));
    let report = document(&mut replicate(&package), 0);
    assert_eq!(dataset(&report, "validation")["order_dependent_pairs"], 1);
}

#[test]
fn the_literal_quit_rule_is_counted_where_it_decides_otherwise() {
    // By hand: with C current, I's only offer is rejected by C, who has one offer itself, so
    // the literal rule ends it before C's winning offer. The other way round C wins at once.
    let package = validation_of(&two_users());
    let report = document(&mut replicate(&package), 0);
    let dataset = dataset(&report, "validation");
    assert_eq!((&dataset["literal_quit_differs"], &dataset["order_dependent_pairs"]), (&json!(1), &json!(0)));
}

#[test]
fn conditions_that_no_rule_activates_are_a_warning() {
    let package = validation_of(&two_users());
    let status = |user: &str| format!("run/validation/usecases/{user}/user_status.json");
    package.write(&status("I"), r#"{"s1": true, "s2": false, "a": true}"#);
    package.write(VALIDATION, &line("CI", ("current", 2)));
    let (_, warnings) = said(&package, 0);
    let expected = format!(
        "warning: validation: ./{}: conditions that no rule activates, disclosed without effect: s1, s2\n",
        status("I")
    );
    assert!(warnings.contains(&expected), "{warnings}");
    // The same in two files is one warning.
    package.write(&status("C"), r#"{"s1": true, "s2": false, "b": true}"#);
    let (_, warnings) = said(&package, 1);
    let lines: Vec<&str> = warnings.lines().filter(|line| line.contains("no rule activates")).collect();
    assert_eq!(lines.len(), 1, "{warnings}");
    assert!(lines[0].ends_with("s1, s2 (and likewise in another file)"), "{warnings}");
    let report = document(&mut replicate(&package), 1);
    let told = dataset(&report, "validation")["warnings"].as_array().unwrap();
    assert!(told.iter().any(|warning| warning.as_str().unwrap().contains("no rule activates")));
}

#[test]
fn a_users_own_goal_does_not_matter() {
    let package = validation_of(&two_users());
    package.write("run/validation/usecases/ethical_implications.json", r#"{"t1": [], "another one": []}"#);
    let told = refusal(&mut replicate(&package), package.path());
    assert!(told.starts_with("the published system: goal \"t2\" is not listed"), "{told}");
}

/// Needs the published data beside the checkout.
#[test]
#[ignore = "needs the reference data beside the checkout"]
fn the_reference_data_is_reproduced() {
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/reference");
    assert!(reference.is_dir(), "{}: is not there", reference.display());
    let report = document(selfneg().arg("replicate").arg(&reference), 0);
    for (name, cases) in
        [("validation", 90), ("scalability", 450), ("willingness", 45), ("multi-lateral", 20)]
    {
        let dataset = dataset(&report, name);
        assert_eq!(dataset["cases"], cases);
        assert_eq!((&dataset["outcome_mismatches"], &dataset["round_mismatches"]), (&json!(0), &json!(0)));
    }
    assert_eq!(dataset(&report, "validation")["ground_truth"]["agree"], 90);
    assert_eq!(dataset(&report, "validation")["literal_quit_differs"], 33);
}
