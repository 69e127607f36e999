//! Literal enumeration: every pair of users of a small domain, with every alteration
//! within the domain, in no cleverer way than one after the other.

use rayon::prelude::*;
use selfneg_core::{Activation, Aggregation, Condition, Disposition, Options, Outcome, Rank, Side};

use crate::case::{OpenCase, OpenUser};
use crate::counterexample::{Altered, Counterexample, OwnedUser, guarded};
use crate::engine::Engine;
use crate::property::policy::{Bilateral, Policy, PolicyProperty};
use crate::property::{Alteration, Judgement, Property, Second, Trial};
use crate::transcript::{Memory, Round};

/// In which orders the users of a domain disclose their conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Orders {
    /// By index, as in the paper.
    Index,
    /// Every order.
    Every,
}

/// A set of users: every profile with ranks of a set, every set of true conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Domain {
    /// Its name in reports.
    pub name: &'static str,
    /// The number of dispositions; both goals imply all of them.
    pub dispositions: u16,
    /// The dispositions that each condition activates.
    pub activation: &'static [&'static [Disposition]],
    /// The ranks, rising.
    pub ranks: &'static [u8],
    /// In which orders conditions are disclosed.
    pub orders: Orders,
}

const D0: Disposition = Disposition(0);
const D1: Disposition = Disposition(1);
const D2: Disposition = Disposition(2);
const D3: Disposition = Disposition(3);

impl Domain {
    /// Three dispositions with one condition each: 216 users. A rank of 3 exceeds every
    /// willingness of the tables, a rank of 1 does not.
    pub const THREE: Self = Self {
        name: "3 dispositions, one condition each, ranks {0, 1, 3}, index order",
        dispositions: 3,
        activation: &[&[D0], &[D1], &[D2]],
        ranks: &[0, 1, 3],
        orders: Orders::Index,
    };

    /// The same with ranks of 0 and 1: 64 users.
    pub const THREE_LOW: Self = Self {
        name: "3 dispositions, one condition each, ranks {0, 1}, index order",
        ranks: &[0, 1],
        ..Self::THREE
    };

    /// The same with ranks of 0 and 3: 64 users.
    pub const THREE_HIGH: Self = Self {
        name: "3 dispositions, one condition each, ranks {0, 3}, index order",
        ranks: &[0, 3],
        ..Self::THREE
    };

    /// The same with ranks of 0 and 3 and every order of disclosure: 128 users.
    pub const THREE_ORDERED: Self = Self {
        name: "3 dispositions, one condition each, ranks {0, 3}, every order",
        orders: Orders::Every,
        ..Self::THREE_HIGH
    };

    /// Four conditions that share two dispositions: 144 users.
    pub const SHARED: Self = Self {
        name: "2 dispositions, four conditions (one activates both), ranks {0, 1, 3}, index order",
        dispositions: 2,
        activation: &[&[D0], &[D0], &[D1], &[D0, D1]],
        ranks: &[0, 1, 3],
        orders: Orders::Index,
    };

    /// The same with ranks of 0 and 3: 64 users.
    pub const SHARED_HIGH: Self = Self {
        name: "2 dispositions, four conditions (one activates both), ranks {0, 3}, index order",
        ranks: &[0, 3],
        ..Self::SHARED
    };

    /// Three conditions that share two dispositions, in every order: 64 users.
    pub const SHARED_ORDERED: Self = Self {
        name: "2 dispositions, three conditions (two share one), ranks {0, 3}, every order",
        activation: &[&[D0], &[D0], &[D1]],
        orders: Orders::Every,
        ..Self::SHARED_HIGH
    };

    /// Two dispositions with one condition each: 36 users.
    pub const TWO: Self = Self {
        name: "2 dispositions, one condition each, ranks {0, 1, 3}, index order",
        activation: &[&[D0], &[D1]],
        ..Self::SHARED
    };

    /// The same with ranks of 0 to 4: 100 users.
    pub const TWO_WIDE: Self = Self {
        name: "2 dispositions, one condition each, ranks {0, 1, 2, 3, 4}, index order",
        ranks: &[0, 1, 2, 3, 4],
        ..Self::TWO
    };

    /// Two conditions that share one of two dispositions: 36 users.
    pub const SHARED_TWO: Self = Self {
        name: "2 dispositions, two conditions that share one, ranks {0, 1, 3}, index order",
        activation: &[&[D0], &[D0, D1]],
        ..Self::SHARED
    };

