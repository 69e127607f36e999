//! Reading from a party what its own complete offer is worth to it.
use selfneg_core::{Current, Impact, Party};

fn threshold(party: &Party<'_, Current>) -> Impact {
    party.threshold
}

fn main() {
    let _ = threshold;
}
