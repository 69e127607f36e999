//! Two users and their rules as owned lists, how to draw them at random, and how to hand
//! them to the engine.
#![allow(dead_code, reason = "each test file takes the part it needs")]
#![allow(clippy::unwrap_used, reason = "clippy looks for tests only in functions marked so")]

use std::collections::BTreeSet;

use proptest::collection::{btree_set, vec};
use proptest::prelude::*;
use proptest::sample::subsequence;
use selfneg_core::{
    Activation, Aggregation, Case, Condition, Disposition, EthicalProfile, Fallback, Implication, Options,
    QuitRule, Rank, Side, Status, TieRule, User,
};

/// One user. Lists shorter than the number of dispositions mean 0 for the rest.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Person {
    pub(crate) ranks: Vec<u8>,
    pub(crate) status: Vec<u16>,
    pub(crate) mentions: Vec<u8>,
}

impl Person {
    fn rank_at_most_1(&mut self, dispositions: &BTreeSet<u16>) {
        for &disposition in dispositions {
            if let Some(rank) = self.ranks.get_mut(usize::from(disposition)) {
                *rank %= 2;
            }
        }
    }
}

/// A whole case: row `c` of `rows` lists what condition `c` activates.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Situation {
    pub(crate) rows: Vec<Vec<u16>>,
    pub(crate) current: Person,
    pub(crate) interrupting: Person,
}

impl Situation {
    pub(crate) fn person(&self, side: Side) -> &Person {
        match side {
            Side::Current => &self.current,
            Side::Interrupting => &self.interrupting,
        }
    }

    pub(crate) fn swapped(&self) -> Self {
        Self {
            rows: self.rows.clone(),
            current: self.interrupting.clone(),
            interrupting: self.current.clone(),
        }
    }

    /// The dispositions that conditions of `side` activate and none of the other user's.
    fn reaches_only(&self, side: Side) -> BTreeSet<u16> {
        let reaches = |side: Side| -> BTreeSet<u16> {
            let status = self.person(side).status.iter();
            status.filter_map(|&condition| self.rows.get(usize::from(condition))).flatten().copied().collect()
        };
        reaches(side).difference(&reaches(side.other())).copied().collect()
    }

    /// Lends the case to `f`.
    pub(crate) fn with<T>(&self, f: impl FnOnce(&Case<'_>) -> T) -> T {
        let rows: Vec<Vec<Disposition>> =
            self.rows.iter().map(|row| row.iter().copied().map(Disposition).collect()).collect();
        let rows: Vec<&[Disposition]> = rows.iter().map(Vec::as_slice).collect();
        let [current, interrupting] = [&self.current, &self.interrupting].map(|person| {
            let ranks: Vec<Rank> = person.ranks.iter().copied().map(Rank).collect();
            let status: Vec<Condition> = person.status.iter().copied().map(Condition).collect();
            (ranks, status)
        });
        f(&Case {
            activation: Activation::new(&rows).unwrap(),
            current: user(&current, &self.current.mentions),
            interrupting: user(&interrupting, &self.interrupting.mentions),
        })
    }
}

fn user<'a>((ranks, status): &'a (Vec<Rank>, Vec<Condition>), mentions: &'a [u8]) -> User<'a> {
    User::new(EthicalProfile::new(ranks), Status::new(status).unwrap(), Implication::new(mentions))
}

/// Every variant with willingness 0, 1 and 2.
pub(crate) fn variants() -> impl Iterator<Item = Options> {
    QuitRule::ALL.iter().flat_map(|&quit| {
        Aggregation::ALL.iter().flat_map(move |&aggregation| {
            TieRule::ALL.iter().flat_map(move |&tie| {
                Fallback::ALL.iter().flat_map(move |&fallback| {
                    (0..=2).map(move |willingness| Options { quit, aggregation, tie, fallback, willingness })
                })
            })
        })
    })
}

/// Users of at most `most` conditions each. Rules that share dispositions among
/// conditions, statuses that share conditions among users and include some without a row,
/// goals that imply all or some dispositions, once or more often; ranks up to 1, 3 or 255,
/// so that equal totals are frequent. In every second one the users share no condition
/// and rank at most 1 what only their own ones activate, so that mutual deference is
/// frequent.
pub(crate) fn situations(most: usize) -> impl Strategy<Value = Situation> {
    let small_or_any_rank = prop_oneof![Just(1u8), Just(3), Just(255)];
    (0..=most, 1..=most.clamp(2, 40), small_or_any_rank).prop_flat_map(|(conditions, dispositions, most_rank)| {
        let disposition = 0..u16::try_from(dispositions).unwrap();
        let rows = vec(
            prop_oneof![
                3 => disposition.clone().prop_map(|d| vec![d]),
                1 => btree_set(disposition, 0..=4).prop_map(|row| row.into_iter().collect::<Vec<_>>()).prop_shuffle(),
            ],
            conditions.saturating_sub(1)..=conditions,
        );
        let person = || {
            let mentions = prop_oneof![
                2 => Just(vec![1; dispositions]),
                2 => vec(0..=1u8, 0..=dispositions),
                1 => vec(0..=3u8, 0..=dispositions),
                1 => vec(any::<u8>(), 0..=dispositions),
            ];
            let all: Vec<u16> = (0..u16::try_from(conditions).unwrap()).collect();
            (
                vec(0..=most_rank, dispositions.saturating_sub(1)..=dispositions),
                subsequence(all, 0..=conditions).prop_shuffle(),
                mentions,
            )
                .prop_map(|(ranks, status, mentions)| Person { ranks, status, mentions })
        };
        (rows, person(), person(), any::<bool>()).prop_map(|(rows, current, interrupting, deferential)| {
            let mut situation = Situation { rows, current, interrupting };
            if deferential {
                situation.current.status.retain(|condition| condition % 2 == 0);
                situation.interrupting.status.retain(|condition| condition % 2 == 1);
                let [current, interrupting] =
                    [Side::Current, Side::Interrupting].map(|side| situation.reaches_only(side));
                situation.current.rank_at_most_1(&current);
                situation.interrupting.rank_at_most_1(&interrupting);
            }
            situation
        })
    })
}
