//! Everything that the page says, without a word of HTML.

use std::time::Duration;

use super::decision::{Decision, decisions, variant};
use super::stage::Stage;
use super::timeline::{Kind, Timeline};
use super::who::Who;
use crate::trace::{Message, Recording};

/// What a page is made from.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The trace's file name, for people.
    pub file: &'a str,
    /// The trace's bytes as they are on disk.
    pub bytes: &'a [u8],
    /// What was recorded.
    pub recording: &'a Recording,
    /// All messages, those for viewers included.
    pub messages: &'a [Message],
}

/// A report, ready to be rendered. All text is as in the trace, not escaped.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// What it is about.
    pub title: String,
    /// What the trace is, one line each.
    pub facts: Vec<Fact>,
    /// What cannot be shown, and what would be needed for it.
    pub missing: Vec<Missing>,
    /// Since the run's begin.
    pub until: Duration,
    /// The time that the map opens at: the first interruption, or the first decision.
    pub opening: Duration,
    /// Where everybody was.
    pub stage: Stage,
    /// What happened, in sentences.
    pub timeline: Timeline,
    /// What was decided.
    pub decisions: Vec<Decision>,
}

/// A line of what the trace is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fact {
    /// For instance "recorded by".
    pub name: &'static str,
    /// For instance "selfneg 0.1.0".
    pub value: String,
}

/// Something that the page cannot show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// What.
    pub what: &'static str,
    /// Why, and what would be needed.
    pub why: String,
}

impl Page {
    /// The page of a trace.
    #[must_use]
    pub fn of(source: Source<'_>) -> Self {
        let Source { recording, messages, .. } = source;
        let header = &recording.header;
        let who = Who::of(recording, header.specification.as_ref());
        let stage = Stage::of(header, &[], messages);
        let timeline = Timeline::of(messages);
        let decisions = decisions(recording, &who);
        let last = messages.iter().map(|message| message.log_time).max().unwrap_or(0);
        let interruption = timeline.sentences(|kind| kind == Kind::Interruption).next();
        let opening = interruption
            .map(|sentence| sentence.at)
            .or_else(|| decisions.first().map(|decision| decision.at))
            .unwrap_or_default();
        let title = if header.scenario.is_empty() { "A run of the robot" } else { &header.scenario };
        Self {
            title: title.to_owned(),
            facts: facts(source, decisions.len()),
            missing: missing(recording, &stage, &timeline),
            until: Duration::from_nanos(last),
            opening,
            stage,
            timeline,
            decisions,
        }
    }
}

fn facts(source: Source<'_>, decisions: usize) -> Vec<Fact> {
    let header = &source.recording.header;
    let mut facts = vec![
        Fact { name: "Trace", value: format!("{}, {} bytes", source.file, grouped(source.bytes.len())) },
        Fact { name: "BLAKE3 of the file", value: blake3::hash(source.bytes).to_hex().to_string() },
        Fact { name: "Recorded by", value: header.program.clone() },
        Fact { name: "Format", value: format!("{}.{}", header.format_major, header.format_minor) },
        Fact { name: "Decisions", value: decisions.to_string() },
    ];
    if let Some(options) = &header.options {
        facts.push(Fact { name: "Protocol variant", value: variant(options) });
    }
    let complete = match &source.recording.damage {
        None => "yes, as far as the trace itself can tell".to_owned(),
        Some(damage) => format!("no: {damage}"),
    };
    facts.push(Fact { name: "Complete", value: complete });
    facts
}

fn missing(recording: &Recording, stage: &Stage, timeline: &Timeline) -> Vec<Missing> {
    let mut missing = Vec::new();
    let hidden = "The personal part of this trace is not there, or locked.".to_owned();
    if recording.rules.is_none() {
        let what = "what was disclosed, what it was worth, and what people are called";
        missing.push(Missing { what, why: hidden.clone() });
    }
    if stage.robot().is_none() {
        missing.push(Missing { what: "where the robot went", why: hidden.clone() });
    }
    if !timeline.named {
        missing.push(Missing { what: "the story with names", why: hidden });
    }
    missing
}

/// A number with its thousands apart.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (nth, digit) in digits.chars().enumerate() {
        if nth > 0 && digits.len().saturating_sub(nth).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
