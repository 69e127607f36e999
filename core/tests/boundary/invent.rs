//! Making an offer that nobody made.
use selfneg_core::{Condition, Current, Implication, Offer};

fn offer<'a>(goal: Implication<'a>, conditions: &'a [Condition]) -> Offer<'a, Current> {
    Offer::new(goal, conditions)
}

fn main() {
    let _ = offer;
}
