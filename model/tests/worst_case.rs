//! The worst case over real-valued ranks against every case of small whole-number domains,
//! for every protocol variant, and its instances against the engine.

#![allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing, reason = "a test may panic")]

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use selfneg_core::{
    Activation, Aggregation, Case, Condition, Disposition, EthicalProfile, Fallback, Implication, Options,
    Outcome, QuitRule, Rank, Side, Status, TieRule, User,
};
use selfneg_model::exact::{Rational, rational};
use selfneg_model::worst_case::{Instance, MAX_DISPOSITIONS, Person, WorstCase, WorstCaseError, worst_case};
use selfneg_model::{Cause, Decided, Impacts, Regret};

fn variants(willingness: &[u8]) -> Vec<Options> {
    let mut all = Vec::new();
    for &quit in QuitRule::ALL {
        for &tie in TieRule::ALL {
            for &fallback in Fallback::ALL {
                for &willingness in willingness {
                    let aggregation = Aggregation::PerCondition;
                    all.push(Options { quit, aggregation, tie, fallback, willingness });
                }
            }
        }
    }
    all
}

fn worst(dispositions: usize, ranks: RangeInclusive<u8>, options: &Options) -> WorstCase {
    let worst = worst_case(dispositions, ranks, options, &|_, _| ()).unwrap();
    assert!(worst.certified);
    worst
}

