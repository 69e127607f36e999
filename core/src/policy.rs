//! The published policy for two interrupters: who gets precedence among three users,
//! from bilateral outcomes.
//!
//! It can serve a user whom somebody present beats; the policy `condorcet`, which cannot,
//! is for any number of users and lives in `selfneg-model`.

use core::fmt;

use crate::outcome::{Outcome, Side};

/// The three users by arrival: A is being served, B interrupted first, C second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Arrival {
    /// The current user.
    A,
    /// The first interrupter.
    B,
    /// The second interrupter.
    C,
}

/// A negotiation that the policy asks for. The earlier arrival is the current user.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Pairing {
    /// A current, B interrupting.
    AB,
    /// A current, C interrupting.
    AC,
    /// B current, C interrupting.
    BC,
}

impl Pairing {
    /// The user who plays the current side.
    #[must_use]
    pub const fn current(self) -> Arrival {
        match self {
            Self::AB | Self::AC => Arrival::A,
            Self::BC => Arrival::B,
        }
    }

    /// The user who plays the interrupting side.
    #[must_use]
    pub const fn interrupting(self) -> Arrival {
        match self {
            Self::AB => Arrival::B,
            Self::AC | Self::BC => Arrival::C,
        }
    }

    /// Who won, if anybody.
    #[must_use]
    pub const fn winner(self, outcome: Outcome) -> Option<Arrival> {
        match outcome {
            Outcome::Agreement(Side::Current) => Some(self.current()),
            Outcome::Agreement(Side::Interrupting) => Some(self.interrupting()),
            Outcome::NoAgreement => None,
        }
    }
}

impl fmt::Display for Pairing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self)
    }
}

/// The published policy. `negotiate` holds one bilateral negotiation; it is called for
/// [`Pairing::AB`], then [`Pairing::AC`], and for [`Pairing::BC`] only if needed.
/// `None` is no agreement.
pub fn published<F: FnMut(Pairing) -> Outcome>(mut negotiate: F) -> Option<Arrival> {
    let mut winner = |pairing: Pairing| pairing.winner(negotiate(pairing));
    let ab = winner(Pairing::AB);
    let ac = winner(Pairing::AC);
    match (ab, ac) {
        (None, _) => ac,
        (_, None) => ab,
        (Some(Arrival::A), Some(Arrival::A)) => Some(Arrival::A),
        (Some(Arrival::A), Some(beats_a)) | (Some(beats_a), Some(Arrival::A)) => {
            winner(Pairing::BC).filter(|&won| won == beats_a)
        }
        (Some(_), Some(_)) => winner(Pairing::BC),
    }
}
