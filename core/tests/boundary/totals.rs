//! Reading from a verdict the two totals behind it.
use selfneg_core::{Verdict, Weighing};

fn totals(verdict: Verdict) -> Weighing {
    verdict.weighing()
}

fn main() {
    let _ = totals;
}
