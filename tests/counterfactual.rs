//! What would have changed a decision, and how little would have sufficed to be disclosed,
//! against plain enumerations that edit what users say instead of what the engine gets.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test may panic"
)]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use selfneg::binding::{BoundRules, BoundUser, GoalChoice};
use selfneg::counterfactual::{Counterfactuals, Edit, Kind, Pairs, Question};
use selfneg::disclosure::{self, Least};
use selfneg::input::{Rules, Truth, User, UserFiles};
use selfneg::precedence::{Policy, decide};
use selfneg_core::{Aggregation, Fallback, Options, QuitRule, Rank, TieRule};

const CONDITIONS: [&str; 4] = ["a", "b", "c", "d"];
const DISPOSITIONS: [&str; 3] = ["x", "y", "z"];

/// A case by name, as people write it.
#[derive(Clone, Debug)]
struct Told {
    activation: Vec<(String, Vec<String>)>,
    implied: Vec<Vec<String>>,
    users: Vec<Person>,
    options: Options,
}

#[derive(Clone, Debug)]
struct Person {
    /// True conditions, in their order of disclosure.
    conditions: Vec<String>,
    ranks: Vec<u8>,
}

impl Told {
    fn bound(&self) -> (BoundRules, Vec<BoundUser>) {
        let goals = self.implied.iter().enumerate();
        let rules = Rules {
            activation: self.activation.clone(),
            implications: goals.map(|(nth, implied)| (format!("goal {nth}"), implied.clone())).collect(),
            activation_file: PathBuf::from("activation"),
            implications_file: PathBuf::from("implications"),
        };
        let mut rules = BoundRules::new(rules).unwrap();
        let users = self.users.iter().enumerate().map(|(nth, person)| {
            let ranks = DISPOSITIONS.iter().zip(&person.ranks);
            let user = User {
                name: format!("user {nth}"),
                profile: ranks.map(|(name, rank)| ((*name).to_owned(), Rank(*rank))).collect(),
                status: person.conditions.iter().map(|name| (name.clone(), Truth::True)).collect(),
                goal: Some(format!("goal {nth}")),
                location: "here".to_owned(),
                files: UserFiles::of_folder(Path::new("user")),
            };
            rules.bind(&user, &GoalChoice::OwnFile).unwrap()
        });
        let users = users.collect();
        (rules, users)
    }

    fn policy(&self) -> Policy {
        Policy::default_for(self.users.len() - 1)
    }

    fn served(&self) -> usize {
        let (rules, users) = self.bound();
        decide(&rules, &users, self.options, self.policy()).unwrap().served
    }

    fn counterfactuals(&self, pairs: u64) -> Counterfactuals {
        let (rules, users) = self.bound();
        let question =
            Question { rules: &rules, users: &users, options: self.options, policy: self.policy() };
        Counterfactuals::with_at_most(&question, pairs).unwrap()
    }

    fn scale(&self) -> u8 {
        // Only dispositions that the rules name are anybody's.
        let (_, users) = self.bound();
        users.iter().flat_map(|user| user.ranks().iter().map(|rank| rank.0)).max().unwrap_or(0).max(5)
    }
}

/// A change by name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Change {
    Withheld(usize, String),
    Added(usize, String),
    Rank(usize, String, u8),
    Order(usize),
}

impl Change {
    fn of(edit: Edit, rules: &BoundRules) -> Self {
        match edit {
            Edit::Withheld { user, condition } => {
                Self::Withheld(user, rules.condition_name(condition).to_owned())
            }
            Edit::Added { user, condition, .. } => {
                Self::Added(user, rules.condition_name(condition).to_owned())
            }
            Edit::Rank { user, disposition, to, .. } => {
                Self::Rank(user, rules.disposition_name(disposition).to_owned(), to.0)
            }
            Edit::Order { with } => Self::Order(with),
        }
    }
}

