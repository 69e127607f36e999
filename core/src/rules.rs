//! The robot's rules, known to both sides: which condition activates which disposition,
//! and which dispositions a goal implies (the paper's *disposition activation* and
//! *ethical implication*).

use core::fmt;

/// The largest number of conditions of a user, of rows of an [`Activation`], and of
/// dispositions of a row or a profile: within it no total can overflow.
pub const MAX_ITEMS: usize = u16::MAX as usize;

/// A disposition by its index: something a profile can give precedence to
/// ("elderly people").
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Disposition(pub u16);

impl Disposition {
    pub(crate) fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// A condition by its index: something true or false of a user now ("elderly").
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Condition(pub u16);

/// Which dispositions each condition activates: row `c` belongs to [`Condition`]`(c)`.
///
/// A condition without a row activates nothing but is still disclosed, one round, as in
/// the published system.
#[derive(Clone, Copy, Debug)]
pub struct Activation<'a> {
    rows: &'a [&'a [Disposition]],
}

impl<'a> Activation<'a> {
    /// Rules in which no condition activates anything.
    pub const EMPTY: Activation<'static> = Activation { rows: &[] };

    /// Checks that every row is a set.
    ///
    /// # Errors
    /// [`RulesError`] if there are more than [`MAX_ITEMS`] rows, or a row is longer than
    /// that or names a disposition twice.
    pub fn new(rows: &'a [&'a [Disposition]]) -> Result<Self, RulesError> {
        if rows.len() > MAX_ITEMS {
            return Err(RulesError::TooManyConditions);
        }
        let mut c = 0;
        while let Some(row) = rows.get(c) {
            if row.len() > MAX_ITEMS {
                return Err(RulesError::RowTooLong { row: c });
            }
            let mut i = 0;
            while let Some(&disposition) = row.get(i) {
                if contains(row.split_at_checked(i).map_or(&[][..], |(before, _)| before), disposition) {
                    return Err(RulesError::Repeated { row: c, disposition });
                }
                i = i.saturating_add(1);
            }
            c = c.saturating_add(1);
        }
        Ok(Self { rows })
    }

    /// The dispositions that `condition` activates, each once.
    #[must_use]
    pub fn of(self, condition: Condition) -> &'a [Disposition] {
        match self.rows.get(usize::from(condition.0)) {
            Some(row) => row,
            None => &[],
        }
    }

    pub(crate) fn activates(self, condition: Condition, disposition: Disposition) -> bool {
        contains(self.of(condition), disposition)
    }
}

fn contains(row: &[Disposition], disposition: Disposition) -> bool {
    let mut i = 0;
    while let Some(&d) = row.get(i) {
        if d.0 == disposition.0 {
            return true;
        }
        i = i.saturating_add(1);
    }
    false
}

/// Why an [`Activation`] was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RulesError {
    /// More than [`MAX_ITEMS`] rows.
    TooManyConditions,
    /// A row with more than [`MAX_ITEMS`] dispositions.
    RowTooLong {
        /// The row's index.
        row: usize,
    },
    /// A row that names a disposition twice.
    Repeated {
        /// The row's index.
        row: usize,
        /// What it repeats.
        disposition: Disposition,
    },
}

impl fmt::Display for RulesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooManyConditions => write!(f, "more than {MAX_ITEMS} conditions"),
            Self::RowTooLong { row } => {
                write!(f, "condition {row} activates more than {MAX_ITEMS} dispositions")
            }
            Self::Repeated { row, disposition } => {
                write!(f, "condition {row} names disposition {} twice", disposition.0)
            }
        }
    }
}

impl core::error::Error for RulesError {}

/// The dispositions that pursuing a goal affects: for each disposition, how often the
/// goal's list names it (0 = not implied; beyond the slice = 0).
///
/// In the paper the list is a set, so 0 and 1 are all one needs. The published system
/// counts a name again if the list repeats it; so does
/// [`Aggregation::PerCondition`](crate::Aggregation::PerCondition), while
/// [`Aggregation::PerDisposition`](crate::Aggregation::PerDisposition) takes the set.
#[derive(Clone, Copy, Debug)]
pub struct Implication<'a> {
    mentions: &'a [u8],
}

impl<'a> Implication<'a> {
    /// A goal from its mentions, one number per disposition.
    #[must_use]
    pub const fn new(mentions: &'a [u8]) -> Self {
        Self { mentions }
    }

    /// Whether both are the same list in memory.
    pub(crate) fn is_same(self, other: Implication<'_>) -> bool {
        core::ptr::eq(self.mentions.as_ptr(), other.mentions.as_ptr())
            && self.mentions.len() == other.mentions.len()
    }

    /// How often the goal's list names `disposition`.
    #[must_use]
    pub fn mentions(self, disposition: Disposition) -> u8 {
        match self.mentions.get(disposition.index()) {
            Some(&n) => n,
            None => 0,
        }
    }
}
