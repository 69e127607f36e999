//! One user's own data: an ethical profile, the conditions that are true, and a goal.

use core::fmt;

use crate::rules::{Condition, Disposition, Implication, MAX_ITEMS};

/// How strongly a profile gives precedence to a disposition (the paper's scale is
/// 1..=5; the published generator also uses 0).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Rank(pub u8);

/// A user's ranks in the active context: entry `d` belongs to
/// [`Disposition`]`(d)`. A disposition without an entry ranks 0, as in the published
/// system.
#[derive(Clone, Copy)]
pub struct EthicalProfile<'a> {
    ranks: &'a [Rank],
}

impl<'a> EthicalProfile<'a> {
    /// A profile from its ranks.
    #[must_use]
    pub const fn new(ranks: &'a [Rank]) -> Self {
        Self { ranks }
    }

    pub(crate) fn rank(self, disposition: Disposition) -> u64 {
        match self.ranks.get(disposition.index()) {
            Some(&Rank(rank)) => u64::from(rank),
            None => 0,
        }
    }
}

/// A user's true conditions in their order of disclosure. What is false or withheld is
/// not in it, so nothing can look at it. A condition that stands in it twice is disclosed
/// twice, and under [`Aggregation::PerCondition`](crate::Aggregation::PerCondition) counts
/// twice; the readers of the toolkit give each once.
#[derive(Clone, Copy)]
pub struct Status<'a> {
    conditions: &'a [Condition],
}

impl<'a> Status<'a> {
    /// A status from the true conditions, the first to be disclosed first.
    ///
    /// # Errors
    /// [`TooManyConditions`] if there are more than [`MAX_ITEMS`].
    pub const fn new(conditions: &'a [Condition]) -> Result<Self, TooManyConditions> {
        if conditions.len() > MAX_ITEMS {
            return Err(TooManyConditions { count: conditions.len() });
        }
        Ok(Self { conditions })
    }

    pub(crate) fn conditions(self) -> &'a [Condition] {
        self.conditions
    }
}

/// A status was refused: it has more than [`MAX_ITEMS`] true conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyConditions {
    /// How many it has.
    pub count: usize,
}

impl fmt::Display for TooManyConditions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} true conditions, more than {MAX_ITEMS}", self.count)
    }
}

impl core::error::Error for TooManyConditions {}

/// What the robot knows of one user when it starts to negotiate.
///
/// Its fields are private, it has no accessor for them and no `Debug`: code that holds a
/// `User` can have it take part in a negotiation or weigh an offer, not read it.
#[derive(Clone, Copy)]
pub struct User<'a> {
    profile: EthicalProfile<'a>,
    status: Status<'a>,
    goal: Implication<'a>,
}

impl<'a> User<'a> {
    /// A user with this profile and status who wants this goal.
    #[must_use]
    pub const fn new(profile: EthicalProfile<'a>, status: Status<'a>, goal: Implication<'a>) -> Self {
        Self { profile, status, goal }
    }

    pub(crate) fn profile(self) -> EthicalProfile<'a> {
        self.profile
    }

    pub(crate) fn status(self) -> Status<'a> {
        self.status
    }

    pub(crate) fn goal(self) -> Implication<'a> {
        self.goal
    }
}
