//! A negotiation as it was observed, round by round.

use selfneg_core::{Conclusion, Disclosure, Observer, Ruling, Side, Weighing};

/// One round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Round {
    /// From 1.
    pub number: u32,
    /// Whose turn it was.
    pub sender: Side,
    /// What happened.
    pub event: Event,
}

/// What happened in a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The sender disclosed one more condition.
    Offer {
        /// How many it has disclosed now.
        depth: usize,
        /// The new one.
        discloses: Disclosure,
        /// The receiver's own two totals.
        weighing: Weighing,
        /// What became of the offer.
        ruling: Ruling,
    },
    /// The sender had no further offer.
    Quit,
}

/// An [`Observer`] that keeps all rounds.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    /// The rounds so far.
    pub rounds: Vec<Round>,
    open: Option<OpenOffer>,
}

/// An offer whose ruling is still to come.
#[derive(Clone, Copy, Debug)]
struct OpenOffer {
    number: u32,
    sender: Side,
    depth: usize,
    discloses: Disclosure,
    weighing: Option<Weighing>,
}

impl Observer for Recorder {
    fn offer(&mut self, round: u32, sender: Side, depth: usize, discloses: Disclosure) {
        self.open = Some(OpenOffer { number: round, sender, depth, discloses, weighing: None });
    }

    fn weighed(&mut self, _receiver: Side, weighing: Weighing) {
        if let Some(open) = &mut self.open {
            open.weighing = Some(weighing);
        }
    }

    fn ruled(&mut self, _receiver: Side, ruling: Ruling) {
        if let Some(OpenOffer { number, sender, depth, discloses, weighing: Some(weighing) }) =
            self.open.take()
        {
            let event = Event::Offer { depth, discloses, weighing, ruling };
            self.rounds.push(Round { number, sender, event });
        }
    }

    fn quit(&mut self, round: u32, sender: Side) {
        self.rounds.push(Round { number: round, sender, event: Event::Quit });
    }

    fn concluded(&mut self, _conclusion: Conclusion) {}
}
