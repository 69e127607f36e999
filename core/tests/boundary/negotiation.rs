//! Reaching a user's party through the negotiation.
use selfneg_core::{Current, Negotiation, Party};

fn current<'a>(negotiation: Negotiation<'a>) -> Party<'a, Current> {
    negotiation.current
}

fn main() {
    let _ = current;
}
