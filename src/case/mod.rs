//! A trace's decisions, each as a case that can be decided again on its own.
//!
//! [`Docket::of`] reads off what is recorded of every decision, from the open records alone
//! where the personal part is missing. [`Recording::cases`] adds, where it can, what the
//! mission's memory held of everybody who took part; [`Inputs::decide`] then decides the same
//! case without a mission: by [`precedence::decide`](crate::precedence::decide), in one go.
//!
//! ```no_run
//! use selfneg::case::Case;
//! use selfneg::trace::Recording;
//!
//! let recording = Recording::read(&std::fs::read("trace.mcap")?)?;
//! for case in recording.cases() {
//!     if let Case::Negotiated(case) = &case
//!         && let Ok(inputs) = &case.inputs
//!     {
//!         let decision = inputs.decide()?;
//!         let same = case.recorded.served_place() == Some(decision.served);
//!         println!("decision {}: {}", case.recorded.decision, if same { "same" } else { "differs" });
//!     }
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod docket;
mod inputs;
mod recorded;

pub use docket::Docket;
pub use inputs::{CaseError, Inputs};
pub(crate) use inputs::{policy_for, rules_to_run};
pub use recorded::{
    RecordedDecision, RecordedEmergency, RecordedEnd, RecordedEvent, RecordedNegotiation, RecordedRound,
    Worth, options_in,
};

use crate::trace::Recording;

/// One decision of a trace.
#[derive(Clone, Debug)]
pub enum Case {
    /// Users negotiated.
    Negotiated(Box<NegotiatedCase>),
    /// An emergency was found certain.
    Emergency(RecordedEmergency),
}

/// A decision among users, with what it takes to make it again.
#[derive(Clone, Debug)]
pub struct NegotiatedCase {
    /// What is recorded of it.
    pub recorded: RecordedDecision,
    /// What it was made from; an error if some of it is not in the trace, or not any more.
    pub inputs: Result<Inputs, CaseError>,
}

impl Case {
    /// Its number among all decisions of the trace, from 1.
    #[must_use]
    pub fn decision(&self) -> u64 {
        match self {
            Self::Negotiated(case) => case.recorded.decision,
            Self::Emergency(emergency) => emergency.decision,
        }
    }
}

impl Recording {
    /// Every decision, in the order in which they were made, emergencies included.
    #[must_use]
    pub fn cases(&self) -> Vec<Case> {
        let Docket { decisions, emergencies, .. } = Docket::of(self);
        let inputs = inputs::of_decisions(self, &decisions);
        let mut cases: Vec<Case> = decisions
            .into_iter()
            .zip(inputs)
            .map(|(recorded, inputs)| Case::Negotiated(Box::new(NegotiatedCase { recorded, inputs })))
            .chain(emergencies.into_iter().map(Case::Emergency))
            .collect();
        cases.sort_by_key(Case::decision);
        cases
    }
}