/// Every single change that changes whom the robot serves, with its size.
fn by_hand(told: &Told) -> BTreeSet<(u64, Change)> {
    let served = told.served();
    changes(told, |who| who != served)
}

/// Every single change after which the robot serves such a user, with its size.
fn changes(told: &Told, wanted: impl Fn(usize) -> bool) -> BTreeSet<(u64, Change)> {
    let mut flips = BTreeSet::new();
    let (rules, _) = told.bound();
    let known = |name: &str| rules.disposition(name).is_some();
    for user in 0..told.users.len() {
        for (at, name) in told.users[user].conditions.iter().enumerate() {
            let mut other = told.clone();
            other.users[user].conditions.remove(at);
            if wanted(other.served()) {
                flips.insert((1, Change::Withheld(user, name.clone())));
            }
        }
        for (name, _) in &told.activation {
            if told.users[user].conditions.contains(name) {
                continue;
            }
            for at in 0..=told.users[user].conditions.len() {
                let mut other = told.clone();
                other.users[user].conditions.insert(at, name.clone());
                if wanted(other.served()) {
                    flips.insert((1, Change::Added(user, name.clone())));
                }
            }
        }
        for (d, name) in DISPOSITIONS.iter().enumerate().filter(|(_, name)| known(name)) {
            for to in 0..=told.scale() {
                let mut other = told.clone();
                let from = std::mem::replace(&mut other.users[user].ranks[d], to);
                if wanted(other.served()) {
                    flips.insert((u64::from(from.abs_diff(to)), Change::Rank(user, (*name).to_owned(), to)));
                }
            }
        }
    }
    for with in 1..told.users.len() {
        let mut other = told.clone();
        other.users.swap(0, with);
        other.implied.swap(0, with);
        let place = other.served();
        let who = if place == 0 {
            with
        } else if place == with {
            0
        } else {
            place
        };
        if wanted(who) {
            flips.insert((1, Change::Order(with)));
        }
    }
    flips
}

fn options() -> impl Strategy<Value = Options> {
    let any = |count: usize| 0..count;
    (any(2), any(2), any(3), any(2), 0..3_u8).prop_map(|(quit, aggregation, tie, fallback, willingness)| {
        Options {
            quit: QuitRule::ALL[quit],
            aggregation: Aggregation::ALL[aggregation],
            tie: TieRule::ALL[tie],
            fallback: Fallback::ALL[fallback],
            willingness,
        }
    })
}

fn names(of: &'static [&'static str]) -> impl Strategy<Value = Vec<String>> + Clone {
    proptest::sample::subsequence(of, 0..=of.len())
        .prop_shuffle()
        .prop_map(|names| names.into_iter().map(str::to_owned).collect())
}

fn told(users: impl Strategy<Value = usize>) -> impl Strategy<Value = Told> {
    let person = (names(&CONDITIONS), proptest::collection::vec(0..=6_u8, 3))
        .prop_map(|(conditions, ranks)| Person { conditions, ranks });
    users.prop_flat_map(move |users| {
        (
            proptest::collection::vec(names(&DISPOSITIONS), CONDITIONS.len()),
            proptest::collection::vec(names(&DISPOSITIONS), users),
            proptest::collection::vec(person.clone(), users),
            options(),
        )
            .prop_map(|(rows, implied, users, options)| Told {
                activation: CONDITIONS.iter().map(|name| (*name).to_owned()).zip(rows).collect(),
                implied,
                users,
                options,
            })
    })
}

