//! `selfneg graph`: the protocol's states of a case, or who beats whom.

use std::fmt;
use std::fs;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use selfneg_core::{Activation, Case, Options};
use selfneg_model::drawing::{ProtocolLabels, beats_dot, beats_svg, protocol_dot, protocol_svg};
use selfneg_model::protocol_graph::{Move, ProtocolGraph, moves_of};
use serde::Serialize;

use super::options::ProtocolOptions;
use super::present::{Folders, Present};
use super::{CommandError, Report, Status, json};
use crate::binding::END_OF_GOAL;
use crate::precedence::beats;

/// Draw the states that a negotiation can reach and the way it goes, or who beats whom among
/// several interrupters, with its cycles and Smith set
#[derive(Debug, Args)]
pub(super) struct Graph {
    #[command(flatten)]
    folders: Folders,
    /// What to draw [default: protocol for one interrupter, beats for more]
    #[arg(long, value_enum, value_name = "WHAT")]
    of: Option<Subject>,
    /// As Graphviz DOT or as an SVG picture [default: by the file's ending, else dot]
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<Format>,
    /// File to write instead of standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print what the graph says as one JSON document
    #[arg(long, conflicts_with_all = ["format", "output"])]
    json: bool,
    #[command(flatten)]
    options: ProtocolOptions,
}

/// What to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Subject {
    /// The states that the negotiation can reach
    Protocol,
    /// Who beats whom
    Beats,
}

/// How to draw it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Graphviz
    Dot,
    /// A picture
    Svg,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Dot => "dot",
            Self::Svg => "svg",
        })
    }
}

#[derive(Serialize)]
struct BeatsRecord {
    users: Vec<String>,
    beats: Vec<[String; 2]>,
    beats_everyone: Option<String>,
    smith_set: Vec<String>,
    schwartz_set: Vec<String>,
    cycles: Vec<Vec<String>>,
}

#[derive(Serialize)]
struct ProtocolRecord {
    variant: String,
    states: usize,
    moves: usize,
    ways: usize,
    rounds_taken: usize,
}

/// A drawing in every form.
struct Drawn {
    dot: String,
    svg: String,
    json: String,
}

impl Graph {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let present = self.folders.read()?;
        let options = self.options.variant(present.users.first().is_some_and(|current| current.end_of_goal));
        let default = if self.folders.interrupters() == 1 { Subject::Protocol } else { Subject::Beats };
        let drawn = match self.of.unwrap_or(default) {
            Subject::Protocol => self.protocol(&present, options)?,
            Subject::Beats => who_beats_whom(&present, options)?,
        };
        let text = match self.format() {
            _ if self.json => drawn.json,
            Format::Dot => drawn.dot,
            Format::Svg => drawn.svg,
        };
        let output = match &self.output {
            None => text,
            Some(file) => {
                fs::write(file, text)
                    .map_err(|source| CommandError::Unwritable { file: file.clone(), source })?;
                format!("Drawn in {}\n", file.display())
            }
        };
        Ok(Report { output, warnings: present.warnings, status: Status::Passed })
    }

    fn format(&self) -> Format {
        let ending = self.output.as_ref().and_then(|file| file.extension());
        self.format.unwrap_or(if ending.is_some_and(|ending| ending == "svg") {
            Format::Svg
        } else {
            Format::Dot
        })
    }

    fn protocol(&self, present: &Present, options: Options) -> Result<Drawn, CommandError> {
        let [current, interrupting] = present.users.as_slice() else {
            return Err(CommandError::Arguments(format!(
                "--of protocol: a negotiation is between two users, found {}; expected one --interrupting",
                present.users.len()
            )));
        };
        let rows = present.rules.rows();
        let activation = Activation::new(&rows)?;
        let case = Case { activation, current: current.user()?, interrupting: interrupting.user()? };
        let names = |user: &crate::binding::BoundUser| -> Vec<String> {
            user.conditions().iter().map(|&c| present.rules.condition_name(c).to_owned()).collect()
        };
        let mut current_offers = names(current);
        if options.willingness > 0 {
            current_offers.push(END_OF_GOAL.to_owned());
        }
        let labels = ProtocolLabels {
            current: current.name.clone(),
            interrupting: interrupting.name.clone(),
            current_offers,
            interrupting_offers: names(interrupting),
            variant: options.to_string(),
        };
        let graph =
            ProtocolGraph::of(labels.current_offers.len(), labels.interrupting_offers.len(), &options);
        let path: Vec<Move> = moves_of(&case, &options);
        Ok(Drawn {
            dot: protocol_dot(&graph, &labels, &path),
            svg: protocol_svg(&graph, &labels, &path),
            json: json(&ProtocolRecord {
                variant: options.to_string(),
                states: graph.graph().node_count(),
                moves: graph.graph().edge_count(),
                ways: graph.ways().len(),
                rounds_taken: path.len(),
            })?,
        })
    }
}

fn who_beats_whom(present: &Present, options: Options) -> Result<Drawn, CommandError> {
    let graph = beats(&present.rules, &present.users, options)?;
    let names: Vec<String> = present.users.iter().map(|user| user.name.clone()).collect();
    let name = |user: usize| names.get(user).cloned().unwrap_or_default();
    let named = |users: Vec<usize>| users.into_iter().map(name).collect::<Vec<String>>();
    let mut pairs = Vec::new();
    for winner in 0..names.len() {
        for loser in 0..names.len() {
            if graph.beats(winner, loser) {
                pairs.push([name(winner), name(loser)]);
            }
        }
    }
    Ok(Drawn {
        dot: beats_dot(&graph, &names),
        svg: beats_svg(&graph, &names),
        json: json(&BeatsRecord {
            users: names.clone(),
            beats: pairs,
            beats_everyone: graph.condorcet_winner().map(name),
            smith_set: named(graph.smith_set()),
            schwartz_set: named(graph.schwartz_set()),
            cycles: graph.cycles().into_iter().map(named).collect(),
        })?,
    })
}
