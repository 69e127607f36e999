//! Going on while there is no conclusion.
use selfneg_core::{Conclusion, Negotiation, Step};

fn go_on(negotiation: Negotiation<'_>) -> Conclusion {
    match negotiation.step(&mut ()) {
        Step::Concluded(conclusion) => conclusion,
        Step::Ongoing(next) => next.run(&mut ()),
    }
}

fn main() {
    let _ = go_on;
}
