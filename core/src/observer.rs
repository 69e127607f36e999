//! What can be seen of a negotiation while it runs.

use core::num::NonZeroU64;

use crate::impact::Impact;
use crate::outcome::{Conclusion, Side};
use crate::rules::Condition;

/// What the newest offer discloses beyond the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Disclosure {
    /// One more true condition.
    Condition(Condition),
    /// The current user's willingness to be interrupted: it means nothing to anyone
    /// else.
    Willingness,
}

/// What a receiver weighs: two totals of its own ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Weighing {
    /// EI of the offer in the receiver's eyes.
    pub value: Impact,
    /// EI of the receiver's own complete offer in its own eyes.
    pub threshold: Impact,
}

impl Weighing {
    /// The receiver's utility of the offer, if positive: it accepts exactly then.
    #[must_use]
    pub fn surplus(self) -> Option<Surplus> {
        NonZeroU64::new(self.value.0.saturating_sub(self.threshold.0)).map(Surplus)
    }
}

/// By how much an acceptable offer exceeds the receiver's own complete offer, in the
/// receiver's eyes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Surplus(pub NonZeroU64);

/// What the receiver's verdict does to the offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Ruling {
    /// Acceptable to the receiver.
    Accept,
    /// Not acceptable.
    Reject,
    /// Acceptable, but held until the receiver has made its own offer of this depth.
    Hold,
}

impl Ruling {
    /// `accept`, `reject` or `hold`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Accept => "accept",
            Self::Reject => "reject",
            Self::Hold => "hold",
        }
    }
}

/// Watches a negotiation round by round. A round is either `offer`, `weighed`, `ruled`,
/// in this order, or `quit`. The unit type watches nothing and costs nothing.
pub trait Observer {
    /// The sender of round `round` (from 1) discloses one more condition, its
    /// `depth`-th.
    fn offer(&mut self, round: u32, sender: Side, depth: usize, discloses: Disclosure) {
        let _ = (round, sender, depth, discloses);
    }

    /// The receiver weighs that offer. Told by the receiver itself: these totals are its
    /// own, and no value that the engine or the sender gets holds them.
    fn weighed(&mut self, receiver: Side, weighing: Weighing) {
        let _ = (receiver, weighing);
    }

    /// What becomes of that offer.
    fn ruled(&mut self, receiver: Side, ruling: Ruling) {
        let _ = (receiver, ruling);
    }

    /// The sender of round `round` has no further offer and quits.
    fn quit(&mut self, round: u32, sender: Side) {
        let _ = (round, sender);
    }

    /// The negotiation is over.
    fn concluded(&mut self, conclusion: Conclusion) {
        let _ = conclusion;
    }
}

impl Observer for () {}

impl<O: Observer + ?Sized> Observer for &mut O {
    fn offer(&mut self, round: u32, sender: Side, depth: usize, discloses: Disclosure) {
        (**self).offer(round, sender, depth, discloses);
    }
    fn weighed(&mut self, receiver: Side, weighing: Weighing) {
        (**self).weighed(receiver, weighing);
    }
    fn ruled(&mut self, receiver: Side, ruling: Ruling) {
        (**self).ruled(receiver, ruling);
    }
    fn quit(&mut self, round: u32, sender: Side) {
        (**self).quit(round, sender);
    }
    fn concluded(&mut self, conclusion: Conclusion) {
        (**self).concluded(conclusion);
    }
}
