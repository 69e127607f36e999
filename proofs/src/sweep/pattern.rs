//! Which dispositions the two statuses of a pair touch, up to what no verdict depends on.
//!
//! Given the two statuses, what a user makes of the other's offers depends on its own
//! ranks alone. Its *task* is what the statuses leave for its ranks to decide: in the
//! order in which the other discloses them, the dispositions it hears of, each with the
//! number of conditions it hears and the weight the disposition has in its own complete
//! offer; and the weights of the dispositions it alone has. Pairs of statuses with the
//! same two tasks are one pattern, counted with its multiplicity.

use rustc_hash::FxHashMap;
use selfneg_core::Aggregation;

use super::domain::Domain;

/// One disposition that a user hears of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Heard {
    /// How many conditions the other discloses for it. At least 1.
    pub(super) disclosed: u8,
    /// How often its rank counts in the user's own complete offer.
    pub(super) own: u8,
}

/// A node of the tree of sequences of dispositions heard of. The root hears of none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Sequence(u32);

impl Sequence {
    pub(super) const ROOT: Self = Self(0);
}

/// A multiset of weights, ascending.
type Weights = Vec<u8>;

/// What is left for one user's ranks to decide.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Task {
    /// The weights of the dispositions that only the user itself has, ascending.
    pub(super) alone: Weights,
    /// The dispositions it hears of.
    pub(super) heard: Sequence,
}

/// The number of a task in [`Patterns::tasks`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct TaskId(pub(super) u32);

/// For each disposition how many conditions of the current and of the interrupting user
/// are true: one byte each, disposition 0 in the highest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Statuses(u128);

impl Statuses {
    fn and(self, current: u8, interrupting: u8) -> Self {
        Self(self.0 << 8 | u128::from(current << 4 | interrupting))
    }

    /// The counts of current and interrupting user, disposition 0 first.
    pub(super) fn counts(self, dispositions: usize) -> impl Iterator<Item = (u8, u8)> {
        (0..dispositions).rev().map(move |d| {
            let byte = u8::try_from(self.0 >> (8 * d) & 0xff).unwrap_or_default();
            (byte >> 4, byte & 0x0f)
        })
    }
}

/// Pairs of statuses that set both users the same tasks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pattern {
    /// The current user's task.
    pub(super) current: TaskId,
    /// The interrupting user's task.
    pub(super) interrupting: TaskId,
    /// How many pairs of statuses, times the ranks of both users for each disposition
    /// that neither status touches.
    pub(super) ways: u128,
    /// One of those pairs.
    pub(super) statuses: Statuses,
}

/// All patterns of a domain and their tasks.
pub(super) struct Patterns {
    tree: Vec<Node>,
    /// The tasks; a [`TaskId`] is an index.
    pub(super) tasks: Vec<Task>,
    /// The patterns by the numbers of true conditions of current and interrupting user,
    /// within each sorted by the two tasks.
    pub(super) by_lengths: Vec<Vec<Pattern>>,
}

struct Node {
    parent: Option<Sequence>,
    last: Heard,
    conditions: u8,
}

/// The part of a pattern that the dispositions so far make.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct Prefix {
    current: Task,
    interrupting: Task,
}

impl Patterns {
    pub(super) fn of(domain: &Domain, aggregation: Aggregation) -> Self {
        let mut tree = Tree::new();
        let start = Task { alone: Vec::new(), heard: Sequence::ROOT };
        let mut prefixes: FxHashMap<Prefix, (u128, Statuses)> = FxHashMap::default();
        prefixes.insert(Prefix { current: start.clone(), interrupting: start }, (1, Statuses(0)));
        let ranks = u128::from(domain.ranks().end() - domain.ranks().start()) + 1;
        for &conditions in domain.conditions_per_disposition() {
            let mut longer: FxHashMap<Prefix, (u128, Statuses)> = FxHashMap::default();
            for (prefix, (ways, statuses)) in &prefixes {
                for c in 0..=conditions {
                    for i in 0..=conditions {
                        let free = if c == 0 && i == 0 { ranks * ranks } else { 1 };
                        let more = ways * choose(conditions, c) * choose(conditions, i) * free;
                        let witness = statuses.and(c, i);
                        let key = Prefix {
                            current: tree.extend(&prefix.current, aggregation, i, c),
                            interrupting: tree.extend(&prefix.interrupting, aggregation, c, i),
                        };
                        longer
                            .entry(key)
                            .and_modify(|(total, first)| {
                                *total += more;
                                *first = witness.max(*first);
                            })
                            .or_insert((more, witness));
                    }
                }
            }
            prefixes = longer;
        }
        tree.number(domain, &prefixes)
    }

