//! How much was disclosed in a decision, against the least that could have been accepted.
//!
//! In a negotiation the order of disclosure is the sender's, blind to what the receiver
//! thinks. Looking back with both users' data in hand one can say what would have sufficed:
//! the *least* of a sender is the smallest number of its true conditions that, disclosed
//! alone, with the sender's goal, the receiver would have accepted. An offer is worth no less
//! the more it discloses, so if not even the complete offer is acceptable, nothing is
//! ([`Least::Never`]). Nobody could have known the least beforehand without reading the other
//! user's profile: it measures what blindness costs and is no rule that the robot could follow.
//!
//! With every condition counted by itself (`per-condition`) the least are the conditions of
//! the most worth to the receiver. With every disposition counted once (`per-disposition`) it
//! is a covering problem, solved by search; beyond [`MAX_STEPS`] steps of it the best that is
//! known is reported as [`Least::AtMost`].

use selfneg_core::{Activation, Aggregation, Condition, Disposition, Options, Side, impact_of_serving};

use crate::binding::{BoundRules, BoundUser};
use crate::precedence::{Decision, HeldNegotiation, PrecedenceError};
use crate::transcript::Event;

/// How far the search for the least goes.
pub const MAX_STEPS: u64 = 1_000_000;

/// One side of a negotiation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Disclosed {
    /// The sender, by arrival.
    pub sender: usize,
    /// Who heard it, by arrival.
    pub receiver: usize,
    /// How many conditions were disclosed. Willingness is none.
    pub disclosed: usize,
    /// How many true conditions there are.
    pub conditions: usize,
    /// How few would have been accepted.
    pub least: Least,
}

/// How few conditions would have been accepted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Least {
    /// So many, and no fewer: these, for example.
    Exactly(Vec<Condition>),
    /// These suffice; whether fewer would is not known.
    AtMost(Vec<Condition>),
    /// Not even all of them.
    Never,
}

impl Least {
    /// How many suffice, as far as is known.
    #[must_use]
    pub fn sufficient(&self) -> Option<usize> {
        match self {
            Self::Exactly(conditions) | Self::AtMost(conditions) => Some(conditions.len()),
            Self::Never => None,
        }
    }
}

/// Both sides of each negotiation of a decision, in the order in which these were held, the
/// current side first.
///
/// # Errors
/// [`PrecedenceError`] if the engine refuses the rules or a status.
pub fn of_decision(
    rules: &BoundRules,
    users: &[BoundUser],
    decision: &Decision,
) -> Result<Vec<[Disclosed; 2]>, PrecedenceError> {
    let two = |held: &HeldNegotiation| {
        let (current, interrupting) = (users.get(held.current)?, users.get(held.interrupting)?);
        let side = |side: Side| {
            let (sender, receiver, places) = match side {
                Side::Current => (current, interrupting, (held.current, held.interrupting)),
                Side::Interrupting => (interrupting, current, (held.interrupting, held.current)),
            };
            // Willingness raises the bar of the current side.
            let willingness = if side == Side::Interrupting { held.options.willingness } else { 0 };
            let options = Options { willingness, ..held.options };
            Ok(Disclosed {
                sender: places.0,
                receiver: places.1,
                disclosed: disclosed(held, side, sender.conditions().len()),
                conditions: sender.conditions().len(),
                least: least(rules, sender, receiver, options, MAX_STEPS)?,
            })
        };
        Some(side(Side::Current).and_then(|first| Ok([first, side(Side::Interrupting)?])))
    };
    decision.negotiations.iter().filter_map(two).collect()
}

/// How many conditions a side has disclosed in the end.
fn disclosed(held: &HeldNegotiation, side: Side, conditions: usize) -> usize {
    let depth = |event: &Event| match event {
        Event::Offer { depth, .. } => *depth,
        Event::Quit => 0,
    };
    let depths = held.rounds.iter().filter(|round| round.sender == side).map(|round| depth(&round.event));
    depths.max().unwrap_or(0).min(conditions)
}

