//! The negotiation engine: a state machine that one steps round by round.
//!
//! It holds the two [`Party`]s and never sees a user: all it can learn is what the wall
//! in [`party`](crate::party) lets through.

use crate::observer::{Observer, Ruling, Surplus};
use crate::options::{Options, QuitRule, TieRule};
use crate::outcome::{Conclusion, Ending, Outcome, Side};
use crate::party::{Current, Interrupting, Party, Role, Verdict};

/// Who sends in the next round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Turn {
    /// This side sends, and after a rejection the other one.
    Alternating(Side),
    /// This side sends for good: the other one has quit.
    Alone(Side),
}

impl Turn {
    /// The sender.
    #[must_use]
    pub const fn sender(self) -> Side {
        match self {
            Self::Alternating(side) | Self::Alone(side) => side,
        }
    }
}

/// A negotiation under way.
///
/// [`step`](Self::step) consumes it and gives back either the negotiation after one more
/// round or its conclusion, so a concluded negotiation cannot go on.
#[derive(Clone)]
pub struct Negotiation<'a> {
    current: Party<'a, Current>,
    interrupting: Party<'a, Interrupting>,
    quit: QuitRule,
    tie: TieRule,
    turn: Turn,
    held: Option<Held>,
    rounds: u32,
}

/// An acceptable offer that waits for the receiver's own offer of the same depth.
#[derive(Clone, Copy)]
struct Held {
    sender: Side,
    surplus: Surplus,
}

/// What one round led to.
#[derive(Clone)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with")]
pub enum Step<'a> {
    /// The negotiation goes on.
    Ongoing(Negotiation<'a>),
    /// It is over.
    Concluded(Conclusion),
}

/// What the sender and the receiver of one round did.
enum Exchange {
    /// The sender had no further offer.
    NothingToOffer,
    /// The receiver judged an offer.
    Judged { verdict: Verdict, receiver_owes_reply: bool, receiver_can_go_deeper: bool },
}

impl<'a> Negotiation<'a> {
    /// The start: nothing is disclosed, and the interrupting user sends first.
    #[must_use]
    pub fn between(
        current: Party<'a, Current>,
        interrupting: Party<'a, Interrupting>,
        options: &Options,
    ) -> Self {
        Self {
            current,
            interrupting,
            quit: options.quit,
            tie: options.tie,
            turn: Turn::Alternating(Side::Interrupting),
            held: None,
            rounds: 0,
        }
    }

