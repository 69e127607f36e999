//! When a receiver may add to the total it has instead of weighing an offer anew. Results
//! cannot show a refusal, only the time that a long negotiation takes, so this asks the
//! function itself: the source files are compiled into this test.
#![allow(dead_code, unreachable_pub, reason = "whole modules are here, of which one function is checked")]
#![allow(clippy::indexing_slicing, reason = "clippy looks for tests only in functions marked so")]

#[path = "../src/impact.rs"]
mod impact;
#[path = "../src/options.rs"]
mod options;
#[path = "../src/rules.rs"]
mod rules;
#[path = "../src/user.rs"]
mod user;

use impact::Disclosed;
use rules::{Condition, Implication};

// In memory once: what is compared is where they are.
static CONDITIONS: [Condition; 5] = [Condition(0), Condition(1), Condition(2), Condition(3), Condition(4)];
static MENTIONS: [u8; 4] = [1, 0, 2, 1];

/// Of the offers that one list of conditions and one list of mentions can make, one
/// continues another exactly if the goal is the same and it discloses no less. That the
/// conditions are in memory once is what an offer and the next one of the same sender have
/// in common.
#[test]
fn an_offer_continues_those_of_its_sender_that_disclose_no_more() {
    let mut continued = 0;
    for (goal, depth) in goals_and_depths() {
        let offer = disclosed(goal, depth);
        for (earlier_goal, earlier_depth) in goals_and_depths() {
            let earlier = disclosed(earlier_goal, earlier_depth);
            let expected = goal == earlier_goal && earlier_depth <= depth;
            assert_eq!(
                offer.continues(earlier),
                expected,
                "goal {goal:?}, depth {depth}, after goal {earlier_goal:?}, depth {earlier_depth}"
            );
            continued += u32::from(expected);
        }
    }
    // Ten stretches of the mentions, 21 pairs of depths.
    assert_eq!(continued, 10 * 21);
}

/// Equal conditions elsewhere in memory are a yes that it may miss; other conditions, and
/// another goal of the same length, are a no that it must not.
#[test]
fn an_offer_does_not_continue_one_of_other_memory() {
    let other_conditions = [4, 3, 2, 1, 0].map(Condition);
    let other_mentions = [0, 1, 2, 1];
    let offer = disclosed((0, 4), 5);
    for depth in 1..=5 {
        let conditions = &other_conditions[..depth];
        assert!(!offer.continues(Disclosed { conditions, ..offer }));
        let goal = Implication::new(&other_mentions);
        assert!(!offer.continues(Disclosed { goal, ..disclosed((0, 4), depth) }));
    }
    assert!(!offer.continues(Disclosed::NOTHING));
}

/// Every stretch of the mentions that is not empty, with every depth.
fn goals_and_depths() -> impl Iterator<Item = ((usize, usize), usize)> {
    (0..4).flat_map(|start| (start + 1..=4).flat_map(move |end| (0..=5).map(move |d| ((start, end), d))))
}

fn disclosed((start, end): (usize, usize), depth: usize) -> Disclosed<'static> {
    Disclosed { goal: Implication::new(&MENTIONS[start..end]), conditions: &CONDITIONS[..depth] }
}
