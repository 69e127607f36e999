//! Both sides together: all pairs of users with given numbers of conditions, in classes.

use std::cmp::Ordering;

use rustc_hash::FxHashMap;
use selfneg_core::{Condition, Rank};

use super::domain::Domain;
use super::grain::{Detail, Grain};
use super::pair::{Pair, Person};
use super::pattern::{Pattern, TaskId};
use super::table::{Acceptance, Behaviour, Smallest, Table};

/// What all pairs are made of.
pub(super) struct Parts<'a> {
    pub(super) domain: &'a Domain,
    pub(super) grain: &'a Grain,
    pub(super) tables: &'a [Table],
}

/// What the grain keeps of a [`Behaviour`], but for the exact gain.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Manner {
    plain: Acceptance,
    willing: Acceptance,
    gain: Ordering,
    willing_gain: Ordering,
}

/// What the grain keeps of the manners of both, current user first.
#[derive(PartialEq, Eq, Hash)]
struct Manners {
    depths: [(u8, u8); 2],
    gains: [(Ordering, Ordering); 2],
    /// Whose surplus is larger if both accept at the same depth, as the roles are and
    /// with the roles swapped.
    ties: [Option<Ordering>; 2],
}

/// All pairs with the same manners and the same difference of gains.
#[derive(Clone, Copy)]
struct Cell {
    count: u128,
    sum: u32,
    pattern: u32,
    current: u32,
    interrupting: u32,
}

/// The interrupting users to whom a current user's task leaves one behaviour.
#[derive(Clone, Copy)]
struct Mixed {
    count: u128,
    sum: u32,
    pattern: u32,
    entry: u32,
}

/// The behaviours of one side, sorted, and the manner of each as an index.
struct Side {
    behaviours: Vec<Behaviour>,
    manners: Vec<Manner>,
    manner_of: Vec<usize>,
}

impl Side {
    fn of<'t>(tables: impl Iterator<Item = &'t Table>, grain: &Grain) -> Self {
        let mut behaviours: Vec<Behaviour> = tables.flatten().map(|&(behaviour, _)| behaviour).collect();
        behaviours.sort_unstable();
        behaviours.dedup();
        let mut manners: Vec<Manner> = Vec::new();
        let mut manner_of = Vec::with_capacity(behaviours.len());
        for &Behaviour { plain, willing, gain } in &behaviours {
            let manner = Manner {
                plain,
                willing,
                gain: gain.cmp(&0),
                willing_gain: gain.cmp(&i16::from(grain.willingness)),
            };
            if manners.last() != Some(&manner) {
                manners.push(manner);
            }
            manner_of.push(manners.len() - 1);
        }
        Self { behaviours, manners, manner_of }
    }

    /// The index of each behaviour of a table.
    fn indices(&self, table: &Table) -> Vec<usize> {
        table
            .iter()
            .map(|(behaviour, _)| self.behaviours.binary_search(behaviour).unwrap_or(usize::MAX))
            .collect()
    }

    /// The range of gains.
    fn gains(&self) -> (i32, i32) {
        let gains = || self.behaviours.iter().map(|behaviour| i32::from(behaviour.gain));
        (gains().min().unwrap_or(0), gains().max().unwrap_or(0))
    }
}

impl Manners {
    fn of(current: &Manner, interrupting: &Manner, grain: &Grain) -> Self {
        let tie = |current: Acceptance, interrupting: Acceptance| {
            let tied = grain.surplus && current.depth > 0 && current.depth == interrupting.depth;
            tied.then(|| current.surplus.cmp(&interrupting.surplus))
        };
        Self {
            depths: [current, interrupting].map(|manner| (manner.plain.depth, manner.willing.depth)),
            gains: [current, interrupting].map(|manner| (manner.gain, manner.willing_gain)),
            ties: [tie(current.willing, interrupting.plain), tie(current.plain, interrupting.willing)],
        }
    }
}

