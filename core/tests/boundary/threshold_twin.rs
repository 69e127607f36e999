//! Reading from a party how many offers it has made.
use selfneg_core::{Current, Party};

fn made(party: &Party<'_, Current>) -> usize {
    party.offers_made()
}

fn main() {
    let _ = made;
}
