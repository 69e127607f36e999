//! Properties checked by the sweep, and its progress.

use selfneg_core::{Case, Options};
use selfneg_proofs::sweep::{Check, Counts, Detail, Domain, Pair, Person, Progress, check};

use crate::seen::size;
use crate::variants::variants;

/// A property that fails now and then: pairs and smallest counterexample are those of the
/// enumeration.
#[test]
fn checks_count_what_fails_and_find_a_smallest() {
    let domain = Domain::one_to_one(3, 1..=3).unwrap();
    let people: Vec<Person> = domain.people().collect();
    let short = |case: &Case<'_>, options: &Options| case.negotiate(options).rounds <= 5;
    let checks: Vec<Check<_>> =
        variants(&[0, 2]).into_iter().map(|options| Check { property: short, options }).collect();
    let checked = check(&domain, &checks, Detail::Merged, &|_| ()).unwrap();
    assert_eq!(checked.len(), checks.len());
    for (check, checked) in checks.iter().zip(checked) {
        let (mut failing, mut smallest) = (0, None);
        for current in &people {
            for interrupting in &people {
                let pair = Pair { current: current.clone(), interrupting: interrupting.clone() };
                if !short(&pair.case(domain.activation().unwrap()).unwrap(), &check.options) {
                    failing += 1;
                    smallest = smallest.into_iter().chain([size(&pair)]).min();
                }
            }
        }
        assert_eq!(checked.pairs, domain.pairs());
        assert_eq!((checked.failing, checked.counterexample.as_ref().map(size)), (failing, smallest));
        if let Some(pair) = checked.counterexample {
            assert!(!short(&pair.case(domain.activation().unwrap()).unwrap(), &check.options));
        }
    }
}

#[test]
fn progress_ascends_to_the_whole() {
    let domain = Domain::one_to_one(5, 1..=3).unwrap();
    let told = std::sync::Mutex::new(Vec::new());
    Counts::of(&domain, &Options::default(), Detail::Merged, &|progress| told.lock().unwrap().push(progress))
        .unwrap();
    let told = told.into_inner().unwrap();
    let shares: Vec<(bool, u128, u128)> = told
        .iter()
        .map(|progress| match *progress {
            Progress::Sides { done, total } => {
                (false, u128::try_from(done).unwrap(), u128::try_from(total).unwrap())
            }
            Progress::Pairs { done, total } => (true, done, total),
        })
        .collect();
    assert!(shares.is_sorted());
    for pairs in [false, true] {
        let last = shares.iter().rfind(|share| share.0 == pairs).unwrap();
        assert_eq!(last.1, last.2);
    }
}
