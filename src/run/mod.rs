//! A run: the mission drives the simulated robot, and whoever wants to watches.
//!
//! Pure but for what watchers do: the same [`Scenario`](crate::scenario::Scenario) gives the
//! same calls of every [`Watcher`], with the same arguments. It ends when everything has
//! happened and the mission is idle, when the mission is over, or when the scenario's time
//! is up; so it always ends.

mod following;
mod narrator;
mod outcome;
mod runner;
mod sketch;
mod storybook;
mod watcher;

pub use outcome::{Ended, Failure, HowItEnded, Outcome, RequestOutcome};
pub use runner::run;
pub use sketch::Sketch;
pub use storybook::{Storybook, Told, clock};
pub use watcher::{Participant, Setup, Watcher};
