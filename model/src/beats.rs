//! Who beats whom.

use petgraph::Direction;
use petgraph::algo::tarjan_scc;
use petgraph::graph::{DiGraph, NodeIndex};

/// The beats-graph of some users: an edge from the winner of each bilateral negotiation
/// that ended in agreement to its loser. Users are numbered by arrival, from 0.
#[derive(Clone, Debug, Default)]
pub struct BeatsGraph {
    graph: DiGraph<(), ()>,
}

impl BeatsGraph {
    /// `users` users of whom nobody beats anybody yet.
    #[must_use]
    pub fn new(users: usize) -> Self {
        let mut graph = DiGraph::new();
        for _ in 0..users {
            graph.add_node(());
        }
        Self { graph }
    }

    /// Notes that `winner` beats `loser`. Users that the graph does not have are left
    /// out.
    pub fn add(&mut self, winner: usize, loser: usize) {
        let (winner, loser) = (NodeIndex::new(winner), NodeIndex::new(loser));
        let known = |user: NodeIndex| user.index() < self.graph.node_count();
        if known(winner) && known(loser) {
            self.graph.update_edge(winner, loser, ());
        }
    }

    /// Whether `winner` beats `loser`.
    #[must_use]
    pub fn beats(&self, winner: usize, loser: usize) -> bool {
        self.graph.contains_edge(NodeIndex::new(winner), NodeIndex::new(loser))
    }

    /// How many users there are.
    #[must_use]
    pub fn users(&self) -> usize {
        self.graph.node_count()
    }

    /// Who beats `user`, by arrival.
    #[must_use]
    pub fn beaten_by(&self, user: usize) -> Vec<usize> {
        let mut winners: Vec<usize> = self
            .graph
            .neighbors_directed(NodeIndex::new(user), Direction::Incoming)
            .map(NodeIndex::index)
            .collect();
        winners.sort_unstable();
        winners
    }

    /// The user who beats everyone else, if there is one. A single user does.
    #[must_use]
    pub fn condorcet_winner(&self) -> Option<usize> {
        let others = self.users().checked_sub(1)?;
        (0..self.users()).find(|&user| self.graph.neighbors(NodeIndex::new(user)).count() == others)
    }

    /// The Schwartz set, by arrival: the members of those strongly connected components
    /// that nobody outside beats. Empty only without users.
    #[must_use]
    pub fn schwartz_set(&self) -> Vec<usize> {
        let mut set: Vec<usize> = tarjan_scc(&self.graph)
            .into_iter()
            .filter(|component| {
                component.iter().all(|&user| {
                    self.graph
                        .neighbors_directed(user, Direction::Incoming)
                        .all(|winner| component.contains(&winner))
                })
            })
            .flatten()
            .map(NodeIndex::index)
            .collect();
        set.sort_unstable();
        set
    }

    /// The Smith set, by arrival: the smallest set of users each of whom beats everyone
    /// outside of it. Where pairs can fail to agree it can be larger than the
    /// [Schwartz set](Self::schwartz_set), never smaller. Empty only without users.
    #[must_use]
    pub fn smith_set(&self) -> Vec<usize> {
        // Whoever is not beaten by a member has to be one too, so it is the one component
        // of the relation "is not beaten by" that everyone else is below.
        let mut unbeaten: DiGraph<(), ()> = DiGraph::new();
        let users: Vec<NodeIndex> = (0..self.users()).map(|_| unbeaten.add_node(())).collect();
        for &user in &users {
            for &other in &users {
                if user != other && !self.beats(other.index(), user.index()) {
                    unbeaten.add_edge(user, other, ());
                }
            }
        }
        let top = tarjan_scc(&unbeaten).pop().unwrap_or_default();
        let mut set: Vec<usize> = top.into_iter().map(NodeIndex::index).collect();
        set.sort_unstable();
        set
    }

    /// For each set of users who beat each other in a circle, by arrival: a shortest cycle
    /// through the earliest of them, who stands first. Each beats the next, the last the
    /// first.
    #[must_use]
    pub fn cycles(&self) -> Vec<Vec<usize>> {
        let mut cycles: Vec<Vec<usize>> = tarjan_scc(&self.graph)
            .into_iter()
            .filter(|component| component.len() > 1)
            .filter_map(|component| component.into_iter().map(NodeIndex::index).min())
            .map(|first| self.shortest_cycle(first))
            .collect();
        cycles.sort_unstable();
        cycles
    }

    /// Breadth first from `first` back to it; ties go to the earlier arrival.
    fn shortest_cycle(&self, first: usize) -> Vec<usize> {
        let mut came_from = vec![None; self.users()];
        let mut layer = vec![first];
        while !layer.is_empty() {
            let mut next = Vec::new();
            for &winner in &layer {
                if winner != first && self.beats(winner, first) {
                    let mut cycle = vec![winner];
                    while let Some(before) =
                        cycle.last().and_then(|&user| came_from.get(user).copied().flatten())
                    {
                        cycle.push(before);
                    }
                    cycle.reverse();
                    return cycle;
                }
                for loser in 0..self.users() {
                    if loser != first
                        && self.beats(winner, loser)
                        && let Some(slot @ None) = came_from.get_mut(loser)
                    {
                        *slot = Some(winner);
                        next.push(loser);
                    }
                }
            }
            layer = next;
        }
        Vec::new()
    }
}
