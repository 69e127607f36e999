//! *Planner*: which profile to activate.

use super::super::record::{ActiveProfile, Unusable};
use super::analyzer::Analysis;

/// What the executor is to do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    pub(super) activate: ActiveProfile,
    /// The context has no profile, so the active one stays.
    pub(super) kept: bool,
    pub(super) inferred: u64,
}

/// The user's own profile for the context. Users who gave none at all get the normative
/// default; whoever gave profiles, but none for this context, is not given the robot's
/// values instead: at the start that makes the data unusable, later the active profile
/// stays.
pub(super) fn plan(analysis: Analysis, active: ActiveProfile) -> Result<Plan, Unusable> {
    let found = match (analysis.own, analysis.normative) {
        (Some(own), _) => Some(ActiveProfile::Own(own)),
        (None, Some(normative)) if analysis.gave_no_profile => Some(ActiveProfile::Normative(normative)),
        (None, _) => None,
    };
    let inferred = analysis.inferred;
    match (found, active) {
        (Some(activate), _) => Ok(Plan { activate, kept: false, inferred }),
        (None, ActiveProfile::None) if analysis.has_location => Err(Unusable::UnknownContext),
        (None, ActiveProfile::None) => Err(Unusable::NoLocation),
        (None, active) => Ok(Plan { activate: active, kept: true, inferred }),
    }
}
