//! The *negotiation manager*: which bilateral negotiation is under way, what the others came
//! to, and whom they all give precedence.

mod agenda;
mod engine;
mod impact_analyzer;
mod offer_generator;
mod utility;

use selfneg_core::{Fallback, Outcome, Side};
use zeroize::Zeroize;

use super::event::UserId;
use super::lifecycle::Lifecycle;
use super::memory::{Cell, Cells, nonzero};
use super::specification::MissionRules;
use super::user_managers::UserManagers;
use crate::precedence::Policy;
use agenda::Agenda;
pub(super) use engine::{EngineError, Pair, next_round};
pub(super) use impact_analyzer::EthicalImpactAnalyzer;
pub(super) use offer_generator::OfferGenerator;

/// The bilateral negotiations of one decision.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct NegotiationManager {
    pub(super) lifecycle: Lifecycle,
    /// The one under way.
    pub(super) pair: Option<Pair>,
    /// Those that are over.
    settled: Cells<Settled>,
    /// The current user's, as it was when the first negotiation began.
    pub(super) willingness: u8,
}

/// How two users' negotiation ended.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
struct Settled {
    /// 0: nothing settled; 1: no agreement; 2: for the current side; 3: for the
    /// interrupting side.
    outcome: u8,
    current: u32,
    interrupting: u32,
    rounds: u32,
}

impl Settled {
    fn outcome(&self) -> Outcome {
        match self.outcome {
            2 => Outcome::Agreement(Side::Current),
            3 => Outcome::Agreement(Side::Interrupting),
            _ => Outcome::NoAgreement,
        }
    }
}

impl Cell for Settled {
    fn vacant() -> Self {
        Self { outcome: 0, current: 0, interrupting: 0, rounds: 0 }
    }

    fn wipe(&mut self) {
        self.outcome.zeroize();
        self.current.zeroize();
        self.interrupting.zeroize();
        self.rounds.zeroize();
    }

    fn residue(&self) -> usize {
        [
            nonzero(&[self.outcome]),
            nonzero(&self.current.to_ne_bytes()),
            nonzero(&self.interrupting.to_ne_bytes()),
            nonzero(&self.rounds.to_ne_bytes()),
        ]
        .into_iter()
        .sum()
    }

    #[cfg(test)]
    fn bytes(&self, into: &mut Vec<u8>) {
        into.push(self.outcome);
        into.extend(self.current.to_ne_bytes());
        into.extend(self.interrupting.to_ne_bytes());
        into.extend(self.rounds.to_ne_bytes());
    }
}

/// What is to happen next in a decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// These two negotiate; the first is on the current side.
    Negotiate(UserId, UserId),
    /// It is decided.
    Decided { policy: Policy, agreement: Option<UserId>, served: UserId, rounds: u32 },
}

impl NegotiationManager {
    pub(super) fn new(rules: &MissionRules) -> Self {
        let users = usize::from(rules.limits().users);
        Self {
            lifecycle: Lifecycle::Unconfigured,
            pair: None,
            settled: Cells::new(users.saturating_mul(users)),
            willingness: 0,
        }
    }

    /// Whether a decision is being prepared or made.
    pub(super) fn is_open(&self) -> bool {
        matches!(self.lifecycle, Lifecycle::Inactive | Lifecycle::Active)
    }

    /// Notes how the negotiation under way ended.
    pub(super) fn settle(&mut self, pair: Pair, outcome: Outcome) {
        self.pair = None;
        if let Some(cell) = self.settled.all_mut().iter_mut().find(|cell| cell.outcome == 0) {
            *cell = Settled {
                outcome: match outcome {
                    Outcome::NoAgreement => 1,
                    Outcome::Agreement(Side::Current) => 2,
                    Outcome::Agreement(Side::Interrupting) => 3,
                },
                current: pair.current.0,
                interrupting: pair.interrupting.0,
                rounds: pair.rounds,
            };
        }
    }

    /// A user takes no part any more: what was settled with them goes. True if the
    /// negotiation under way was with them, and is broken off.
    pub(super) fn leave(&mut self, user: UserId) -> bool {
        for cell in self.settled.all_mut() {
            if cell.outcome != 0 && (cell.current == user.0 || cell.interrupting == user.0) {
                cell.wipe();
            }
        }
        let with = |pair: &Pair| pair.current == user || pair.interrupting == user;
        let broken_off = self.pair.as_ref().is_some_and(with);
        if broken_off {
            self.pair = None;
        }
        broken_off
    }

    /// Everything of the decision goes.
    pub(super) fn clear(&mut self) {
        self.pair = None;
        self.settled.wipe();
        self.willingness.zeroize();
    }

    /// What the policy wants next among `participants`, by arrival, the current user first.
    pub(super) fn next(
        &self,
        participants: &[UserId],
        managers: &[&UserManagers],
        rules: &MissionRules,
    ) -> Result<Option<Next>, EngineError> {
        let policy = agenda::policy_for(rules.policy, participants.len());
        let outcome = |earlier: usize, later: usize| {
            let (earlier, later) = (participants.get(earlier)?, participants.get(later)?);
            self.settled
                .all()
                .iter()
                .find(|cell| cell.outcome != 0 && cell.current == earlier.0 && cell.interrupting == later.0)
                .map(Settled::outcome)
        };
        let (agreement, served) = match agenda::agenda(policy, participants.len(), outcome) {
            Agenda::Next(earlier, later) => {
                let two = participants.get(earlier).zip(participants.get(later));
                return Ok(two.map(|(&earlier, &later)| Next::Negotiate(earlier, later)));
            }
            Agenda::Agreement(winner) => (participants.get(winner).copied(), Some(winner)),
            Agenda::NoAgreement(candidates) => match rules.options.fallback {
                Fallback::FirstCome => (None, candidates.first().copied()),
                Fallback::Utilitarian => (None, utility::best_served(&candidates, managers, rules)?),
            },
        };
        let rounds = self.settled.all().iter().map(|cell| cell.rounds).sum();
        let served = served.and_then(|served| participants.get(served)).copied();
        Ok(served.map(|served| Next::Decided { policy, agreement, served, rounds }))
    }

    pub(super) fn residue(&self) -> usize {
        let pair = usize::from(self.pair.is_some());
        self.settled.residue().saturating_add(pair).saturating_add(usize::from(self.willingness))
    }
}
