//! A run: the mission drives the simulated robot, and whoever wants to watches.

mod watcher;

pub use watcher::{Participant, Setup, Watcher};
