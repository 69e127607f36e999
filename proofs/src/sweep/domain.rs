//! A finite domain of users, all ordered pairs of which a sweep covers.

use std::fmt;
use std::ops::RangeInclusive;

use selfneg_core::{Activation, Condition, Disposition, Rank, RulesError};
use thiserror::Error;

use super::pair::Person;

/// The most dispositions a domain can have.
pub const MAX_DISPOSITIONS: usize = 16;

/// The most conditions that can activate one disposition of a domain.
pub const MAX_PER_DISPOSITION: u8 = 15;

static DISPOSITIONS: [Disposition; MAX_DISPOSITIONS] = {
    let mut all = [Disposition(0); MAX_DISPOSITIONS];
    let mut rest: &mut [Disposition] = &mut all;
    let mut index = 0;
    while let Some((first, others)) = rest.split_first_mut() {
        *first = Disposition(index);
        index += 1;
        rest = others;
    }
    all
};

/// All users whose ranks are in a range and who have any set of the domain's conditions.
///
/// The conditions are numbered and disclosed by disposition: first those that activate
/// disposition 0, then those that activate disposition 1, and so on. Each activates one
/// disposition. Every goal implies every disposition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Domain {
    conditions: Vec<u8>,
    rows: Vec<&'static [Disposition]>,
    lowest: u8,
    highest: u8,
    users: u64,
}

/// Why a domain was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DomainError {
    /// There is nothing to rank.
    #[error("a domain needs at least one disposition")]
    NoDispositions,
    /// More than [`MAX_DISPOSITIONS`].
    #[error("{count} dispositions, at most {MAX_DISPOSITIONS}")]
    TooManyDispositions {
        /// How many were asked for.
        count: usize,
    },
    /// More than [`MAX_PER_DISPOSITION`] conditions for one disposition.
    #[error("{count} conditions activate disposition {disposition}, at most {MAX_PER_DISPOSITION}")]
    TooManyConditions {
        /// The disposition, from 0.
        disposition: usize,
        /// How many conditions were asked for.
        count: u8,
    },
    /// The range of ranks is empty.
    #[error("no rank lies in {lowest}..={highest}")]
    NoRanks {
        /// The range's start.
        lowest: u8,
        /// The range's end.
        highest: u8,
    },
    /// 2^64 users or more: the pairs could not be counted in 128 bits.
    #[error("2^64 users or more")]
    TooManyUsers,
}

impl Domain {
    /// `dispositions` dispositions, each activated by one condition of its own.
    ///
    /// # Errors
    /// [`DomainError`], see there.
    pub fn one_to_one(dispositions: usize, ranks: RangeInclusive<u8>) -> Result<Self, DomainError> {
        if dispositions > MAX_DISPOSITIONS {
            return Err(DomainError::TooManyDispositions { count: dispositions });
        }
        Self::many_to_one(&vec![1; dispositions], ranks)
    }

    /// As many dispositions as `conditions` has entries; entry `d` is the number of
    /// conditions that activate disposition `d`.
    ///
    /// # Errors
    /// [`DomainError`], see there.
    pub fn many_to_one(conditions: &[u8], ranks: RangeInclusive<u8>) -> Result<Self, DomainError> {
        let (lowest, highest) = ranks.into_inner();
        if conditions.is_empty() {
            return Err(DomainError::NoDispositions);
        }
        if conditions.len() > MAX_DISPOSITIONS {
            return Err(DomainError::TooManyDispositions { count: conditions.len() });
        }
        if lowest > highest {
            return Err(DomainError::NoRanks { lowest, highest });
        }
        let ranks = u64::from(highest - lowest) + 1;
        let mut users: u64 = 1;
        let mut rows = Vec::new();
        for (disposition, &count) in conditions.iter().enumerate() {
            if count > MAX_PER_DISPOSITION {
                return Err(DomainError::TooManyConditions { disposition, count });
            }
            users = ranks
                .checked_shl(u32::from(count))
                .and_then(|each| users.checked_mul(each))
                .ok_or(DomainError::TooManyUsers)?;
            let row = DISPOSITIONS.get(disposition..=disposition).unwrap_or_default();
            rows.extend(std::iter::repeat_n(row, usize::from(count)));
        }
        Ok(Self { conditions: conditions.to_vec(), rows, lowest, highest, users })
    }

    /// The published activation: ten conditions on six dispositions, three of them on
    /// the first and three on the fifth.
    ///
    /// # Errors
    /// [`DomainError`] for an empty range of ranks.
    pub fn published(ranks: RangeInclusive<u8>) -> Result<Self, DomainError> {
        Self::many_to_one(&[3, 1, 1, 1, 3, 1], ranks)
    }

    /// How many conditions activate each disposition.
    #[must_use]
    pub fn conditions_per_disposition(&self) -> &[u8] {
        &self.conditions
    }

    /// How many dispositions there are.
    #[must_use]
    pub fn dispositions(&self) -> usize {
        self.conditions.len()
    }

    /// How many conditions there are.
    #[must_use]
    pub fn conditions(&self) -> usize {
        self.rows.len()
    }

    /// The ranks that a user may give.
    #[must_use]
    pub fn ranks(&self) -> RangeInclusive<u8> {
        self.lowest..=self.highest
    }

    /// The number of users: 2^conditions times ranks^dispositions.
    #[must_use]
    pub fn users(&self) -> u64 {
        self.users
    }

    /// The number of ordered pairs of users, a user paired with itself included.
    #[must_use]
    pub fn pairs(&self) -> u128 {
        u128::from(self.users) * u128::from(self.users)
    }

    /// Which condition activates which disposition.
    ///
    /// # Errors
    /// None of a domain's: its rows have one disposition each.
    pub fn activation(&self) -> Result<Activation<'_>, RulesError> {
        Activation::new(&self.rows)
    }

    /// The activation's rows, by condition.
    #[must_use]
    pub fn rows(&self) -> &[&'static [Disposition]] {
        &self.rows
    }

    /// Every user, one by one: for domains small enough to enumerate.
    pub fn people(&self) -> impl Iterator<Item = Person> {
        (0..self.users).map(|number| self.person(number))
    }

    /// The user of this number. Each number below [`users`](Self::users) is another
    /// user; from there on they repeat.
    #[must_use]
    pub fn person(&self, number: u64) -> Person {
        let mut rest = number;
        let mut digit = |base: u64| {
            let digit = rest % base;
            rest /= base;
            digit
        };
        let all = (0..).map(Condition).take(self.conditions());
        let conditions = all.filter(|_| digit(2) == 1).collect();
        let span = u64::from(self.highest - self.lowest) + 1;
        let mut rank = || Rank(self.lowest.saturating_add(u8::try_from(digit(span)).unwrap_or(u8::MAX)));
        let ranks = std::iter::repeat_with(&mut rank).take(self.dispositions()).collect();
        Person { conditions, ranks }
    }
}

/// As reports name it: `6 dispositions, one condition each, ranks 1..=5`.
impl fmt::Display for Domain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (dispositions, conditions) = (self.dispositions(), self.conditions());
        if self.conditions.iter().all(|&count| count == 1) {
            let plural = if dispositions == 1 { "" } else { "s" };
            write!(f, "{dispositions} disposition{plural}, one condition each")?;
        } else {
            write!(f, "{conditions} conditions on {dispositions} dispositions (")?;
            for (nth, count) in self.conditions.iter().enumerate() {
                let comma = if nth == 0 { "" } else { ", " };
                write!(f, "{comma}{count}")?;
            }
            f.write_str(")")?;
        }
        write!(f, ", ranks {}..={}", self.lowest, self.highest)
    }
}
