//! The requests that the robot has not closed, by arrival: for each user the goal, the
//! meeting place, and where the request stands. Nothing of profile or status.

use zeroize::Zeroize;

use super::event::{AskId, GoalId, Place, UserId};
use super::memory::{Cell, Cells, nonzero};

/// Where a request stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Stage {
    /// It waits for a chance to interrupt.
    Fresh,
    /// It was deferred: it waits until the robot is free.
    Deferred,
    /// The user's data are asked for.
    Awaited(AskId),
    /// The user's data are there.
    Ready,
    /// The robot serves it.
    Served,
}

/// An open request.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct Request {
    open: bool,
    user: u32,
    goal: u16,
    place: u32,
    pub(super) deferrals: u8,
    pub(super) stage: Stage,
}

impl Request {
    pub(super) fn user(&self) -> UserId {
        UserId(self.user)
    }

    pub(super) fn goal(&self) -> GoalId {
        GoalId(self.goal)
    }

    pub(super) fn place(&self) -> Place {
        Place(self.place)
    }
}

impl Cell for Request {
    fn vacant() -> Self {
        Self { open: false, user: 0, goal: 0, place: 0, deferrals: 0, stage: Stage::Fresh }
    }

    fn wipe(&mut self) {
        self.open.zeroize();
        self.user.zeroize();
        self.goal.zeroize();
        self.place.zeroize();
        self.deferrals.zeroize();
        self.stage = Stage::Fresh;
    }

    fn residue(&self) -> usize {
        [
            usize::from(self.open),
            nonzero(&self.user.to_ne_bytes()),
            nonzero(&self.goal.to_ne_bytes()),
            nonzero(&self.place.to_ne_bytes()),
            usize::from(self.deferrals != 0),
            usize::from(self.stage != Stage::Fresh),
        ]
        .into_iter()
        .sum()
    }

    #[cfg(test)]
    fn bytes(&self, into: &mut Vec<u8>) {
        into.extend(self.user.to_ne_bytes());
        into.extend(self.goal.to_ne_bytes());
        into.extend(self.place.to_ne_bytes());
    }
}

/// The open requests, the earliest first.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct RequestQueue(Cells<Request>);

impl RequestQueue {
    pub(super) fn new(room: usize) -> Self {
        Self(Cells::new(room))
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Request> {
        self.0.all().iter().filter(|request| request.open)
    }

    pub(super) fn first(&self) -> Option<(UserId, GoalId, Place)> {
        self.iter().next().map(|request| (request.user(), request.goal(), request.place()))
    }

    pub(super) fn get(&self, user: UserId) -> Option<&Request> {
        self.iter().find(|request| request.user() == user)
    }

    pub(super) fn get_mut(&mut self, user: UserId) -> Option<&mut Request> {
        self.0.all_mut().iter_mut().find(|request| request.open && request.user() == user)
    }

    /// Keeps a request; false if there is no room.
    pub(super) fn push(&mut self, user: UserId, goal: GoalId, place: Place) -> bool {
        match self.0.all_mut().iter_mut().find(|request| !request.open) {
            Some(request) => {
                *request = Request {
                    open: true,
                    user: user.0,
                    goal: goal.0,
                    place: place.0,
                    deferrals: 0,
                    stage: Stage::Fresh,
                };
                true
            }
            None => false,
        }
    }

    /// Forgets a request. Its memory is overwritten.
    pub(super) fn remove(&mut self, user: UserId) {
        self.move_back(user, true);
    }

    /// Puts a request behind all others.
    pub(super) fn put_last(&mut self, user: UserId) {
        self.move_back(user, false);
    }

    fn move_back(&mut self, user: UserId, forget: bool) {
        let open = self.iter().count();
        let at = self.0.all().iter().position(|request| request.open && request.user() == user);
        let Some(at) = at else { return };
        if let Some(rest) = self.0.all_mut().get_mut(at..open) {
            if let (true, Some(request)) = (forget, rest.first_mut()) {
                request.wipe();
            }
            rest.rotate_left(1);
        }
    }

    pub(super) fn residue(&self) -> usize {
        self.0.residue()
    }

    #[cfg(test)]
    pub(super) fn all_mut(&mut self) -> impl Iterator<Item = &mut Request> {
        self.0.all_mut().iter_mut()
    }
}
