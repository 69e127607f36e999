//! The engine against closed forms: for every case drawn, outcome, rounds and ending are
//! what sums over sets and lists predict.

mod naive;
mod situation;
mod small_domain;

use std::collections::BTreeMap;

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use selfneg_core::{Aggregation, Ending, Fallback, Options, Outcome, QuitRule, Side, TieRule};

use naive::Outlook;
use situation::{Situation, situations, variants};

/// The variants in the scope of the design's statements: quit rule `exhausted`, tie
/// `first-sender`, willingness 0.
fn in_scope() -> impl Iterator<Item = Options> {
    Aggregation::ALL.iter().map(|&aggregation| Options { aggregation, ..Options::default() })
}

/// The design's closed form, and the number of rounds that goes with it: before turn `k`
/// of the interrupter lie its own `k - 1` offers and as many turns of the current user,
/// but at most all its offers and its quit; before turn `k` of the current user,
/// likewise.
fn closed_form(k_i: Option<usize>, k_c: Option<usize>, a: usize, c: usize) -> (Outcome, usize) {
    match (k_i, k_c) {
        (Some(k_i), k_c) if k_c.is_none_or(|k_c| k_i <= k_c) => {
            (Outcome::Agreement(Side::Interrupting), k_i + usize::min(k_i - 1, c + 1))
        }
        (k_i, Some(k_c)) if k_i.is_none_or(|k_i| k_c < k_i) => {
            (Outcome::Agreement(Side::Current), k_c + usize::min(k_c, a + 1))
        }
        _ => (Outcome::NoAgreement, a + c + 2),
    }
}

fn agrees_with_the_closed_form(situation: &Situation) -> Result<(), TestCaseError> {
    let [c, a] = [situation.current.status.len(), situation.interrupting.status.len()];
    for options in in_scope() {
        let k_i = Outlook::of(situation, Side::Interrupting, &options).accepted_at;
        let k_c = Outlook::of(situation, Side::Current, &options).accepted_at;
        let (outcome, rounds) = closed_form(k_i, k_c, a, c);

        let conclusion = situation.with(|case| case.negotiate(&options));

        prop_assert_eq!(conclusion.outcome, outcome, "{}: k_I {:?}, k_C {:?}", options, k_i, k_c);
        prop_assert_eq!(conclusion.rounds as usize, rounds, "{}: k_I {:?}, k_C {:?}", options, k_i, k_c);
        let expected = if outcome == Outcome::NoAgreement { Ending::BothQuit } else { Ending::Accepted };
        prop_assert_eq!(conclusion.ending, expected);
        prop_assert_eq!(rounds == a + c + 2, outcome == Outcome::NoAgreement);
    }
    Ok(())
}

fn agrees_with_the_naive_model(situation: &Situation) -> Result<(), TestCaseError> {
    let a = situation.interrupting.status.len();
    situation.with(|case| {
        for options in variants() {
            let c = naive::offers(situation, Side::Current, &options);
            let decision = case.decide(&options, &mut ());
            prop_assert_eq!(decision.conclusion, naive::conclusion(situation, &options), "{}", options);
            prop_assert_eq!(decision.served, naive::served(situation, &options), "{}", options);
            prop_assert!(decision.conclusion.rounds as usize <= a + c + 2, "{}", options);
        }
        Ok(())
    })
}

fn welfare_is_the_naive_sum(situation: &Situation) -> Result<(), TestCaseError> {
    situation.with(|case| {
        for options in variants() {
            let welfare = case.welfare(&options);
            let expected = |side| naive::welfare(situation, side, options.aggregation);
            let best = expected(Side::Current).max(expected(Side::Interrupting));
            for side in [Side::Current, Side::Interrupting] {
                prop_assert_eq!(u128::from(welfare.of_serving(side).0), expected(side));
                prop_assert_eq!(u128::from(welfare.regret(side).0), best - expected(side));
            }
            prop_assert_eq!(expected(welfare.best()), best);
        }
        Ok(())
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn engine_is_the_closed_form_up_to_200_conditions(situation in situations(200)) {
        agrees_with_the_closed_form(&situation)?;
    }

    #[test]
    fn engine_is_the_naive_model_under_every_variant_up_to_30_conditions(situation in situations(30)) {
        agrees_with_the_naive_model(&situation)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn engine_is_the_closed_form_where_ties_are_frequent(situation in situations(6)) {
        agrees_with_the_closed_form(&situation)?;
    }

    #[test]
    fn engine_is_the_naive_model_under_every_variant_where_ties_are_frequent(situation in situations(6)) {
        agrees_with_the_naive_model(&situation)?;
        welfare_is_the_naive_sum(&situation)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn engine_is_the_naive_model_under_every_variant_up_to_200_conditions(situation in situations(200)) {
        agrees_with_the_naive_model(&situation)?;
    }
}

/// All 4,617 cases of up to two conditions, two dispositions and ranks up to 2, under all
/// 72 variants.
#[test]
fn engine_is_the_naive_model_on_every_smallest_case() {
    let mut cases = 0;
    for situation in (0..=2).flat_map(small_domain::cases) {
        agrees_with_the_naive_model(&situation).unwrap_or_else(|e| panic!("{e}: {situation:?}"));
        cases += 1;
    }
    assert_eq!(cases, 81 + 2 * 4 * 81 + 3 * 16 * 81);
}

/// The random domains would show nothing about a rule that they never reach: every quit
/// rule, tie rule, outcome and ending that can occur together does occur in both.
#[test]
fn random_situations_reach_every_ending_of_every_rule() {
    use Ending::{Accepted, BothQuit, HeldOfferStands, LiteralQuit, Tie};
    use Side::{Current, Interrupting};
    let [current, interrupting] = [Current, Interrupting].map(Outcome::Agreement);
    let none = Outcome::NoAgreement;

    for most in [6, 30] {
        let mut seen: BTreeMap<_, usize> = BTreeMap::new();
        let mut runner = TestRunner::deterministic();
        for _ in 0..3_000 {
            let situation = situations(most).new_tree(&mut runner).unwrap().current();
            for options in variants().filter(|o| (o.willingness, o.fallback) == (0, Fallback::FirstCome)) {
                let conclusion = naive::conclusion(&situation, &options);
                *seen
                    .entry((options.quit, options.tie, conclusion.outcome, conclusion.ending))
                    .or_default() += 1;
            }
        }
        for &quit in QuitRule::ALL {
            for &tie in TieRule::ALL {
                let mut expected = vec![(current, Accepted), (interrupting, Accepted)];
                match quit {
                    QuitRule::Exhausted => expected.push((none, BothQuit)),
                    QuitRule::Literal => {
                        expected.extend([(none, LiteralQuit(Current)), (none, LiteralQuit(Interrupting))]);
                    }
                }
                if tie != TieRule::FirstSender {
                    expected.extend([(interrupting, HeldOfferStands), (none, Tie)]);
                }
                if tie == TieRule::Surplus {
                    expected.extend([(current, Tie), (interrupting, Tie)]);
                }
                for (outcome, ending) in expected {
                    let times = seen.remove(&(quit, tie, outcome, ending)).unwrap_or(0);
                    println!("up to {most}: {quit} {tie} {outcome} {ending:?}: {times}");
                    assert!(times > 0, "up to {most}: never {quit}, {tie}, {outcome}, {ending:?}");
                }
            }
        }
        assert!(seen.is_empty(), "endings that no rule allows: {seen:?}");
    }
}
