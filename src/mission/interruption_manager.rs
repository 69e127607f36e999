//! The *interruption manager*: which requests there are, whether they may interrupt, and
//! how often each was deferred.

use super::command::Refusal;
use super::event::{GoalId, Place, UserId};
use super::lifecycle::Lifecycle;
use super::request_queue::{RequestQueue, Stage};
use super::specification::MissionRules;

/// The open requests.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct InterruptionManager {
    pub(super) lifecycle: Lifecycle,
    pub(super) requests: RequestQueue,
}

/// What becomes of a new request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Admission {
    Admitted,
    Refused(Refusal),
    NoRoom,
}

/// What becomes of a deferred request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Deferral {
    /// It waits; this is how often it was deferred.
    Waits(u8),
    /// It was deferred as often as the specification allows.
    TooOften,
}

impl InterruptionManager {
    pub(super) fn new(rules: &MissionRules) -> Self {
        Self {
            lifecycle: Lifecycle::Unconfigured,
            requests: RequestQueue::new(usize::from(rules.limits().requests)),
        }
    }

    /// Capabilities are looked at before anything is kept or anybody is asked.
    pub(super) fn admit(
        &mut self,
        user: UserId,
        goal: GoalId,
        place: Place,
        rules: &MissionRules,
    ) -> Admission {
        match rules.within_capabilities(goal) {
            None => Admission::Refused(Refusal::UnknownGoal),
            Some(false) => Admission::Refused(Refusal::Incapable),
            Some(true) if self.requests.get(user).is_some() => Admission::Refused(Refusal::AlreadyAsking),
            Some(true) if self.requests.push(user, goal, place) => Admission::Admitted,
            Some(true) => Admission::NoRoom,
        }
    }

    /// Counts a deferral. Of the user the request alone is kept.
    pub(super) fn defer(&mut self, user: UserId, stage: Stage, rules: &MissionRules) -> Deferral {
        let Some(request) = self.requests.get_mut(user) else { return Deferral::TooOften };
        request.deferrals = request.deferrals.saturating_add(1);
        request.stage = stage;
        if request.deferrals >= rules.limits().deferrals {
            Deferral::TooOften
        } else {
            Deferral::Waits(request.deferrals)
        }
    }

    /// The first request that may still interrupt.
    pub(super) fn first_fresh(&self) -> Option<UserId> {
        self.requests.iter().find(|request| request.stage == Stage::Fresh).map(|request| request.user())
    }

    /// The first request that waits for whatever reason.
    pub(super) fn first_waiting(&self) -> Option<UserId> {
        let waits = |stage| matches!(stage, Stage::Fresh | Stage::Deferred);
        self.requests.iter().find(|request| waits(request.stage)).map(|request| request.user())
    }

    /// Those whose data are asked for or there, and who are not served: whoever interrupts.
    pub(super) fn candidates(&self) -> impl Iterator<Item = UserId> {
        let takes_part = |stage| matches!(stage, Stage::Awaited(_) | Stage::Ready);
        self.requests.iter().filter(move |request| takes_part(request.stage)).map(|request| request.user())
    }

    pub(super) fn stage(&self, user: UserId) -> Option<Stage> {
        self.requests.get(user).map(|request| request.stage)
    }
}
