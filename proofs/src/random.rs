//! Random search over large users, by proptest, which shrinks what it finds.
//!
//! A draw has up to 200 conditions a side, rows that share dispositions, conditions
//! without a row, goals that imply some dispositions, not at all, once or twice, and ranks
//! of 0..=2 or 0..=255. Half of the users rank their own needs low, so that mutual
//! deference, which most interesting properties turn on, is not a rarity.

use proptest::collection::vec;
use proptest::prelude::{Strategy, any};
use proptest::prop_oneof;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use selfneg_core::{Condition, Disposition, Observer, Options, Rank, Side};

use crate::counterexample::{self, Altered, Counterexample, OwnedCase, OwnedUser};
use crate::engine::{Core, Engine};
use crate::property::{Alteration, Judgement, Property};
use crate::shrink::shrink;

/// The most conditions of a user that is drawn.
pub const MOST_CONDITIONS: usize = 200;

const MOST_DISPOSITIONS: u16 = 40;

/// What the reports say of where random cases come from.
pub const DOMAIN: &str = "up to 200 conditions a side and 40 dispositions, ranks 0..=255, shared activations";

/// Numbers from which a second case is made, so that it shrinks with the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recipe {
    /// The side that is altered.
    pub side: Side,
    /// One number a condition: the greatest quarter is hidden; they give a new order; and
    /// so on. Missing ones are 0.
    pub keys: Vec<u8>,
    /// Other ranks.
    pub ranks: Vec<u8>,
}

impl Recipe {
    fn key(&self, index: usize) -> u8 {
        self.keys.get(index).copied().unwrap_or(0)
    }

    fn reordered(&self, conditions: &[Condition]) -> Vec<Condition> {
        let mut keyed: Vec<(u8, Condition)> =
            conditions.iter().enumerate().map(|(index, &condition)| (self.key(index), condition)).collect();
        keyed.sort_by_key(|&(key, _)| key);
        keyed.into_iter().map(|(_, condition)| condition).collect()
    }

    /// The altered user.
    #[must_use]
    pub fn alter(&self, alteration: Alteration, case: &OwnedCase, options: &Options) -> OwnedUser {
        let mut user = case.user(self.side).clone();
        let ranks = || self.ranks.iter().copied().map(Rank).collect();
        match alteration {
            Alteration::None | Alteration::Copied => {}
            Alteration::Hidden => {
                let mut index = 0;
                user.conditions.retain(|_| {
                    index += 1;
                    self.key(index - 1) < 192
                });
            }
            Alteration::Reordered => user.conditions = self.reordered(&user.conditions),
            Alteration::Misreported => user.ranks = ranks(),
            Alteration::Undisclosed => {
                let disclosed = disclosed(case, self.side, options).min(user.conditions.len());
                let rest = user.conditions.split_off(disclosed);
                user.conditions.extend(self.reordered(&rest));
                // Conditions without a row change nobody's total.
                user.conditions.extend((60_000..).map(Condition).take(usize::from(self.key(0) % 3)));
            }
            Alteration::Replaced => {
                let kept = usize::from(self.key(0)).min(user.conditions.len());
                let rest = user.conditions.split_off(kept);
                let rest = self.reordered(&rest);
                let some = rest.len() - usize::from(self.key(1) % 4).min(rest.len());
                user.conditions.extend(rest.into_iter().take(some));
                user.ranks = ranks();
            }
        }
        user
    }
}

/// How many offers `side` makes.
fn disclosed(case: &OwnedCase, side: Side, options: &Options) -> usize {
    struct Deepest(Side, usize);
    impl Observer for Deepest {
        fn offer(&mut self, _: u32, sender: Side, depth: usize, _: selfneg_core::Disclosure) {
            if sender == self.0 {
                self.1 = depth;
            }
        }
    }
    let mut deepest = Deepest(side, 0);
    case.open(|case| Core.negotiate(case, options, &mut deepest));
    deepest.1
}

/// A case and the numbers for a second one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Draw {
    /// The case.
    pub case: OwnedCase,
    /// The numbers.
    pub recipe: Recipe,
}

fn ranks(most: usize) -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![vec(0..=2_u8, 0..=most), vec(any::<u8>(), 0..=most)]
}

fn user(dispositions: u16, conditions: usize) -> impl Strategy<Value = (Vec<u8>, Vec<u16>, Vec<u8>)> {
    let most = usize::from(dispositions);
    let indices = u16::try_from(conditions).unwrap_or(u16::MAX);
    (
        ranks(most),
        vec(0..=indices, 0..=conditions),
        prop_oneof![3 => vec(1..=1_u8, most), 1 => vec(0..=2_u8, 0..=most)],
    )
}