    /// Three conditions, two of which share one of the dispositions that each activates:
    /// 128 users. [`SHARED`](Self::SHARED) does not refute `sorted-hide-proofness`.
    pub const WOVEN: Self = Self {
        name: "4 dispositions, three conditions (two share one of two), ranks {0, 3}, index order",
        dispositions: 4,
        activation: &[&[D0, D1], &[D1, D2], &[D3]],
        ranks: &[0, 3],
        orders: Orders::Index,
    };

    /// The domains over which a property is enumerated by default. Together they
    /// refute it wherever it is expected to fail.
    #[must_use]
    pub const fn of(property: Property, options: &Options) -> &'static [Self] {
        if matches!(property, Property::SortedHideProofness)
            && matches!(options.aggregation, Aggregation::PerDisposition)
        {
            return &[Self::WOVEN];
        }
        match property.alteration() {
            Alteration::None | Alteration::Copied => &[Self::THREE, Self::SHARED, Self::TWO_WIDE],
            Alteration::Hidden => &[Self::THREE_LOW, Self::THREE_HIGH, Self::SHARED_HIGH],
            Alteration::Reordered => &[Self::THREE_ORDERED, Self::SHARED_ORDERED],
            Alteration::Undisclosed => &[Self::THREE_LOW, Self::THREE_HIGH, Self::SHARED_HIGH],
            Alteration::Misreported | Alteration::Replaced => &[Self::TWO, Self::SHARED_TWO],
        }
    }

    /// Every user, the smallest first (see [`OwnedUser::size`]).
    #[must_use]
    pub fn users(&self) -> Vec<OwnedUser> {
        let statuses = self.statuses();
        let mut users: Vec<OwnedUser> = Vec::new();
        for ranks in self.profiles() {
            for conditions in &statuses {
                users.push(OwnedUser {
                    ranks: ranks.clone(),
                    conditions: conditions.clone(),
                    goal: vec![1; usize::from(self.dispositions)],
                });
            }
        }
        users.sort_by_cached_key(|user| (user.size(), user.clone()));
        users
    }

    fn profiles(&self) -> Vec<Vec<Rank>> {
        let mut profiles = vec![Vec::new()];
        for _ in 0..self.dispositions {
            profiles = profiles
                .into_iter()
                .flat_map(|profile: Vec<Rank>| {
                    self.ranks.iter().map(move |&rank| {
                        let mut longer = profile.clone();
                        longer.push(Rank(rank));
                        longer
                    })
                })
                .collect();
        }
        profiles
    }

    fn statuses(&self) -> Vec<Vec<Condition>> {
        let conditions: Vec<Condition> = (0..).map(Condition).take(self.activation.len()).collect();
        let mut statuses: Vec<Vec<Condition>> = vec![Vec::new()];
        let mut longest = statuses.clone();
        for _ in &conditions {
            longest = longest
                .iter()
                .flat_map(|status| {
                    conditions
                        .iter()
                        .filter(|&next| match self.orders {
                            Orders::Index => status.last().is_none_or(|last| last < next),
                            Orders::Every => !status.contains(next),
                        })
                        .map(|&next| status.iter().copied().chain([next]).collect())
                })
                .collect();
            statuses.extend(longest.iter().cloned());
        }
        statuses
    }
}

/// What enumeration of one domain, or of several, came to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// How many cases (with alterations: pairs of cases) were looked at.
    pub cases: u128,
    /// How many of them met the property's premise.
    pub nonvacuous: u128,
    /// How many of them refute it.
    pub failing: u128,
    /// The smallest that does: fewest true conditions in total, then the smallest sum of
    /// ranks, then lexicographically; of the first domain that has one.
    pub smallest: Option<Counterexample>,
}

impl Tally {
    fn and(self, other: Self) -> Self {
        Self {
            cases: self.cases + other.cases,
            nonvacuous: self.nonvacuous + other.nonvacuous,
            failing: self.failing + other.failing,
            smallest: self.smallest.or(other.smallest),
        }
    }
}

/// Where a refuting case is in the domain, in the order of size.
type Place = ((usize, u64), usize, usize, usize, Side);

#[derive(Clone, Copy, Default)]
struct Count {
    cases: u128,
    nonvacuous: u128,
    failing: u128,
    smallest: Option<Place>,
}

