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
