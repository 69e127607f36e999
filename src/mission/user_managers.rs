//! The components that each user has one of, in one place and apart from other users'.

use super::context_ethics::ContextEthicsManager;
use super::event::UserId;
use super::negotiation::{EthicalImpactAnalyzer, OfferGenerator};
use super::specification::MissionRules;

/// One user's components.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct UserManagers {
    /// Whose they are; nobody's while unconfigured.
    pub(super) user: Option<UserId>,
    pub(super) context: ContextEthicsManager,
    pub(super) offers: OfferGenerator,
    pub(super) impact: EthicalImpactAnalyzer,
}

impl UserManagers {
    pub(super) fn new(rules: &MissionRules) -> Self {
        Self {
            user: None,
            context: ContextEthicsManager::new(rules),
            offers: OfferGenerator::new(rules),
            impact: EthicalImpactAnalyzer::new(rules),
        }
    }

    pub(super) fn residue(&self) -> usize {
        [
            usize::from(self.user.is_some()),
            self.context.residue(),
            self.offers.residue(),
            self.impact.residue(),
        ]
        .into_iter()
        .sum()
    }

    /// All memory for user data, byte by byte.
    #[cfg(test)]
    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.context.bytes(&mut bytes);
        self.offers.bytes(&mut bytes);
        self.impact.bytes(&mut bytes);
        bytes
    }
}