impl Count {
    fn and(self, other: Self) -> Self {
        Self {
            cases: self.cases + other.cases,
            nonvacuous: self.nonvacuous + other.nonvacuous,
            failing: self.failing + other.failing,
            smallest: match (self.smallest, other.smallest) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            },
        }
    }

    fn note(&mut self, judgement: Judgement, place: Place) {
        self.cases += 1;
        match judgement {
            Judgement::Vacuous => {}
            Judgement::Holds => self.nonvacuous += 1,
            Judgement::Fails => {
                self.nonvacuous += 1;
                self.failing += 1;
                self.smallest = Some(self.smallest.map_or(place, |smallest| smallest.min(place)));
            }
        }
    }
}

/// Checks `property` on every case of every domain of `domains`.
pub fn enumerate<E: Engine + Sync>(
    property: Property,
    engine: &E,
    domains: &[Domain],
    options: &Options,
) -> Tally {
    domains
        .iter()
        .map(|domain| enumerate_one(property, engine, domain, options))
        .fold(Tally::default(), Tally::and)
}

fn enumerate_one<E: Engine + Sync>(
    property: Property,
    engine: &E,
    domain: &Domain,
    options: &Options,
) -> Tally {
    let owned = domain.users();
    let copies = owned.clone();
    let (Ok(activation), Some(users), Some(copied)) = (
        Activation::new(domain.activation),
        owned.iter().map(OwnedUser::open).collect::<Option<Vec<_>>>(),
        copies.iter().map(OwnedUser::open).collect::<Option<Vec<_>>>(),
    ) else {
        return Tally::default();
    };
    let alternatives = alternatives(property.alteration(), &owned);
    let seconds = if property.alteration() == Alteration::Copied { &copied } else { &users };
    let count = users
        .par_iter()
        .enumerate()
        .map(|(c, &current)| {
            let mut count = Count::default();
            let mut first = [Round::BLANK; 16];
            let mut second = [Round::BLANK; 16];
            let mut memory = Memory { first: &mut first, second: &mut second };
            for (i, &interrupting) in users.iter().enumerate() {
                let case = OpenCase { activation, current, interrupting };
                let size = match (owned.get(c), owned.get(i)) {
                    (Some(a), Some(b)) => (a.size().0 + b.size().0, a.size().1 + b.size().1),
                    _ => continue,
                };
                let mut judge = |second: Second<'_>, alternative: usize| {
                    let trial = Trial { case, second, options: *options };
                    let judgement = guarded(property, engine, &trial, &mut memory);
                    count.note(judgement, (size, c, i, alternative, second.side));
                };
                match property.alteration() {
                    Alteration::None => judge(Second { case, side: Side::Current }, c),
                    Alteration::Copied => {
                        if let (Some(&current), Some(&interrupting)) = (seconds.get(c), seconds.get(i)) {
                            let case = OpenCase { activation, current, interrupting };
                            judge(Second { case, side: Side::Current }, c);
                        }
                    }
                    _ => {
                        for (side, index) in [(Side::Current, c), (Side::Interrupting, i)] {
                            for &alternative in alternatives.get(index).into_iter().flatten() {
                                if let Some(&user) = seconds.get(alternative) {
                                    judge(Second { case: case.with(side, user), side }, alternative);
                                }
                            }
                        }
                    }
                }
            }
            count
        })
        .reduce(Count::default, Count::and);
    Tally {
        cases: count.cases,
        nonvacuous: count.nonvacuous,
        failing: count.failing,
        smallest: count.smallest.and_then(|place| counterexample(property, domain, &owned, place, options)),
    }
}

fn counterexample(
    property: Property,
    domain: &Domain,
    owned: &[OwnedUser],
    (_, c, i, alternative, side): Place,
    options: &Options,
) -> Option<Counterexample> {
    let altered = match property.alteration() {
        Alteration::None | Alteration::Copied => None,
        _ => Some(Altered {
            index: match side {
                Side::Current => 0,
                Side::Interrupting => 1,
            },
            user: owned.get(alternative)?.clone(),
        }),
    };
    Some(Counterexample {
        activation: domain.activation.iter().map(|row| row.to_vec()).collect(),
        users: vec![owned.get(c)?.clone(), owned.get(i)?.clone()],
        altered,
        options: *options,
    })
}