proptest! {
    #[test]
    fn no_single_change_is_missed_or_invented(told in told(2..=4_usize)) {
        let by_hand = by_hand(&told);
        let (rules, _) = told.bound();
        let found = told.counterfactuals(0);
        let listed: BTreeSet<(u64, Change)> =
            found.single.iter().map(|one| (one.size, Change::of(one.edits[0], &rules))).collect();
        prop_assert_eq!(listed.len(), found.single.len());
        prop_assert!(listed.is_subset(&by_hand), "{:?} of {:?}", listed, by_hand);
        for missing in by_hand.difference(&listed) {
            // Of a rank, the nearest is enough.
            let (size, Change::Rank(user, name, _)) = missing else {
                return Err(TestCaseError::fail(format!("missed {missing:?}")));
            };
            let nearer = listed.iter().any(|(nearest, change)| {
                matches!(change, Change::Rank(whose, other, _) if whose == user && other == name) && nearest <= size
            });
            prop_assert!(nearer, "missed {:?}", missing);
        }
        let least = by_hand.first().map(|(size, _)| *size);
        prop_assert_eq!(found.single.first().map(|one| one.size), least);
        prop_assert!(found.single.is_sorted_by_key(|one| (one.size, one.edits[0].kind())));
    }

    #[test]
    fn what_a_user_alone_could_have_changed(told in told(2..=4_usize), user in 0..4_usize) {
        let user = user % told.users.len();
        let served = told.served();
        let wanted = |who: usize| if served == user { who != user } else { who == user };
        let (rules, users) = told.bound();
        let own = |change: &Change| match change {
            Change::Withheld(whose, _) | Change::Added(whose, _) | Change::Rank(whose, ..) => *whose == user,
            Change::Order(_) => false,
        };
        let by_hand: BTreeSet<_> =
            changes(&told, wanted).into_iter().filter(|(_, change)| own(change)).collect();
        let question = Question { rules: &rules, users: &users, options: told.options, policy: told.policy() };
        let found = Counterfactuals::by_own_data(&question, user).unwrap();
        let listed: BTreeSet<_> =
            found.single.iter().map(|one| (one.size, Change::of(one.edits[0], &rules))).collect();
        prop_assert!(listed.is_subset(&by_hand), "{:?} of {:?}", listed, by_hand);
        let without_size = |set: &BTreeSet<(u64, Change)>| -> BTreeSet<(u8, String)> {
            set.iter()
                .map(|(_, change)| match change {
                    Change::Withheld(_, name) => (0, name.clone()),
                    Change::Added(_, name) => (1, name.clone()),
                    Change::Rank(_, name, _) => (2, name.clone()),
                    Change::Order(with) => panic!("an order, with {with}"),
                })
                .collect()
        };
        prop_assert_eq!(without_size(&listed), without_size(&by_hand));
    }

    #[test]
    fn a_condition_is_added_as_late_as_suffices(told in told(2..=3_usize)) {
        let served = told.served();
        let (rules, _) = told.bound();
        for one in told.counterfactuals(0).of_kind(Kind::Added, None) {
            let Edit::Added { user, condition, before } = one.edits[0] else { panic!("{one:?}") };
            let places = told.users[user].conditions.len();
            for at in before.unwrap_or(places)..=places {
                let mut other = told.clone();
                other.users[user].conditions.insert(at, rules.condition_name(condition).to_owned());
                prop_assert_eq!(other.served() != served, at == before.unwrap_or(places));
            }
        }
    }

    #[test]
    fn pairs_are_tried_if_no_single_change_of_data_suffices(told in told(2..=2_usize)) {
        let found = told.counterfactuals(200);
        let data = found.single.iter().any(|one| one.edits[0].kind() != Kind::Order);
        prop_assert_eq!(found.pairs == Pairs::NotNeeded, data);
        match &found.pairs {
            Pairs::Found(pair) => {
                prop_assert_eq!(pair.edits.len(), 2);
                prop_assert!(pair.served != found.served);
                prop_assert!(pair.size >= 2);
            }
            Pairs::NoneOfTheFirst { pairs } => prop_assert_eq!(*pairs, 200),
            Pairs::NotNeeded | Pairs::NoneOf { .. } => {}
        }
    }

    #[test]
    fn the_least_disclosure_is_the_smallest_subset(told in told(2..=2_usize)) {
        let (rules, users) = told.bound();
        let found = disclosure::least(&rules, &users[1], &users[0], told.options, disclosure::MAX_STEPS).unwrap();
        let bar = worth(&told, 0, &told.users[0].conditions, 0) + u64::from(told.options.willingness);
        let own = &told.users[1].conditions;
        let smallest = (0..1_u32 << own.len())
            .filter(|subset| {
                let disclosed: Vec<String> = (0..own.len())
                    .filter(|at| subset >> at & 1 == 1)
                    .map(|at| own[at].clone())
                    .collect();
                worth(&told, 1, &disclosed, 0) > bar
            })
            .map(u32::count_ones)
            .min();
        prop_assert!(!matches!(found, Least::AtMost(_)), "{} conditions need no more steps", own.len());
        prop_assert_eq!(found.sufficient().map(|count| u32::try_from(count).unwrap()), smallest);
        if let Least::Exactly(chosen) = found {
            let disclosed: Vec<String> = chosen.iter().map(|&one| rules.condition_name(one).to_owned()).collect();
            prop_assert!(worth(&told, 1, &disclosed, 0) > bar);
        }
    }

    #[test]
    fn an_agreement_rests_on_no_less_than_the_least(told in told(2..=3_usize)) {
        let (rules, users) = told.bound();
        let decision = decide(&rules, &users, told.options, told.policy()).unwrap();
        let sides = disclosure::of_decision(&rules, &users, &decision).unwrap();
        prop_assert_eq!(sides.len(), decision.negotiations.len());
        for (held, [current, interrupting]) in decision.negotiations.iter().zip(&sides) {
            prop_assert_eq!((current.sender, current.receiver), (held.current, held.interrupting));
            prop_assert_eq!((interrupting.sender, interrupting.receiver), (held.interrupting, held.current));
            for side in [current, interrupting] {
                prop_assert!(side.disclosed <= side.conditions);
                prop_assert_eq!(side.conditions, told.users[side.sender].conditions.len());
            }
            let Some(winner) = held.conclusion.outcome.winner() else { continue };
            let winner = match winner {
                selfneg_core::Side::Current => current,
                selfneg_core::Side::Interrupting => interrupting,
            };
            prop_assert!(winner.least.sufficient().unwrap() <= winner.disclosed);
        }
    }
}

