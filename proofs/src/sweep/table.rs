//! One user's side of all pairs: for each task, how many rank vectors make it behave in
//! each way, and a smallest one of them.
//!
//! Let D(k) be what the other's offer of depth k is worth to the user, less its own
//! complete offer, both in its own eyes. Disclosing a condition of a disposition ranked
//! r raises D by r (or by nothing, if it counts once and was counted), and D starts at
//! minus the own complete offer. That start contains the ranks of dispositions that are
//! still to be heard of, so the dynamic programme guesses their weighted sum, carries
//! what is left of the guess, and keeps what ends at exactly nothing left.

use std::collections::btree_map::{self, BTreeMap};
use std::collections::hash_map::Entry;
use std::hash::{Hash, Hasher};

use rayon::prelude::*;
use rustc_hash::{FxBuildHasher, FxHashMap};
use selfneg_core::Aggregation;

use super::domain::Domain;
use super::grain::Grain;
use super::pattern::{Heard, Patterns, Sequence, TaskId};

/// When a user first accepts: its depth, and the surplus there if the grain asks for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Acceptance {
    /// From 1; 0 = never.
    pub(super) depth: u8,
    /// 0 if the grain does not ask.
    pub(super) surplus: u8,
}

/// What a user does with the other's offers, in either role.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Behaviour {
    /// As the interrupting user.
    pub(super) plain: Acceptance,
    /// As a current user of the grain's willingness.
    pub(super) willing: Acceptance,
    /// D of the other's complete offer.
    pub(super) gain: i16,
}

/// The smallest rank vector: by the sum of ranks, then lexicographically. Its digits are
/// ranks less the lowest, first the dispositions the user has alone, by ascending
/// weight, then those it hears of, in order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Smallest {
    /// The sum of ranks.
    pub(super) sum: u32,
    /// The digits as one number.
    pub(super) digits: u64,
}

/// How many rank vectors there are of one kind, and the smallest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vectors {
    pub(super) count: u64,
    pub(super) smallest: Smallest,
}

impl Vectors {
    fn join(&mut self, more: Self) {
        self.count += more.count;
        self.smallest = self.smallest.min(more.smallest);
    }
}

/// The behaviours that a task leaves open, sorted.
pub(super) type Table = Vec<(Behaviour, Vectors)>;

/// A state of the dynamic programme. `behaviour.gain` is D so far.
#[derive(Clone, Copy, PartialEq, Eq)]
struct State {
    behaviour: Behaviour,
    /// What is left of the guess: the own complete offer's part in dispositions still to
    /// be heard of.
    left: i16,
}

impl Hash for State {
    /// One word, injectively: a depth is below 64, a surplus below 256.
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        let Behaviour { plain, willing, gain } = self.behaviour;
        let [high, low] = gain.to_be_bytes();
        let [left_high, left_low] = self.left.to_be_bytes();
        let depths = u16::from(plain.depth) << 6 | u16::from(willing.depth);
        let [depths_high, depths_low] = depths.to_be_bytes();
        hasher.write_u64(u64::from_be_bytes([
            high,
            low,
            left_high,
            left_low,
            depths_high,
            depths_low,
            plain.surplus,
            willing.surplus,
        ]));
    }
}

type Layer = FxHashMap<State, Vectors>;

/// The tables of all tasks, by [`TaskId`]. Calls `done` after each.
pub(super) fn tables(
    domain: &Domain,
    grain: &Grain,
    patterns: &Patterns,
    done: &(dyn Fn() + Sync),
) -> Vec<Table> {
    let mut by_alone: BTreeMap<&[u8], Vec<(Sequence, TaskId)>> = BTreeMap::new();
    for (task, id) in patterns.tasks.iter().zip(0..) {
        by_alone.entry(&task.alone).or_default().push((task.heard, TaskId(id)));
    }
    let mut numbered: Vec<(TaskId, Table)> = by_alone
        .into_par_iter()
        .flat_map(|(alone, tasks)| Grower::new(domain, grain, patterns, &tasks, done).grow(alone))
        .collect();
    numbered.sort_unstable_by_key(|(id, _)| *id);
    numbered.into_iter().map(|(_, table)| table).collect()
}

/// Grows the tree of sequences for the tasks of users with the same weights alone.
struct Grower<'a> {
    lowest: u8,
    ranks: u8,
    dispositions: usize,
    grain: &'a Grain,
    branches: FxHashMap<Sequence, Branch>,
    done: &'a (dyn Fn() + Sync),
}

#[derive(Default)]
struct Branch {
    task: Option<TaskId>,
    longer: Vec<(Sequence, Heard)>,
    /// The largest weight that the own complete offer has in what is heard after.
    own_to_come: u8,
}

impl<'a> Grower<'a> {
    fn new(
        domain: &Domain,
        grain: &'a Grain,
        patterns: &Patterns,
        tasks: &[(Sequence, TaskId)],
        done: &'a (dyn Fn() + Sync),
    ) -> Self {
        let mut branches: FxHashMap<Sequence, Branch> = FxHashMap::default();
        for &(sequence, task) in tasks {
            branches.entry(sequence).or_default().task = Some(task);
            let mut own_to_come = 0;
            let mut node = sequence;
            while let Some((shorter, last)) = patterns.shortened(node) {
                own_to_come += last.own;
                let branch = branches.entry(shorter).or_default();
                branch.own_to_come = branch.own_to_come.max(own_to_come);
                if !branch.longer.contains(&(node, last)) {
                    branch.longer.push((node, last));
                }
                node = shorter;
            }
        }
        Self {
            lowest: *domain.ranks().start(),
            ranks: domain.ranks().end() - domain.ranks().start(),
            dispositions: domain.dispositions(),
            grain,
            branches,
            done,
        }
    }