fn draws_of(dispositions: u16, conditions: usize) -> impl Strategy<Value = Draw> {
    let row = vec(0..dispositions, 0..=3);
    (
        vec(row, 0..=conditions),
        user(dispositions, conditions),
        user(dispositions, conditions),
        any::<[bool; 2]>(),
        any::<bool>(),
        vec(any::<u8>(), 0..=conditions),
        ranks(usize::from(dispositions)),
    )
        .prop_map(|(rows, current, interrupting, humble, interrupts, keys, ranks)| {
            let activation: Vec<Vec<Disposition>> =
                rows.into_iter().map(|row| distinct(row.into_iter().map(Disposition))).collect();
            let [humble_current, humble_interrupting] = humble;
            let case = OwnedCase {
                current: assemble(&activation, current, humble_current),
                interrupting: assemble(&activation, interrupting, humble_interrupting),
                activation,
            };
            let side = if interrupts { Side::Interrupting } else { Side::Current };
            Draw { case, recipe: Recipe { side, keys, ranks } }
        })
}

fn assemble(
    activation: &[Vec<Disposition>],
    (ranks, conditions, goal): (Vec<u8>, Vec<u16>, Vec<u8>),
    humble: bool,
) -> OwnedUser {
    let conditions = distinct(conditions.into_iter().map(Condition));
    let mut ranks: Vec<Rank> = ranks.into_iter().map(Rank).collect();
    if humble {
        for condition in &conditions {
            for disposition in activation.get(usize::from(condition.0)).into_iter().flatten() {
                if let Some(rank) = ranks.get_mut(usize::from(disposition.0)) {
                    rank.0 /= 2;
                }
            }
        }
    }
    OwnedUser { ranks, conditions, goal }
}

fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut distinct = Vec::new();
    for item in items {
        if !distinct.contains(&item) {
            distinct.push(item);
        }
    }
    distinct
}

/// Cases of every size, small ones as often as large ones.
pub fn draws() -> impl Strategy<Value = Draw> {
    prop_oneof![
        draws_of(3, 4),
        draws_of(6, 10),
        draws_of(12, 40),
        draws_of(MOST_DISPOSITIONS, MOST_CONDITIONS)
    ]
}

/// What `draw` says of `property`. A draw that `selfneg_core` refuses is vacuous.
pub fn judge<E: Engine>(property: Property, engine: &E, draw: &Draw, options: &Options) -> Judgement {
    let side = draw.recipe.side;
    let mut second = draw.case.clone();
    let altered = draw.recipe.alter(property.alteration(), &draw.case, options);
    match side {
        Side::Current => second.current = altered,
        Side::Interrupting => second.interrupting = altered,
    }
    counterexample::judge(property, engine, &draw.case, (&second, side), options)
}

/// What random search came to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Search {
    /// How many cases were drawn, up to the first that refutes the property.
    pub cases: u128,
    /// How many of them met the property's premise.
    pub nonvacuous: u128,
    /// What the first that refutes it shrank to.
    pub counterexample: Option<Counterexample>,
}

/// Checks `property` on `cases` random cases. The same `seed` draws the same ones.
pub fn search<E: Engine>(property: Property, engine: &E, options: &Options, cases: u32, seed: u64) -> Search {
    let mut bytes = [0; 32];
    for (byte, value) in bytes.iter_mut().zip(seed.to_le_bytes()) {
        *byte = value;
    }
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    let strategy = draws();
    let mut search = Search::default();
    for _ in 0..cases {
        // No strategy here filters what it draws, so none gives up.
        let Ok(mut tree) = strategy.new_tree(&mut runner) else { continue };
        let draw = tree.current();
        let judgement = judge(property, engine, &draw, options);
        search.cases += 1;
        search.nonvacuous += u128::from(judgement != Judgement::Vacuous);
        if judgement == Judgement::Fails {
            let draw = simplest(draw, &mut tree, |draw| judge(property, engine, draw, options));
            search.counterexample = Some(shrink(property, engine, in_full(property, draw, options)));
            break;
        }
    }
    search
}

/// How many simplifications are tried of a draw: they make it small enough for
/// [`shrink`], which then knows more of what it is about.
const SIMPLIFICATIONS: u32 = 512;

fn simplest<T: ValueTree<Value = Draw>>(
    first: Draw,
    tree: &mut T,
    judge: impl Fn(&Draw) -> Judgement,
) -> Draw {
    let mut best = first;
    let mut more = tree.simplify();
    for _ in 0..SIMPLIFICATIONS {
        if !more {
            break;
        }
        let draw = tree.current();
        more = match judge(&draw) {
            Judgement::Fails => {
                best = draw;
                tree.simplify()
            }
            Judgement::Holds | Judgement::Vacuous => tree.complicate(),
        };
    }
    best
}

fn in_full(property: Property, draw: Draw, options: &Options) -> Counterexample {
    let altered = match property.alteration() {
        Alteration::None | Alteration::Copied => None,
        alteration => Some(Altered {
            index: match draw.recipe.side {
                Side::Current => 0,
                Side::Interrupting => 1,
            },
            user: draw.recipe.alter(alteration, &draw.case, options),
        }),
    };
    Counterexample {
        activation: draw.case.activation,
        users: vec![draw.case.current, draw.case.interrupting],
        altered,
        options: *options,
    }
}