/// What disclosing these conditions of `sender` is worth to `receiver`, by names.
fn worth(told: &Told, sender: usize, disclosed: &[String], receiver: usize) -> u64 {
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    let mut total = 0;
    for condition in disclosed {
        let (_, row) = told.activation.iter().find(|(name, _)| name == condition).unwrap();
        for disposition in row.iter().filter(|name| told.implied[sender].contains(name)) {
            if seen.insert(disposition) || told.options.aggregation == Aggregation::PerCondition {
                let at = DISPOSITIONS.iter().position(|name| name == disposition).unwrap();
                total += u64::from(told.users[receiver].ranks[at]);
            }
        }
    }
    total
}

/// Each of six conditions its own disposition, all goals imply all.
fn letters(users: &[(&str, [u8; 3])]) -> Told {
    let row =
        |(condition, disposition): (&&str, &&str)| ((*condition).to_owned(), vec![(*disposition).to_owned()]);
    Told {
        activation: CONDITIONS[..3].iter().zip(&DISPOSITIONS).map(row).collect(),
        implied: vec![DISPOSITIONS.map(str::to_owned).to_vec(); users.len()],
        users: users
            .iter()
            .map(|(conditions, ranks)| Person {
                conditions: conditions.chars().map(String::from).collect(),
                ranks: ranks.to_vec(),
            })
            .collect(),
        options: Options::default(),
    }
}

