//! `selfneg simulate`: a scenario, from its begin to its end.

use std::fmt::Write as _;
use std::io;
use std::iter;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::ProgressBar;
use selfneg_sim::World;
use serde::Serialize;

use super::durable::Durable;
use super::key_files::{auditor_public_keys, random, robot_key};
use super::{CommandError, Report, Status, json, overwriting, progress, write_whole};
use crate::mission::{Closing, Refusal, Staff};
use crate::run::{Ended, HowItEnded, Outcome, Sketch, Storybook, Told, Watcher, clock, run};
use crate::scenario::Scenario;
use crate::seal::{Privacy, Seal};
use crate::trace::TraceWriter;

/// Run a scenario in the simulated building, and tell its story
#[derive(Debug, Args)]
pub(super) struct Simulate {
    /// The scenario file (TOML; docs/scenario.md)
    #[arg(value_name = "SCENARIO")]
    scenario: PathBuf,
    /// Record the run into this file (MCAP; docs/trace.md). Made anew if it is there; what
    /// was decided is in it even if the run is killed
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Sign the trace with this key (keygen makes one)
    #[arg(long, value_name = "ROBOT_KEY", requires = "trace")]
    sign: Option<PathBuf>,
    /// Encrypt what is personal in the trace to this auditor; may be given several times
    #[arg(long, value_name = "AUDITOR_PUB", requires = "trace", conflicts_with = "plaintext")]
    seal: Vec<PathBuf>,
    /// Write what is personal into the trace for everybody to read: for fictional people
    #[arg(long, requires = "trace")]
    plaintext: bool,
    /// Take as long as it would really take
    #[arg(long)]
    realtime: bool,
    /// Draw the run into this file (SVG)
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Print one JSON document instead of the story
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Document<'a> {
    scenario: &'a str,
    #[serde(flatten)]
    outcome: &'a Outcome,
    story: &'a [Told],
}

impl Simulate {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let read = || iter::once(&self.scenario).chain(&self.sign).chain(&self.seal).map(PathBuf::as_path);
        for written in self.trace.iter().chain(&self.picture) {
            overwriting::refuse(written, read())?;
        }
        let scenario = Scenario::open(&self.scenario)?;
        let record = match &self.trace {
            Some(file) => Some((file.as_path(), self.seal()?)),
            None => None,
        };
        let mut warnings = Vec::new();
        if let Some((file, Seal { privacy: Privacy::LeftOut, .. })) = &record {
            warnings.push(format!(
                "{}: what is personal is left out, and so nobody can check the decisions: --seal AUDITOR_PUB \
                 encrypts it, --plaintext leaves it in the open",
                file.display()
            ));
        }
        let ran = play(&scenario, self.realtime, record)?;
        if let Some(file) = &self.picture {
            write_whole(file, &ran.sketch.to_svg())?;
        }
        let outcome = &ran.outcome;
        let status = if outcome.is_all_right() { Status::Passed } else { Status::Failed };
        let output = match self.json {
            true => {
                let story = &ran.story.told;
                json(&Document { scenario: &scenario.name, outcome, story })?
            }
            false => told(&scenario, &ran),
        };
        Ok(Report { output, warnings, status })
    }

    /// The trace's seal, as the options say.
    fn seal(&self) -> Result<Seal, CommandError> {
        let privacy = match (self.plaintext, self.seal.as_slice()) {
            (true, _) => Privacy::Plain,
            (false, []) => Privacy::LeftOut,
            (false, files) => Privacy::Sealed(auditor_public_keys(files)?),
        };
        let signer = self.sign.as_deref().map(robot_key).transpose()?;
        Ok(Seal { privacy, signer, random: Box::new(random) })
    }
}

/// A run that was told and drawn.
pub(super) struct Ran {
    pub(super) outcome: Outcome,
    pub(super) story: Storybook,
    pub(super) sketch: Sketch,
}

