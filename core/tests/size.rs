//! The largest users that the crate takes, the totals they can reach, and what it refuses.
#![allow(clippy::unwrap_used, reason = "clippy looks for tests only in functions marked so")]

mod naive;
mod situation;

use std::error::Error;

use selfneg_core::{
    Activation, Aggregation, Condition, Disposition, Ending, EthicalProfile, Impact, Implication, MAX_ITEMS,
    Options, Outcome, QuitRule, Rank, RulesError, Side, Status, TieRule, User, impact_of_serving,
};

use situation::{Person, Situation};

const MOST: u16 = u16::MAX;

/// Condition `c` activates disposition `c`; both users have all `count` conditions, and
/// both goals imply all dispositions.
fn one_to_one(count: u16, rank: u8) -> Situation {
    let person = Person {
        ranks: vec![rank; usize::from(count)],
        status: (0..count).collect(),
        mentions: vec![1; usize::from(count)],
    };
    Situation { rows: (0..count).map(|c| vec![c]).collect(), interrupting: person.clone(), current: person }
}

/// Both users rank all 65,535 dispositions alike, so each finds the other's complete offer
/// exactly as good as its own: the longest negotiation there is.
#[test]
fn negotiates_to_the_end_at_the_largest_size() {
    let situation = one_to_one(MOST, 255);
    situation.with(|case| {
        for &tie in TieRule::ALL {
            let options = Options { tie, ..Options::default() };
            let conclusion = case.negotiate(&options);
            assert_eq!(conclusion.outcome, Outcome::NoAgreement);
            assert_eq!(conclusion.ending, Ending::BothQuit);
            assert_eq!(conclusion.rounds, 2 * u32::from(MOST) + 2);
        }
        let willing = Options { willingness: 255, ..Options::default() };
        assert_eq!(case.negotiate(&willing).rounds, 2 * u32::from(MOST) + 3);
        let literal = Options { quit: QuitRule::Literal, ..Options::default() };
        let conclusion = case.negotiate(&literal);
        assert_eq!(conclusion.ending, Ending::LiteralQuit(Side::Current));
        assert_eq!(conclusion.rounds, 2 * u32::from(MOST) - 1);
    });
}

/// The current user lacks the last condition, all else is equal: with its last one the
/// interrupter's offer is worth more.
#[test]
fn the_last_of_65_535_conditions_decides() {
    let mut situation = one_to_one(MOST, 255);
    situation.current.status.pop();
    situation.with(|case| {
        let conclusion = case.negotiate(&Options::default());
        assert_eq!(conclusion.outcome, Outcome::Agreement(Side::Interrupting));
        // 65,535 offers of one's own, 65,534 of the other's.
        assert_eq!(conclusion.rounds, 2 * u32::from(MOST) - 1);
    });
}

/// Quadratic by design, so smaller.
#[test]
fn per_disposition_at_2_000_conditions() {
    let situation = one_to_one(2_000, 1);
    let options = Options { aggregation: Aggregation::PerDisposition, ..Options::default() };
    situation.with(|case| {
        let conclusion = case.negotiate(&options);
        assert_eq!((conclusion.outcome, conclusion.rounds), (Outcome::NoAgreement, 4_002));
    });
    assert_eq!(naive::conclusion(&situation, &options).rounds, 4_002);
}

/// Total of `conditions` conditions that all activate `dispositions` dispositions, each
/// mentioned 255 times and ranked 255.
fn largest_total(conditions: usize, dispositions: usize) -> (Impact, u128) {
    let row: Vec<Disposition> = (0..=u16::MAX).take(dispositions).map(Disposition).collect();
    let rows = [&row[..]];
    let status = vec![Condition(0); conditions];
    let ranks = vec![Rank(255); dispositions];
    let mentions = vec![255; dispositions];
    let activation = Activation::new(&rows).unwrap();
    let user =
        User::new(EthicalProfile::new(&ranks), Status::new(&status).unwrap(), Implication::new(&mentions));
    let expected = conditions as u128 * dispositions as u128 * 255 * 255;
    (impact_of_serving(&user, &user, activation, Aggregation::PerCondition), expected)
}

/// 65,535 conditions, 256 dispositions each: above 2^39, far beyond 32 bits.
#[test]
fn totals_are_exact_beyond_32_bits() {
    let (total, expected) = largest_total(MAX_ITEMS, 256);
    assert_eq!(u128::from(total.0), expected);
    assert!(expected > 1 << 39);
}

/// The largest total that there can be is exact, and below the bound that `Impact` names.
#[test]
#[ignore = "4.3 * 10^9 additions: run with --release"]
fn the_largest_total_is_exact() {
    let (total, expected) = largest_total(MAX_ITEMS, MAX_ITEMS);
    assert_eq!(u128::from(total.0), expected);
    assert!(expected < 1 << 48);
}

