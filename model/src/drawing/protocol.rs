//! The states that a negotiation can reach, with the way that one negotiation went.

use std::cmp::Ordering;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;

use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use selfneg_core::{Outcome, Ruling, Side, Turn};

use super::canvas::{Anchor, CURRENT, Canvas, FAINT, INK, INTERRUPTING, NEUTRAL, PATH, Style, text_width};
use super::quoted;
use crate::protocol_graph::{Move, ProtocolGraph, State};

/// The names in a drawing.
#[derive(Clone, Debug)]
pub struct ProtocolLabels {
    /// The user being served.
    pub current: String,
    /// The user who interrupts.
    pub interrupting: String,
    /// What each further offer of the current user discloses.
    pub current_offers: Vec<String>,
    /// What each further offer of the interrupting user discloses.
    pub interrupting_offers: Vec<String>,
    /// The protocol variant.
    pub variant: String,
}

impl ProtocolLabels {
    fn name(&self, side: Side) -> &str {
        match side {
            Side::Current => &self.current,
            Side::Interrupting => &self.interrupting,
        }
    }

    fn disclosed(&self, side: Side, depth: usize) -> &str {
        let offers = match side {
            Side::Current => &self.current_offers,
            Side::Interrupting => &self.interrupting_offers,
        };
        depth.checked_sub(1).and_then(|at| offers.get(at)).map_or("?", String::as_str)
    }

    /// What happens next in a state, in two lines.
    fn state(&self, state: State, graph: &ProtocolGraph) -> [String; 2] {
        match state {
            State::Concluded(outcome) => [self.conclusion(outcome), String::new()],
            State::Open { turn, current, interrupting, held } => {
                let sender = turn.sender();
                let made = match sender {
                    Side::Current => current,
                    Side::Interrupting => interrupting,
                };
                let depth = made + 1;
                let quits = usize::from(matches!(turn, Turn::Alone(_)));
                let round = current + interrupting + quits + 1;
                let first = match held {
                    Some(holder) => format!("Round {round}: {}'s offer {depth} is held", self.name(holder)),
                    None => format!("Round {round}"),
                };
                let second = if depth > graph.offers(sender) {
                    format!("{} has no further offer", self.name(sender))
                } else {
                    let disclosed = self.disclosed(sender, depth);
                    format!("{} offers {depth}: {disclosed}", self.name(sender))
                };
                [first, second]
            }
        }
    }

    fn conclusion(&self, outcome: Outcome) -> String {
        match outcome {
            Outcome::Agreement(winner) => format!("agreement for {}", self.name(winner)),
            Outcome::NoAgreement => "no agreement".to_owned(),
        }
    }
}

/// What a move is called.
fn move_name(taken: Move) -> &'static str {
    match taken {
        Move::Quit { .. } => "quits",
        Move::Offer { held_surplus: Some(order), .. } => match order {
            Ordering::Greater => "accepted, gains less",
            Ordering::Less => "accepted, gains more",
            Ordering::Equal => "accepted, gains the same",
        },
        Move::Offer { ruling: Ruling::Accept, .. } => "accepted",
        Move::Offer { ruling: Ruling::Reject, .. } => "rejected",
        Move::Offer { ruling: Ruling::Hold, .. } => "acceptable, held",
    }
}

/// The moves of one negotiation as edges.
fn edges_of(graph: &ProtocolGraph, path: &[Move]) -> Vec<(NodeIndex, Move)> {
    graph.follow(path).into_iter().zip(path.iter().copied()).collect()
}

fn colour(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Agreement(Side::Current) => CURRENT,
        Outcome::Agreement(Side::Interrupting) => INTERRUPTING,
        Outcome::NoAgreement => NEUTRAL,
    }
}

