//! Going on after the conclusion.
use selfneg_core::{Conclusion, Negotiation, Step};

fn go_on(negotiation: Negotiation<'_>) -> Option<Conclusion> {
    match negotiation.step(&mut ()) {
        Step::Concluded(_) => Some(negotiation.run(&mut ())),
        Step::Ongoing(_) => None,
    }
}

fn main() {
    let _ = go_on;
}
