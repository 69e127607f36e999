//! Two concrete users, which anyone can rerun.

use std::cmp::Ordering;

use selfneg_core::{
    Activation, Case, Condition, EthicalProfile, Implication, Rank, Status, TooManyConditions, User,
};

use super::domain::MAX_DISPOSITIONS;

/// Every goal of a domain implies every disposition once.
static GOAL: [u8; MAX_DISPOSITIONS] = [1; MAX_DISPOSITIONS];

/// One user of a domain.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Person {
    /// The true conditions in order of disclosure.
    pub conditions: Vec<Condition>,
    /// A rank for each disposition.
    pub ranks: Vec<Rank>,
}

impl Person {
    /// The user as the engine takes it.
    ///
    /// # Errors
    /// [`TooManyConditions`], which no person of a domain has.
    pub fn user(&self) -> Result<User<'_>, TooManyConditions> {
        Ok(User::new(
            EthicalProfile::new(&self.ranks),
            Status::new(&self.conditions)?,
            Implication::new(&GOAL),
        ))
    }

    fn sum_of_ranks(&self) -> u32 {
        self.ranks.iter().map(|rank| u32::from(rank.0)).sum()
    }
}

/// An ordered pair of users.
///
/// Pairs are ordered by size: the fewest conditions in total, then the smallest sum of
/// all ranks, then lexicographically.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Pair {
    /// The user whom the robot is serving.
    pub current: Person,
    /// The user who interrupts.
    pub interrupting: Person,
}

impl Pair {
    /// The pair as the engine takes it.
    ///
    /// # Errors
    /// [`TooManyConditions`], which no pair of a domain has.
    pub fn case<'a>(&'a self, activation: Activation<'a>) -> Result<Case<'a>, TooManyConditions> {
        Ok(Case { activation, current: self.current.user()?, interrupting: self.interrupting.user()? })
    }

    fn size(&self) -> (usize, u32) {
        (
            self.current.conditions.len() + self.interrupting.conditions.len(),
            self.current.sum_of_ranks() + self.interrupting.sum_of_ranks(),
        )
    }
}

impl Ord for Pair {
    fn cmp(&self, other: &Self) -> Ordering {
        self.size()
            .cmp(&other.size())
            .then_with(|| self.current.cmp(&other.current))
            .then_with(|| self.interrupting.cmp(&other.interrupting))
    }
}

impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