/// For each user of the domain, the users that an alteration can turn it into.
fn alternatives(alteration: Alteration, users: &[OwnedUser]) -> Vec<Vec<usize>> {
    let fits = |before: &OwnedUser, after: &OwnedUser| match alteration {
        Alteration::None | Alteration::Copied => false,
        Alteration::Hidden => {
            before.ranks == after.ranks
                && after.conditions.len() < before.conditions.len()
                && after.conditions.iter().all(|condition| before.conditions.contains(condition))
        }
        Alteration::Reordered => {
            before.ranks == after.ranks
                && after.conditions.len() == before.conditions.len()
                && after.conditions.iter().all(|condition| before.conditions.contains(condition))
                && after != before
        }
        Alteration::Misreported => before.conditions == after.conditions && before.ranks != after.ranks,
        Alteration::Undisclosed => before.ranks == after.ranks && before.conditions != after.conditions,
        Alteration::Replaced => before != after,
    };
    users
        .iter()
        .map(|before| {
            users
                .iter()
                .enumerate()
                .filter(|(_, after)| fits(before, after))
                .map(|(index, _)| index)
                .collect()
        })
        .collect()
}

/// Every triple of outcomes of the three bilateral negotiations: all that a policy can
/// look at, so this establishes a property of the policy for users of every size.
#[must_use]
pub fn outcome_triples() -> Vec<Bilateral> {
    const OUTCOMES: [Outcome; 3] =
        [Outcome::Agreement(Side::Current), Outcome::Agreement(Side::Interrupting), Outcome::NoAgreement];
    OUTCOMES
        .iter()
        .flat_map(|&ab| {
            OUTCOMES.iter().flat_map(move |&ac| OUTCOMES.iter().map(move |&bc| Bilateral { ab, ac, bc }))
        })
        .collect()
}

/// Checks `property` on every case of three users of `domain`, negotiating each of the
/// three pairs. The willingness is that of the user being served, so it has no part in
/// the negotiation between the two who interrupt.
pub fn enumerate_policy<P: Policy + Sync, E: Engine + Sync>(
    property: PolicyProperty,
    policy: &P,
    engine: &E,
    domain: &Domain,
    options: &Options,
) -> Tally {
    let owned = domain.users();
    let (Ok(activation), Some(users)) =
        (Activation::new(domain.activation), owned.iter().map(OwnedUser::open).collect::<Option<Vec<_>>>())
    else {
        return Tally::default();
    };
    let table = |options: &Options| -> Vec<Vec<Outcome>> {
        let negotiate = |&current: &OpenUser<'_>, &interrupting: &OpenUser<'_>| {
            let case = OpenCase { activation, current, interrupting };
            engine.negotiate(&case, options, &mut ()).outcome
        };
        users.par_iter().map(|a| users.iter().map(|b| negotiate(a, b)).collect()).collect()
    };
    let with_served = table(options);
    let between_interrupters = table(&Options { willingness: 0, ..*options });
    let sizes: Vec<(usize, u64)> = owned.iter().map(OwnedUser::size).collect();
    let (count, smallest) = with_served
        .par_iter()
        .enumerate()
        .map(|(a, against_a)| {
            let mut count = Count::default();
            let mut smallest: Option<((usize, u64), [usize; 3])> = None;
            for (b, &ab) in against_a.iter().enumerate() {
                let row = between_interrupters.get(b).map_or(&[][..], Vec::as_slice);
                for (c, (&ac, &bc)) in against_a.iter().zip(row).enumerate() {
                    let judgement = property.check(policy, Bilateral { ab, ac, bc });
                    count.cases += 1;
                    count.nonvacuous += u128::from(judgement != Judgement::Vacuous);
                    if judgement == Judgement::Fails {
                        count.failing += 1;
                        let of = |index: usize| sizes.get(index).copied().unwrap_or_default();
                        let size = (of(a).0 + of(b).0 + of(c).0, of(a).1 + of(b).1 + of(c).1);
                        let here = (size, [a, b, c]);
                        smallest = Some(smallest.map_or(here, |smallest| smallest.min(here)));
                    }
                }
            }
            (count, smallest)
        })
        .reduce(
            || (Count::default(), None),
            |(a, s), (b, t)| {
                let smallest = match (s, t) {
                    (Some(s), Some(t)) => Some(s.min(t)),
                    (s, t) => s.or(t),
                };
                (a.and(b), smallest)
            },
        );
    Tally {
        cases: count.cases,
        nonvacuous: count.nonvacuous,
        failing: count.failing,
        smallest: smallest.map(|(_, places)| Counterexample {
            activation: domain.activation.iter().map(|row| row.to_vec()).collect(),
            users: places.iter().filter_map(|&place| owned.get(place).cloned()).collect(),
            altered: None,
            options: *options,
        }),
    }
}
