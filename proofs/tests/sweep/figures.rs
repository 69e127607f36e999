//! The sweep against figures that were established outside this project, by another
//! program: all 10^12 ordered pairs of the paper's size.

use selfneg_core::Options;
use selfneg_proofs::sweep::{Counts, Detail, Domain, DomainError};

use crate::seen::{Seen, size};

fn paper() -> Domain {
    Domain::one_to_one(6, 1..=5).unwrap()
}

#[test]
fn the_papers_domain_has_the_known_counts() {
    for detail in [Detail::Merged, Detail::ByPattern] {
        let counts = Counts::of(&paper(), &Options::default(), detail, &|_| ()).unwrap();
        assert_eq!(counts.pairs, 1_000_000_000_000);
        assert_eq!(counts.agreement_current, 414_054_505_704);
        assert_eq!(counts.agreement_interrupting, 449_419_405_176);
        assert_eq!(counts.no_agreement, 136_526_089_120);
        assert_eq!(counts.role_dependent, 35_364_899_472);
        assert_eq!(counts.suboptimal(), 71_439_792_922);
        assert_eq!(counts.max_regret(), 24);
    }
}

#[test]
fn the_instances_are_what_they_are_given_for() {
    let domain = paper();
    let options = Options::default();
    let counts = Counts::of(&domain, &options, Detail::Merged, &|_| ()).unwrap();
    let activation = domain.activation().unwrap();

    let worst = counts.max_regret_pair().unwrap().case(activation).unwrap();
    let served = worst.decide(&options, &mut ()).served;
    assert_eq!(worst.welfare(&options).regret(served).0, counts.max_regret());

    let dependent = counts.role_dependent_pair.as_ref().unwrap();
    assert_eq!(size(dependent).0, 2, "nobody defers without a condition of the other");
    assert!(Seen::of(&dependent.case(activation).unwrap(), &options).role_dependent());
}

#[test]
fn multiplicities_add_up_whatever_the_shape() {
    let domains = [
        Domain::one_to_one(1, 0..=0),
        Domain::one_to_one(1, 255..=255),
        Domain::one_to_one(2, 0..=255),
        Domain::one_to_one(7, 1..=5),
        Domain::one_to_one(10, 0..=1),
        Domain::many_to_one(&[0, 2, 0, 1], 1..=4),
        Domain::many_to_one(&[15, 1], 3..=4),
        Domain::published(2..=4),
    ];
    for domain in domains {
        let domain = domain.unwrap();
        let counts = Counts::of(&domain, &Options::default(), Detail::Merged, &|_| ()).unwrap();
        assert_eq!(counts.pairs, domain.pairs());
        assert_eq!(
            counts.agreement_current + counts.agreement_interrupting + counts.no_agreement,
            domain.pairs()
        );
    }
}

#[test]
fn a_domain_that_cannot_be_counted_is_refused() {
    assert_eq!(Domain::one_to_one(0, 1..=5), Err(DomainError::NoDispositions));
    assert_eq!(Domain::one_to_one(17, 1..=1), Err(DomainError::TooManyDispositions { count: 17 }));
    #[expect(clippy::reversed_empty_ranges, reason = "an empty range is the case under test")]
    let empty = Domain::one_to_one(3, 5..=1);
    assert_eq!(empty, Err(DomainError::NoRanks { lowest: 5, highest: 1 }));
    assert_eq!(
        Domain::many_to_one(&[1, 16], 1..=5),
        Err(DomainError::TooManyConditions { disposition: 1, count: 16 })
    );
    // 2^8 conditions and 256^7 ranks are 2^63 users; one condition more is one too many.
    assert_eq!(Domain::many_to_one(&[2, 1, 1, 1, 1, 1, 0], 0..=255).unwrap().users(), 1 << 63);
    assert_eq!(Domain::many_to_one(&[2, 1, 1, 1, 1, 1, 1], 0..=255), Err(DomainError::TooManyUsers));
    assert_eq!(Domain::one_to_one(16, 0..=255), Err(DomainError::TooManyUsers));
}
