//! Deepening an offer by more than its sender has disclosed.
use selfneg_core::{Current, Offer};

fn deeper(mut offer: Offer<'_, Current>) -> Offer<'_, Current> {
    offer.depth = 9;
    offer
}

fn main() {
    let _ = deeper;
}
