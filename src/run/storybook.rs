//! Keeps the story of a run.

use std::io;
use std::time::Duration;

use serde::Serialize;

use super::watcher::Watcher;

/// All sentences of a run. It names users: personal.
#[derive(Clone, Debug, Default)]
pub struct Storybook {
    /// In the order in which they were told.
    pub told: Vec<Told>,
}

/// A sentence and when it was told.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Told {
    /// In simulated seconds since the run's begin.
    #[serde(serialize_with = "super::outcome::seconds")]
    pub at: Duration,
    /// The sentence.
    pub sentence: String,
}

/// A time as minutes and seconds.
#[must_use]
pub fn clock(at: Duration) -> String {
    let seconds = at.as_secs();
    format!("{:02}:{:02}", seconds / 60, seconds % 60)
}

impl Storybook {
    /// The story, a sentence a line, each after its time.
    #[must_use]
    pub fn to_text(&self) -> String {
        self.told.iter().map(|told| format!("{} {}\n", clock(told.at), told.sentence)).collect()
    }
}

impl Watcher for Storybook {
    fn sentence(&mut self, at: Duration, sentence: &str) -> io::Result<()> {
        self.told.push(Told { at, sentence: sentence.to_owned() });
        Ok(())
    }
}