    /// The sequence without its last disposition, and that disposition.
    pub(super) fn shortened(&self, sequence: Sequence) -> Option<(Sequence, Heard)> {
        let node = self.node(sequence)?;
        node.parent.map(|parent| (parent, node.last))
    }

    fn node(&self, sequence: Sequence) -> Option<&Node> {
        self.tree.get(index(sequence.0))
    }
}

struct Tree {
    nodes: Vec<Node>,
    children: FxHashMap<(Sequence, Heard), Sequence>,
}

impl Tree {
    fn new() -> Self {
        let root = Node { parent: None, last: Heard { disclosed: 0, own: 0 }, conditions: 0 };
        Self { nodes: vec![root], children: FxHashMap::default() }
    }

    /// The task with one more disposition, of which the other user has `others` true
    /// conditions and the user itself `own`.
    fn extend(&mut self, task: &Task, aggregation: Aggregation, others: u8, own: u8) -> Task {
        let own = match aggregation {
            Aggregation::PerCondition => own,
            Aggregation::PerDisposition => own.min(1),
        };
        let mut task = task.clone();
        if others > 0 {
            task.heard = self.child(task.heard, Heard { disclosed: others, own });
        } else if own > 0 {
            let place = task.alone.partition_point(|&weight| weight <= own);
            task.alone.insert(place, own);
        }
        task
    }

    fn child(&mut self, parent: Sequence, last: Heard) -> Sequence {
        let nodes = &mut self.nodes;
        *self.children.entry((parent, last)).or_insert_with(|| {
            let conditions = nodes.get(index(parent.0)).map_or(0, |node| node.conditions);
            nodes.push(Node { parent: Some(parent), last, conditions: conditions + last.disclosed });
            Sequence(number(nodes.len() - 1))
        })
    }

    fn number(self, domain: &Domain, prefixes: &FxHashMap<Prefix, (u128, Statuses)>) -> Patterns {
        let mut tasks: Vec<Task> = prefixes
            .keys()
            .flat_map(|prefix| [prefix.current.clone(), prefix.interrupting.clone()])
            .collect();
        tasks.sort_unstable();
        tasks.dedup();
        let ids: FxHashMap<&Task, TaskId> =
            tasks.iter().zip(0..).map(|(task, id)| (task, TaskId(id))).collect();
        let lengths = domain.conditions() + 1;
        let mut by_lengths: Vec<Vec<Pattern>> = Vec::new();
        by_lengths.resize_with(lengths * lengths, Vec::new);
        let conditions = |sequence: Sequence| {
            self.nodes.get(index(sequence.0)).map_or(0, |node| usize::from(node.conditions))
        };
        for (prefix, (ways, statuses)) in prefixes {
            let group = conditions(prefix.interrupting.heard) * lengths + conditions(prefix.current.heard);
            let ids = ids.get(&prefix.current).zip(ids.get(&prefix.interrupting));
            if let Some((patterns, (&current, &interrupting))) = by_lengths.get_mut(group).zip(ids) {
                patterns.push(Pattern { current, interrupting, ways: *ways, statuses: *statuses });
            }
        }
        for patterns in &mut by_lengths {
            patterns.sort_unstable_by_key(|pattern| (pattern.current, pattern.interrupting));
        }
        by_lengths.retain(|patterns| !patterns.is_empty());
        Patterns { tree: self.nodes, tasks, by_lengths }
    }
}

/// The number of subsets of this size. Exact: `n` is at most
/// [`MAX_PER_DISPOSITION`](super::domain::MAX_PER_DISPOSITION).
fn choose(n: u8, size: u8) -> u128 {
    (0..size).fold(1, |ways, taken| ways * u128::from(n - taken) / (u128::from(taken) + 1))
}

fn index(id: u32) -> usize {
    usize::try_from(id).unwrap_or(usize::MAX)
}

fn number(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
