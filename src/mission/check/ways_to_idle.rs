//! From every situation the mission comes to idle. Stateright's `eventually` is unsound on
//! cycles, so the explored graph is searched backwards from the idle situations.
//!
//! Only steps count that the environment owes the mission: timeouts, finished actions, rounds.
//! So the mission comes to rest without any user's answer, failure, withdrawal or shutdown.

use std::collections::HashMap;

use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::{Dfs, Reversed};

use super::model::Explored;

/// How many situations have no such way.
pub(super) fn stranded(explored: &Explored) -> usize {
    let mut graph: DiGraph<(), ()> = DiGraph::with_capacity(explored.states.len(), explored.due.len());
    let nodes: HashMap<u64, NodeIndex> =
        explored.states.iter().map(|&state| (state, graph.add_node(()))).collect();
    for (from, to) in &explored.due {
        graph.add_edge(nodes[from], nodes[to], ());
    }
    let backwards = Reversed(&graph);
    let mut search = Dfs::empty(backwards);
    let mut reached = 0;
    for idle in &explored.idle {
        search.move_to(nodes[idle]);
        while search.next(backwards).is_some() {
            reached += 1;
        }
    }
    explored.states.len() - reached
}