impl Parts<'_> {
    /// Calls `visit` with a smallest pair of each class of these patterns, and how many
    /// pairs the class has. All patterns must have the same numbers of conditions.
    pub(super) fn classes<E>(
        &self,
        patterns: &[Pattern],
        mut visit: impl FnMut(&Pair, u128) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut visit = |cell: &Cell| {
            if cell.count > 0
                && let Some(pair) = self.pair(patterns, cell)
            {
                visit(&pair, cell.count)?;
            }
            Ok(())
        };
        match self.grain.detail {
            Detail::Merged => self.cells(patterns).iter().try_for_each(visit),
            Detail::ByPattern => {
                for (number, pattern) in (0..).zip(patterns) {
                    self.cells_of(number, pattern).try_for_each(|cell| visit(&cell))?;
                }
                Ok(())
            }
        }
    }

    /// Every behaviour of the current user with every one of the interrupting user.
    fn cells_of(&self, number: u32, pattern: &Pattern) -> impl Iterator<Item = Cell> {
        let entries = |task| (0..).zip(self.table(task).into_iter().flatten());
        let ways = pattern.ways;
        let interrupting = pattern.interrupting;
        entries(pattern.current).flat_map(move |(current, (_, c))| {
            entries(interrupting).map(move |(interrupting, (_, i))| Cell {
                count: ways * u128::from(c.count) * u128::from(i.count),
                sum: c.smallest.sum + i.smallest.sum,
                pattern: number,
                current,
                interrupting,
            })
        })
    }

    fn cells(&self, patterns: &[Pattern]) -> Vec<Cell> {
        let tables = |task: fn(&Pattern) -> TaskId| {
            let mut tasks: Vec<TaskId> = patterns.iter().map(task).collect();
            tasks.sort_unstable();
            tasks.dedup();
            tasks
        };
        let current_tasks = tables(|pattern| pattern.current);
        let interrupting_tasks = tables(|pattern| pattern.interrupting);
        let current = Side::of(current_tasks.iter().filter_map(|&task| self.table(task)), self.grain);
        let interrupting =
            Side::of(interrupting_tasks.iter().filter_map(|&task| self.table(task)), self.grain);
        let indices: FxHashMap<TaskId, Vec<usize>> = interrupting_tasks
            .iter()
            .filter_map(|&task| Some((task, interrupting.indices(self.table(task)?))))
            .collect();

        let mut numbers: FxHashMap<Manners, usize> = FxHashMap::default();
        let mut rows: Vec<Vec<usize>> = Vec::with_capacity(current.manners.len());
        for c in &current.manners {
            let row = interrupting.manners.iter().map(|i| {
                let next = numbers.len();
                *numbers.entry(Manners::of(c, i, self.grain)).or_insert(next)
            });
            rows.push(row.collect());
        }
        let (least_c, most_c) = current.gains();
        let (least_i, most_i) = interrupting.gains();
        let least = least_i - most_c;
        let span = usize::try_from(most_i - least_c - least + 1).unwrap_or_default();
        let no_pair = Cell { count: 0, sum: u32::MAX, pattern: 0, current: 0, interrupting: 0 };
        let mut cells = vec![no_pair; numbers.len() * span];

        let nobody = Mixed { count: 0, sum: u32::MAX, pattern: 0, entry: 0 };
        let mut mixed = vec![nobody; interrupting.behaviours.len()];
        let mut numbered = (0..).zip(patterns).peekable();
        while let Some(&(_, &Pattern { current: task, .. })) = numbered.peek() {
            mixed.fill(nobody);
            while let Some((number, pattern)) = numbered.next_if(|(_, pattern)| pattern.current == task) {
                self.mix(number, pattern, &indices, &mut mixed);
            }
            for (entry, (behaviour, vectors)) in (0..).zip(self.table(task).into_iter().flatten()) {
                let Ok(index) = current.behaviours.binary_search(behaviour) else { continue };
                let row = current.manner_of.get(index).and_then(|&manner| rows.get(manner));
                let Some(row) = row else { continue };
                let origin = i32::from(behaviour.gain) + least;
                let others = interrupting.manner_of.iter().zip(&interrupting.behaviours).zip(&mixed);
                for ((&manner, other), mixed) in others {
                    if mixed.count == 0 {
                        continue;
                    }
                    let column = usize::try_from(i32::from(other.gain) - origin).unwrap_or(usize::MAX);
                    let cell = row.get(manner).and_then(|number| cells.get_mut(number * span + column));
                    let Some(cell) = cell else { continue };
                    cell.count += mixed.count * u128::from(vectors.count);
                    let sum = vectors.smallest.sum + mixed.sum;
                    if sum < cell.sum {
                        cell.sum = sum;
                        cell.pattern = mixed.pattern;
                        cell.current = entry;
                        cell.interrupting = mixed.entry;
                    }
                }
            }
        }
        cells
    }

    /// Adds a pattern's interrupting users.
    fn mix(
        &self,
        number: u32,
        pattern: &Pattern,
        indices: &FxHashMap<TaskId, Vec<usize>>,
        mixed: &mut [Mixed],
    ) {
        let table = self.table(pattern.interrupting).into_iter().flatten();
        let indices = indices.get(&pattern.interrupting).into_iter().flatten();
        for ((entry, (_, vectors)), &index) in (0..).zip(table).zip(indices) {
            let Some(mixed) = mixed.get_mut(index) else { continue };
            mixed.count += pattern.ways * u128::from(vectors.count);
            if vectors.smallest.sum < mixed.sum {
                mixed.sum = vectors.smallest.sum;
                mixed.pattern = number;
                mixed.entry = entry;
            }
        }
    }

    fn table(&self, task: TaskId) -> Option<&Table> {
        self.tables.get(usize::try_from(task.0).ok()?)
    }

    /// The smallest pair of a class.
    fn pair(&self, patterns: &[Pattern], cell: &Cell) -> Option<Pair> {
        let pattern = patterns.get(usize::try_from(cell.pattern).ok()?)?;
        let smallest = |task, entry| {
            let (_, vectors) = self.table(task)?.get(usize::try_from(entry).ok()?)?;
            Some(vectors.smallest)
        };
        let current = smallest(pattern.current, cell.current)?;
        let interrupting = smallest(pattern.interrupting, cell.interrupting)?;
        let counts: Vec<(u8, u8)> = pattern.statuses.counts(self.domain.dispositions()).collect();
        let swapped: Vec<(u8, u8)> = counts.iter().map(|&(c, i)| (i, c)).collect();
        Some(Pair {
            current: self.person(&counts, current),
            interrupting: self.person(&swapped, interrupting),
        })
    }

    /// The user with this many true conditions of each disposition (its own first, then
    /// the other's), the first of each.
    fn person(&self, counts: &[(u8, u8)], smallest: Smallest) -> Person {
        let mut conditions = Vec::new();
        let mut next: u16 = 0;
        for (&(own, _), &all) in counts.iter().zip(self.domain.conditions_per_disposition()) {
            conditions.extend((next..).take(usize::from(own)).map(Condition));
            next += u16::from(all);
        }
        let numbered = || counts.iter().enumerate();
        let mut alone: Vec<(u8, usize)> = numbered()
            .filter(|(_, (own, other))| *own > 0 && *other == 0)
            .map(|(disposition, &(own, _))| (own, disposition))
            .collect();
        alone.sort_unstable();
        let heard = numbered().filter(|(_, (_, other))| *other > 0).map(|(disposition, _)| disposition);
        let order: Vec<usize> = alone.into_iter().map(|(_, disposition)| disposition).chain(heard).collect();
        let (lowest, highest) = self.domain.ranks().into_inner();
        let base = u64::from(highest - lowest) + 1;
        let mut ranks = vec![Rank(lowest); counts.len()];
        let mut digits = smallest.digits;
        for disposition in order.into_iter().rev() {
            if let Some(rank) = ranks.get_mut(disposition) {
                *rank = Rank(lowest.saturating_add(u8::try_from(digits % base).unwrap_or(u8::MAX)));
            }
            digits /= base;
        }
        Person { conditions, ranks }
    }
}
