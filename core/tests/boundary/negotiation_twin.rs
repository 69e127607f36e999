//! Asking the negotiation how much a user has disclosed.
use selfneg_core::{Negotiation, Side};

fn disclosed(negotiation: &Negotiation<'_>) -> usize {
    negotiation.depth(Side::Current)
}

fn main() {
    let _ = disclosed;
}