/// The graph in DOT; the moves of `path` are drawn bold.
#[must_use]
pub fn protocol_dot(graph: &ProtocolGraph, labels: &ProtocolLabels, path: &[Move]) -> String {
    let taken = edges_of(graph, path);
    let mut text = String::from("digraph protocol {\n");
    let title = format!(
        "{} (current) and {} (interrupting)\n{}",
        labels.current, labels.interrupting, labels.variant
    );
    let _ = writeln!(text, "  label={};\n  labelloc=t;", quoted(&title));
    text.push_str("  node [shape=box, style=rounded, fontname=\"Helvetica\"];\n");
    for node in graph.graph().node_indices() {
        let Some(&state) = graph.graph().node_weight(node) else { continue };
        let [first, second] = labels.state(state, graph);
        let _ = match state {
            State::Concluded(outcome) => writeln!(
                text,
                "  {} [label={}, style=\"rounded,filled\", fillcolor=\"{}\", fontcolor=white];",
                node.index(),
                quoted(&first),
                colour(outcome)
            ),
            State::Open { .. } => {
                writeln!(text, "  {} [label={}];", node.index(), quoted(&format!("{first}\n{second}")))
            }
        };
    }
    for edge in graph.graph().edge_references() {
        let bold = if taken.contains(&(edge.source(), *edge.weight())) {
            format!(", color=\"{PATH}\", penwidth=2.5")
        } else {
            String::new()
        };
        let (from, to) = (edge.source().index(), edge.target().index());
        let _ = writeln!(text, "  {from} -> {to} [label={}{bold}];", quoted(move_name(*edge.weight())));
    }
    text.push_str("}\n");
    text
}

/// Height of the round that leads to a state, of a box, and of a conclusion, in pixels.
const ROW: f64 = 84.0;
const BOX: f64 = 46.0;
const PILL: f64 = 26.0;

/// The graph as an SVG picture: one row a round, conclusions beside the state that they end.
/// The moves of `path` are drawn bold and blue.
#[must_use]
pub fn protocol_svg(graph: &ProtocolGraph, labels: &ProtocolLabels, path: &[Move]) -> String {
    Picture::new(graph, labels, path).draw()
}

struct Picture<'a> {
    graph: &'a ProtocolGraph,
    labels: &'a ProtocolLabels,
    taken: Vec<(NodeIndex, Move)>,
    /// By open state: its centre.
    places: HashMap<NodeIndex, (f64, f64)>,
    box_width: f64,
    pill_width: f64,
    spine: f64,
    aside: f64,
}

impl<'a> Picture<'a> {
    fn new(graph: &'a ProtocolGraph, labels: &'a ProtocolLabels, path: &[Move]) -> Self {
        let weights = graph.graph().node_weights();
        let box_width = weights
            .filter(|state| matches!(state, State::Open { .. }))
            .flat_map(|state| labels.state(*state, graph))
            .map(|line| text_width(&line))
            .fold(120.0, f64::max)
            + 28.0;
        let pill_width = graph
            .graph()
            .edge_references()
            .filter_map(|edge| pill(graph, labels, edge.target(), *edge.weight()))
            .map(|(text, _)| text_width(&text))
            .fold(80.0, f64::max)
            + 28.0;
        let spine = 24.0 + pill_width + 50.0 + box_width / 2.0;
        let aside = spine + box_width + 120.0;
        let mut picture = Self {
            graph,
            labels,
            taken: edges_of(graph, path),
            places: HashMap::new(),
            box_width,
            pill_width,
            spine,
            aside,
        };
        picture.place();
        picture
    }

    /// A state's row is the number of rounds before it; states with a held offer stand aside.
    fn place(&mut self) {
        let mut rows: BTreeMap<usize, usize> = BTreeMap::new();
        let mut open = vec![(self.graph.start(), 0_usize)];
        while let Some((node, row)) = open.pop() {
            if rows.insert(node.index(), row).is_some() {
                continue;
            }
            open.extend(self.graph.graph().neighbors(node).map(|next| (next, row + 1)));
        }
        let most = self.graph.graph().node_indices().map(|node| self.pills(node).len()).max().unwrap_or(0);
        let step = ROW.max(number(most) * (PILL + 6.0) + 24.0);
        for (index, row) in rows {
            let node = NodeIndex::new(index);
            if let Some(State::Open { held, .. }) = self.graph.graph().node_weight(node) {
                let x = if held.is_some() { self.aside } else { self.spine };
                self.places.insert(node, (x, 110.0 + number(row) * step));
            }
        }
    }

    /// The conclusions that a state can end in.
    fn pills(&self, node: NodeIndex) -> Vec<(Move, String, Outcome)> {
        let edges = self.graph.graph().edges(node);
        let mut pills: Vec<(Move, String, Outcome)> = edges
            .filter_map(|edge| {
                let (text, outcome) = pill(self.graph, self.labels, edge.target(), *edge.weight())?;
                Some((*edge.weight(), text, outcome))
            })
            .collect();
        pills.sort_by_key(|(taken, ..)| *taken);
        pills
    }

