//! Whatever should hold, holds for large random users too; what ever refuted it is kept in
//! `large_users.regressions` and tried first.

use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;
use selfneg_proofs::engine::Core;
use selfneg_proofs::expected::{Verdict, expected};
use selfneg_proofs::property::{Judgement, Property};
use selfneg_proofs::random::{draws, judge};
use selfneg_proofs::variant::variants;

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 128,
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct("tests/large_users.regressions"))),
        ..ProptestConfig::default()
    })]

    #[test]
    fn no_random_case_refutes_what_should_hold(draw in draws()) {
        for options in variants() {
            for &property in Property::ALL {
                if expected(property, &options) == Verdict::Holds {
                    let judgement = judge(property, &Core, &draw, &options);
                    prop_assert!(judgement != Judgement::Fails, "{property} under {options}");
                }
            }
        }
    }
}
