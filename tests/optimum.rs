//! `selfneg optimum`, through the program: the paper's example, causes of regret on smallest
//! cases, its limits, and how long a case takes.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use std::time::{Duration, Instant};

use proptest::prelude::*;
use scaffold::folders::Place;
use scaffold::program::selfneg;
use selfneg::optimum::{Optimum, Situation};
use selfneg_core::{
    Activation, Aggregation, Case, Condition, Disposition, EthicalProfile, Fallback, Implication, Options,
    QuitRule, Rank, Side, Status, TieRule, User,
};
use selfneg_model::{BeatsGraph, Cause, Decided, Impacts, Regret};
use serde_json::{Value, json};

/// The JSON of `selfneg optimum` of these users, the first one current.
fn optimum(place: &Place, users: &[&str], more: &[&str]) -> Value {
    let mut command = selfneg();
    command.arg("optimum").arg("--rules").arg(place.path()).arg("--json");
    command.args(users.iter().map(|user| place.of(user))).args(more);
    serde_json::from_slice(&command.assert().code(0).get_output().stdout).unwrap()
}

#[test]
fn alice_is_the_optimum_of_the_papers_example() {
    let place = Place::mall();
    let document = optimum(&place, &["Alice", "Bob"], &[]);
    assert_eq!(document["welfare"], json!({"Alice": 15, "Bob": 6}));
    assert_eq!(document["impacts"]["Bob"], json!({"Alice": 8, "Bob": 4}));
    assert_eq!(document["optimal"], json!(["Alice"]));
    assert_eq!(document["served"], "Alice");
    assert_eq!((&document["regret"], &document["cause"]), (&json!(0), &json!("agreed-and-optimal")));
    assert_eq!(document["certificate"]["verified"], true);
    assert_eq!(document["certificate"]["gap"], "0");
    assert_eq!(document["order"]["waiting"]["users"], json!(["Alice", "Bob"]));
}

#[test]
fn the_first_folder_is_the_current_user_and_each_cause_has_its_name() {
    // Neither takes the other's offer; serving I would be worth 5 + 5, C stays with 5 + 1.
    let place = Place::of_letters();
    place.user("C", "b", "a5 b5").user("I", "a", "a5 b1");
    let document = optimum(&place, &["C", "I"], &[]);
    assert_eq!((&document["served"], &document["regret"]), (&json!("C"), &json!(4)));
    assert_eq!(document["cause"], "fallback");
    let swapped = optimum(&place, &["I", "C"], &[]);
    assert_eq!((&swapped["served"], &swapped["regret"]), (&json!("I"), &json!(0)));
    let helped = optimum(&place, &["C", "I"], &["--fallback", "utilitarian"]);
    assert_eq!((&helped["served"], &helped["regret"]), (&json!("I"), &json!(0)));

    // Each would take the other's first offer; the interrupter offers first.
    let place = Place::of_letters();
    place.user("C", "b", "a1").user("I", "a", "b5");
    let document = optimum(&place, &["C", "I"], &[]);
    assert_eq!((&document["served"], &document["regret"]), (&json!("I"), &json!(4)));
    assert_eq!(document["cause"], "mutual-deference");

    // Without willingness C would have taken a.
    let place = Place::of_letters();
    place.user("C", "b", "a5 b1").user("I", "a", "b1");
    let document = optimum(&place, &["C", "I"], &["--willingness", "9"]);
    assert_eq!((&document["served"], &document["cause"]), (&json!("C"), &json!("willingness")));
}

#[test]
fn one_user_is_served_and_two_of_one_name_are_refused() {
    let place = Place::mall();
    let alone = optimum(&place, &["Alice"], &[]);
    assert_eq!((&alone["served"], &alone["cause"]), (&json!("Alice"), &json!("alone")));
    assert_eq!(alone["utilitarian"]["lottery"], json!({"Alice": "1"}));
    let mall = place.path();
    let twice = [mall.join("Bob"), mall.join("Bob")];
    selfneg().arg("optimum").arg("--rules").arg(mall).args(twice).assert().code(2);
    selfneg().arg("optimum").arg("--rules").arg(mall).assert().code(2);
}

