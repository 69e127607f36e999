//! Lotteries: the utilitarian one against the largest welfare, the egalitarian one against
//! the minimax theorem, the Nash one against its own exact factor.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test may panic")]

use proptest::prelude::*;
use selfneg_model::Impacts;
use selfneg_model::exact::{Rational, rational};
use selfneg_model::lottery::{LotteryError, MAX_USERS, egalitarian, nash, utilitarian};

fn impacts(users: std::ops::RangeInclusive<usize>, most: u64) -> impl Strategy<Value = Impacts> {
    users
        .prop_flat_map(move |n| prop::collection::vec(prop::collection::vec(0..=most, n), n))
        .prop_map(|rows| Impacts::of_rows(rows).unwrap())
}

fn expected(impacts: &Impacts, shares: &[Rational], user: usize) -> Rational {
    impacts.in_eyes_of(user).iter().zip(shares).map(|(&impact, share)| rational(impact) * share).sum()
}

fn is_distribution(shares: &[Rational]) -> bool {
    shares.iter().all(|share| *share >= rational(0)) && shares.iter().sum::<Rational>() == rational(1)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_utilitarian_lottery_is_worth_the_largest_welfare(impacts in impacts(1..=7, 30)) {
        let lottery = utilitarian(&impacts).unwrap();
        let best = (0..impacts.users()).map(|user| impacts.welfare(user)).max().unwrap();
        prop_assert_eq!(&lottery.value, &rational(best));
        prop_assert_eq!(&lottery.bound, &rational(best));
        prop_assert!(is_distribution(&lottery.shares));
        for (user, share) in lottery.shares.iter().enumerate() {
            prop_assert!(*share == rational(0) || impacts.optimal().contains(&user));
        }
    }

    #[test]
    fn nobody_expects_less_than_the_egalitarian_value(impacts in impacts(1..=7, 30)) {
        let lottery = egalitarian(&impacts).unwrap();
        prop_assert!(is_distribution(&lottery.shares));
        let least = (0..impacts.users()).map(|user| expected(&impacts, &lottery.shares, user)).min();
        prop_assert_eq!(least.as_ref(), Some(&lottery.value));
        prop_assert_eq!(&lottery.value, &lottery.bound);
        // Serving one user for certain, or all with equal chances, does not beat it.
        let even = vec![Rational::new(1.into(), impacts.users().into()); impacts.users()];
        let worst = (0..impacts.users()).map(|user| expected(&impacts, &even, user)).min().unwrap();
        prop_assert!(worst <= lottery.value);
        for served in 0..impacts.users() {
            let worst = (0..impacts.users()).map(|user| impacts.of_serving(served, user)).min().unwrap();
            prop_assert!(rational(worst) <= lottery.value);
        }
    }

    #[test]
    fn no_lottery_exceeds_the_nash_factor(
        impacts in impacts(2..=6, 30),
        other in prop::collection::vec(0_u32..50, 6),
    ) {
        let lottery = nash(&impacts).unwrap();
        prop_assert!(is_distribution(&lottery.shares));
        prop_assert!(lottery.factor >= rational(1));
        prop_assert!(lottery.factor <= Rational::new(10_001.into(), 10_000.into()), "{}", lottery.factor);
        let total: u32 = other[..impacts.users()].iter().sum();
        prop_assume!(total > 0);
        let other: Vec<Rational> =
            other[..impacts.users()].iter().map(|&o| Rational::new(o.into(), total.into())).collect();
        let caring: Vec<usize> =
            (0..impacts.users()).filter(|user| !lottery.indifferent.contains(user)).collect();
        let product = |shares: &[Rational]| -> Rational {
            caring.iter().map(|&user| expected(&impacts, shares, user)).product()
        };
        let power: Rational = caring.iter().map(|_| lottery.factor.clone()).product();
        prop_assert!(product(&other) <= product(&lottery.shares) * power);
    }
}

#[test]
fn nobody_cannot_be_served() {
    let nobody = Impacts::of_rows(vec![]).unwrap();
    for error in [utilitarian(&nobody).unwrap_err(), egalitarian(&nobody).unwrap_err()] {
        assert_eq!(error, LotteryError::NoUsers);
    }
    assert_eq!(nash(&nobody).unwrap_err(), LotteryError::NoUsers);
}

#[test]
fn one_user_is_served_for_certain() {
    for worth in [0, 9] {
        let alone = Impacts::of_rows(vec![vec![worth]]).unwrap();
        assert_eq!(utilitarian(&alone).unwrap().shares, [rational(1)]);
        let fair = egalitarian(&alone).unwrap();
        assert_eq!((fair.shares, fair.value), (vec![rational(1)], rational(worth)));
        assert_eq!(nash(&alone).unwrap().shares, [rational(1)]);
    }
}

#[test]
fn a_hundred_users_have_lotteries_and_more_than_the_limit_are_refused() {
    let many = |users: u64| {
        let row = |eyes| (0..users).map(|served| (eyes * 7 + served * 13 + eyes * served) % 31).collect();
        Impacts::of_rows((0..users).map(row).collect()).unwrap()
    };
    let hundred = many(100);
    let best = utilitarian(&hundred).unwrap();
    assert_eq!(best.value, best.bound);
    let fair = egalitarian(&hundred).unwrap();
    assert_eq!(fair.value, fair.bound);
    assert!(nash(&hundred).unwrap().factor < Rational::new(1001.into(), 1000.into()));
    assert_eq!(utilitarian(&many(129)).unwrap_err(), LotteryError::TooManyUsers { found: MAX_USERS + 1 });
}

#[test]
fn where_opposite_interests_meet_the_criteria_differ() {
    // User 0 gains 9 by being served, user 1 only 2, user 2 is at 1 either way.
    let impacts = Impacts::of_rows(vec![vec![9, 0, 0], vec![0, 2, 0], vec![1, 1, 1]]).unwrap();
    assert_eq!(utilitarian(&impacts).unwrap().shares, [rational(1), rational(0), rational(0)]);
    let half = Rational::new(1.into(), 2.into());
    assert_eq!(nash(&impacts).unwrap().shares, [half.clone(), half, rational(0)]);
    let fair = egalitarian(&impacts).unwrap();
    assert_eq!(fair.value, rational(1));
}
