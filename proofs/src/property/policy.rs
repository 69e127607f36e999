//! The published policy for three users: properties of whom it serves, given who wins the
//! three bilateral negotiations.

use selfneg_core::Outcome;
use selfneg_core::policy::{Arrival, Pairing, published};

use super::Judgement;

/// The outcomes of the three negotiations, in which the earlier arrival is current.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bilateral {
    /// A current, B interrupting.
    pub ab: Outcome,
    /// A current, C interrupting.
    pub ac: Outcome,
    /// B current, C interrupting.
    pub bc: Outcome,
}

impl Bilateral {
    /// The outcome of one of them.
    #[must_use]
    pub const fn of(self, pairing: Pairing) -> Outcome {
        match pairing {
            Pairing::AB => self.ab,
            Pairing::AC => self.ac,
            Pairing::BC => self.bc,
        }
    }

    /// Whether `winner` beats `loser`.
    #[must_use]
    pub fn beats(self, winner: Arrival, loser: Arrival) -> bool {
        let pairing = match (winner, loser) {
            (Arrival::A, Arrival::B) | (Arrival::B, Arrival::A) => Pairing::AB,
            (Arrival::A, Arrival::C) | (Arrival::C, Arrival::A) => Pairing::AC,
            (Arrival::B, Arrival::C) | (Arrival::C, Arrival::B) => Pairing::BC,
            (Arrival::A, Arrival::A) | (Arrival::B, Arrival::B) | (Arrival::C, Arrival::C) => return false,
        };
        pairing.winner(self.of(pairing)) == Some(winner)
    }
}

/// A way to choose among three users from the three outcomes; `None` is no agreement.
pub trait Policy {
    /// The choice.
    fn choose(&self, outcomes: Bilateral) -> Option<Arrival>;
}

/// `selfneg_core::policy::published`.
#[derive(Clone, Copy, Debug)]
pub struct Published;

impl Policy for Published {
    fn choose(&self, outcomes: Bilateral) -> Option<Arrival> {
        published(|pairing| outcomes.of(pairing))
    }
}

const USERS: [Arrival; 3] = [Arrival::A, Arrival::B, Arrival::C];

/// A property of a policy for three users.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PolicyProperty {
    /// See [`statement`](Self::statement).
    CondorcetConsistency,
    /// See [`statement`](Self::statement).
    UnbeatenService,
    /// See [`statement`](Self::statement).
    AgreementHasCause,
}

impl PolicyProperty {
    /// Every property, in the order of the tables.
    pub const ALL: &'static [Self] =
        &[Self::CondorcetConsistency, Self::UnbeatenService, Self::AgreementHasCause];

    /// Its name in tables and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::CondorcetConsistency => "condorcet-consistency",
            Self::UnbeatenService => "unbeaten-service",
            Self::AgreementHasCause => "agreement-has-cause",
        }
    }

    /// What it says, in one sentence.
    #[must_use]
    pub const fn statement(self) -> &'static str {
        match self {
            Self::CondorcetConsistency => {
                "A user who beats both others in their bilateral negotiations is the agreed winner."
            }
            Self::UnbeatenService => "Nobody beats the agreed winner in a bilateral negotiation.",
            Self::AgreementHasCause => "The agreed winner beats somebody in a bilateral negotiation.",
        }
    }

    /// Which triples of outcomes say nothing about it.
    #[must_use]
    pub const fn vacuous(self) -> &'static str {
        match self {
            Self::CondorcetConsistency => "nobody beats both others",
            Self::UnbeatenService | Self::AgreementHasCause => "no agreement",
        }
    }

    /// What a triple of outcomes says of it.
    pub fn check<P: Policy>(self, policy: &P, outcomes: Bilateral) -> Judgement {
        let chosen = policy.choose(outcomes);
        let beats_both = |user| USERS.iter().all(|&other| other == user || outcomes.beats(user, other));
        match (self, chosen) {
            (Self::CondorcetConsistency, _) => match USERS.iter().copied().find(|&user| beats_both(user)) {
                Some(user) => Judgement::from_bool(chosen == Some(user)),
                None => Judgement::Vacuous,
            },
            (Self::UnbeatenService | Self::AgreementHasCause, None) => Judgement::Vacuous,
            (Self::UnbeatenService, Some(user)) => {
                Judgement::from_bool(!USERS.iter().any(|&other| outcomes.beats(other, user)))
            }
            (Self::AgreementHasCause, Some(user)) => {
                Judgement::from_bool(USERS.iter().any(|&other| outcomes.beats(user, other)))
            }
        }
    }
}

impl std::fmt::Display for PolicyProperty {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}
