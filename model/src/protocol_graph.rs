//! The states that a negotiation can reach, whatever the verdicts.
//!
//! This is a second telling of the protocol, independent of the engine's: it knows how many
//! offers each side has and nothing else, and takes every verdict as possible. It is tested
//! against the engine, and the worst case of regret is taken over its paths.

use std::cmp::Ordering;
use std::collections::{HashMap, VecDeque};

use petgraph::Direction;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef;
use selfneg_core::{
    Case, Disclosure, Observer, Options, Outcome, QuitRule, Ruling, Side, TieRule, Turn, Weighing,
};

/// Where a negotiation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum State {
    /// Before a round.
    Open {
        /// Who sends next, and whether the other one has quit.
        turn: Turn,
        /// How many offers the current user has made.
        current: usize,
        /// How many offers the interrupting user has made.
        interrupting: usize,
        /// Whose acceptable offer is held.
        held: Option<Side>,
    },
    /// After the last round.
    Concluded(Outcome),
}

/// One round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Move {
    /// The sender has no further offer.
    Quit {
        /// Who quits.
        sender: Side,
    },
    /// The sender makes an offer and the receiver judges it.
    Offer {
        /// Who offers.
        sender: Side,
        /// How many conditions are disclosed by now.
        depth: usize,
        /// What becomes of it.
        ruling: Ruling,
        /// Where surpluses break a tie: how that of the held offer's receiver compares to
        /// that of this one's.
        held_surplus: Option<Ordering>,
    },
}

/// All reachable states and the moves between them.
#[derive(Clone, Debug)]
pub struct ProtocolGraph {
    graph: DiGraph<State, Move>,
    start: NodeIndex,
    /// How many offers each side has.
    offers: [usize; 2],
}

impl ProtocolGraph {
    /// The states of a negotiation in which the current and the interrupting user have so
    /// many offers, the current user's willingness included.
    #[must_use]
    pub fn of(current_offers: usize, interrupting_offers: usize, options: &Options) -> Self {
        let offers = [current_offers, interrupting_offers];
        let first = State::Open {
            turn: Turn::Alternating(Side::Interrupting),
            current: 0,
            interrupting: 0,
            held: None,
        };
        let mut graph = DiGraph::new();
        let start = graph.add_node(first);
        let mut known = HashMap::from([(first, start)]);
        let mut open = VecDeque::from([(first, start)]);
        while let Some((state, from)) = open.pop_front() {
            for (taken, next) in moves(state, offers, options) {
                let to = *known.entry(next).or_insert_with(|| {
                    let to = graph.add_node(next);
                    open.push_back((next, to));
                    to
                });
                graph.add_edge(from, to, taken);
            }
        }
        Self { graph, start, offers }
    }

    /// The graph: states, and moves between them.
    #[must_use]
    pub fn graph(&self) -> &DiGraph<State, Move> {
        &self.graph
    }

    /// Where every negotiation starts.
    #[must_use]
    pub fn start(&self) -> NodeIndex {
        self.start
    }

    /// How many offers a side has.
    #[must_use]
    pub fn offers(&self, side: Side) -> usize {
        let [current, interrupting] = self.offers;
        match side {
            Side::Current => current,
            Side::Interrupting => interrupting,
        }
    }

    /// Every way from the start to a conclusion: its moves, and what it comes to.
    #[must_use]
    pub fn ways(&self) -> Vec<(Vec<Move>, Outcome)> {
        let mut ways = Vec::new();
        let mut open = vec![(self.start, Vec::new())];
        while let Some((at, taken)) = open.pop() {
            if let Some(State::Concluded(outcome)) = self.graph.node_weight(at) {
                ways.push((taken, *outcome));
                continue;
            }
            for edge in self.graph.edges_directed(at, Direction::Outgoing) {
                let mut longer = taken.clone();
                longer.push(*edge.weight());
                open.push((edge.target(), longer));
            }
        }
        ways.sort_unstable_by(|(a, _), (b, _)| a.cmp(b));
        ways
    }

    /// The states that these moves lead through, the start included. Shorter than the moves
    /// plus one if some move is not possible.
    #[must_use]
    pub fn follow(&self, moves: &[Move]) -> Vec<NodeIndex> {
        let mut at = self.start;
        let mut visited = vec![at];
        for taken in moves {
            let next = self.graph.edges_directed(at, Direction::Outgoing).find(|edge| edge.weight() == taken);
            let Some(edge) = next else { break };
            at = edge.target();
            visited.push(at);
        }
        visited
    }
}

