//! How much welfare a decision lost, and what lost it.

use std::fmt;

use crate::impacts::Impacts;

/// A decision among users who are numbered by arrival.
#[derive(Clone, Copy)]
pub struct Decided<'a> {
    /// Whom the negotiations gave precedence, if they agreed.
    pub agreement: Option<usize>,
    /// Whom the robot serves.
    pub served: usize,
    /// Whether the first of two users beat the second in a negotiation that was held.
    pub beat: &'a dyn Fn(usize, usize) -> bool,
    /// The willingness of user 0 to be interrupted.
    pub willingness: u8,
}

/// What a decision lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Regret {
    /// max W - W(served), in ranks.
    pub amount: u64,
    /// What decided.
    pub cause: Cause,
}

/// What made a decision as good or bad as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cause {
    /// There is one user only, and nothing to decide.
    Alone,
    /// The negotiations agreed on a user whom to serve has the most welfare.
    AgreedAndOptimal,
    /// Each of the two would have accepted the other's complete offer, so who spoke first
    /// of what decided.
    MutualDeference,
    /// The current user's willingness kept it from accepting what is worth more to it.
    Willingness,
    /// What is best for the two who negotiated is not best for all who are present.
    ThirdUsers,
    /// The policy for many users preferred somebody who did not beat the best one.
    Policy,
    /// Nobody agreed, and the fallback decided, well or badly.
    Fallback,
}

impl Cause {
    /// The name that reports and JSON use.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Alone => "alone",
            Self::AgreedAndOptimal => "agreed-and-optimal",
            Self::MutualDeference => "mutual-deference",
            Self::Willingness => "willingness",
            Self::ThirdUsers => "third-users",
            Self::Policy => "policy",
            Self::Fallback => "fallback",
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl Regret {
    /// The regret of a decision.
    #[must_use]
    pub fn of(impacts: &Impacts, decided: &Decided<'_>) -> Self {
        let best = impacts.optimal().first().copied().unwrap_or(decided.served);
        let amount = impacts.welfare(best).saturating_sub(impacts.welfare(decided.served));
        Self { amount, cause: cause(impacts, decided, best, amount) }
    }
}

fn cause(impacts: &Impacts, decided: &Decided<'_>, best: usize, amount: u64) -> Cause {
    let Some(winner) = decided.agreement else {
        return if impacts.users() == 1 { Cause::Alone } else { Cause::Fallback };
    };
    if amount == 0 {
        return Cause::AgreedAndOptimal;
    }
    if !(decided.beat)(winner, best) {
        return Cause::Policy;
    }
    let worth_to_the_two =
        |served| impacts.of_serving(served, winner).saturating_add(impacts.of_serving(served, best));
    if worth_to_the_two(winner) >= worth_to_the_two(best) {
        return Cause::ThirdUsers;
    }
    // The loser accepted, so for these two to lose by it the winner must like the loser's
    // offer better than its own. Only its willingness can have hidden that.
    let willingness = if winner == 0 { u64::from(decided.willingness) } else { 0 };
    let threshold = impacts.of_serving(winner, winner).saturating_add(willingness);
    if impacts.of_serving(best, winner) > threshold { Cause::MutualDeference } else { Cause::Willingness }
}
