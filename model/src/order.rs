//! A full precedence order: who before whom, so that together the users lose least.
//!
//! What is minimised is a sum over pairs: what it costs that one goes before the other. Two
//! such costs are at hand, [waiting](PairCosts::waiting) and
//! [overruled agreements](PairCosts::overruling); any other can be given.
//!
//! The linear programme has a variable for every two users, 1 if the earlier arrival goes
//! first, and rows that forbid cycles of three. For up to five users its optimum is that of
//! the orders; from six on it may be better than any order, and then the order is proved
//! optimal by dynamic programming over all sets of users, whose values are checked as well.

use num_traits::Zero;
use petgraph::algo::tarjan_scc;
use petgraph::graph::{DiGraph, NodeIndex};
use thiserror::Error;

use crate::beats::BeatsGraph;
use crate::exact::{Attempt, LinearProgramme, Rational, SolveError, Variable, rational, solve};
use crate::impacts::Impacts;

/// The most users who may contradict each other in a cycle.
pub const MAX_ENTANGLED: usize = 16;

/// What it costs that one user goes before another, for every two.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairCosts {
    /// By the one who goes first, then by the other.
    rows: Vec<Vec<u64>>,
}

/// An order of all users, and why there is none better.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order {
    /// The users, first to be served first.
    pub users: Vec<usize>,
    /// What the order costs.
    pub cost: u64,
    /// What the linear programme proves that every order costs at least.
    pub relaxation: Rational,
    /// What proves the order optimal.
    pub proof: Proof,
}

/// What proves an order optimal. All of it has been checked in exact arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Proof {
    /// Every two users are in the cheaper order of the two.
    Pairs,
    /// The linear programme proves a bound of more than the cost minus 1, and costs are
    /// whole numbers.
    Relaxation,
    /// The relaxation is too weak; the values of dynamic programming over all sets of users
    /// prove it.
    DynamicProgramming,
}

/// Why there is no order.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum OrderError {
    /// More than [`MAX_ENTANGLED`] users contradict each other.
    #[error(
        "{found} users each of whom should go before another in a cycle, at most {MAX_ENTANGLED} can be ordered"
    )]
    TooEntangled {
        /// How many they are.
        found: usize,
    },
    /// The costs overflow.
    #[error("the costs of an order exceed 64 bits")]
    TooCostly,
    /// The linear programme could not be solved.
    #[error(transparent)]
    Unsolved(#[from] SolveError),
    /// The values of the dynamic programme failed their check: a defect.
    #[error("the dynamic programme's values prove nothing")]
    Unproved,
}

impl PairCosts {
    /// Takes the costs themselves: `rows[u][v]` is what it costs that `u` goes before `v`.
    /// `None` if they do not make a square. The diagonal does not count.
    #[must_use]
    pub fn of_rows(rows: Vec<Vec<u64>>) -> Option<Self> {
        let square = rows.iter().all(|row| row.len() == rows.len());
        square.then_some(Self { rows })
    }

    /// Waiting, weighted by welfare: that `u` goes before `v` makes `v` wait for as long as
    /// it takes to serve `u`, and each unit of time costs the welfare of serving `v`. Users
    /// for whom `times` has no entry take 1 unit.
    #[must_use]
    pub fn waiting(impacts: &Impacts, times: &[u64]) -> Self {
        let users = impacts.users();
        let row = |first: usize| {
            let time = times.get(first).copied().unwrap_or(1);
            (0..users).map(|second| time.saturating_mul(impacts.welfare(second))).collect()
        };
        Self { rows: (0..users).map(row).collect() }
    }

    /// Overruled agreements: 1 for each user who goes before another who beats it.
    #[must_use]
    pub fn overruling(beats: &BeatsGraph) -> Self {
        let users = beats.users();
        let row = |first: usize| (0..users).map(|second| u64::from(beats.beats(second, first))).collect();
        Self { rows: (0..users).map(row).collect() }
    }

    /// How many users there are.
    #[must_use]
    pub fn users(&self) -> usize {
        self.rows.len()
    }

    /// What it costs that `first` goes before `second`.
    #[must_use]
    pub fn of(&self, first: usize, second: usize) -> u64 {
        self.rows.get(first).and_then(|row| row.get(second)).copied().unwrap_or(0)
    }