/// The moves that the engine makes in a case, for [`ProtocolGraph::follow`].
#[must_use]
pub fn moves_of(case: &Case<'_>, options: &Options) -> Vec<Move> {
    let mut watcher = Watcher { tie: options.tie, ..Watcher::default() };
    case.negotiation(options).run(&mut watcher);
    watcher.moves
}

#[derive(Default)]
struct Watcher {
    tie: TieRule,
    offer: Option<(Side, usize)>,
    surplus: u64,
    held: Option<u64>,
    moves: Vec<Move>,
}

impl Observer for Watcher {
    fn offer(&mut self, _round: u32, sender: Side, depth: usize, _discloses: Disclosure) {
        self.offer = Some((sender, depth));
    }

    fn weighed(&mut self, _receiver: Side, weighing: Weighing) {
        self.surplus = weighing.surplus().map_or(0, |surplus| surplus.0.get());
    }

    fn ruled(&mut self, _receiver: Side, ruling: Ruling) {
        let Some((sender, depth)) = self.offer.take() else { return };
        let tie = self.tie == TieRule::Surplus && ruling == Ruling::Accept;
        let held_surplus = if tie { self.held.map(|held| held.cmp(&self.surplus)) } else { None };
        if ruling == Ruling::Hold {
            self.held = Some(self.surplus);
        }
        self.moves.push(Move::Offer { sender, depth, ruling, held_surplus });
    }

    fn quit(&mut self, _round: u32, sender: Side) {
        self.moves.push(Move::Quit { sender });
    }
}

/// What can happen in a state, and where it leads.
fn moves(
    state: State,
    [current_offers, interrupting_offers]: [usize; 2],
    options: &Options,
) -> Vec<(Move, State)> {
    let State::Open { turn, current, interrupting, held } = state else { return Vec::new() };
    let sender = turn.sender();
    let receiver = sender.other();
    let made = |side| match side {
        Side::Current => current,
        Side::Interrupting => interrupting,
    };
    let offers = |side| match side {
        Side::Current => current_offers,
        Side::Interrupting => interrupting_offers,
    };
    let depth = made(sender) + 1;
    if depth > offers(sender) {
        let next = match (options.quit, turn) {
            (QuitRule::Exhausted, Turn::Alternating(_)) => {
                State::Open { turn: Turn::Alone(receiver), current, interrupting, held }
            }
            _ => State::Concluded(Outcome::NoAgreement),
        };
        return vec![(Move::Quit { sender }, next)];
    }
    let after = |turn, held| match sender {
        Side::Current => State::Open { turn, current: depth, interrupting, held },
        Side::Interrupting => State::Open { turn, current, interrupting: depth, held },
    };
    let offer = |ruling, held_surplus| Move::Offer { sender, depth, ruling, held_surplus };
    let agreement = |side| State::Concluded(Outcome::Agreement(side));
    let nothing = State::Concluded(Outcome::NoAgreement);
    if let Some(holder) = held {
        let mut next = vec![(offer(Ruling::Reject, None), agreement(holder))];
        if options.tie == TieRule::Surplus {
            next.push((offer(Ruling::Accept, Some(Ordering::Greater)), agreement(holder)));
            next.push((offer(Ruling::Accept, Some(Ordering::Less)), agreement(sender)));
            next.push((offer(Ruling::Accept, Some(Ordering::Equal)), nothing));
        } else {
            next.push((offer(Ruling::Accept, None), nothing));
        }
        return next;
    }
    let reply_is_due = made(receiver) < depth && depth <= offers(receiver);
    let acceptable = if options.tie != TieRule::FirstSender && reply_is_due {
        (offer(Ruling::Hold, None), after(Turn::Alternating(receiver), Some(sender)))
    } else {
        (offer(Ruling::Accept, None), agreement(sender))
    };
    let rejected = if options.quit == QuitRule::Literal && depth >= offers(receiver) {
        nothing
    } else {
        match turn {
            Turn::Alternating(_) => after(Turn::Alternating(receiver), None),
            Turn::Alone(_) => after(turn, None),
        }
    };
    vec![acceptable, (offer(Ruling::Reject, None), rejected)]
}
