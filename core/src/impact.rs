//! The ethical impact of an offer in one user's eyes (the paper's *ethical impact
//! analyzer* and *utility function*).

use core::fmt;

use crate::options::Aggregation;
use crate::rules::{Activation, Condition, Disposition, Implication};
use crate::user::EthicalProfile;

/// A sum of ranks. It cannot overflow: at most 65,535 conditions, each with at most
/// 65,535 dispositions, each mentioned at most 255 times with a rank of at most 255,
/// stay below 2^48.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Impact(pub u64);

impl Impact {
    pub(crate) fn plus(self, more: Impact) -> Impact {
        Impact(self.0.saturating_add(more.0))
    }
}

impl fmt::Display for Impact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// What a goal together with some disclosed conditions affects: the content of an offer,
/// free of who made it.
#[derive(Clone, Copy)]
pub(crate) struct Disclosed<'a> {
    pub(crate) goal: Implication<'a>,
    pub(crate) conditions: &'a [Condition],
}

impl Disclosed<'_> {
    pub(crate) const NOTHING: Disclosed<'static> = Disclosed { goal: Implication::new(&[]), conditions: &[] };

    /// Whether `earlier` is a prefix of this by construction: the same memory, not
    /// longer. It may say no of an equal prefix elsewhere; its yes is certain.
    pub(crate) fn continues(self, earlier: Disclosed<'_>) -> bool {
        core::ptr::eq(self.conditions.as_ptr(), earlier.conditions.as_ptr())
            && earlier.conditions.len() <= self.conditions.len()
            && self.goal.is_same(earlier.goal)
    }

    /// `EI_r(o)`: the ranks in `eyes`, summed over what is disclosed.
    pub(crate) fn impact(
        self,
        eyes: EthicalProfile<'_>,
        activation: Activation<'_>,
        aggregation: Aggregation,
    ) -> Impact {
        self.impact_beyond(0, eyes, activation, aggregation)
    }

    /// The part of [`impact`](Self::impact) that the conditions from index `heard` on
    /// add to the ones before: a receiver who has heard a prefix weighs only what is new.
    pub(crate) fn impact_beyond(
        self,
        heard: usize,
        eyes: EthicalProfile<'_>,
        activation: Activation<'_>,
        aggregation: Aggregation,
    ) -> Impact {
        let mut total = Impact::default();
        let mut next = heard;
        while let Some(&condition) = self.conditions.get(next) {
            let row = activation.of(condition);
            let mut d = 0;
            while let Some(&disposition) = row.get(d) {
                let mentions = u64::from(self.goal.mentions(disposition));
                let counted = match aggregation {
                    Aggregation::PerCondition => mentions,
                    Aggregation::PerDisposition => {
                        if mentions > 0 && !self.activated_before(next, disposition, activation) {
                            1
                        } else {
                            0
                        }
                    }
                };
                total = total.plus(Impact(eyes.rank(disposition).saturating_mul(counted)));
                d = d.saturating_add(1);
            }
            next = next.saturating_add(1);
        }
        total
    }

    /// Whether a condition before index `end` activates `disposition` already.
    fn activated_before(self, end: usize, disposition: Disposition, activation: Activation<'_>) -> bool {
        let mut i = 0;
        while i < end {
            match self.conditions.get(i) {
                Some(&earlier) if activation.activates(earlier, disposition) => return true,
                Some(_) => i = i.saturating_add(1),
                None => return false,
            }
        }
        false
    }
}
