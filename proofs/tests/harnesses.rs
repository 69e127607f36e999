//! Every body of a Kani harness runs on stable, on random draws, and reaches every outcome
//! that it claims to reach.

use std::collections::BTreeSet;

use selfneg_proofs::harness::{ALL, Source};

/// `SplitMix64`: small, and the same everywhere.
struct Random {
    state: u64,
    covered: BTreeSet<&'static str>,
}

impl Source for Random {
    fn below(&mut self, bound: u8) -> u8 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        u8::try_from((mixed ^ (mixed >> 31)) % u64::from(bound)).unwrap_or(0)
    }

    fn covered(&mut self, what: &'static str) {
        self.covered.insert(what);
    }
}

const DRAWS: u32 = 20_000;

#[test]
fn every_harness_holds_and_reaches_all_its_covers() {
    for harness in ALL {
        let mut source = Random { state: 2, covered: BTreeSet::new() };
        for _ in 0..DRAWS {
            (harness.run)(&mut source);
        }
        assert_eq!(source.covered.len(), harness.covers, "{}: reached {:?}", harness.name, source.covered);
    }
}

#[test]
fn names_are_distinct() {
    let names: BTreeSet<_> = ALL.iter().map(|harness| harness.name).collect();
    assert_eq!(names.len(), ALL.len());
}
