//! `selfneg regret` and `selfneg policies`, through the program, on domains small enough for
//! the tests; and the paper's domain.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

mod scaffold;

use scaffold::program::selfneg;
use serde_json::{Value, json};

fn document(arguments: &[&str]) -> Value {
    serde_json::from_slice(&selfneg().args(arguments).assert().code(0).get_output().stdout).unwrap()
}

#[test]
fn the_two_methods_agree_for_three_dispositions_under_every_option() {
    for options in [
        &[][..],
        &["--tie", "fallback"],
        &["--tie", "surplus"],
        &["--fallback", "utilitarian"],
        &["--quit", "literal"],
        &["--willingness", "2"],
        &["--aggregation", "per-disposition"],
    ] {
        let regret = document(&[&["regret", "--json", "--dispositions", "3"][..], options].concat());
        assert_eq!(regret["certified"], true, "{options:?}");
        assert_eq!(regret["consistent"], true, "{options:?}");
        assert_eq!(regret["tight"], true, "{options:?}");
        assert_eq!(regret["domain"]["pairs"], 1_000_000);
    }
}

#[test]
fn causes_of_three_dispositions_are_as_known() {
    let regret = document(&["regret", "--json", "--dispositions", "3"]);
    let of = |cause: &str| {
        let cause = &regret["by_cause"][cause];
        (cause["integer_max"].clone(), cause["lp_max"].clone(), cause["attained"].clone())
    };
    assert_eq!(of("agreed-and-optimal"), (json!(0), json!("0"), json!(true)));
    assert_eq!(of("mutual-deference"), (json!(8), json!("9"), json!(false)));
    assert_eq!(of("fallback"), (json!(9), json!("9"), json!(true)));
    assert_eq!(regret["instance"]["attains"], true);
    assert_eq!(regret["instance"]["regret"], "9");
}

/// The paper's domain; seconds when optimised, so it is left to such builds.
#[test]
#[cfg_attr(debug_assertions, ignore = "slow without optimisation")]
fn the_papers_domain_is_as_known() {
    let regret = document(&["regret", "--json"]);
    assert_eq!((&regret["integer_max"], &regret["lp_max"]), (&json!(24), &json!("24")));
    let deference = &regret["by_cause"]["mutual-deference"];
    assert_eq!((&deference["integer_max"], &deference["lp_max"]), (&json!(18), &json!("19")));
    assert_eq!(deference["attained"], false);
    assert_eq!(regret["losing"], 71_439_792_922_u64);
    assert_eq!(regret["by_cause"]["fallback"]["pairs"], 136_526_089_120_u64);
}

#[test]
fn impossible_domains_are_refused() {
    for arguments in [
        &["--dispositions", "0"][..],
        &["--dispositions", "11"],
        &["--ranks", "5..=1"],
        &["--ranks", "1..5"],
        &["--ranks", "0..=256"],
    ] {
        selfneg().arg("regret").args(arguments).assert().code(2);
    }
}

#[test]
fn condorcet_agrees_on_nobody_who_is_beaten_and_published_does() {
    let swept = document(&["policies", "--json", "--dispositions", "2", "--ranks", "0..=2"]);
    assert_eq!(swept["triples"], 46_656);
    let [published, condorcet] = [&swept["policies"][0], &swept["policies"][1]];
    assert_eq!(condorcet["beaten_agreements"], 0);
    assert!(published["beaten_agreements"].as_u64().unwrap() > 0);
    let sample = ["policies", "--json", "--dispositions", "6", "--sample", "2000", "--seed", "7"];
    assert_eq!(document(&sample), document(&sample));
    assert_eq!(document(&sample)["triples"], 2000);
    selfneg().args(["policies", "--dispositions", "6"]).assert().code(2);
    selfneg().args(["policies", "--willingness", "1"]).assert().code(2);
}
