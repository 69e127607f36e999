//! The *offer generator* of one user: a snapshot of what the user can offer.
//!
//! The offers themselves are made by [`Party::offer`](selfneg_core::Party::offer), one
//! condition at a time, from this snapshot.

use selfneg_core::{Condition, Implication, Status, TooManyConditions};
use zeroize::Zeroize;

use super::super::context_ethics::ContextEthicsManager;
use super::super::event::GoalId;
use super::super::lifecycle::Lifecycle;
use super::super::memory::{Cells, nonzero};
use super::super::specification::MissionRules;

/// The user's true conditions and goal as they were when the negotiation began.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(in super::super) struct OfferGenerator {
    pub(in super::super) lifecycle: Lifecycle,
    conditions: Cells<Condition>,
    length: usize,
    goal: u16,
    /// 0: the general implication; n: the one of the goal's n-th context, from 1.
    in_context: usize,
}

impl OfferGenerator {
    pub(in super::super) fn new(rules: &MissionRules) -> Self {
        let most = usize::from(rules.limits().conditions).saturating_add(rules.inferred().len());
        Self {
            lifecycle: Lifecycle::Unconfigured,
            conditions: Cells::new(most),
            length: 0,
            goal: 0,
            in_context: 0,
        }
    }

    /// Takes the snapshot.
    pub(in super::super) fn snapshot(
        &mut self,
        user: &ContextEthicsManager,
        goal: GoalId,
        rules: &MissionRules,
    ) {
        self.wipe();
        self.goal = goal.0;
        self.in_context = user.goal_context(goal, rules).map_or(0, |nth| nth.saturating_add(1));
        for (slot, condition) in self.conditions.all_mut().iter_mut().zip(user.true_conditions(rules)) {
            *slot = condition;
            self.length = self.length.saturating_add(1);
        }
    }

    pub(super) fn status(&self) -> Result<Status<'_>, TooManyConditions> {
        Status::new(self.conditions.first(self.length))
    }

    pub(super) fn implication<'a>(&self, rules: &'a MissionRules) -> Implication<'a> {
        rules.implication(GoalId(self.goal), self.in_context.checked_sub(1))
    }

    pub(in super::super) fn has_conditions(&self) -> bool {
        self.length > 0
    }

    pub(in super::super) fn wipe(&mut self) {
        self.conditions.wipe();
        self.length.zeroize();
        self.goal.zeroize();
        self.in_context.zeroize();
    }

    pub(in super::super) fn residue(&self) -> usize {
        [
            self.conditions.residue(),
            nonzero(&self.length.to_ne_bytes()),
            nonzero(&self.goal.to_ne_bytes()),
            nonzero(&self.in_context.to_ne_bytes()),
        ]
        .into_iter()
        .sum()
    }

    #[cfg(test)]
    pub(in super::super) fn bytes(&self, into: &mut Vec<u8>) {
        self.conditions.bytes(into);
        into.extend(self.length.to_ne_bytes());
        into.extend(self.goal.to_ne_bytes());
        into.extend(self.in_context.to_ne_bytes());
    }
}