#[test]
fn a_hundred_users_have_an_answer_and_more_than_the_limit_are_refused() {
    let place = Place::of_letters();
    let names: Vec<String> = (0..129).map(|user| format!("U{user}")).collect();
    for (user, name) in names.iter().enumerate() {
        let letters: String = "abcdef"
            .chars()
            .enumerate()
            .filter(|(at, _)| (user + 1) >> at & 1 == 1)
            .map(|(_, c)| c)
            .collect();
        let ranks: Vec<String> =
            "abcdef".chars().enumerate().map(|(at, c)| format!("{c}{}", (user * (at + 3)) % 6)).collect();
        place.user(name, &letters, &ranks.join(" "));
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let document = optimum(&place, &names[..100], &[]);
    assert_eq!(document["certificate"]["verified"], true);
    assert_eq!(document["order"]["waiting"]["users"].as_array().unwrap().len(), 100);
    let mut command = selfneg();
    command.arg("optimum").arg("--rules").arg(place.path()).args(names.iter().map(|user| place.of(user)));
    let output = command.assert().code(2).get_output().stderr.clone();
    assert!(String::from_utf8(output).unwrap().contains("129 users, at most 128"));
}

#[test]
fn service_times_change_the_order() {
    let place = Place::mall();
    let document = optimum(&place, &["Alice", "Bob"], &["--service-time", "5", "--service-time", "1"]);
    assert_eq!(document["order"]["waiting"]["users"], json!(["Bob", "Alice"]));
    let mut command = selfneg();
    command.args(["optimum", "--service-time", "5", "--rules"]).arg(place.path());
    command.args([place.of("Alice"), place.of("Bob")]).assert().code(2);
}

/// Users by what they rank and what is true of them; condition d activates d and d + 1.
type Person = (Vec<u16>, Vec<u8>);

fn person() -> impl Strategy<Value = Person> {
    (prop::collection::btree_set(0_u16..5, 0..=5), prop::collection::vec(0_u8..6, 6))
        .prop_map(|(conditions, ranks)| (conditions.into_iter().collect(), ranks))
}

fn every_variant() -> Vec<Options> {
    let mut all = Vec::new();
    for &quit in QuitRule::ALL {
        for &aggregation in Aggregation::ALL {
            for &tie in TieRule::ALL {
                for &fallback in Fallback::ALL {
                    for willingness in 0..=2 {
                        all.push(Options { quit, aggregation, tie, fallback, willingness });
                    }
                }
            }
        }
    }
    all
}

fn with_case(people: &[Person; 2], use_case: impl FnOnce(&Case<'_>)) {
    let rows: Vec<[Disposition; 2]> = (0..5).map(|d| [Disposition(d), Disposition(d + 1)]).collect();
    let rows: Vec<&[Disposition]> = rows.iter().map(|row| &row[..]).collect();
    let goal = [1, 1, 1, 0, 1, 2];
    let data = people.clone().map(|(conditions, ranks)| {
        let conditions: Vec<Condition> = conditions.into_iter().map(Condition).collect();
        (conditions, ranks.into_iter().map(Rank).collect::<Vec<_>>())
    });
    let [current, interrupting] = [0, 1].map(|side: usize| {
        let (conditions, ranks) = &data[side];
        User::new(EthicalProfile::new(ranks), Status::new(conditions).unwrap(), Implication::new(&goal))
    });
    use_case(&Case { activation: Activation::new(&rows).unwrap(), current, interrupting });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// For every variant: the optimum is at least as good as whoever is served, the regret
    /// is what the engine's own welfare says, and an agreement that the winner would not
    /// have returned loses nothing without willingness.
    #[test]
    fn nobody_served_is_better_than_the_optimum(people in [person(), person()]) {
        for options in every_variant() {
            with_case(&people, |case| {
                let decision = case.decide(&options, &mut ());
                let welfare = case.welfare(&options);
                let at = |side| usize::from(side == Side::Interrupting);
                let agreement = decision.conclusion.outcome.winner().map(at);
                let impacts =
                    Impacts::among(&[case.current, case.interrupting], case.activation, options.aggregation);
                let beat = |winner: usize, loser: usize| agreement == Some(winner) && winner != loser;
                let decided = Decided {
                    agreement, served: at(decision.served), beat: &beat, willingness: options.willingness,
                };
                let regret = Regret::of(&impacts, &decided);
                assert_eq!(regret.amount, welfare.regret(decision.served).0, "{options}");
                let best = impacts.optimal()[0];
                assert!(impacts.welfare(best) >= impacts.welfare(at(decision.served)), "{options}");
                if let Some(winner) = agreement && options.willingness == 0 {
                    let loser = 1 - winner;
                    let mutual = impacts.of_serving(loser, winner) > impacts.of_serving(winner, winner);
                    assert!(mutual || regret.amount == 0, "{options}");
                    assert!(matches!(regret.cause, Cause::AgreedAndOptimal | Cause::MutualDeference), "{options}");
                }
            });
        }
    }
}

/// One case's optimum is well under 10 ms where programs are optimised; this also runs where
/// they are not, so it allows ten times that.
#[test]
fn one_case_takes_milliseconds() {
    let impacts = Impacts::of_rows(vec![vec![7, 2, 5], vec![8, 4, 1], vec![3, 3, 6]]).unwrap();
    let names = ["A", "B", "C"].map(str::to_owned);
    let situation = Situation {
        names: &names,
        impacts: &impacts,
        options: Options::default(),
        decision: None,
        beats: &BeatsGraph::new(3),
        times: &[],
    };
    let fastest = (0..5).map(|_| {
        let start = Instant::now();
        assert!(Optimum::of(&situation).unwrap().verified());
        start.elapsed()
    });
    let fastest = fastest.min().unwrap();
    println!("one case: {fastest:?}");
    assert!(fastest < Duration::from_millis(100), "{fastest:?}");
}
