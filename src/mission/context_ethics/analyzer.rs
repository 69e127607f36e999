//! *Analyzer*: what the noted data mean: which profiles are for this context, and which
//! conditions follow from it.

use super::super::specification::MissionRules;
use super::memory::UserMemory;

/// What the analyzer found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Analysis {
    pub(super) has_location: bool,
    pub(super) gave_no_profile: bool,
    pub(super) own: Option<u16>,
    pub(super) normative: Option<u16>,
    /// One bit for each inference rule that holds. A condition of which the user has said
    /// anything, also that it is withheld, is never inferred.
    pub(super) inferred: u64,
}

/// Looks at the memory of one user.
pub(super) fn analyze(memory: &UserMemory, rules: &MissionRules) -> Analysis {
    let normative = rules.normative().iter().position(|(label, _)| memory.is_at(label));
    let mut inferred = 0_u64;
    let conditions = rules.inferred();
    for (nth, (rule, condition)) in rules.specification.inferences.iter().zip(conditions).enumerate() {
        let holds = memory.is(&rule.attribute, &rule.value) && !memory.has_spoken_of(condition.0);
        if holds {
            inferred |= u32::try_from(nth).ok().and_then(|nth| 1_u64.checked_shl(nth)).unwrap_or(0);
        }
    }
    Analysis {
        has_location: memory.has_location(),
        gave_no_profile: memory.gave_no_profile(),
        own: memory.own_profile(),
        normative: normative.and_then(|at| u16::try_from(at).ok()),
        inferred,
    }
}
