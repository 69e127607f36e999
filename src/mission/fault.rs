//! Deliberate faults, so that the checks can be seen to fail. A mission outside this crate's
//! own tests has none, and no way to get one.

/// One rule taken out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Fault {
    /// Who loses precedence is not wiped, as in the published system.
    KeepLosersData,
    /// The goal that loses precedence is not stopped.
    LeaveGoalRunning,
    /// A request whose data do not arrive is dropped without a word.
    ForgetOnTimeout,
    /// A request is dropped that comes while another user's data are awaited, as in the
    /// published system.
    DropSecondInterruption,
    /// A user without conditions is waited for in silence, as in the published system.
    HangWithoutConditions,
    /// Data are taken whenever they arrive, as in the published system.
    TakeLateData,
    /// Components are given back without having been cleaned up.
    SkipCleanup,
    /// A claimed emergency is believed.
    BelieveClaims,
}

/// The faults of one mission: at most one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Faults {
    #[cfg(test)]
    pub(super) present: Option<Fault>,
}

impl Faults {
    #[cfg(test)]
    pub(super) fn has(self, fault: Fault) -> bool {
        self.present == Some(fault)
    }

    #[cfg(not(test))]
    #[expect(clippy::unused_self, reason = "the tests' counterpart looks at it")]
    pub(super) const fn has(self, _: Fault) -> bool {
        false
    }
}
