//! The policy `condorcet` against its definition, for every beats-graph of up to four
//! users.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test may panic")]

use selfneg_core::{Outcome, Side};
use selfneg_model::{Condorcet, Precedence};

fn pairs(users: usize) -> Vec<(usize, usize)> {
    (0..users).flat_map(|earlier| (earlier + 1..users).map(move |later| (earlier, later))).collect()
}

/// Every assignment of an outcome to every pair of users.
fn every_negotiation(users: usize) -> impl Iterator<Item = Condorcet> {
    let pairs = pairs(users);
    let outcomes =
        [Outcome::Agreement(Side::Current), Outcome::Agreement(Side::Interrupting), Outcome::NoAgreement];
    (0..3usize.pow(u32::try_from(pairs.len()).unwrap())).map(move |code| {
        Condorcet::negotiate(users, |earlier, later| {
            let at = pairs.iter().position(|&pair| pair == (earlier, later)).unwrap();
            outcomes[code / 3usize.pow(u32::try_from(at).unwrap()) % 3]
        })
    })
}

/// Reachability by brute force: the definition needs no components.
fn reaches(condorcet: &Condorcet, from: usize, to: usize) -> bool {
    let mut seen = vec![from];
    let mut next = 0;
    while next < seen.len() {
        for user in 0..condorcet.beats().users() {
            if condorcet.beats().beats(seen[next], user) && !seen.contains(&user) {
                seen.push(user);
            }
        }
        next += 1;
    }
    seen.contains(&to)
}

#[test]
fn an_agreement_is_a_user_who_beats_everyone_else() {
    for users in 1..=4 {
        for condorcet in every_negotiation(users) {
            let winners: Vec<usize> = (0..users)
                .filter(|&w| (0..users).all(|other| other == w || condorcet.beats().beats(w, other)))
                .collect();
            match condorcet.precedence() {
                Precedence::Agreement(winner) => assert_eq!(winners, [winner]),
                Precedence::NoAgreement { .. } => assert_eq!(winners, [0; 0]),
            }
        }
    }
}

#[test]
fn candidates_are_the_users_who_beat_back_whoever_beats_them() {
    for users in 2..=4 {
        for condorcet in every_negotiation(users) {
            let Precedence::NoAgreement { candidates } = condorcet.precedence() else { continue };
            let schwartz: Vec<usize> = (0..users)
                .filter(|&user| {
                    (0..users)
                        .all(|other| !reaches(&condorcet, other, user) || reaches(&condorcet, user, other))
                })
                .collect();
            assert_eq!(candidates, schwartz);
            assert!(!candidates.is_empty());
        }
    }
}

#[test]
fn a_winner_is_beaten_by_nobody() {
    for condorcet in every_negotiation(4) {
        if let Precedence::Agreement(winner) = condorcet.precedence() {
            assert_eq!(condorcet.beats().beaten_by(winner), [0; 0]);
        }
    }
}

#[test]
fn without_users_there_is_nobody_to_serve() {
    let nobody = Condorcet::negotiate(0, |_, _| Outcome::NoAgreement);
    assert_eq!(nobody.precedence(), Precedence::NoAgreement { candidates: vec![] });
}

#[test]
fn the_smith_set_is_the_smallest_whose_members_beat_all_others() {
    for users in 1..=4_usize {
        for condorcet in every_negotiation(users) {
            let beats = condorcet.beats();
            let dominates = |set: usize| {
                let has = |user: usize| set >> user & 1 == 1;
                (0..users)
                    .filter(|&u| has(u))
                    .all(|u| (0..users).filter(|&v| !has(v)).all(|v| beats.beats(u, v)))
            };
            let smallest =
                (1..1_usize << users).filter(|&set| dominates(set)).min_by_key(|set| set.count_ones());
            let members: Vec<usize> = (0..users).filter(|u| smallest.unwrap() >> u & 1 == 1).collect();
            assert_eq!(beats.smith_set(), members);
            assert!(beats.schwartz_set().iter().all(|user| members.contains(user)));
        }
    }
}

#[test]
fn a_cycle_is_named_for_every_set_of_users_who_reach_each_other() {
    for condorcet in every_negotiation(4) {
        let beats = condorcet.beats();
        let in_cycle: Vec<usize> = (0..4)
            .filter(|&u| (0..4).any(|v| v != u && reaches(&condorcet, u, v) && reaches(&condorcet, v, u)))
            .collect();
        let cycles = beats.cycles();
        assert_eq!(cycles.is_empty(), in_cycle.is_empty());
        for cycle in cycles {
            assert!(cycle.len() >= 3 && cycle.iter().all(|user| in_cycle.contains(user)));
            for (at, &user) in cycle.iter().enumerate() {
                assert!(beats.beats(user, cycle[(at + 1) % cycle.len()]));
            }
        }
    }
}
