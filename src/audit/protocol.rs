//! What the open records alone show of a negotiation: whether each round, and the end, follow
//! from the verdicts before it.
//!
//! The protocol is stated here once more, on purpose: on verdicts and numbers of offers, with
//! nothing of the engine. How many offers a user has is personal; the walk keeps bounds of it,
//! which every round narrows, and which must not cross.

use selfneg_core::{Options, QuitRule, Ruling, Side, TieRule};

use super::finding::{Log, Place, conditions};
use super::property::Property;
use crate::case::{RecordedEvent, RecordedNegotiation, RecordedRound, Worth};
use crate::mission::UserId;

/// One of something for each side.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sides<T> {
    pub(super) current: T,
    pub(super) interrupting: T,
}

impl<T: Copy> Sides<T> {
    fn both(of: T) -> Self {
        Self { current: of, interrupting: of }
    }

    fn of(&self, side: Side) -> T {
        match side {
            Side::Current => self.current,
            Side::Interrupting => self.interrupting,
        }
    }

    fn of_mut(&mut self, side: Side) -> &mut T {
        match side {
            Side::Current => &mut self.current,
            Side::Interrupting => &mut self.interrupting,
        }
    }
}

/// The numbers of offers of the two users of a negotiation, if they are known. Willingness is
/// an offer of the current user.
pub(super) type Offers = Option<Sides<u64>>;

/// Checks one negotiation.
pub(super) fn check(
    negotiation: &RecordedNegotiation,
    offers: Offers,
    decision: Option<u64>,
    options: &Options,
    log: &mut Log,
) {
    let mut walk = Walk::new(negotiation, offers, options);
    let mut fault = None;
    for (number, round) in (1..).zip(&negotiation.rounds) {
        if let Err(wrong) = walk.round(number, round) {
            fault = Some((round, wrong));
            break;
        }
    }
    match fault {
        Some((round, (property, what))) => {
            let at = Place::entry(round.index, round.at).of_decision(decision).in_round(round.number);
            log.broken(property, at, format!("{}: {what}", pair(negotiation)));
        }
        None => {
            let rounds = u64::try_from(negotiation.rounds.len()).unwrap_or(u64::MAX);
            log.held_times(Property::Protocol, rounds);
            log.held_times(Property::OneDisclosure, walk.made.current.saturating_add(walk.made.interrupting));
            check_end(negotiation, &walk, decision, log);
        }
    }
    let Sides { current, interrupting } = offers.unwrap_or(walk.made);
    let most = current.saturating_add(interrupting).saturating_add(2);
    let rounds = u64::try_from(negotiation.rounds.len()).unwrap_or(u64::MAX);
    if rounds > most {
        let at = Place::entry(negotiation.index, negotiation.at).of_decision(decision);
        let what = format!("{}: {rounds} rounds, where at most {most} can be", pair(negotiation));
        log.broken(Property::Termination, at, what);
    } else {
        log.held(Property::Termination);
    }
}

fn check_end(negotiation: &RecordedNegotiation, walk: &Walk<'_>, decision: Option<u64>, log: &mut Log) {
    let Some(end) = &negotiation.end else { return };
    let last = negotiation.rounds.last();
    let at = Place { entry: Some(end.index), time: last.map(|round| round.at), ..Place::WHOLE };
    let at = at.of_decision(decision);
    let who = pair(negotiation);
    let mut broken = |property, what: String| log.broken(property, at, format!("{who}: {what}"));
    if end.sides != (negotiation.current, negotiation.interrupting) {
        return broken(Property::Protocol, "its end names other users than its begin".to_owned());
    }
    let rounds = u32::try_from(negotiation.rounds.len()).unwrap_or(u32::MAX);
    if end.rounds != rounds {
        broken(Property::Protocol, format!("its end counts {} rounds, {rounds} are recorded", end.rounds));
    }
    let Some(conclusion) = &walk.conclusion else {
        return broken(
            Property::Protocol,
            format!("it ends after round {rounds} ({}), where it has to go on", end.ending),
        );
    };
    if end.ending != conclusion.ending {
        broken(
            Property::Protocol,
            format!("it is said to end by {}, and ended by {}", end.ending, conclusion.ending),
        );
    }
    match conclusion.winner {
        Winner::Either if end.winner.is_none() => {}
        Winner::Either | Winner::Side(_) | Winner::Nobody => {
            let side = end.winner.and_then(|winner| walk.side(winner));
            let accepted = side.is_some_and(|side| walk.accepted.of(side));
            if end.winner.is_some() && !accepted {
                let what = format!("{} wins without an offer that was accepted", name(end.winner));
                return broken(Property::NoVerdictWithoutOffer, what);
            }
            let follows = match conclusion.winner {
                Winner::Either => true,
                Winner::Side(side) => end.winner == Some(walk.users.of(side)),
                Winner::Nobody => end.winner.is_none(),
            };
            if !follows {
                let expected = match conclusion.winner {
                    Winner::Side(side) => Some(walk.users.of(side)),
                    Winner::Either | Winner::Nobody => None,
                };
                let what =
                    format!("the winner is {}, by the rounds it is {}", name(end.winner), name(expected));
                return broken(Property::Protocol, what);
            }
        }
    }
    log.held(Property::NoVerdictWithoutOffer);
    log.held(Property::Protocol);
}

