//! The classes themselves: that they are complete, as coarse as promised, and that the
//! engine does the same with all members of one.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use proptest::prelude::*;
use selfneg_core::Aggregation;
use selfneg_proofs::sweep::{Class, Detail, Domain, Grain, Pair, Person, Tally, sweep};

use crate::promise::{Promise, promise};
use crate::seen::{Seen, Size, size};
use crate::variants::variants;

struct Classes(Vec<(Pair, u128)>);

impl Tally for Classes {
    fn take(&mut self, class: &Class<'_>) {
        self.0.push((class.pair.clone(), class.multiplicity));
    }

    fn merge(mut self, other: Self) -> Self {
        self.0.extend(other.0);
        self
    }
}

fn grains(aggregation: Aggregation, detail: Detail) -> Vec<Grain> {
    let mut grains = Vec::new();
    for willingness in 0..=2 {
        for surplus in [false, true] {
            grains.push(Grain { aggregation, willingness, surplus, detail });
        }
    }
    grains
}

/// Class by class: as many pairs as the enumeration finds, the representative one of the
/// smallest, and no two merged classes that might have been one.
#[test]
fn every_class_is_what_the_grain_promises() {
    let domains = [
        Domain::one_to_one(3, 1..=3).unwrap(),
        Domain::one_to_one(3, 0..=2).unwrap(),
        Domain::many_to_one(&[1, 2, 1], 0..=1).unwrap(),
        Domain::many_to_one(&[3, 1], 1..=3).unwrap(),
    ];
    for domain in &domains {
        let people: Vec<Person> = domain.people().collect();
        for grain in Aggregation::ALL.iter().flat_map(|&aggregation| grains(aggregation, Detail::Merged)) {
            let mut literal: HashMap<Promise, (u128, Size)> = HashMap::new();
            for current in &people {
                for interrupting in &people {
                    let pair = Pair { current: current.clone(), interrupting: interrupting.clone() };
                    let class = literal.entry(promise(domain, &grain, &pair)).or_insert((0, size(&pair)));
                    *class = (class.0 + 1, class.1.min(size(&pair)));
                }
            }
            let swept = sweep(domain, &grain, || Classes(Vec::new()), &|_| ()).unwrap();
            assert_eq!(swept.classes, u64::try_from(literal.len()).unwrap(), "{grain:?}");
            for (pair, multiplicity) in swept.tally.0 {
                let found = literal.remove(&promise(domain, &grain, &pair));
                assert_eq!(found, Some((multiplicity, size(&pair))), "{grain:?} {pair:?}");
            }
        }
    }
}

/// The detailed classes are parts of the merged ones.
#[test]
fn by_pattern_splits_the_merged_classes() {
    let domain = Domain::one_to_one(4, 0..=3).unwrap();
    for grain in grains(Aggregation::PerCondition, Detail::Merged) {
        let by_promise = |detail| {
            let mut classes: HashMap<Promise, u128> = HashMap::new();
            let swept = sweep(&domain, &Grain { detail, ..grain }, || Classes(Vec::new()), &|_| ()).unwrap();
            for (pair, multiplicity) in swept.tally.0 {
                *classes.entry(promise(&domain, &grain, &pair)).or_default() += multiplicity;
            }
            (swept.classes, classes)
        };
        let (merged, coarse) = by_promise(Detail::Merged);
        let (split, fine) = by_promise(Detail::ByPattern);
        assert_eq!(coarse, fine);
        assert!(split > merged);
    }
}

fn large_domains() -> [Domain; 4] {
    [
        Domain::one_to_one(6, 1..=5).unwrap(),
        Domain::one_to_one(4, 0..=12).unwrap(),
        Domain::published(1..=3).unwrap(),
        Domain::many_to_one(&[2, 3, 2], 0..=6).unwrap(),
    ]
}

type ByPromise = HashMap<Promise, Pair>;
type Known = HashMap<(usize, Grain), Arc<ByPromise>>;

/// The classes of one of the large domains, swept once a grain.
fn classes_of(domain: usize, grain: Grain) -> Arc<ByPromise> {
    static KNOWN: Mutex<Option<Known>> = Mutex::new(None);
    let mut known = KNOWN.lock().unwrap();
    let classes = known.get_or_insert_default().entry((domain, grain)).or_insert_with(|| {
        let domain = &large_domains()[domain];
        let swept = sweep(domain, &grain, || Classes(Vec::new()), &|_| ()).unwrap();
        let by_promise = |(pair, _)| (promise(domain, &grain, &pair), pair);
        Arc::new(swept.tally.0.into_iter().map(by_promise).collect())
    });
    Arc::clone(classes)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    /// A random pair of a large domain is in a class, and under every variant that the
    /// grain serves the engine does with it what it does with the representative:
    /// outcome, rounds, ending and regret, in both roles.
    #[test]
    fn a_representative_speaks_for_its_class(
        domain in 0..large_domains().len(),
        numbers in any::<[u64; 2]>(),
        per_disposition in any::<bool>(),
        willingness in 0..=2_u8,
        surplus in any::<bool>(),
    ) {
        let aggregation =
            if per_disposition { Aggregation::PerDisposition } else { Aggregation::PerCondition };
        let grain = Grain { aggregation, willingness, surplus, detail: Detail::Merged };
        let classes = classes_of(domain, grain);
        let domain = &large_domains()[domain];
        let [current, interrupting] = numbers.map(|number| domain.person(number));
        let pair = Pair { current, interrupting };
        let representative = classes.get(&promise(domain, &grain, &pair));
        prop_assert!(representative.is_some(), "a pair without a class");
        let representative = representative.unwrap();
        prop_assert!(size(representative) <= size(&pair));
        let activation = domain.activation().unwrap();
        for options in variants(&[0, willingness]).into_iter().filter(|options| grain.serves(options)) {
            let of = |pair: &Pair| Seen::of(&pair.case(activation).unwrap(), &options);
            prop_assert_eq!(of(representative), of(&pair), "{} {:?}", options, representative);
        }
    }
}