    /// One round.
    #[must_use]
    pub fn step<O: Observer>(mut self, observer: &mut O) -> Step<'a> {
        self.rounds = self.rounds.saturating_add(1);
        let exchange = match self.turn.sender() {
            Side::Current => exchange(&mut self.current, &mut self.interrupting, self.rounds, observer),
            Side::Interrupting => exchange(&mut self.interrupting, &mut self.current, self.rounds, observer),
        };
        match exchange {
            Exchange::NothingToOffer => self.after_quit(observer),
            Exchange::Judged { verdict: Verdict::Acceptable(surplus), receiver_owes_reply, .. } => {
                self.after_acceptable(surplus, receiver_owes_reply, observer)
            }
            Exchange::Judged { verdict: Verdict::Rejected, receiver_can_go_deeper, .. } => {
                self.after_rejection(receiver_can_go_deeper, observer)
            }
        }
    }

    /// Plays the negotiation to its end.
    pub fn run<O: Observer>(mut self, observer: &mut O) -> Conclusion {
        loop {
            match self.step(observer) {
                Step::Ongoing(next) => self = next,
                Step::Concluded(conclusion) => return conclusion,
            }
        }
    }

    fn after_quit<O: Observer>(mut self, observer: &mut O) -> Step<'a> {
        let quitter = self.turn.sender();
        match (self.quit, self.turn) {
            (QuitRule::Literal, _) => {
                self.conclude(Outcome::NoAgreement, Ending::LiteralQuit(quitter), observer)
            }
            (QuitRule::Exhausted, Turn::Alone(_)) => {
                self.conclude(Outcome::NoAgreement, Ending::BothQuit, observer)
            }
            (QuitRule::Exhausted, Turn::Alternating(_)) => {
                self.turn = Turn::Alone(quitter.other());
                Step::Ongoing(self)
            }
        }
    }

    fn after_acceptable<O: Observer>(
        mut self,
        surplus: Surplus,
        receiver_owes_reply: bool,
        observer: &mut O,
    ) -> Step<'a> {
        let sender = self.turn.sender();
        let receiver = sender.other();
        if let Some(held) = self.held {
            observer.ruled(receiver, Ruling::Accept);
            let outcome = break_tie(self.tie, held, Held { sender, surplus });
            return self.conclude(outcome, Ending::Tie, observer);
        }
        match self.tie {
            TieRule::Fallback | TieRule::Surplus if receiver_owes_reply => {
                observer.ruled(receiver, Ruling::Hold);
                self.held = Some(Held { sender, surplus });
                self.turn = Turn::Alternating(receiver);
                Step::Ongoing(self)
            }
            TieRule::FirstSender | TieRule::Fallback | TieRule::Surplus => {
                observer.ruled(receiver, Ruling::Accept);
                self.conclude(Outcome::Agreement(sender), Ending::Accepted, observer)
            }
        }
    }

    fn after_rejection<O: Observer>(mut self, receiver_can_go_deeper: bool, observer: &mut O) -> Step<'a> {
        let receiver = self.turn.sender().other();
        observer.ruled(receiver, Ruling::Reject);
        if let Some(held) = self.held {
            return self.conclude(Outcome::Agreement(held.sender), Ending::HeldOfferStands, observer);
        }
        if self.quit == QuitRule::Literal && !receiver_can_go_deeper {
            return self.conclude(Outcome::NoAgreement, Ending::LiteralQuit(receiver), observer);
        }
        if let Turn::Alternating(_) = self.turn {
            self.turn = Turn::Alternating(receiver);
        }
        Step::Ongoing(self)
    }

    fn conclude<O: Observer>(self, outcome: Outcome, ending: Ending, observer: &mut O) -> Step<'a> {
        let conclusion = Conclusion { outcome, rounds: self.rounds, ending };
        observer.concluded(conclusion);
        Step::Concluded(conclusion)
    }

    /// Rounds played so far.
    #[must_use]
    pub fn rounds(&self) -> u32 {
        self.rounds
    }

    /// Who sends in the next round.
    #[must_use]
    pub fn turn(&self) -> Turn {
        self.turn
    }

    /// How many conditions `side` has disclosed so far.
    #[must_use]
    pub fn depth(&self, side: Side) -> usize {
        match side {
            Side::Current => self.current.offers_made(),
            Side::Interrupting => self.interrupting.offers_made(),
        }
    }

    /// The side whose acceptable offer is held, if one is.
    #[must_use]
    pub fn holds(&self) -> Option<Side> {
        self.held.map(|held| held.sender)
    }
}

/// One round between a sender and a receiver. Their types keep them apart: each of the
/// two is asked for its own part only.
fn exchange<'a, S: Role, O: Observer>(
    sender: &mut Party<'a, S>,
    receiver: &mut Party<'a, S::Other>,
    round: u32,
    observer: &mut O,
) -> Exchange {
    let Some(offer) = sender.offer() else {
        observer.quit(round, S::SIDE);
        return Exchange::NothingToOffer;
    };
    let depth = offer.depth();
    observer.offer(round, S::SIDE, depth, offer.discloses());
    Exchange::Judged {
        verdict: receiver.judge(&offer, observer),
        receiver_owes_reply: receiver.has_yet_to_offer(depth),
        receiver_can_go_deeper: receiver.has_offer(depth.saturating_add(1)),
    }
}

/// Each user would accept the other's offer of this depth. Asked only under the two tie
/// rules that hold offers.
fn break_tie(tie: TieRule, held: Held, reply: Held) -> Outcome {
    match tie {
        TieRule::Surplus if held.surplus > reply.surplus => Outcome::Agreement(held.sender),
        TieRule::Surplus if reply.surplus > held.surplus => Outcome::Agreement(reply.sender),
        TieRule::FirstSender | TieRule::Fallback | TieRule::Surplus => Outcome::NoAgreement,
    }
}
