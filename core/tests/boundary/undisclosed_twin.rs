//! Reading from an offer what it discloses.
use selfneg_core::{Condition, Interrupting, Offer};

fn disclosed<'a>(offer: &Offer<'a, Interrupting>) -> &'a [Condition] {
    offer.conditions()
}

fn main() {
    let _ = disclosed;
}
