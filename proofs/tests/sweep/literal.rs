//! Counts of the sweep against literal enumeration: small domains, every ordered pair run
//! through the engine one by one.

use rayon::prelude::*;
use selfneg_core::{Aggregation, Case, Options, Outcome, Side};
use selfneg_proofs::sweep::{Counts, Detail, Domain, Person, Regret};

use crate::seen::{Seen, Size, size, size_of};
use crate::variants::variants;

/// Counts of a literal enumeration; the instances by their size.
#[derive(Default, Debug, PartialEq, Eq)]
struct Literal {
    outcomes: [u128; 3],
    role_dependent: u128,
    smallest_role_dependent: Option<Size>,
    regret: [(u128, u64, Option<Size>); 2],
}

impl Literal {
    fn of(domain: &Domain, options: &Options) -> Self {
        let people: Vec<Person> = domain.people().collect();
        let activation = domain.activation().unwrap();
        people
            .par_iter()
            .fold(Self::default, |mut literal, current| {
                for interrupting in &people {
                    let case = Case {
                        activation,
                        current: current.user().unwrap(),
                        interrupting: interrupting.user().unwrap(),
                    };
                    literal.add(size_of(current, interrupting), &Seen::of(&case, options));
                }
                literal
            })
            .reduce(Self::default, |a, b| a.join(&b))
    }

    fn add(&mut self, size: Size, seen: &Seen) {
        let place = match seen.conclusions[0].outcome {
            Outcome::Agreement(Side::Current) => 0,
            Outcome::Agreement(Side::Interrupting) => 1,
            Outcome::NoAgreement => 2,
        };
        self.outcomes[place] += 1;
        if seen.role_dependent() {
            self.role_dependent += 1;
            self.smallest_role_dependent = least(self.smallest_role_dependent, Some(size));
        }
        if seen.regret[0] > 0 {
            let (pairs, max, smallest) = &mut self.regret[usize::from(place == 2)];
            *pairs += 1;
            if seen.regret[0] > *max {
                (*max, *smallest) = (seen.regret[0], Some(size));
            } else if seen.regret[0] == *max {
                *smallest = least(*smallest, Some(size));
            }
        }
    }

    fn join(self, other: &Self) -> Self {
        let mut joined = Self {
            role_dependent: self.role_dependent + other.role_dependent,
            smallest_role_dependent: least(self.smallest_role_dependent, other.smallest_role_dependent),
            ..Self::default()
        };
        for place in 0..3 {
            joined.outcomes[place] = self.outcomes[place] + other.outcomes[place];
        }
        for place in 0..2 {
            let (a, b) = (self.regret[place], other.regret[place]);
            let max = a.1.max(b.1);
            let at_max = |one: (u128, u64, Option<Size>)| one.2.filter(|_| one.1 == max);
            joined.regret[place] = (a.0 + b.0, max, least(at_max(a), at_max(b)));
        }
        joined
    }
}

fn least(a: Option<Size>, b: Option<Size>) -> Option<Size> {
    a.into_iter().chain(b).min()
}

/// The same from the sweep's counts.
fn as_literal(counts: &Counts) -> Literal {
    let regret = |regret: &Regret| (regret.pairs, regret.max, regret.pair.as_ref().map(size));
    Literal {
        outcomes: [counts.agreement_current, counts.agreement_interrupting, counts.no_agreement],
        role_dependent: counts.role_dependent,
        smallest_role_dependent: counts.role_dependent_pair.as_ref().map(size),
        regret: [regret(&counts.regret_agreed), regret(&counts.regret_fallback)],
    }
}

fn same_counts(domain: &Domain, variants: &[Options]) {
    for options in variants {
        let literal = Literal::of(domain, options);
        for detail in [Detail::Merged, Detail::ByPattern] {
            let counts = Counts::of(domain, options, detail, &|_| ()).unwrap();
            assert_eq!(as_literal(&counts), literal, "{options}, {detail:?}, {domain:?}");
            assert_eq!(counts.suboptimal(), literal.regret[0].0 + literal.regret[1].0);
            assert_eq!(counts.max_regret(), literal.regret[0].1.max(literal.regret[1].1));
        }
    }
}

#[test]
fn three_dispositions_every_variant() {
    for ranks in [1..=3, 0..=2] {
        same_counts(&Domain::one_to_one(3, ranks).unwrap(), &variants(&[0, 1, 2]));
    }
}

#[test]
fn four_dispositions_every_variant() {
    same_counts(&Domain::one_to_one(4, 1..=2).unwrap(), &variants(&[0, 1, 2]));
}

#[test]
fn four_dispositions_of_three_ranks() {
    let some = [
        "exhausted/per-condition/first-sender/first-come/w0",
        "literal/per-condition/surplus/utilitarian/w1",
    ];
    let some: Vec<Options> = variants(&[0, 1])
        .into_iter()
        .filter(|options| some.contains(&options.to_string().as_str()))
        .collect();
    assert_eq!(some.len(), 2);
    same_counts(&Domain::one_to_one(4, 1..=3).unwrap(), &some);
}

#[test]
fn several_conditions_of_one_disposition_every_variant() {
    for (conditions, ranks) in
        [(&[2, 1][..], 0..=2), (&[1, 3], 1..=3), (&[2, 0, 2], 1..=2), (&[1, 2, 1], 0..=1)]
    {
        same_counts(&Domain::many_to_one(conditions, ranks).unwrap(), &variants(&[0, 1, 2]));
    }
}

#[test]
fn willingness_out_of_reach() {
    let domain = Domain::one_to_one(2, 0..=3).unwrap();
    same_counts(&domain, &variants(&[3, 7, 255]));
}

/// One condition each cannot tell the aggregations apart; several can.
#[test]
fn aggregations_differ_only_if_conditions_share_a_disposition() {
    let counts = |domain: &Domain, aggregation| {
        let options = Options { aggregation, ..Options::default() };
        as_literal(&Counts::of(domain, &options, Detail::Merged, &|_| ()).unwrap())
    };
    let both = |domain: &Domain| Aggregation::ALL.iter().map(|&a| counts(domain, a)).collect::<Vec<_>>();
    let one_to_one = both(&Domain::one_to_one(5, 1..=4).unwrap());
    assert_eq!(one_to_one[0], one_to_one[1]);
    let many_to_one = both(&Domain::many_to_one(&[2, 1], 1..=2).unwrap());
    assert_ne!(many_to_one[0], many_to_one[1]);
}
