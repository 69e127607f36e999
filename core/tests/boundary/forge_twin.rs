//! Passing an offer on as it is.
use selfneg_core::{Current, Offer};

fn as_deep(offer: Offer<'_, Current>) -> Offer<'_, Current> {
    assert!(offer.depth() > 0);
    offer
}

fn main() {
    let _ = as_deep;
}