/// The fewest true conditions of `sender` that `receiver`, whose willingness is that of
/// `options`, would accept.
///
/// # Errors
/// [`PrecedenceError`] if the engine refuses the rules or a status.
pub fn least(
    rules: &BoundRules,
    sender: &BoundUser,
    receiver: &BoundUser,
    options: Options,
    max_steps: u64,
) -> Result<Least, PrecedenceError> {
    let rows = rules.rows();
    let activation = Activation::new(&rows)?;
    let eyes = receiver.user()?;
    let own = impact_of_serving(&eyes, &eyes, activation, options.aggregation).0;
    let bar = own.saturating_add(u64::from(options.willingness));
    if impact_of_serving(&sender.user()?, &eyes, activation, options.aggregation).0 <= bar {
        return Ok(Least::Never);
    }
    let items = sender.conditions().iter().map(|&condition| {
        let worth = activation.of(condition).iter().map(|&disposition| {
            let rank = receiver.ranks().get(usize::from(disposition.0)).map_or(0, |rank| u64::from(rank.0));
            let mentions = u64::from(sender.mentions(disposition));
            let counted = match options.aggregation {
                Aggregation::PerCondition => mentions,
                Aggregation::PerDisposition => mentions.min(1),
            };
            (disposition, rank.saturating_mul(counted))
        });
        Item::new(condition, worth.filter(|(_, worth)| *worth > 0).collect())
    });
    let mut items: Vec<Item> = items.collect();
    items.sort_by_key(|item| std::cmp::Reverse(item.alone));
    Ok(match options.aggregation {
        Aggregation::PerCondition => Least::Exactly(most_worth(&items, bar)),
        Aggregation::PerDisposition => cover(&items, bar, max_steps),
    })
}

/// A condition as the receiver sees it.
struct Item {
    condition: Condition,
    worth: Vec<(Disposition, u64)>,
    /// Its worth if nothing else is disclosed.
    alone: u64,
}

impl Item {
    fn new(condition: Condition, worth: Vec<(Disposition, u64)>) -> Self {
        let alone = worth.iter().map(|(_, worth)| worth).sum();
        Self { condition, worth, alone }
    }

    /// What it adds to what is covered.
    fn beyond(&self, covered: &[Disposition]) -> u64 {
        self.worth
            .iter()
            .filter(|(disposition, _)| !covered.contains(disposition))
            .map(|(_, worth)| worth)
            .sum()
    }
}

/// Of `items`, the most worth first, as many as exceed the bar.
fn most_worth(items: &[Item], bar: u64) -> Vec<Condition> {
    let mut total = 0_u64;
    let mut chosen = Vec::new();
    for item in items {
        if total > bar {
            break;
        }
        total = total.saturating_add(item.alone);
        chosen.push(item.condition);
    }
    chosen
}

/// The fewest items whose dispositions, each counted once, exceed the bar.
fn cover(items: &[Item], bar: u64, max_steps: u64) -> Least {
    let greedy = greedily(items, bar);
    let mut search = Search { items, bar, steps_left: max_steps, chosen: Vec::new(), covered: Vec::new() };
    for size in 0..greedy.len() {
        match search.reaches(0, size, 0) {
            Some(true) => return Least::Exactly(search.conditions()),
            Some(false) => {}
            None => return Least::AtMost(greedy),
        }
    }
    Least::Exactly(greedy)
}

/// Each time the item that adds most.
fn greedily(items: &[Item], bar: u64) -> Vec<Condition> {
    let mut chosen = Vec::new();
    let mut covered = Vec::new();
    let mut total = 0_u64;
    while total <= bar {
        let best = items.iter().max_by_key(|item| item.beyond(&covered));
        let Some(item) = best.filter(|item| item.beyond(&covered) > 0) else { break };
        total = total.saturating_add(item.beyond(&covered));
        covered.extend(item.worth.iter().map(|(disposition, _)| *disposition));
        chosen.push(item.condition);
    }
    chosen
}

/// Depth first through the subsets of a given size.
struct Search<'a> {
    items: &'a [Item],
    bar: u64,
    steps_left: u64,
    chosen: Vec<&'a Item>,
    covered: Vec<Disposition>,
}

impl Search<'_> {
    /// Whether `more` items from place `from` on lift `total` over the bar; they are then in
    /// `chosen`. `None`: no steps are left.
    fn reaches(&mut self, from: usize, more: usize, total: u64) -> Option<bool> {
        if total > self.bar {
            return Some(true);
        }
        self.steps_left = self.steps_left.checked_sub(1)?;
        let items = self.items;
        for (at, item) in items.iter().enumerate().skip(from) {
            // The items are sorted: no later ones can add more than these alone.
            let bound: u64 = items.iter().skip(at).take(more).map(|item| item.alone).sum();
            if more == 0 || total.saturating_add(bound) <= self.bar {
                return Some(false);
            }
            let with = total.saturating_add(item.beyond(&self.covered));
            let covered_before = self.covered.len();
            self.covered.extend(item.worth.iter().map(|(disposition, _)| *disposition));
            self.chosen.push(item);
            if self.reaches(at.saturating_add(1), more.saturating_sub(1), with)? {
                return Some(true);
            }
            let _ = self.chosen.pop();
            self.covered.truncate(covered_before);
        }
        Some(false)
    }

    fn conditions(&self) -> Vec<Condition> {
        self.chosen.iter().map(|item| item.condition).collect()
    }
}
