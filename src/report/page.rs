//! Everything that the page says, without a word of HTML.

use std::time::Duration;

use super::decision::{Decision, decisions, variant};
use super::seal::Seal;
use super::stage::Stage;
use super::timeline::{Kind, Timeline};
use super::who::Who;
use crate::audit::{Audit, Keys, audit_opened};
use crate::explain::{Audience, explain};
use crate::trace::{Message, Opened, TraceError, messages, open};

/// A report, ready to be rendered. All text is as in the trace, not escaped.
#[derive(Clone, Debug)]
pub struct Page {
    /// What it is about.
    pub title: String,
    /// Whether names, conditions or ranks are on it.
    pub personal: bool,
    /// What the trace is, one line each.
    pub facts: Vec<Fact>,
    /// What cannot be shown, if anything.
    pub missing: Option<Missing>,
    /// The length of the run.
    pub until: Duration,
    /// The time that the map opens at: the interruption that led to the first decision.
    pub opening: Duration,
    /// Where everybody was.
    pub stage: Stage,
    /// What happened, in sentences.
    pub timeline: Timeline,
    /// What was decided.
    pub decisions: Vec<Decision>,
    /// Who signed the trace, and where what is personal is.
    pub seal: Seal,
    /// What was checked.
    pub audit: Audit,
}

/// A line of what the trace is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fact {
    /// For instance "Recorded by".
    pub name: &'static str,
    /// For instance "selfneg 0.1.0".
    pub value: String,
}

/// What the page cannot show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// One thing each.
    pub what: Vec<&'static str>,
    /// Why, and what would be needed.
    pub why: String,
}

/// A trace's file, as it is on disk.
#[derive(Clone, Copy, Debug)]
pub struct File<'a> {
    /// Its name, for people.
    pub name: &'a str,
    /// All of it.
    pub bytes: &'a [u8],
}

/// A trace as far as keys open it, and what was found out about it.
struct Source<'a> {
    file: File<'a>,
    opened: &'a Opened,
    messages: &'a [Message],
    audit: Audit,
}

impl Page {
    /// The page of a trace, with what the keys open of it: everything for an auditor if the
    /// personal part can be read, else what is open.
    ///
    /// # Errors
    /// [`TraceError`] if not even the trace's header can be read, or its format is a newer one.
    pub fn of(file: File<'_>, keys: &Keys) -> Result<Self, TraceError> {
        let opened = open(file.bytes, &keys.identities)?;
        let mut messages = messages(file.bytes, &keys.identities)?;
        if opened.recording.damage.is_some() {
            // What the recording refused is the last that it counted.
            let read = opened.recording.messages.saturating_sub(1);
            messages.retain(|message| u64::from(message.sequence) < read);
        }
        let audit = audit_opened(&opened, keys);
        Ok(Self::new(Source { file, opened: &opened, messages: &messages, audit }))
    }

    fn new(source: Source<'_>) -> Self {
        let Source { opened, messages, .. } = &source;
        let recording = &opened.recording;
        let header = &recording.header;
        let who = Who::of(recording);
        let stage = Stage::of(header, messages);
        let timeline = Timeline::of(messages);
        let personal = recording.rules.is_some();
        let audience = if personal { Audience::Auditor } else { Audience::Public };
        // Explaining everything for a level that can be read has no reason to fail.
        let explained = explain(recording, audience, None).unwrap_or_default();
        let decisions = decisions(recording, &who, &explained);
        let last = messages.iter().map(|message| message.log_time).max().unwrap_or(0);
        let opening = opening(&timeline, &decisions);
        let title = if header.scenario.is_empty() { "A run of the robot" } else { &header.scenario };
        Self {
            title: title.to_owned(),
            personal: personal || who.knows_names() || timeline.named || stage.robot().is_some(),
            facts: facts(&source, decisions.len()),
            missing: missing(opened, &stage, &timeline),
            until: Duration::from_nanos(last),
            opening,
            seal: Seal::of(opened, source.audit.seal.as_ref()),
            stage,
            timeline,
            decisions,
            audit: source.audit,
        }
    }
}

/// The last interruption before the first decision, or without decisions the first one.
fn opening(timeline: &Timeline, decisions: &[Decision]) -> Duration {
    let mut interruptions = timeline.sentences(|kind| kind == Kind::Interruption).map(|sentence| sentence.at);
    match decisions.first() {
        Some(first) => interruptions.take_while(|at| *at <= first.at).last().unwrap_or(first.at),
        None => interruptions.next().unwrap_or_default(),
    }
}

fn facts(source: &Source<'_>, decisions: usize) -> Vec<Fact> {
    let recording = &source.opened.recording;
    let header = &recording.header;
    let File { name, bytes } = source.file;
    let mut facts = vec![
        Fact { name: "File", value: format!("{name}, {} bytes", grouped(bytes.len())) },
        Fact { name: "BLAKE3 of the file", value: blake3::hash(bytes).to_hex().to_string() },
        Fact { name: "Recorded by", value: header.program.clone() },
        Fact { name: "Format", value: format!("{}.{}", header.format_major, header.format_minor) },
        Fact { name: "Decisions", value: decisions.to_string() },
    ];
    if let Some(options) = &header.options {
        facts.push(Fact { name: "Protocol variant", value: variant(options) });
    }
    let complete = match &recording.damage {
        None => "yes, as far as the trace itself can tell".to_owned(),
        Some(damage) => format!("no: {damage}"),
    };
    facts.push(Fact { name: "Complete", value: complete });
    facts
}

fn missing(opened: &Opened, stage: &Stage, timeline: &Timeline) -> Option<Missing> {
    let mut what = Vec::new();
    if opened.recording.rules.is_none() {
        what.push("what people and goals are called, what was disclosed, and what it was worth");
        what.push("what would have changed a decision, and what serving whom is worth");
    } else if !opened.erased.is_empty() {
        what.push("what those erased were called and disclosed, and what offers were worth to them");
        what.push(
            "what would have changed a decision in which they took part, and what serving whom was worth",
        );
    }
    if stage.robot().is_none() {
        what.push("where the robot and people were");
    }
    if !timeline.named {
        what.push("the story with names");
    }
    (!what.is_empty()).then(|| Missing { what, why: super::seal::why_hidden(opened) })
}

/// A number with its thousands apart.
pub(super) fn grouped(number: usize) -> String {
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
