//! Two users with the lid off: what a checker must read to say what the engine should
//! have done, and what `selfneg_core`'s [`User`] gives nobody.

use selfneg_core::{Activation, Case, Condition, EthicalProfile, Implication, Rank, Side, Status, User};

/// One user's data, readable, borrowed. Copying it copies references.
#[derive(Clone, Copy)]
pub struct OpenUser<'a> {
    ranks: &'a [Rank],
    conditions: &'a [Condition],
    goal: &'a [u8],
    status: Status<'a>,
}

impl<'a> OpenUser<'a> {
    /// A user from its ranks by disposition, its true conditions in order of disclosure,
    /// and how often its goal mentions each disposition.
    ///
    /// # Errors
    /// [`TooManyConditions`](selfneg_core::TooManyConditions) as for [`Status::new`].
    pub const fn new(
        ranks: &'a [Rank],
        conditions: &'a [Condition],
        goal: &'a [u8],
    ) -> Result<Self, selfneg_core::TooManyConditions> {
        match Status::new(conditions) {
            Ok(status) => Ok(Self { ranks, conditions, goal, status }),
            Err(error) => Err(error),
        }
    }

    /// The ranks, by disposition.
    #[must_use]
    pub const fn ranks(&self) -> &'a [Rank] {
        self.ranks
    }

    /// The true conditions, in order of disclosure.
    #[must_use]
    pub const fn conditions(&self) -> &'a [Condition] {
        self.conditions
    }

    /// How often the goal mentions each disposition.
    #[must_use]
    pub const fn goal(&self) -> &'a [u8] {
        self.goal
    }

    /// The same user without its last true condition; `None` if it has no condition.
    #[must_use]
    pub const fn without_last(&self) -> Option<Self> {
        match self.conditions.split_last() {
            Some((_, before)) => match Status::new(before) {
                Ok(status) => Some(Self { ranks: self.ranks, conditions: before, goal: self.goal, status }),
                Err(_) => None,
            },
            None => None,
        }
    }

    /// The user as the engine takes it.
    #[must_use]
    pub const fn closed(&self) -> User<'a> {
        User::new(EthicalProfile::new(self.ranks), self.status, Implication::new(self.goal))
    }
}

/// A case whose users a checker can read.
#[derive(Clone, Copy)]
pub struct OpenCase<'a> {
    /// Which condition activates which dispositions.
    pub activation: Activation<'a>,
    /// The user whom the robot is serving.
    pub current: OpenUser<'a>,
    /// The user who asks for something else.
    pub interrupting: OpenUser<'a>,
}

impl<'a> OpenCase<'a> {
    /// The user on `side`.
    #[must_use]
    pub const fn user(&self, side: Side) -> &OpenUser<'a> {
        match side {
            Side::Current => &self.current,
            Side::Interrupting => &self.interrupting,
        }
    }

    /// The same case with another user on `side`.
    #[must_use]
    pub const fn with(&self, side: Side, user: OpenUser<'a>) -> Self {
        match side {
            Side::Current => {
                Self { activation: self.activation, current: user, interrupting: self.interrupting }
            }
            Side::Interrupting => {
                Self { activation: self.activation, current: self.current, interrupting: user }
            }
        }
    }

    /// The same two users with their parts swapped.
    #[must_use]
    pub const fn swapped(&self) -> Self {
        Self { activation: self.activation, current: self.interrupting, interrupting: self.current }
    }

    /// The case as the engine takes it.
    #[must_use]
    pub const fn closed(&self) -> Case<'a> {
        Case {
            activation: self.activation,
            current: self.current.closed(),
            interrupting: self.interrupting.closed(),
        }
    }
}