    fn grow(&self, alone: &[u8]) -> Vec<(TaskId, Table)> {
        let one = Vectors { count: 1, smallest: Smallest::default() };
        let mut totals: BTreeMap<i16, Vectors> = BTreeMap::from([(0, one)]);
        for &weight in alone {
            let mut more: BTreeMap<i16, Vectors> = BTreeMap::new();
            for (total, vectors) in totals {
                for digit in 0..=self.ranks {
                    let total = total + self.weighted(digit, weight);
                    add(more.entry(total), self.ranked(vectors, digit));
                }
            }
            totals = more;
        }
        let root = Sequence::ROOT;
        let mut layer = Layer::default();
        for (total, vectors) in totals {
            for left in 0..=self.most_left(root) {
                let never = Acceptance::default();
                let behaviour = Behaviour { plain: never, willing: never, gain: -(total + left) };
                layer.insert(State { behaviour, left }, vectors);
            }
        }
        self.grow_from(root, alone.len(), 0, &layer)
    }

    /// The tables of all tasks that begin with `sequence`, of `depth` conditions.
    fn grow_from(&self, sequence: Sequence, placed: usize, depth: u8, layer: &Layer) -> Vec<(TaskId, Table)> {
        let Some(branch) = self.branches.get(&sequence) else { return Vec::new() };
        let mut tables: Vec<(TaskId, Table)> = branch
            .longer
            .par_iter()
            .with_max_len(1)
            .flat_map(|&(longer, heard)| {
                let next = self.hear(layer, heard, depth, self.most_left(longer));
                self.grow_from(longer, placed + 1, depth + heard.disclosed, &next)
            })
            .collect();
        if let Some(task) = branch.task {
            tables.push((task, self.table(layer, self.dispositions - placed)));
            (self.done)();
        }
        tables
    }

    /// One more disposition, of each rank.
    fn hear(&self, layer: &Layer, heard: Heard, depth: u8, most_left: i16) -> Layer {
        let mut next = Layer::with_capacity_and_hasher(layer.len() * 2, FxBuildHasher);
        for (&State { behaviour, left }, &vectors) in layer {
            for digit in 0..=self.ranks {
                let left = left - self.weighted(digit, heard.own);
                if left < 0 {
                    break;
                }
                if left > most_left {
                    continue;
                }
                let behaviour = self.after(behaviour, heard.disclosed, self.weighted(digit, 1), depth);
                let vectors = self.ranked(vectors, digit);
                match next.entry(State { behaviour, left }) {
                    Entry::Occupied(mut entry) => entry.get_mut().join(vectors),
                    Entry::Vacant(entry) => {
                        entry.insert(vectors);
                    }
                }
            }
        }
        next
    }

    /// The behaviour after `disclosed` more conditions of one disposition of this rank.
    fn after(&self, mut behaviour: Behaviour, disclosed: u8, rank: i16, depth: u8) -> Behaviour {
        for nth in 1..=disclosed {
            match self.grain.aggregation {
                Aggregation::PerDisposition if nth > 1 => break,
                Aggregation::PerCondition | Aggregation::PerDisposition => behaviour.gain += rank,
            }
            self.accept(&mut behaviour.plain, behaviour.gain, depth + nth);
            let willing = behaviour.gain - i16::from(self.grain.willingness);
            self.accept(&mut behaviour.willing, willing, depth + nth);
        }
        behaviour
    }

    fn accept(&self, acceptance: &mut Acceptance, surplus: i16, depth: u8) {
        if acceptance.depth == 0 && surplus > 0 {
            acceptance.depth = depth;
            if self.grain.surplus {
                // At most one rank: the offer before was not acceptable.
                acceptance.surplus = u8::try_from(surplus).unwrap_or(u8::MAX);
            }
        }
    }

    /// The states with nothing left, given the number of dispositions without influence.
    fn table(&self, layer: &Layer, free: usize) -> Table {
        let lowest = (0..free).fold(0, |sum, _| sum + u32::from(self.lowest));
        let mut table: Table = layer
            .iter()
            .filter(|(state, _)| state.left == 0)
            .map(|(state, &vectors)| {
                let Smallest { sum, digits } = vectors.smallest;
                (state.behaviour, Vectors { smallest: Smallest { sum: sum + lowest, digits }, ..vectors })
            })
            .collect();
        table.sort_unstable_by_key(|(behaviour, _)| *behaviour);
        table
    }

    fn most_left(&self, sequence: Sequence) -> i16 {
        let weight = self.branches.get(&sequence).map_or(0, |branch| branch.own_to_come);
        self.weighted(self.ranks, weight)
    }

    /// The rank of this digit, times a weight: at most 63 conditions times 255.
    fn weighted(&self, digit: u8, weight: u8) -> i16 {
        i16::from(self.lowest + digit) * i16::from(weight)
    }

    fn ranked(&self, vectors: Vectors, digit: u8) -> Vectors {
        let Smallest { sum, digits } = vectors.smallest;
        let sum = sum + u32::from(self.lowest + digit);
        let digits = digits * (u64::from(self.ranks) + 1) + u64::from(digit);
        Vectors { smallest: Smallest { sum, digits }, ..vectors }
    }
}

fn add<K: Ord>(entry: btree_map::Entry<'_, K, Vectors>, more: Vectors) {
    entry.and_modify(|vectors| vectors.join(more)).or_insert(more);
}