/// As any number is, with the width that the caller asks for.
#[test]
fn a_total_is_written_as_a_number() {
    for total in [0, 7, u64::MAX] {
        assert_eq!(Impact(total).to_string(), total.to_string());
        assert_eq!(format!("{:>5}|{:<5}|", Impact(total), Impact(total)), format!("{total:>5}|{total:<5}|"));
    }
}

/// A verdict that hangs on the last of 65,535 conditions, with totals of about 2^35, against
/// 128-bit sums.
#[test]
fn verdicts_are_exact_beyond_32_bits() {
    let person = |conditions: usize| Person {
        ranks: vec![255; 8],
        status: vec![0; conditions],
        mentions: vec![255; 8],
    };
    let situation = Situation {
        rows: vec![(0..8).collect()],
        interrupting: person(MAX_ITEMS),
        current: person(MAX_ITEMS - 1),
    };
    situation.with(|case| {
        let conclusion = case.negotiate(&Options::default());
        assert_eq!(conclusion.outcome, Outcome::Agreement(Side::Interrupting));
        assert_eq!(conclusion.rounds, 2 * u32::from(MOST) - 1);

        let welfare = case.welfare(&Options::default());
        for side in [Side::Current, Side::Interrupting] {
            let expected = naive::welfare(&situation, side, Aggregation::PerCondition);
            assert!(expected > 1 << 35);
            assert_eq!(u128::from(welfare.of_serving(side).0), expected);
        }
        assert_eq!(welfare.regret(Side::Current), Impact(2 * 8 * 255 * 255));
    });
}

#[test]
fn a_status_of_more_than_65_535_conditions_is_refused() {
    let mut conditions = vec![Condition(0); MAX_ITEMS];
    assert!(Status::new(&conditions).is_ok());
    conditions.push(Condition(0));
    let error = Status::new(&conditions).err().unwrap();
    assert_eq!(error.count, 65_536);
    assert_eq!(error.to_string(), "65536 true conditions, more than 65535");
    assert!(error.source().is_none());
}

fn refused(rows: &[&[Disposition]]) -> RulesError {
    Activation::new(rows).err().unwrap()
}

#[test]
fn more_than_65_535_rows_are_refused() {
    let mut rows: Vec<&[Disposition]> = vec![&[Disposition(MOST)]; MAX_ITEMS];
    let activation = Activation::new(&rows).unwrap();
    assert_eq!(activation.of(Condition(MOST - 1)), [Disposition(MOST)]);
    assert_eq!(activation.of(Condition(MOST)), []);
    rows.push(&[]);
    assert_eq!(refused(&rows), RulesError::TooManyConditions);
    assert_eq!(refused(&rows).to_string(), "more than 65535 conditions");
}

/// It is refused for its length before anything is compared.
#[test]
fn a_row_of_more_than_65_535_dispositions_is_refused() {
    let row: Vec<Disposition> = (0..=MOST).map(Disposition).collect();
    let error = refused(&[&[], &row]);
    assert_eq!(error, RulesError::RowTooLong { row: 1 });
    assert_eq!(error.to_string(), "condition 1 activates more than 65535 dispositions");
}

/// A row of exactly 65,535 is looked into.
#[test]
fn a_row_of_65_535_dispositions_is_not_refused_for_its_length() {
    let row = [Disposition(MOST); MAX_ITEMS];
    assert_eq!(refused(&[&row]), RulesError::Repeated { row: 0, disposition: Disposition(MOST) });
}

#[test]
fn a_row_that_repeats_a_disposition_is_refused() {
    let [d3, d5] = [Disposition(3), Disposition(5)];
    for repeating in [vec![d3, d3], vec![d3, d5, d3], vec![d5, d3, d3]] {
        let error = refused(&[&[d3, d5], &repeating]);
        assert_eq!(error, RulesError::Repeated { row: 1, disposition: d3 });
        assert_eq!(error.to_string(), "condition 1 names disposition 3 twice");
    }
    assert!(Activation::new(&[&[d3, d5], &[d5, d3]]).is_ok());
}

#[test]
fn rules_without_rows_activate_nothing() {
    for condition in [0, 1, MOST] {
        assert_eq!(Activation::EMPTY.of(Condition(condition)), []);
        assert_eq!(Activation::new(&[]).unwrap().of(Condition(condition)), []);
    }
    for disposition in [0, 1, MOST] {
        assert_eq!(Implication::new(&[]).mentions(Disposition(disposition)), 0);
        assert_eq!(
            Implication::new(&[7]).mentions(Disposition(disposition)),
            if disposition == 0 { 7 } else { 0 }
        );
    }
}
