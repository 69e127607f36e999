//! *Executor*: puts the plan into effect in the manager's memory.

use super::super::event::UserId;
use super::super::record::Record;
use super::super::specification::MissionRules;
use super::memory::UserMemory;
use super::planner::Plan;

/// Activates the profile and the inferred conditions, and tells what has changed.
pub(super) fn execute(
    memory: &mut UserMemory,
    plan: Plan,
    user: UserId,
    rules: &MissionRules,
    mut tell: impl FnMut(Record),
) {
    if plan.kept {
        tell(Record::ProfileKept { user });
    } else if memory.active != plan.activate {
        tell(Record::ProfileActivated { user, profile: plan.activate });
    }
    memory.active = plan.activate;
    let changed = memory.inferred ^ plan.inferred;
    for rule in 0..rules.inferred().len() {
        let bit = u32::try_from(rule).ok().and_then(|nth| 1_u64.checked_shl(nth)).unwrap_or(0);
        if changed & bit != 0 {
            tell(Record::Inferred { user, rule, holds: plan.inferred & bit != 0 });
        }
    }
    memory.inferred = plan.inferred;
}