#[test]
fn a_withheld_condition_can_turn_a_loss_into_a_win() {
    // The design's smallest case of it: the interrupter has a and b, the current user c.
    let told = letters(&[("c", [0, 1, 0]), ("ab", [0, 0, 1])]);
    let (rules, _) = told.bound();
    let found = told.counterfactuals(0);
    assert_eq!(found.served, 0);
    let a = rules.condition("a").unwrap();
    let withheld: Vec<_> = found.of_kind(Kind::Withheld, Some(1)).map(|one| one.edits.clone()).collect();
    assert_eq!(withheld, [vec![Edit::Withheld { user: 1, condition: a }]]);
}

#[test]
fn where_nobody_ranks_anything_two_conditions_change_nothing() {
    // No conditions are worth anything, so neither are two; two ranks can be.
    let told = letters(&[("", [5, 5, 5]), ("", [5, 5, 5])]);
    let found = told.counterfactuals(u64::MAX);
    // One added condition of the interrupter outweighs nothing, since the current user has no
    // offer of its own.
    assert_eq!(found.smallest().unwrap().edits[0].kind(), Kind::Added);

    let mut nothing = letters(&[("", [0, 0, 0]), ("", [0, 0, 0])]);
    nothing.implied = vec![Vec::new(); 2];
    let found = nothing.counterfactuals(u64::MAX);
    assert!(found.single.iter().all(|one| one.edits[0].kind() == Kind::Order), "{found:?}");
    // 2 users, each 3 conditions that can be added and 3 ranks with 5 other values.
    let edits = 2 * (3 + 3 * 5_u64);
    let same_rank = 2 * 3 * (5 * 4 / 2);
    assert_eq!(found.pairs, Pairs::NoneOf { pairs: edits * (edits - 1) / 2 - same_rank });
    assert_eq!(found.decided, edits + 1 + edits * (edits - 1) / 2 - same_rank);
}

#[test]
fn the_search_for_the_least_says_when_it_gives_up() {
    let rows = 24;
    let dispositions = 24;
    let activation: Vec<(String, Vec<String>)> = (0..rows)
        .map(|row| {
            let activated = (0..dispositions).filter(|d| (row * 7 + d * 5 + row * d) % 11 < 3);
            (format!("c{row}"), activated.map(|d| format!("d{d}")).collect())
        })
        .collect();
    let all: Vec<String> = (0..dispositions).map(|d| format!("d{d}")).collect();
    let rules = Rules {
        activation: activation.clone(),
        implications: vec![("goal".to_owned(), all.clone())],
        activation_file: PathBuf::from("activation"),
        implications_file: PathBuf::from("implications"),
    };
    let mut rules = BoundRules::new(rules).unwrap();
    let mut bind = |name: &str, conditions: Vec<String>| {
        let user = User {
            name: name.to_owned(),
            profile: all.iter().map(|name| (name.clone(), Rank(1))).collect(),
            status: conditions.into_iter().map(|name| (name, Truth::True)).collect(),
            goal: Some("goal".to_owned()),
            location: "here".to_owned(),
            files: UserFiles::of_folder(Path::new("user")),
        };
        rules.bind(&user, &GoalChoice::OwnFile).unwrap()
    };
    let sender = bind("sender", activation.iter().map(|(name, _)| name.clone()).collect());
    let receiver = bind("receiver", Vec::new());
    // Everything that is activated at all is to be covered.
    let covered: BTreeSet<&String> = activation.iter().flat_map(|(_, row)| row).collect();
    let willingness = u8::try_from(covered.len() - 1).unwrap();
    let options = Options { aggregation: Aggregation::PerDisposition, willingness, ..Options::default() };
    let given_up = disclosure::least(&rules, &sender, &receiver, options, 3).unwrap();
    let exact = disclosure::least(&rules, &sender, &receiver, options, disclosure::MAX_STEPS).unwrap();
    assert!(matches!(given_up, Least::AtMost(_)), "{given_up:?}");
    assert!(matches!(exact, Least::Exactly(_)), "{exact:?}");
    assert!(exact.sufficient() <= given_up.sufficient());
}