fn name(user: Option<UserId>) -> String {
    user.map_or_else(|| "nobody".to_owned(), |user| format!("user {}", user.0))
}

/// The two users, in words.
pub(super) fn pair(negotiation: &RecordedNegotiation) -> String {
    format!("negotiation of user {} (current) and user {}", negotiation.current.0, negotiation.interrupting.0)
}

struct Walk<'n> {
    negotiation: &'n RecordedNegotiation,
    quit: QuitRule,
    tie: TieRule,
    users: Sides<UserId>,
    sender: Side,
    /// The other side has quit.
    alone: bool,
    /// Offers made.
    made: Sides<u64>,
    /// Bounds of the number of offers that each user has.
    least: Sides<u64>,
    most: Sides<u64>,
    /// Whose offer is held, and what it is worth.
    held: Option<(Side, Option<Worth>)>,
    /// Whose last offer the other one would accept.
    accepted: Sides<bool>,
    conclusion: Option<Ended>,
}

struct Ended {
    winner: Winner,
    ending: &'static str,
}

enum Winner {
    Side(Side),
    Nobody,
    /// Either user, or nobody: it depends on totals that are not there.
    Either,
}

type Wrong = (Property, String);

impl<'n> Walk<'n> {
    fn new(negotiation: &'n RecordedNegotiation, offers: Offers, options: &Options) -> Self {
        Self {
            negotiation,
            quit: options.quit,
            tie: options.tie,
            users: Sides { current: negotiation.current, interrupting: negotiation.interrupting },
            sender: Side::Interrupting,
            alone: false,
            made: Sides::default(),
            least: offers.unwrap_or_default(),
            most: offers.unwrap_or(Sides::both(u64::MAX)),
            held: None,
            accepted: Sides::default(),
            conclusion: None,
        }
    }

    fn side(&self, user: UserId) -> Option<Side> {
        [Side::Current, Side::Interrupting].into_iter().find(|&side| self.users.of(side) == user)
    }

    /// The next round; `number` is the one that it must have.
    fn round(&mut self, number: u32, round: &RecordedRound) -> Result<(), Wrong> {
        let protocol = |what: String| Err((Property::Protocol, what));
        if self.conclusion.is_some() {
            return protocol("it goes on after its end".to_owned());
        }
        if round.number != number {
            return protocol(format!("round {} follows where round {number} must", round.number));
        }
        let (sender, receiver) = (self.sender, self.sender.other());
        let [sends, receives] = [sender, receiver].map(|side| self.users.of(side));
        if (round.sender, round.receiver) != (sends, receives) {
            let what = format!(
                "user {} sends to user {}, where it is user {}'s turn",
                round.sender.0, round.receiver.0, sends.0
            );
            return protocol(what);
        }
        match round.event {
            RecordedEvent::Unknown => {
                let what = "it is neither an offer nor a quit".to_owned();
                Err((Property::NoVerdictWithoutOffer, what))
            }
            RecordedEvent::Quit => self.quit(sender, receiver),
            RecordedEvent::Offer { verdict: None, .. } => {
                Err((Property::NoVerdictWithoutOffer, "an offer without a verdict".to_owned()))
            }
            RecordedEvent::Offer { depth, verdict: Some(verdict), worth, .. } => {
                self.offer(sender, depth)?;
                self.rule(sender, receiver, depth, verdict, worth, number)
            }
        }
    }

    fn quit(&mut self, sender: Side, receiver: Side) -> Result<(), Wrong> {
        if self.held.is_some() {
            return Err((Property::Protocol, "it quits, though it owes a reply to a held offer".to_owned()));
        }
        self.at_most(sender, self.made.of(sender), "it quits with an offer left")?;
        match (self.quit, self.alone) {
            (QuitRule::Literal, _) => self.conclude(Winner::Nobody, "literal-quit"),
            (QuitRule::Exhausted, true) => self.conclude(Winner::Nobody, "both-quit"),
            (QuitRule::Exhausted, false) => {
                self.alone = true;
                self.sender = receiver;
            }
        }
        Ok(())
    }

