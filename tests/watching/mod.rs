//! A watcher that keeps everything that it is shown.
#![allow(dead_code, reason = "every test file uses its own part")]

use std::io;
use std::time::Duration;

use selfneg::mission::{Event, Output, Record};
use selfneg::run::{Setup, Watcher};
use selfneg_sim::World;

#[derive(Default)]
pub(crate) struct Log {
    /// Every call, with everything in it, as text.
    pub(crate) lines: Vec<String>,
    pub(crate) times: Vec<Duration>,
    /// When the world was shown.
    pub(crate) shown: Vec<Duration>,
    pub(crate) events: Vec<(Duration, Event)>,
    pub(crate) outputs: Vec<(Duration, Output)>,
}

impl Log {
    pub(crate) fn records(&self) -> impl Iterator<Item = &Record> {
        self.outputs.iter().filter_map(|(_, output)| match output {
            Output::Record(record) => Some(record),
            Output::Command(_) => None,
        })
    }

    fn line(&mut self, at: Duration, what: &str) {
        self.times.push(at);
        self.lines.push(format!("{at:?} {what}"));
    }
}

impl Watcher for Log {
    fn begin(&mut self, setup: &Setup<'_>) -> io::Result<()> {
        self.line(Duration::ZERO, &format!("begin {setup:?}"));
        Ok(())
    }

    fn event(&mut self, at: Duration, event: &Event) -> io::Result<()> {
        // Debug does not show texts about users; JSON does.
        self.line(at, &format!("event {}", serde_json::to_string(event)?));
        self.events.push((at, event.clone()));
        Ok(())
    }

    fn output(&mut self, at: Duration, output: &Output) -> io::Result<()> {
        self.line(at, &format!("output {}", serde_json::to_string(output)?));
        self.outputs.push((at, output.clone()));
        Ok(())
    }

    fn world(&mut self, at: Duration, world: &World) -> io::Result<()> {
        let (robot, people): (_, Vec<_>) = (world.robot(), world.people().collect());
        self.line(at, &format!("world {robot:?} {people:?} {:?}", world.activity()));
        self.shown.push(at);
        Ok(())
    }

    fn sentence(&mut self, at: Duration, sentence: &str) -> io::Result<()> {
        self.line(at, &format!("sentence {sentence}"));
        Ok(())
    }

    fn decided(&mut self, at: Duration) -> io::Result<()> {
        self.line(at, "decided");
        Ok(())
    }

    fn end(&mut self, at: Duration) -> io::Result<()> {
        self.line(at, "end");
        Ok(())
    }
}
