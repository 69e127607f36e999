//! The published policy for two interrupters, on all 27 combinations of bilateral outcomes.

use selfneg_core::policy::{Arrival, Pairing, published};
use selfneg_core::{Outcome, Side};

use Arrival::{A, B, C};
use Pairing::{AB, AC, BC};

/// What the outcomes of AB and AC lead to.
#[derive(Clone, Copy)]
enum Then {
    /// Straight to this result.
    Result(Option<Arrival>),
    /// To negotiating BC, whose winner leads to the result.
    Negotiate(fn(bc: Option<Arrival>) -> Option<Arrival>),
}

use Then::{Negotiate, Result};

/// The design's text: the winners of AB and of AC, and what they lead to.
const TABLE: [(Option<Arrival>, Option<Arrival>, Then); 9] = [
    // AB no agreement -> AC's outcome
    (None, None, Result(None)),
    (None, Some(A), Result(Some(A))),
    (None, Some(C), Result(Some(C))),
    // else AC no agreement -> AB's outcome
    (Some(A), None, Result(Some(A))),
    (Some(B), None, Result(Some(B))),
    // A beats both -> A
    (Some(A), Some(A), Result(Some(A))),
    // A lost both -> BC's outcome
    (Some(B), Some(C), Negotiate(|bc| bc)),
    // A lost exactly one -> that winner, if it also beats the other interrupter
    (Some(B), Some(A), Negotiate(|bc| if bc == Some(B) { Some(B) } else { None })),
    (Some(A), Some(C), Negotiate(|bc| if bc == Some(C) { Some(C) } else { None })),
];

fn outcome(pairing: Pairing, winner: Option<Arrival>) -> Outcome {
    let Some(winner) = winner else { return Outcome::NoAgreement };
    if winner == pairing.current() {
        return Outcome::Agreement(Side::Current);
    }
    assert_eq!(winner, pairing.interrupting(), "{winner:?} takes no part in {pairing}");
    Outcome::Agreement(Side::Interrupting)
}

#[test]
fn all_27_combinations_are_as_published() {
    let mut combinations = 0;
    for (ab, ac, then) in TABLE {
        for bc in [None, Some(B), Some(C)] {
            let mut asked = Vec::new();
            let served = published(|pairing| {
                asked.push(pairing);
                outcome(
                    pairing,
                    match pairing {
                        AB => ab,
                        AC => ac,
                        BC => bc,
                    },
                )
            });

            let (expected, expected_asked) = match then {
                Result(result) => (result, vec![AB, AC]),
                Negotiate(then) => (then(bc), vec![AB, AC, BC]),
            };
            assert_eq!(served, expected, "AB {ab:?}, AC {ac:?}, BC {bc:?}");
            assert_eq!(asked, expected_asked, "AB {ab:?}, AC {ac:?}, BC {bc:?}");
            combinations += 1;
        }
    }
    assert_eq!(combinations, 27);
}

/// What the policy is criticised for: C beats B, who is served.
#[test]
fn it_can_serve_a_user_whom_somebody_present_beats() {
    let served = published(|pairing| {
        outcome(
            pairing,
            match pairing {
                AB => Some(B),
                AC => None,
                BC => Some(C),
            },
        )
    });
    assert_eq!(served, Some(B));
}

#[test]
fn in_each_pairing_the_earlier_arrival_is_current() {
    for (pairing, current, interrupting, name) in [(AB, A, B, "AB"), (AC, A, C, "AC"), (BC, B, C, "BC")] {
        assert_eq!((pairing.current(), pairing.interrupting()), (current, interrupting));
        assert_eq!(pairing.winner(Outcome::Agreement(Side::Current)), Some(current));
        assert_eq!(pairing.winner(Outcome::Agreement(Side::Interrupting)), Some(interrupting));
        assert_eq!(pairing.winner(Outcome::NoAgreement), None);
        assert_eq!(pairing.to_string(), name);
    }
}