    /// What an order of all users costs; `None` beyond 64 bits.
    #[must_use]
    pub fn of_order(&self, order: &[usize]) -> Option<u64> {
        let mut total: u64 = 0;
        let mut later = order;
        while let Some((&first, rest)) = later.split_first() {
            for &second in rest {
                total = total.checked_add(self.of(first, second))?;
            }
            later = rest;
        }
        Some(total)
    }

    /// The costs among some of the users.
    fn among(&self, users: &[usize]) -> Self {
        let row = |&first: &usize| users.iter().map(|&second| self.of(first, second)).collect();
        Self { rows: users.iter().map(row).collect() }
    }
}

/// Smith's rule: by welfare per unit of service time, the largest first. The best order for
/// [waiting](PairCosts::waiting), found without any optimisation: the check of [`best`].
#[must_use]
pub fn smith(impacts: &Impacts, times: &[u64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..impacts.users()).collect();
    let time = |user: usize| u128::from(times.get(user).copied().unwrap_or(1));
    let weight = |user: usize| u128::from(impacts.welfare(user));
    order.sort_by(|&u, &v| (weight(v) * time(u)).cmp(&(weight(u) * time(v))));
    order
}

/// The cheapest order.
///
/// Where the cheaper order of every two users makes no cycle, it is the answer, for any
/// number of users. Where it does, each set of users entangled in cycles is ordered by
/// itself.
///
/// # Errors
/// [`OrderError`].
pub fn best(costs: &PairCosts) -> Result<Order, OrderError> {
    let mut order = Order { users: Vec::new(), cost: 0, relaxation: Rational::zero(), proof: Proof::Pairs };
    for component in entangled(costs) {
        let part = among_entangled(&costs.among(&component))?;
        for &before in &order.users {
            for &user in &component {
                // Nobody in a later component should go before anybody in an earlier one.
                order.relaxation += rational(costs.of(before, user).min(costs.of(user, before)));
            }
        }
        order.relaxation += part.relaxation;
        order.proof = order.proof.max(part.proof);
        order.users.extend(part.users.iter().filter_map(|&at| component.get(at)));
    }
    order.cost = costs.of_order(&order.users).ok_or(OrderError::TooCostly)?;
    let slack = rational(order.cost) - &order.relaxation;
    let proved = match order.proof {
        Proof::Pairs => slack.is_zero(),
        Proof::Relaxation | Proof::DynamicProgramming => true,
    };
    if proved { Ok(order) } else { Err(OrderError::Unproved) }
}

/// The strongly connected components of the graph in which a user points to everyone whom
/// it had cheaper go before, sources first; each by arrival.
fn entangled(costs: &PairCosts) -> Vec<Vec<usize>> {
    let mut graph: DiGraph<(), ()> = DiGraph::new();
    let users: Vec<NodeIndex> = (0..costs.users()).map(|_| graph.add_node(())).collect();
    for &first in &users {
        for &second in &users {
            if costs.of(first.index(), second.index()) < costs.of(second.index(), first.index()) {
                graph.add_edge(first, second, ());
            }
        }
    }
    let mut components: Vec<Vec<usize>> = tarjan_scc(&graph)
        .into_iter()
        .map(|component| {
            let mut users: Vec<usize> = component.into_iter().map(NodeIndex::index).collect();
            users.sort_unstable();
            users
        })
        .collect();
    components.reverse();
    components
}

/// The cheapest order of users who cannot be told apart by pairs.
fn among_entangled(costs: &PairCosts) -> Result<Order, OrderError> {
    if costs.users() <= 1 {
        let users = (0..costs.users()).collect();
        return Ok(Order { users, cost: 0, relaxation: Rational::zero(), proof: Proof::Pairs });
    }
    if costs.users() > MAX_ENTANGLED {
        return Err(OrderError::TooEntangled { found: costs.users() });
    }
    let values = SetValues::of(costs).ok_or(OrderError::TooCostly)?;
    let users = values.order(costs).ok_or(OrderError::Unproved)?;
    let cost = costs.of_order(&users).ok_or(OrderError::TooCostly)?;
    let relaxation = relaxation(costs)?;
    let proof = if relaxation > rational(cost) - rational(1) {
        Proof::Relaxation
    } else if values.lower_bound(costs) == Some(cost) {
        Proof::DynamicProgramming
    } else {
        return Err(OrderError::Unproved);
    };
    Ok(Order { users, cost, relaxation, proof })
}

/// For each set of users, as bits, the least that ordering it costs.
struct SetValues {
    least: Vec<u64>,
}

