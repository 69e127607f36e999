//! What an audit comes to.

use std::fmt;

use serde::Serialize;

/// What was found out about a trace, the worst first. Of several the worst is the trace's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Not a trace, or one of a newer format.
    Unreadable,
    /// What is there is not what was written.
    Tampered,
    /// A decision, or a round of it, is not what rules, options and inputs lead to.
    WrongDecision,
    /// A property does not hold that every run has.
    Violation,
    /// The end is missing; what is intact was audited.
    Truncated,
    /// Signed, but no robot key was given, or another key signed.
    Untrusted,
    /// Not signed, or with personal data in the open.
    Unsealed,
    /// Personal data are erased, left out, or locked for the identity given.
    Incomplete,
    /// Nothing is wrong with it.
    Ok,
}

impl Status {
    /// All of them, the worst first.
    pub const ALL: [Self; 9] = [
        Self::Unreadable,
        Self::Tampered,
        Self::WrongDecision,
        Self::Violation,
        Self::Truncated,
        Self::Untrusted,
        Self::Unsealed,
        Self::Incomplete,
        Self::Ok,
    ];

    /// The name in reports and JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unreadable => "unreadable",
            Self::Tampered => "tampered",
            Self::WrongDecision => "wrong-decision",
            Self::Violation => "violation",
            Self::Truncated => "truncated",
            Self::Untrusted => "untrusted",
            Self::Unsealed => "unsealed",
            Self::Incomplete => "incomplete",
            Self::Ok => "ok",
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
