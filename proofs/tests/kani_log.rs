//! The checker of Kani's output, on a log that is as it should be and on logs that are
//! not. (The logs are written by hand in the format of Kani 0.67.)

use selfneg_proofs::kani_log::{Expected, Problem, problems};

const EXPECTED: &[Expected<'static>] =
    &[Expected { name: "termination", covers: 2 }, Expected { name: "closed_form", covers: 1 }];

#[test]
fn a_good_log_passes() {
    assert_eq!(problems(include_str!("kani_logs/good.log"), EXPECTED), []);
}

#[test]
fn a_failed_harness_does_not() {
    let found = problems(include_str!("kani_logs/failed.log"), EXPECTED);
    assert_eq!(found, [Problem::NotVerified("termination".to_owned()), Problem::Summary { expected: 2 }]);
}

#[test]
fn an_unsatisfied_cover_does_not() {
    let found = problems(include_str!("kani_logs/uncovered.log"), EXPECTED);
    assert_eq!(found, [Problem::Covers { name: "termination".to_owned(), found: Some((1, 2)), expected: 2 }]);
}

#[test]
fn a_missing_harness_does_not() {
    let found = problems(include_str!("kani_logs/missing.log"), EXPECTED);
    assert_eq!(found, [Problem::Missing("closed_form".to_owned()), Problem::Summary { expected: 2 }]);
}

#[test]
fn a_log_cut_short_does_not() {
    let found = problems(include_str!("kani_logs/cut_short.log"), EXPECTED);
    assert_eq!(found, [Problem::Missing("closed_form".to_owned()), Problem::Summary { expected: 2 }]);
}

#[test]
fn a_harness_nobody_expects_does_not() {
    let found = problems(include_str!("kani_logs/good.log"), &EXPECTED[..1]);
    assert_eq!(found, [Problem::Unexpected("closed_form".to_owned()), Problem::Summary { expected: 1 }]);
}

#[test]
fn a_vanished_cover_does_not() {
    let more = [Expected { name: "termination", covers: 3 }, EXPECTED[1]];
    let found = problems(include_str!("kani_logs/good.log"), &more);
    assert_eq!(found, [Problem::Covers { name: "termination".to_owned(), found: Some((2, 2)), expected: 3 }]);
}

#[test]
fn an_empty_log_does_not() {
    assert_eq!(problems("", EXPECTED).len(), 3);
}
