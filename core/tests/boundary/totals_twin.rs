//! Reading from a verdict what it says: by how much an offer is acceptable, if it is.
use selfneg_core::{Surplus, Verdict};

fn surplus(verdict: Verdict) -> Option<Surplus> {
    match verdict {
        Verdict::Acceptable(surplus) => Some(surplus),
        Verdict::Rejected => None,
    }
}

fn main() {
    let _ = surplus;
}
