//! Utilitarian welfare of serving one of two users. It weighs both users' data, so it
//! runs outside the protocol; nothing here is reachable from the engine.

use crate::impact::{Disclosed, Impact};
use crate::options::Aggregation;
use crate::outcome::Side;
use crate::rules::Activation;
use crate::user::User;

/// `user`'s ethical impact of `served`'s complete offer: what serving `served` is worth
/// in the eyes of `user`. The willingness to be interrupted does not count.
#[must_use]
pub fn impact_of_serving(
    served: &User<'_>,
    user: &User<'_>,
    activation: Activation<'_>,
    aggregation: Aggregation,
) -> Impact {
    let complete = Disclosed { goal: served.goal(), conditions: served.status().conditions() };
    complete.impact(user.profile(), activation, aggregation)
}

/// W of serving either of two users: the sum over both users of the ethical impact of
/// the served one's complete offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Welfare {
    /// W(current).
    pub current: Impact,
    /// W(interrupting).
    pub interrupting: Impact,
}

impl Welfare {
    /// The welfare of serving each of the two.
    #[must_use]
    pub fn of(
        current: &User<'_>,
        interrupting: &User<'_>,
        activation: Activation<'_>,
        aggregation: Aggregation,
    ) -> Self {
        let of_serving = |served: &User<'_>| {
            impact_of_serving(served, current, activation, aggregation).plus(impact_of_serving(
                served,
                interrupting,
                activation,
                aggregation,
            ))
        };
        Self { current: of_serving(current), interrupting: of_serving(interrupting) }
    }

    /// W of serving `side`.
    #[must_use]
    pub fn of_serving(self, side: Side) -> Impact {
        match side {
            Side::Current => self.current,
            Side::Interrupting => self.interrupting,
        }
    }

    /// Whom to serve for the most welfare; equal: the current user.
    #[must_use]
    pub fn best(self) -> Side {
        if self.interrupting > self.current { Side::Interrupting } else { Side::Current }
    }

    /// max W - W(served).
    #[must_use]
    pub fn regret(self, served: Side) -> Impact {
        Impact(self.of_serving(self.best()).0.saturating_sub(self.of_serving(served).0))
    }
}
