//! The *ethical impact analyzer* of one user: a snapshot of the profile through which the
//! user's side weighs offers.
//!
//! The weighing is [`Party::judge`](selfneg_core::Party::judge), on this snapshot.

use selfneg_core::{EthicalProfile, Rank};

use super::super::context_ethics::ContextEthicsManager;
use super::super::lifecycle::Lifecycle;
use super::super::memory::Cells;
use super::super::specification::MissionRules;

/// The user's ranks in the context as it was when the negotiation began.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(in super::super) struct EthicalImpactAnalyzer {
    pub(in super::super) lifecycle: Lifecycle,
    ranks: Cells<Rank>,
}

impl EthicalImpactAnalyzer {
    pub(in super::super) fn new(rules: &MissionRules) -> Self {
        Self { lifecycle: Lifecycle::Unconfigured, ranks: Cells::new(rules.bound().dispositions()) }
    }

    /// Takes the snapshot.
    pub(in super::super) fn snapshot(&mut self, user: &ContextEthicsManager, rules: &MissionRules) {
        self.wipe();
        for (slot, rank) in self.ranks.all_mut().iter_mut().zip(user.active_ranks(rules)) {
            *slot = *rank;
        }
    }

    pub(super) fn profile(&self) -> EthicalProfile<'_> {
        EthicalProfile::new(self.ranks.all())
    }

    pub(in super::super) fn wipe(&mut self) {
        self.ranks.wipe();
    }

    pub(in super::super) fn residue(&self) -> usize {
        self.ranks.residue()
    }

    #[cfg(test)]
    pub(in super::super) fn bytes(&self, into: &mut Vec<u8>) {
        self.ranks.bytes(into);
    }
}