/// Runs a scenario with a progress bar, and records it into a file with a seal.
pub(super) fn play(
    scenario: &Scenario,
    realtime: bool,
    record: Option<(&Path, Seal)>,
) -> Result<Ran, CommandError> {
    let trace = record.as_ref().map(|(file, _)| *file);
    let (mut story, mut sketch) = (Storybook::default(), Sketch::default());
    let mut bar = Bar::new(scenario.until, realtime);
    let unwritable = |file: &Path| {
        let file = file.to_owned();
        move |source| CommandError::Unwritable { file, source }
    };
    let mut writer = match record {
        Some((file, seal)) => {
            Some(TraceWriter::create(Durable::create(file)?, seal).map_err(unwritable(file))?)
        }
        None => None,
    };
    let mut watchers: Vec<&mut dyn Watcher> = vec![&mut story, &mut sketch, &mut bar];
    if let Some(writer) = &mut writer {
        watchers.push(writer);
    }
    let outcome = run(scenario, &mut watchers).map_err(|source| match trace {
        Some(file) => unwritable(file)(source),
        None => CommandError::Recording(source),
    })?;
    Ok(Ran { outcome, story, sketch })
}

/// The story and what came of it.
pub(super) fn told(scenario: &Scenario, ran: &Ran) -> String {
    let mut text = scenario.name.clone();
    if !scenario.about.is_empty() {
        let _ = write!(text, "\n\n{}", scenario.about.trim());
    }
    let _ = write!(text, "\n\n{}\n{}", ran.story.to_text(), summary(&ran.outcome));
    text
}

fn summary(outcome: &Outcome) -> String {
    let why = match outcome.ended {
        Ended::Idle => "everything is done",
        Ended::ShutDown => "the robot was shut down",
        Ended::TimeUp => "the scenario's time is up",
    };
    let mut text = format!(
        "After {} {why}; the robot drove {:.0} m and made {} {}.\n",
        clock(outcome.after),
        outcome.metres,
        outcome.decisions,
        if outcome.decisions == 1 { "decision" } else { "decisions" }
    );
    for request in &outcome.requests {
        let how = match request.how {
            None => "still open",
            Some(HowItEnded::Closed(Closing::Reached)) => "served",
            Some(HowItEnded::Closed(Closing::Failed)) => "failed",
            Some(HowItEnded::Closed(Closing::Withdrawn)) => "withdrawn",
            Some(HowItEnded::Closed(Closing::Staff(Staff::DeferredTooOften))) => {
                "to staff, put off too often"
            }
            Some(HowItEnded::Closed(Closing::Staff(Staff::NoRoom))) => "to staff, no memory left",
            Some(HowItEnded::Closed(Closing::Staff(Staff::Shutdown))) => "to staff, shut down",
            Some(HowItEnded::Closed(Closing::Staff(Staff::EmergencyBeyondRobot))) => {
                "to staff, beyond the robot"
            }
            Some(HowItEnded::Refused(Refusal::UnknownGoal)) => "refused, unknown goal",
            Some(HowItEnded::Refused(Refusal::Incapable)) => "refused, beyond the robot",
            Some(HowItEnded::Refused(Refusal::AlreadyAsking)) => "refused, an earlier request was open",
        };
        let _ =
            write!(text, "  {} ({}): asked at {}, {how}", request.user, request.goal, clock(request.asked));
        let _ = match request.closed {
            Some(closed) => writeln!(text, " at {}", clock(closed)),
            None => writeln!(text),
        };
    }
    for failure in &outcome.failures {
        let _ = writeln!(text, "  failure at {}: {}", clock(failure.at), failure.what);
    }
    for key in &outcome.never_happened {
        let _ = writeln!(text, "  never happened: {key}");
    }
    text
}

/// Shows how much of the scenario's time has gone, and holds it back until as much real time
/// has gone if that is wanted.
struct Bar {
    bar: ProgressBar,
    real: Option<Instant>,
}

impl Bar {
    fn new(until: Duration, realtime: bool) -> Self {
        let bar = progress::bar(until.as_secs(), "{bar:20} {pos} of at most {len} s  {wide_msg}");
        Self { bar, real: realtime.then(Instant::now) }
    }
}

impl Watcher for Bar {
    fn world(&mut self, at: Duration, _: &World) -> io::Result<()> {
        self.bar.set_position(at.as_secs());
        if let Some(ahead) = self.real.and_then(|began| at.checked_sub(began.elapsed())) {
            thread::sleep(ahead);
        }
        Ok(())
    }

    fn sentence(&mut self, _: Duration, sentence: &str) -> io::Result<()> {
        self.bar.set_message(sentence.to_owned());
        Ok(())
    }

    fn end(&mut self, _: Duration) -> io::Result<()> {
        self.bar.finish_and_clear();
        Ok(())
    }
}
