//! Reading from an offer the whole status of its sender.
use selfneg_core::{Interrupting, Offer, Status};

fn status<'a>(offer: &Offer<'a, Interrupting>) -> Status<'a> {
    offer.status()
}

fn main() {
    let _ = status;
}