/// Hands a case with these conditions and ranks to the engine.
fn with_case<R>(people: [(&[usize], &[u8]); 2], use_case: impl FnOnce(&Case<'_>) -> R) -> R {
    let rows: Vec<[Disposition; 1]> =
        (0..MAX_DISPOSITIONS).map(|d| [Disposition(d.try_into().unwrap())]).collect();
    let rows: Vec<&[Disposition]> = rows.iter().map(|row| &row[..]).collect();
    let activation = Activation::new(&rows).unwrap();
    let people = people.map(|(conditions, ranks)| {
        let conditions: Vec<Condition> =
            conditions.iter().map(|&c| Condition(c.try_into().unwrap())).collect();
        (conditions, ranks.iter().map(|&rank| Rank(rank)).collect::<Vec<_>>())
    });
    let goal = [1; MAX_DISPOSITIONS];
    let [current, interrupting] = [0, 1].map(|side: usize| {
        let (conditions, ranks) = &people[side];
        User::new(EthicalProfile::new(ranks), Status::new(conditions).unwrap(), Implication::new(&goal))
    });
    use_case(&Case { activation, current, interrupting })
}

fn regret(case: &Case<'_>, options: &Options) -> (Regret, Outcome) {
    let decision = case.decide(options, &mut ());
    let outcome = decision.conclusion.outcome;
    let arrival = |side| usize::from(side == Side::Interrupting);
    let agreement = outcome.winner().map(arrival);
    let impacts = Impacts::among(&[case.current, case.interrupting], case.activation, options.aggregation);
    let beat = |winner: usize, loser: usize| agreement == Some(winner) && loser != winner;
    let decided = Decided {
        agreement,
        served: arrival(decision.served),
        beat: &beat,
        willingness: options.willingness,
    };
    let regret = Regret::of(&impacts, &decided);
    assert_eq!(regret.amount, case.welfare(options).regret(decision.served).0);
    (regret, outcome)
}

/// The largest regret by cause over all pairs of users with whole-number ranks.
fn every_case(dispositions: usize, ranks: RangeInclusive<u8>, options: &Options) -> BTreeMap<Cause, u64> {
    let profiles: Vec<Vec<u8>> = (0..dispositions).fold(vec![vec![]], |shorter, _| {
        let longer = |profile: &Vec<u8>| {
            ranks.clone().map(|rank| [&profile[..], &[rank]].concat()).collect::<Vec<_>>()
        };
        shorter.iter().flat_map(longer).collect()
    });
    let statuses: Vec<Vec<usize>> = (0..1_usize << dispositions)
        .map(|bits| (0..dispositions).filter(|d| bits >> d & 1 == 1).collect())
        .collect();
    let mut worst = BTreeMap::new();
    for current in &statuses {
        for interrupting in &statuses {
            for mine in &profiles {
                for theirs in &profiles {
                    let (regret, _) =
                        with_case([(current, mine), (interrupting, theirs)], |case| regret(case, options));
                    let known = worst.entry(regret.cause).or_insert(0);
                    *known = regret.amount.max(*known);
                }
            }
        }
    }
    worst
}

#[test]
fn no_whole_number_case_exceeds_the_certified_bounds_and_some_case_meets_them() {
    for (dispositions, ranks) in [(1, 0..=3), (2, 0..=3), (2, 1..=4)] {
        for options in variants(&[0, 1, 2]) {
            let bounds = worst(dispositions, ranks.clone(), &options);
            for (cause, largest) in every_case(dispositions, ranks.clone(), &options) {
                let Some(bound) = bounds.by_cause.get(&cause) else {
                    // The programmes call an agreement by its worst possible cause.
                    assert!(cause == Cause::AgreedAndOptimal && largest == 0, "{options} {cause}");
                    continue;
                };
                assert!(bound.whole <= bound.supremum);
                assert_eq!(rational(largest), bound.whole, "{options} {cause} {dispositions} {ranks:?}");
            }
        }
    }
}

#[test]
fn an_agreement_that_only_the_loser_accepts_loses_nothing_whatever_the_ranks() {
    for options in variants(&[0, 1]) {
        let bounds = worst(3, 0..=5, &options);
        for cause in [Cause::AgreedAndOptimal, Cause::Willingness] {
            if let Some(bound) = bounds.by_cause.get(&cause) {
                // Willingness 1 can cost less than 1, which whole numbers do not show.
                let most = rational(options.willingness);
                assert!(bound.supremum <= most && bound.whole == rational(0), "{options} {cause}");
                assert!(options.willingness > 0 || bound.supremum == rational(0));
            }
        }
    }
}

/// Ranks in units so small that all are whole, for the engine.
fn in_units(person: &Person, units: u8) -> Vec<u8> {
    let scaled = |rank: &Rational| {
        let rank = rank * rational(units);
        assert!(rank.is_integer(), "{rank}");
        u8::try_from(rank.to_integer()).unwrap()
    };
    person.ranks.iter().map(scaled).collect()
}

fn units(instance: &Instance) -> u8 {
    let ranks = instance.current.ranks.iter().chain(&instance.interrupting.ranks);
    let whole = |units: &u8| ranks.clone().all(|rank| (rank * rational(*units)).is_integer());
    (1..=50).find(whole).unwrap_or_else(|| panic!("{instance:?}"))
}

#[test]
fn the_engine_agrees_with_every_instance() {
    for options in variants(&[0, 1, 2]) {
        for (cause, worst) in worst(3, 1..=5, &options).by_cause {
            let Some(instance) = worst.instance else {
                assert_eq!(worst.supremum, rational(0));
                continue;
            };
            let units = units(&instance);
            let options = Options { willingness: options.willingness * units, ..options };
            let (mine, theirs) =
                (in_units(&instance.current, units), in_units(&instance.interrupting, units));
            let people = [
                (&instance.current.conditions[..], &mine[..]),
                (&instance.interrupting.conditions[..], &theirs[..]),
            ];
            let (regret, outcome) = with_case(people, |case| regret(case, &options));
            assert_eq!(outcome, instance.outcome, "{options}");
            assert_eq!(regret.cause, cause, "{options}");
            assert_eq!(rational(regret.amount), &instance.regret * rational(units), "{options}");
            let short = &worst.supremum - &instance.regret;
            if worst.attained {
                assert_eq!(short, rational(0));
            } else {
                assert!(short > rational(0) && short < rational(1), "{options}: {short}");
            }
        }
    }
}

#[test]
fn impossible_domains_are_refused() {
    let of = |dispositions, ranks| worst_case(dispositions, ranks, &Options::default(), &|_, _| ());
    assert_eq!(of(0, 1..=5).unwrap_err(), WorstCaseError::Dispositions { found: 0 });
    assert_eq!(of(11, 1..=5).unwrap_err(), WorstCaseError::Dispositions { found: 11 });
    #[expect(clippy::reversed_empty_ranges, reason = "that is what is refused")]
    let reversed = 5..=1;
    assert_eq!(of(3, reversed).unwrap_err(), WorstCaseError::NoRanks { lowest: 5, highest: 1 });
}