impl SetValues {
    /// Adds the last user of each set in turn. `None` if a cost overflows.
    fn of(costs: &PairCosts) -> Option<Self> {
        let sets = 1_usize << costs.users();
        let mut least = vec![0_u64; sets];
        for set in 1..sets {
            let mut best = None;
            for last in members(set) {
                let before = set & !(1 << last);
                let cost = least.get(before)?.checked_add(joining(costs, before, last)?)?;
                best = Some(best.map_or(cost, |known: u64| known.min(cost)));
            }
            *least.get_mut(set)? = best?;
        }
        Some(Self { least })
    }

    /// An order that attains the value of the whole set.
    fn order(&self, costs: &PairCosts) -> Option<Vec<usize>> {
        let mut set = self.least.len().checked_sub(1)?;
        let mut reversed = Vec::new();
        while set != 0 {
            let last = members(set).find(|&last| {
                let before = set & !(1 << last);
                let cost = joining(costs, before, last);
                self.least.get(before).zip(cost).map(|(&least, cost)| least + cost)
                    == self.least.get(set).copied()
            })?;
            reversed.push(last);
            set &= !(1 << last);
        }
        reversed.reverse();
        Some(reversed)
    }

    /// What the values prove that every order costs at least: if no user can join any set
    /// for less than the difference of the two sets' values, the steps of any order add up
    /// to at least the value of the whole set. `None` if they do not prove it.
    fn lower_bound(&self, costs: &PairCosts) -> Option<u64> {
        let whole = self.least.len().checked_sub(1)?;
        if *self.least.first()? != 0 {
            return None;
        }
        for (before, &least) in self.least.iter().enumerate() {
            for joins in members(whole & !before) {
                let after = *self.least.get(before | 1 << joins)?;
                if after > least.checked_add(joining(costs, before, joins)?)? {
                    return None;
                }
            }
        }
        self.least.last().copied()
    }
}

/// What it costs that all of `before` go before `last`.
fn joining(costs: &PairCosts, before: usize, last: usize) -> Option<u64> {
    members(before).try_fold(0_u64, |sum, first| sum.checked_add(costs.of(first, last)))
}

fn members(set: usize) -> impl Iterator<Item = usize> {
    (0..MAX_ENTANGLED).filter(move |&user| set >> user & 1 == 1)
}

/// The linear programme's lower bound. Rows that forbid a cycle of three are added only once
/// a point breaks them.
fn relaxation(costs: &PairCosts) -> Result<Rational, OrderError> {
    let users = costs.users();
    let mut programme = LinearProgramme::new();
    let mut pairs: Vec<Vec<Variable>> = Vec::new();
    let mut base = Rational::zero();
    for earlier in 0..users {
        let row = (earlier + 1..users).map(|later| {
            let (first, second) = (rational(costs.of(earlier, later)), rational(costs.of(later, earlier)));
            base += &second;
            programme.variable(rational(0), rational(1), second - first)
        });
        pairs.push(row.collect());
    }
    let pair = |earlier: usize, later: usize| pairs.get(earlier)?.get(later - earlier - 1).copied();
    loop {
        let Attempt::Feasible { certificate, certified } = solve(&programme)? else {
            return Err(SolveError::Inexact.into());
        };
        let mut broken = Vec::new();
        for a in 0..users {
            for b in a + 1..users {
                for c in b + 1..users {
                    let Some(cycle) =
                        pair(a, b).zip(pair(b, c)).zip(pair(a, c)).map(|((ab, bc), ac)| (ab, bc, ac))
                    else {
                        continue;
                    };
                    let (ab, bc, ac) = cycle;
                    let at = |variable: Variable| certificate.point.get(variable.index());
                    let Some(((ab_value, bc_value), ac_value)) = at(ab).zip(at(bc)).zip(at(ac)) else {
                        continue;
                    };
                    let sum = ab_value + bc_value - ac_value;
                    if sum > rational(1) || sum < rational(0) {
                        broken.push((cycle, sum > rational(1)));
                    }
                }
            }
        }
        if broken.is_empty() {
            return Ok(base - certified.bound);
        }
        for ((ab, bc, ac), forward) in broken {
            let terms = [(ab, rational(1)), (bc, rational(1)), (ac, rational(-1))];
            if forward {
                programme.at_most(terms, rational(1));
            } else {
                programme.at_least(terms, rational(0));
            }
        }
    }
}
