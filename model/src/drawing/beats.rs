//! Who beats whom: users in a circle, an arrow from each winner to each loser.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use super::canvas::{Anchor, Canvas, FAINT, INK, INTERRUPTING, NEUTRAL, Style, text_width};
use super::quoted;
use crate::beats::BeatsGraph;

const CANDIDATE: &str = "#fff1c9";
const ORDINARY: &str = "#f4f5f9";

/// The graph in DOT. Candidates (the Schwartz set) are filled, members of the Smith set have
/// a thick border, agreements that are part of a cycle are red.
#[must_use]
pub fn beats_dot(beats: &BeatsGraph, names: &[String]) -> String {
    let facts = Facts::of(beats, names);
    let mut text = String::from("digraph beats {\n");
    let _ = writeln!(text, "  label={};", quoted(&facts.lines().join("\n")));
    text.push_str("  labelloc=t;\n  node [shape=box, style=\"rounded,filled\", fontname=\"Helvetica\"];\n");
    for user in 0..beats.users() {
        let fill = if facts.schwartz.contains(&user) { CANDIDATE } else { ORDINARY };
        let width = if facts.smith.contains(&user) { 2.5 } else { 1.0 };
        let _ = writeln!(
            text,
            "  {user} [label={}, fillcolor=\"{fill}\", penwidth={width}];",
            quoted(name(names, user))
        );
    }
    for (winner, loser) in pairs(beats) {
        let attributes = if facts.is_in_cycle(winner, loser) {
            format!(" [color=\"{INTERRUPTING}\", penwidth=2]")
        } else {
            String::new()
        };
        let _ = writeln!(text, "  {winner} -> {loser}{attributes};");
    }
    text.push_str("}\n");
    text
}

/// The graph as an SVG picture, coloured as in [`beats_dot`]. Where there is no arrow the
/// two did not agree.
#[must_use]
pub fn beats_svg(beats: &BeatsGraph, names: &[String]) -> String {
    let facts = Facts::of(beats, names);
    let users = beats.users();
    let widest = names.iter().map(|name| text_width(name)).fold(40.0, f64::max) + 28.0;
    let height = 36.0;
    let count = f64::from(u32::try_from(users).unwrap_or(u32::MAX));
    let radius = (count * (widest + 40.0) / TAU).max(110.0).max(widest);
    let top = 34.0;
    let centre = (radius + widest / 2.0 + 24.0, top + radius + height / 2.0 + 40.0);
    let place = |user: usize| {
        let turn = f64::from(u32::try_from(user).unwrap_or(0)) / count.max(1.0);
        let angle = TAU * turn - TAU / 4.0;
        (centre.0 + radius * angle.cos(), centre.1 + radius * angle.sin())
    };
    let mut canvas = Canvas::default();
    canvas.text((24.0, top), "Who beats whom", Anchor::Start, INK, 18);
    for (winner, loser) in pairs(beats) {
        let (from, to) = (place(winner), place(loser));
        let size = (widest, height);
        let (colour, width) =
            if facts.is_in_cycle(winner, loser) { (INTERRUPTING, 2.4) } else { (NEUTRAL, 1.5) };
        canvas.arrow(edge_of(from, to, size), edge_of(to, from, size), colour, width);
    }
    for user in 0..users {
        let style = Style {
            fill: if facts.schwartz.contains(&user) { CANDIDATE } else { ORDINARY },
            stroke: if facts.smith.contains(&user) { INK } else { FAINT },
            stroke_width: if facts.smith.contains(&user) { 2.4 } else { 1.2 },
            text: INK,
            radius: 10.0,
        };
        canvas.label(place(user), (widest, height), &[name(names, user)], style);
    }
    let mut baseline = centre.1 + radius + 70.0;
    for line in facts.lines() {
        canvas.text((24.0, baseline), &line, Anchor::Start, INK, 13);
        baseline += 20.0;
    }
    let legend =
        "Filled: Schwartz set. Dark border: Smith set. Red: agreements in a cycle. No arrow: no agreement.";
    canvas.text((24.0, baseline), legend, Anchor::Start, NEUTRAL, 11);
    canvas.document("Who beats whom")
}

/// Where the line from the centre of a box to `to` leaves the box.
fn edge_of(from: (f64, f64), to: (f64, f64), (width, height): (f64, f64)) -> (f64, f64) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let scale = (width / 2.0 / dx.abs().max(1e-9)).min(height / 2.0 / dy.abs().max(1e-9));
    (from.0 + dx * scale, from.1 + dy * scale)
}

fn pairs(beats: &BeatsGraph) -> impl Iterator<Item = (usize, usize)> {
    let users = 0..beats.users();
    users
        .clone()
        .flat_map(move |winner| users.clone().map(move |loser| (winner, loser)))
        .filter(|&(winner, loser)| beats.beats(winner, loser))
}

fn name(names: &[String], user: usize) -> &str {
    names.get(user).map_or("?", String::as_str)
}

/// What there is to say of the graph.
struct Facts<'a> {
    names: &'a [String],
    winner: Option<usize>,
    smith: Vec<usize>,
    schwartz: Vec<usize>,
    cycles: Vec<Vec<usize>>,
    reaches: Vec<Vec<bool>>,
}

impl<'a> Facts<'a> {
    fn of(beats: &BeatsGraph, names: &'a [String]) -> Self {
        Self {
            names,
            winner: beats.condorcet_winner(),
            smith: beats.smith_set(),
            schwartz: beats.schwartz_set(),
            cycles: beats.cycles(),
            reaches: (0..beats.users()).map(|from| reached(beats, from)).collect(),
        }
    }

    /// Whether the loser beats the winner in turn, through others.
    fn is_in_cycle(&self, winner: usize, loser: usize) -> bool {
        self.reaches.get(loser).and_then(|row| row.get(winner)).copied().unwrap_or(false)
    }

    fn lines(&self) -> Vec<String> {
        let named = |users: &[usize], separator: &str| {
            users.iter().map(|&user| name(self.names, user)).collect::<Vec<_>>().join(separator)
        };
        let mut lines = vec![match self.winner {
            Some(winner) => format!("{} beats everyone else.", name(self.names, winner)),
            None => "Nobody beats everyone else.".to_owned(),
        }];
        lines.push(format!("Smith set: {}", named(&self.smith, ", ")));
        lines.push(format!("Schwartz set: {}", named(&self.schwartz, ", ")));
        for cycle in &self.cycles {
            let first = cycle.first().map_or("?", |&user| name(self.names, user));
            lines.push(format!("Cycle: {} beats {first}", named(cycle, " beats ")));
        }
        lines
    }
}

/// Whom a user beats, or beats through others.
fn reached(beats: &BeatsGraph, from: usize) -> Vec<bool> {
    let mut reached = vec![false; beats.users()];
    let mut open = vec![from];
    while let Some(winner) = open.pop() {
        for (loser, seen) in reached.iter_mut().enumerate() {
            if !*seen && beats.beats(winner, loser) {
                *seen = true;
                open.push(loser);
            }
        }
    }
    reached
}
