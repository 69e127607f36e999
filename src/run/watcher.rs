//! What a run shows of itself to whoever records or tells it.

use std::io;
use std::time::Duration;

use selfneg_core::Options;
use selfneg_sim::{Building, World};

use crate::input::{Rules, User};
use crate::mission::{Event, Output, Specification, UserId};
use crate::precedence::Policy;

/// What is fixed before a run begins.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The scenario's name.
    pub name: &'a str,
    /// Where the robot moves.
    pub building: &'a Building,
    /// Disposition activation and ethical implications.
    pub rules: &'a Rules,
    /// Goals, capabilities, emergencies and limits of the mission.
    pub specification: &'a Specification,
    /// The protocol variant.
    pub options: Options,
    /// The policy among several interrupters; `None` is the default for their number.
    pub policy: Option<Policy>,
    /// Everybody who takes part. Names and data are personal.
    pub participants: &'a [Participant],
    /// The names of the meeting places, by [`Place`](crate::mission::Place) number.
    pub places: &'a [String],
}

/// A user of the scenario: the pseudonym that the mission knows, and who it is.
#[derive(Clone, Debug)]
pub struct Participant {
    /// What mission and records call the user.
    pub pseudonym: UserId,
    /// The user's name in the simulated world, where it is a person's.
    pub person: String,
    /// The user's data as read; personal.
    pub user: User,
}

/// Watches a run. All times are since its begin. An event is shown before the mission
/// handles it, and then each of the mission's replies in order; a sentence comes right after
/// what it tells of. What a watcher does not need it leaves out.
pub trait Watcher {
    /// The run is about to begin.
    ///
    /// # Errors
    /// Whatever keeps the watcher from recording; the run ends then.
    fn begin(&mut self, setup: &Setup<'_>) -> io::Result<()> {
        let _ = setup;
        Ok(())
    }

    /// An event, about to be handled by the mission.
    ///
    /// # Errors
    /// As for [`begin`](Self::begin).
    fn event(&mut self, at: Duration, event: &Event) -> io::Result<()> {
        let _ = (at, event);
        Ok(())
    }

    /// A reply of the mission.
    ///
    /// # Errors
    /// As for [`begin`](Self::begin).
    fn output(&mut self, at: Duration, output: &Output) -> io::Result<()> {
        let _ = (at, output);
        Ok(())
    }

    /// Where everybody is, a few times a second and whenever something happens.
    ///
    /// # Errors
    /// As for [`begin`](Self::begin).
    fn world(&mut self, at: Duration, world: &World) -> io::Result<()> {
        let _ = (at, world);
        Ok(())
    }

    /// One plain sentence of the story. It may name users: personal.
    ///
    /// # Errors
    /// As for [`begin`](Self::begin).
    fn sentence(&mut self, at: Duration, sentence: &str) -> io::Result<()> {
        let _ = (at, sentence);
        Ok(())
    }

    /// A decision is complete and has been told: the moment to make it durable.
    ///
    /// # Errors
    /// As for [`begin`](Self::begin).
    fn decided(&mut self, at: Duration) -> io::Result<()> {
        let _ = at;
        Ok(())
    }

    /// The run is over.
    ///
    /// # Errors
    /// As for [`begin`](Self::begin).
    fn end(&mut self, at: Duration) -> io::Result<()> {
        let _ = at;
        Ok(())
    }
}
