//! The two sides of a negotiation, and how it can end.

use core::fmt;

/// The two users of one negotiation, by the part they play. The interrupting user is
/// the first sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The user whom the robot is serving.
    Current,
    /// The user who asks for something else.
    Interrupting,
}

impl Side {
    /// The other one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Current => Self::Interrupting,
            Self::Interrupting => Self::Current,
        }
    }

    /// `current` or `interrupting`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Current => "current",
            Self::Interrupting => "interrupting",
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// What a negotiation came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Outcome {
    /// This side's offer was accepted.
    Agreement(Side),
    /// Nobody's was: the fallback decides.
    NoAgreement,
}

impl Outcome {
    /// The side whose offer was accepted, if any.
    #[must_use]
    pub const fn winner(self) -> Option<Side> {
        match self {
            Self::Agreement(side) => Some(side),
            Self::NoAgreement => None,
        }
    }

    /// `current`, `interrupting` or `no-agreement`, as in the published logs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Agreement(side) => side.name(),
            Self::NoAgreement => "no-agreement",
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Why a negotiation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Ending {
    /// The receiver accepted, and nothing stood against it.
    Accepted,
    /// The held offer won, because the offer of the same depth in reply was rejected.
    HeldOfferStands,
    /// Each would accept the other's offer of this depth, and the tie rule decided.
    Tie,
    /// Both users ran out of offers.
    BothQuit,
    /// This side ended it by the literal quit rule.
    LiteralQuit(Side),
}

impl Ending {
    /// `accepted`, `held-offer-stands`, `tie`, `both-quit` or `literal-quit`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::HeldOfferStands => "held-offer-stands",
            Self::Tie => "tie",
            Self::BothQuit => "both-quit",
            Self::LiteralQuit(_) => "literal-quit",
        }
    }
}

/// A negotiation's result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conclusion {
    /// Whose offer was accepted, if any.
    pub outcome: Outcome,
    /// How many rounds it took; quits count.
    pub rounds: u32,
    /// Why it ended.
    pub ending: Ending,
}
