//! The *context and ethics manager* of one user: a MAPE loop over the user's own data.

mod analyzer;
mod executor;
mod memory;
mod monitor;
mod planner;

use selfneg_core::{Condition, Rank};

use super::event::{GoalId, UserId};
use super::lifecycle::Lifecycle;
use super::record::{ActiveProfile, Record, Unusable};
use super::specification::MissionRules;
use memory::{Statement, UserMemory};
pub(super) use monitor::Update;

/// One user's data, apart from everybody else's.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct ContextEthicsManager {
    pub(super) lifecycle: Lifecycle,
    memory: UserMemory,
}

impl ContextEthicsManager {
    pub(super) fn new(rules: &MissionRules) -> Self {
        Self { lifecycle: Lifecycle::Unconfigured, memory: UserMemory::new(rules) }
    }

    /// Monitors, analyzes, plans and executes. On an error the memory may hold a part of the
    /// update.
    pub(super) fn update(
        &mut self,
        update: Update<'_>,
        user: UserId,
        rules: &MissionRules,
        tell: impl FnMut(Record),
    ) -> Result<(), Unusable> {
        monitor::monitor(&mut self.memory, update, rules)?;
        let analysis = analyzer::analyze(&self.memory, rules);
        let plan = planner::plan(analysis, self.memory.active)?;
        executor::execute(&mut self.memory, plan, user, rules, tell);
        Ok(())
    }

    /// The ranks of the active profile, one for each disposition.
    pub(super) fn active_ranks<'a>(&'a self, rules: &'a MissionRules) -> &'a [Rank] {
        let dispositions = rules.bound().dispositions();
        match self.memory.active {
            ActiveProfile::None => &[],
            ActiveProfile::Own(nth) => {
                let from = usize::from(nth).saturating_mul(dispositions);
                self.memory.ranks.all().get(from..from.saturating_add(dispositions)).unwrap_or(&[])
            }
            ActiveProfile::Normative(nth) => {
                rules.normative().get(usize::from(nth)).map_or(&[], |(_, ranks)| ranks)
            }
        }
    }

    /// The true conditions: those that the user states, in order of disclosure, then the
    /// inferred ones in the order of the rules, each once.
    pub(super) fn true_conditions<'a>(
        &'a self,
        rules: &'a MissionRules,
    ) -> impl Iterator<Item = Condition> + 'a {
        let stated = self.memory.status.all().iter().filter(|statement| statement.is_true());
        let holds = |nth: usize| {
            let bit = u32::try_from(nth).ok().and_then(|nth| 1_u64.checked_shl(nth)).unwrap_or(0);
            self.memory.inferred & bit != 0
        };
        let inferred = rules.inferred().iter().enumerate().filter(move |(nth, condition)| {
            let earlier = rules.inferred().iter().take(*nth).enumerate();
            holds(*nth) && !earlier.into_iter().any(|(e, same)| holds(e) && same == *condition)
        });
        stated.map(|Statement { condition, .. }| Condition(*condition)).chain(inferred.map(|(_, c)| *c))
    }

    /// The name of a condition that the rules do not list.
    pub(super) fn unlisted_name(&self, condition: Condition) -> Option<&str> {
        self.memory.unlisted_name(condition.0)
    }

    /// Which of the goal's implications in particular contexts applies to this user.
    pub(super) fn goal_context(&self, goal: GoalId, rules: &MissionRules) -> Option<usize> {
        rules.contexts_of(goal).iter().position(|case| self.memory.is(&case.attribute, &case.value))
    }

    pub(super) fn wipe(&mut self) {
        self.memory.wipe();
    }

    pub(super) fn residue(&self) -> usize {
        self.memory.residue()
    }

    #[cfg(test)]
    pub(super) fn bytes(&self, into: &mut Vec<u8>) {
        self.memory.bytes(into);
    }
}
