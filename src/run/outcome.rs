//! What came of a run.

use std::time::Duration;

use serde::{Serialize, Serializer};

use crate::mission::{Closing, Refusal};

/// What came of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Outcome {
    /// Why the run ended.
    pub ended: Ended,
    /// How long it took, in simulated seconds.
    #[serde(serialize_with = "seconds")]
    pub after: Duration,
    /// Every request, in the order of asking.
    pub requests: Vec<RequestOutcome>,
    /// How many decisions were made between users, and how many on emergencies.
    pub decisions: u32,
    /// What the robot could not do.
    pub failures: Vec<Failure>,
    /// The keys of what was to happen and never did.
    pub never_happened: Vec<String>,
    /// How far the robot drove, in metres.
    pub metres: f64,
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// Everything happened, and the robot has nothing left to do.
    Idle,
    /// The mission was shut down.
    ShutDown,
    /// The scenario's time was up.
    TimeUp,
}

/// A request and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct RequestOutcome {
    /// Whose; a name, so personal.
    pub user: String,
    /// For what.
    pub goal: String,
    /// When it came, in simulated seconds.
    #[serde(serialize_with = "seconds")]
    pub asked: Duration,
    /// When it ended, in simulated seconds, if it did.
    #[serde(serialize_with = "seconds_if_any")]
    pub closed: Option<Duration>,
    /// How it ended, if it did.
    pub how: Option<HowItEnded>,
}

/// How a request ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum HowItEnded {
    /// The mission closed it.
    Closed(Closing),
    /// The mission refused it at once.
    Refused(Refusal),
}

/// Something that the robot could not do.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct Failure {
    /// When, in simulated seconds.
    #[serde(serialize_with = "seconds")]
    pub at: Duration,
    /// What.
    pub what: String,
}

impl Outcome {
    /// Whether every request came to an end.
    #[must_use]
    pub fn every_request_closed(&self) -> bool {
        self.requests.iter().all(|request| request.how.is_some())
    }

    /// Whether everything that the scenario foresees happened, every request came to an end,
    /// and nothing failed. A request that is refused, withdrawn or handed to staff has come
    /// to its end.
    #[must_use]
    pub fn is_all_right(&self) -> bool {
        self.every_request_closed() && self.failures.is_empty() && self.never_happened.is_empty()
    }

    /// The users who were served, in the order in which their goals were reached.
    #[must_use]
    pub fn served(&self) -> Vec<&str> {
        let mut served: Vec<_> = self
            .requests
            .iter()
            .filter(|request| request.how == Some(HowItEnded::Closed(Closing::Reached)))
            .collect();
        served.sort_by_key(|request| request.closed);
        served.into_iter().map(|request| request.user.as_str()).collect()
    }
}

pub(super) fn seconds<S: Serializer>(time: &Duration, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(time.as_secs_f64())
}

#[expect(clippy::ref_option, reason = "serde calls it so")]
fn seconds_if_any<S: Serializer>(time: &Option<Duration>, serializer: S) -> Result<S::Ok, S::Error> {
    match time {
        Some(time) => serializer.serialize_some(&time.as_secs_f64()),
        None => serializer.serialize_none(),
    }
}
