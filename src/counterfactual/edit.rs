//! One change to a decided case.

use selfneg_core::{Condition, Disposition, Rank};

use crate::binding::BoundUser;

/// What kind of change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// A true condition is not true, or withheld.
    Withheld,
    /// A condition of the rules that was not true is true.
    Added,
    /// A rank is another one.
    Rank,
    /// Another order of arrival.
    Order,
}

impl Kind {
    /// All four, in the order in which changes of the same size are reported.
    pub const ALL: [Self; 4] = [Self::Withheld, Self::Added, Self::Rank, Self::Order];

    /// `withheld`, `added`, `rank` or `order`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Withheld => "withheld",
            Self::Added => "added",
            Self::Rank => "rank",
            Self::Order => "order",
        }
    }
}

/// One change. Users are numbered by their real arrival, 0 being the current one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Edit {
    /// A true condition of the user is not true, or withheld; to the protocol this is one.
    Withheld {
        /// Whose.
        user: usize,
        /// Which.
        condition: Condition,
    },
    /// A condition of the rules that is not true of the user is true.
    Added {
        /// Whose.
        user: usize,
        /// Which.
        condition: Condition,
        /// Before which of the user's true conditions it is disclosed, by its place among
        /// them from 0; `None`: last.
        before: Option<usize>,
    },
    /// The user ranks a disposition higher or lower.
    Rank {
        /// Whose.
        user: usize,
        /// Which.
        disposition: Disposition,
        /// What it is.
        from: Rank,
        /// What it would be.
        to: Rank,
    },
    /// The current user and this interrupter come in each other's place. Willingness stays
    /// with the place: whoever is being served has it.
    Order {
        /// The interrupter.
        with: usize,
    },
}

impl Edit {
    /// What kind of change it is.
    #[must_use]
    pub const fn kind(self) -> Kind {
        match self {
            Self::Withheld { .. } => Kind::Withheld,
            Self::Added { .. } => Kind::Added,
            Self::Rank { .. } => Kind::Rank,
            Self::Order { .. } => Kind::Order,
        }
    }

    /// Whose data it changes; of an order nobody's.
    #[must_use]
    pub const fn user(self) -> Option<usize> {
        match self {
            Self::Withheld { user, .. } | Self::Added { user, .. } | Self::Rank { user, .. } => Some(user),
            Self::Order { .. } => None,
        }
    }

    /// How large it is: a rank by how many steps it moves, all others 1.
    #[must_use]
    pub fn size(self) -> u64 {
        match self {
            Self::Rank { from, to, .. } => u64::from(from.0.abs_diff(to.0)),
            Self::Withheld { .. } | Self::Added { .. } | Self::Order { .. } => 1,
        }
    }

    /// Makes the change.
    pub(super) fn apply(self, users: &mut [BoundUser]) {
        let edited = self.user().and_then(|user| users.get_mut(user));
        match (self, edited) {
            (Self::Withheld { condition, .. }, Some(user)) => {
                let rest = user.conditions().iter().copied().filter(|&other| other != condition).collect();
                *user = user.with_conditions(rest);
            }
            (Self::Added { condition, before, .. }, Some(user)) => {
                let mut conditions = user.conditions().to_vec();
                let at = before.unwrap_or(conditions.len()).min(conditions.len());
                conditions.insert(at, condition);
                *user = user.with_conditions(conditions);
            }
            (Self::Rank { disposition, to, .. }, Some(user)) => *user = user.with_rank(disposition, to),
            (Self::Order { with }, _) => {
                if with < users.len() {
                    users.swap(0, with);
                }
            }
            (Self::Withheld { .. } | Self::Added { .. } | Self::Rank { .. }, None) => {}
        }
    }

    /// Who, by real arrival, is in this place once the change is made.
    pub(super) fn who_is_at(self, place: usize) -> usize {
        match self {
            Self::Order { with } if place == 0 => with,
            Self::Order { with } if place == with => 0,
            _ => place,
        }
    }
}
