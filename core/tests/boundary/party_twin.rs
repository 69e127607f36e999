//! Hearing what a party discloses with its next offer.
use selfneg_core::{Interrupting, Offer, Party};

fn offer<'a>(mut party: Party<'a, Interrupting>) -> Option<Offer<'a, Interrupting>> {
    party.offer()
}

fn main() {
    let _ = offer;
}