    fn draw(&self) -> String {
        let mut canvas = Canvas::default();
        let title =
            format!("{} is being served, {} interrupts", self.labels.current, self.labels.interrupting);
        canvas.text((24.0, 34.0), &title, Anchor::Start, INK, 18);
        let variant = format!("{}. Bold: how it went.", self.labels.variant);
        canvas.text((24.0, 56.0), &variant, Anchor::Start, NEUTRAL, 12);
        let mut nodes: Vec<NodeIndex> = self.places.keys().copied().collect();
        nodes.sort_unstable();
        for &node in &nodes {
            self.draw_moves(&mut canvas, node);
        }
        for &node in &nodes {
            self.draw_state(&mut canvas, node);
        }
        canvas.document(&title)
    }

    fn draw_moves(&self, canvas: &mut Canvas, node: NodeIndex) {
        let Some(&(x, y)) = self.places.get(&node) else { return };
        let line = |taken: Move| match self.taken.contains(&(node, taken)) {
            true => (PATH, 2.6),
            false => (FAINT, 1.4),
        };
        for edge in self.graph.graph().edges(node) {
            let Some(&(to_x, to_y)) = self.places.get(&edge.target()) else { continue };
            let (colour, width) = line(*edge.weight());
            let straight = (x - to_x).abs() < 1.0;
            let (from, to) = if straight {
                ((x, y + BOX / 2.0), (to_x, to_y - BOX / 2.0))
            } else {
                ((x + self.box_width / 2.0, y + 8.0), (to_x - self.box_width / 2.0, to_y - 8.0))
            };
            canvas.arrow(from, to, colour, width);
            let text = move_name(*edge.weight());
            let middle = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
            let ink = if colour == PATH { PATH } else { NEUTRAL };
            let beside = if straight { 8.0 } else { 12.0 };
            canvas.text((middle.0 + beside, middle.1 + 4.0), text, Anchor::Start, ink, 11);
        }
        let pills = self.pills(node);
        let left = (x - self.spine).abs() < 1.0;
        let side = if left { -1.0 } else { 1.0 };
        let pill_x = if left {
            24.0 + self.pill_width / 2.0
        } else {
            x + self.box_width / 2.0 + 50.0 + self.pill_width / 2.0
        };
        let mut pill_y = y - (number(pills.len()) - 1.0) * (PILL + 6.0) / 2.0;
        for (taken, text, outcome) in pills {
            let (line_colour, width) = line(taken);
            let from = (x + side * self.box_width / 2.0, y);
            canvas.arrow(from, (pill_x - side * self.pill_width / 2.0, pill_y), line_colour, width);
            let bold = line_colour == PATH;
            let style = Style {
                fill: if bold { colour(outcome) } else { "#ffffff" },
                stroke: colour(outcome),
                stroke_width: 1.4,
                text: if bold { "#ffffff" } else { colour(outcome) },
                radius: PILL / 2.0,
            };
            canvas.label((pill_x, pill_y), (self.pill_width, PILL), &[&text], style);
            pill_y += PILL + 6.0;
        }
    }

    fn draw_state(&self, canvas: &mut Canvas, node: NodeIndex) {
        let (Some(&place), Some(&state)) = (self.places.get(&node), self.graph.graph().node_weight(node))
        else {
            return;
        };
        let State::Open { turn, .. } = state else { return };
        let visited = self.taken.iter().any(|(at, _)| *at == node);
        let [first, second] = self.labels.state(state, self.graph);
        let sender = match turn.sender() {
            Side::Current => "#e4f1f0",
            Side::Interrupting => "#faece8",
        };
        let style = Style {
            fill: sender,
            stroke: if visited { PATH } else { FAINT },
            stroke_width: if visited { 2.0 } else { 1.0 },
            text: INK,
            radius: 8.0,
        };
        canvas.label(place, (self.box_width, BOX), &[&first, &second], style);
    }
}

/// What a conclusion says, if that is where the move leads.
fn pill(
    graph: &ProtocolGraph,
    labels: &ProtocolLabels,
    to: NodeIndex,
    taken: Move,
) -> Option<(String, Outcome)> {
    match graph.graph().node_weight(to) {
        Some(State::Concluded(outcome)) => {
            Some((format!("{}: {}", move_name(taken), labels.conclusion(*outcome)), *outcome))
        }
        _ => None,
    }
}

fn number(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}
