//! The table of expected verdicts, on the engine that robots run: what should hold is
//! borne out by every case of small domains and by large random ones, and what should fail
//! is refuted by users whom one can look at. The larger domains are for `selfneg verify`.

use selfneg_core::Fallback;
use selfneg_proofs::engine::Core;
use selfneg_proofs::enumeration::{Domain, outcome_triples};
use selfneg_proofs::expected::{Verdict, expected, expected_of_policy, looks_at_fallback};
use selfneg_proofs::harness::witness::{WITNESSES, refuted};
use selfneg_proofs::property::policy::{PolicyProperty, Published};
use selfneg_proofs::property::{Alteration, Judgement, Property};
use selfneg_proofs::report::{Method, verify, verify_every_variant, verify_over, verify_policy};
use selfneg_proofs::variant::variants;

fn small(property: Property) -> &'static [Domain] {
    match (property, property.alteration()) {
        (Property::OrderNeedsDeference, _) => &[Domain::THREE_ORDERED],
        (Property::HidingNeedsDeference, _) => &[Domain::THREE_HIGH],
        (_, Alteration::Hidden | Alteration::Undisclosed) => &[Domain::THREE_HIGH],
        (_, _) => &[Domain::TWO, Domain::SHARED_TWO],
    }
}

#[test]
fn what_should_hold_does_on_every_case_of_small_domains() {
    for &property in Property::ALL {
        for options in variants() {
            let repeated = options.fallback != Fallback::FirstCome && !looks_at_fallback(property);
            if expected(property, &options) == Verdict::Holds && !repeated {
                let report = verify_over(property, &options, &Core, small(property));
                assert!(report.is_as_expected(), "{property} under {options}: {report:?}");
                assert!(report.nonvacuous > 0, "{property} under {options} says nothing");
            }
        }
    }
}

#[test]
fn what_should_fail_is_refuted_by_a_witness() {
    for &property in Property::ALL {
        for options in variants() {
            let fails = expected(property, &options) == Verdict::Fails;
            assert_eq!(refuted(property, &Core, &options), fails, "{property} under {options}");
        }
    }
}

#[test]
fn kani_can_unwind_the_list_of_witnesses() {
    assert!(WITNESSES.len() + 1 < 24, "raise `unwind` of the harnesses that go through it");
}

#[test]
fn large_random_users_bear_the_table_out() {
    for &property in Property::ALL {
        for options in variants().filter(|options| options.fallback == Fallback::FirstCome) {
            let report = verify(property, &options, &Core, Method::Random { cases: 12, seed: 3 });
            assert!(report.is_as_expected(), "{property} under {options}: {report:?}");
        }
    }
}

#[test]
fn the_published_policy_is_as_expected() {
    assert_eq!(outcome_triples().len(), 27);
    let domain = Domain { name: "3 users of 2 dispositions, ranks {0, 3}", ranks: &[0, 3], ..Domain::TWO };
    for &property in PolicyProperty::ALL {
        for options in variants().filter(|options| options.fallback == Fallback::FirstCome) {
            let report = verify_policy(
                property,
                &options,
                &Published,
                &Core,
                &domain,
                expected_of_policy(property, &options),
            );
            assert!(report.is_as_expected(), "{property} under {options}: {report:?}");
        }
    }
}

#[test]
fn variants_that_share_a_run_say_so_of_themselves() {
    let method = Method::Random { cases: 200, seed: 1 };
    let reports = verify_every_variant(Property::RoleSymmetry, &Core, method);
    assert!(reports.iter().map(|report| report.options).eq(variants()));
    for report in &reports {
        assert_eq!(report.expected, expected(Property::RoleSymmetry, &report.options));
        assert!(report.counterexample.as_ref().is_none_or(|found| found.options == report.options));
        assert!(report.is_as_expected());
    }
}

#[test]
fn random_search_finds_and_shrinks_what_fails() {
    let options = Default::default();
    for (property, most) in
        [(Property::RoleSymmetry, 2), (Property::HideProofness, 5), (Property::MisreportProofness, 2)]
    {
        let report = verify(property, &options, &Core, Method::Random { cases: 2_000, seed: 1 });
        let found = report.counterexample.expect("random search should find it");
        assert_eq!(found.judge(property, &Core), Judgement::Fails, "{found:?}");
        let conditions: usize = found.users.iter().map(|user| user.conditions.len()).sum();
        assert!(conditions <= most, "{property} is not small: {found:?}");
    }
}

/// The smallest case of the protocol's description: hiding `a` turns the interrupting
/// user's loss into a win.
#[test]
fn enumeration_finds_the_smallest_hiding_user() {
    let report = verify_over(Property::HideProofness, &Default::default(), &Core, &[Domain::THREE_LOW]);
    let found = report.counterexample.expect("hiding helps");
    let [current, interrupting] = found.users.as_slice() else { panic!("two users") };
    assert_eq!((current.conditions.len(), interrupting.conditions.len()), (1, 2));
    assert_eq!((current.size().1, interrupting.size().1), (1, 1));
    let altered = found.altered.expect("a second case");
    assert_eq!((altered.index, altered.user.conditions.len()), (1, 1));
}