    fn offer(&mut self, sender: Side, depth: u64) -> Result<(), Wrong> {
        let expected = self.made.of(sender).saturating_add(1);
        if depth != expected {
            let what = format!("an offer of {}, where one of {expected} must be", conditions(depth));
            return Err((Property::OneDisclosure, what));
        }
        *self.made.of_mut(sender) = depth;
        self.at_least(sender, depth, "it offers more than it has")
    }

    fn rule(
        &mut self,
        sender: Side,
        receiver: Side,
        depth: u64,
        verdict: Ruling,
        worth: Option<Worth>,
        number: u32,
    ) -> Result<(), Wrong> {
        let owes_reply_possible = self.made.of(receiver) < depth;
        match verdict {
            Ruling::Accept => {
                *self.accepted.of_mut(sender) = true;
                if let Some((first, first_worth)) = self.held {
                    let winner = self.break_tie(first, first_worth, sender, worth);
                    self.conclude(winner, "tie");
                    return Ok(());
                }
                if self.tie != TieRule::FirstSender && owes_reply_possible {
                    let what = "it accepts at once, where the tie rule lets it hold the offer";
                    self.at_most(receiver, depth.saturating_sub(1), what)?;
                }
                self.conclude(Winner::Side(sender), "accepted");
            }
            Ruling::Hold => {
                if self.tie == TieRule::FirstSender || self.held.is_some() || !owes_reply_possible {
                    return Err((Property::Protocol, "it holds an offer, which it may not".to_owned()));
                }
                self.at_least(receiver, depth, "it holds an offer, and has none to reply with")?;
                *self.accepted.of_mut(sender) = true;
                self.held = Some((sender, worth));
                self.alone = false;
                self.sender = receiver;
            }
            Ruling::Reject => {
                if let Some((first, _)) = self.held {
                    self.conclude(Winner::Side(first), "held-offer-stands");
                    return Ok(());
                }
                if self.quit == QuitRule::Literal {
                    let deeper = depth.saturating_add(1);
                    if self.is_last(number) {
                        self.at_most(receiver, depth, "it ends, though the receiver has an offer left")?;
                        self.conclude(Winner::Nobody, "literal-quit");
                        return Ok(());
                    }
                    self.at_least(receiver, deeper, "it goes on, though the receiver has no offer left")?;
                }
                if !self.alone {
                    self.sender = receiver;
                }
            }
        }
        Ok(())
    }

    /// Whether the negotiation is recorded to end after this round.
    fn is_last(&self, number: u32) -> bool {
        let rounds = u32::try_from(self.negotiation.rounds.len()).unwrap_or(u32::MAX);
        self.negotiation.end.is_some() && number == rounds
    }

    fn break_tie(
        &self,
        first: Side,
        first_worth: Option<Worth>,
        reply: Side,
        reply_worth: Option<Worth>,
    ) -> Winner {
        if self.tie != TieRule::Surplus {
            return Winner::Nobody;
        }
        let (Some(first_worth), Some(reply_worth)) = (first_worth, reply_worth) else {
            return Winner::Either;
        };
        let surplus = |worth: Worth| i128::from(worth.value).saturating_sub(i128::from(worth.threshold));
        match surplus(first_worth).cmp(&surplus(reply_worth)) {
            std::cmp::Ordering::Greater => Winner::Side(first),
            std::cmp::Ordering::Less => Winner::Side(reply),
            std::cmp::Ordering::Equal => Winner::Nobody,
        }
    }

    /// The user of this side has at least so many offers.
    fn at_least(&mut self, side: Side, number: u64, wrong: &str) -> Result<(), Wrong> {
        let least = self.least.of_mut(side);
        *least = number.max(*least);
        self.bounds(side, wrong)
    }

    /// The user of this side has at most so many offers.
    fn at_most(&mut self, side: Side, number: u64, wrong: &str) -> Result<(), Wrong> {
        let most = self.most.of_mut(side);
        *most = number.min(*most);
        self.bounds(side, wrong)
    }

    fn bounds(&self, side: Side, wrong: &str) -> Result<(), Wrong> {
        match self.least.of(side) <= self.most.of(side) {
            true => Ok(()),
            false => Err((Property::Protocol, wrong.to_owned())),
        }
    }

    fn conclude(&mut self, winner: Winner, ending: &'static str) {
        self.conclusion = Some(Ended { winner, ending });
    }
}
