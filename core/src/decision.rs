//! One decision between two users: the negotiation, and the fallback without agreement.

use crate::observer::Observer;
use crate::options::{Fallback, Options};
use crate::outcome::{Conclusion, Side};
use crate::party::Party;
use crate::protocol::Negotiation;
use crate::rules::Activation;
use crate::user::User;
use crate::welfare::Welfare;

/// Two users who both want the robot, and the rules that apply.
#[derive(Clone, Copy)]
pub struct Case<'a> {
    /// Which condition activates which dispositions.
    pub activation: Activation<'a>,
    /// The user whom the robot is serving.
    pub current: User<'a>,
    /// The user who asks for something else.
    pub interrupting: User<'a>,
}

/// Whom the robot serves, and what led to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// How the negotiation ended.
    pub conclusion: Conclusion,
    /// The winner, or whom the fallback chose.
    pub served: Side,
}

impl<'a> Case<'a> {
    /// The negotiation between the two, before its first round.
    #[must_use]
    pub fn negotiation(&self, options: &Options) -> Negotiation<'a> {
        Negotiation::between(
            Party::current(self.current, self.activation, options),
            Party::interrupting(self.interrupting, self.activation, options),
            options,
        )
    }

    /// Negotiates to the end: outcome and rounds.
    #[must_use]
    pub fn negotiate(&self, options: &Options) -> Conclusion {
        self.negotiation(options).run(&mut ())
    }

    /// Negotiates, and applies the fallback if there is no agreement.
    pub fn decide<O: Observer>(&self, options: &Options, observer: &mut O) -> Decision {
        let conclusion = self.negotiation(options).run(observer);
        let served = match (conclusion.outcome.winner(), options.fallback) {
            (Some(winner), _) => winner,
            (None, Fallback::FirstCome) => Side::Current,
            (None, Fallback::Utilitarian) => self.welfare(options).best(),
        };
        Decision { conclusion, served }
    }

    /// The welfare of serving either user.
    #[must_use]
    pub fn welfare(&self, options: &Options) -> Welfare {
        Welfare::of(&self.current, &self.interrupting, self.activation, options.aggregation)
    }

    /// The same two users with their parts swapped.
    #[must_use]
    pub fn swapped(&self) -> Self {
        Self { activation: self.activation, current: self.interrupting, interrupting: self.current }
    }
}
