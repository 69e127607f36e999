//! The wall between the two users.
//!
//! A [`Party`] is one user taking part in one negotiation. Everything of the user is
//! private to this file: the engine, and any other code, can only ask it
//!
//! - to make its next [`Offer`], which holds the goal and the conditions disclosed so
//!   far, and nothing from which the rest could be reached (the slice ends there);
//! - to [`judge`](Party::judge) an offer of the *other* side, which yields a
//!   [`Verdict`];
//! - whether it has an offer of some depth at all, which the quit and tie rules need.
//!
//! Which side a party speaks for is part of its type, so a user cannot be made to judge
//! its own offer, and an offer cannot be forged, altered or deepened: it has no public
//! constructor. Nothing in this file is visible to the crate alone: the engine sees
//! exactly what a program outside the crate sees, so what the compiler refuses there
//! (`core/tests/boundary`) it refuses in the engine too.
//!
//! What the types do not rule out, and what keeps the engine from it instead:
//!
//! - asking a party for one offer after another without a verdict between them: the
//!   engine's source has one such call a round (`core/tests/boundary.rs` looks), and
//!   *bounded disclosure* is a property that is checked of every run;
//! - giving [`judge`](Party::judge) an observer of the engine's own, which would be told
//!   the receiver's totals: the engine implements no observer and names no total (same
//!   test); it passes its caller's observer on;
//! - the size of a surplus, which a [`Verdict`] carries because the tie rule `surplus`
//!   needs it, and how many offers a user has, which the quit and tie rules ask for.

use core::marker::PhantomData;

use crate::impact::{Disclosed, Impact};
use crate::observer::{Disclosure, Observer, Surplus, Weighing};
use crate::options::{Aggregation, Options};
use crate::outcome::Side;
use crate::rules::{Activation, Condition, Implication};
use crate::user::User;

/// A side as a type.
pub trait Role: sealed::Sealed + Copy {
    /// The side it speaks to.
    type Other: Role<Other = Self>;
    /// The side as a value.
    const SIDE: Side;
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Current {}
    impl Sealed for super::Interrupting {}
}

/// The user whom the robot is serving.
#[derive(Clone, Copy, Debug)]
pub enum Current {}

/// The user who asks for something else.
#[derive(Clone, Copy, Debug)]
pub enum Interrupting {}

impl Role for Current {
    type Other = Interrupting;
    const SIDE: Side = Side::Current;
}

impl Role for Interrupting {
    type Other = Current;
    const SIDE: Side = Side::Interrupting;
}

/// One user in one negotiation, on the side `R`. See the [module](self) for what it
/// gives away.
#[derive(Clone)]
pub struct Party<'a, R: Role> {
    user: User<'a>,
    activation: Activation<'a>,
    aggregation: Aggregation,
    willing: bool,
    threshold: Impact,
    offers_made: usize,
    heard: Heard<'a>,
    role: PhantomData<R>,
}

/// What was heard last and what it was worth: a cache, on which no verdict depends
/// (`core/tests/observer.rs` compares a party that has it with one that has not).
#[derive(Clone, Copy)]
struct Heard<'a> {
    disclosed: Disclosed<'a>,
    value: Impact,
}

impl<'a> Party<'a, Current> {
    /// The user being served. The willingness of `options` is this user's.
    #[must_use]
    pub fn current(user: User<'a>, activation: Activation<'a>, options: &Options) -> Self {
        Self::new(user, activation, options.aggregation, options.willingness)
    }
}

impl<'a> Party<'a, Interrupting> {
    /// The user who interrupts.
    #[must_use]
    pub fn interrupting(user: User<'a>, activation: Activation<'a>, options: &Options) -> Self {
        Self::new(user, activation, options.aggregation, 0)
    }
}

impl<'a, R: Role> Party<'a, R> {
    fn new(user: User<'a>, activation: Activation<'a>, aggregation: Aggregation, willingness: u8) -> Self {
        let complete = Disclosed { goal: user.goal(), conditions: user.status().conditions() };
        let impact = complete.impact(user.profile(), activation, aggregation);
        Self {
            user,
            activation,
            aggregation,
            willing: willingness > 0,
            threshold: impact.plus(Impact(u64::from(willingness))),
            offers_made: 0,
            heard: Heard { disclosed: Disclosed::NOTHING, value: Impact(0) },
            role: PhantomData,
        }
    }

    /// The next offer: one more condition than the last. `None` once all is disclosed.
    pub fn offer(&mut self) -> Option<Offer<'a, R>> {
        let depth = self.offers_made.saturating_add(1);
        if !self.has_offer(depth) {
            return None;
        }
        self.offers_made = depth;
        let conditions = self.user.status().conditions();
        let disclosed = match conditions.split_at_checked(depth) {
            Some((prefix, _)) => prefix,
            None => conditions,
        };
        Some(Offer {
            depth,
            disclosed: Disclosed { goal: self.user.goal(), conditions: disclosed },
            role: PhantomData,
        })
    }

    /// Weighs an offer of the other side against the own complete offer: acceptable iff
    /// it is worth strictly more in this user's eyes (the paper's utility function). The
    /// two totals go to `observer` alone.
    pub fn judge<O: Observer>(&mut self, offer: &Offer<'a, R::Other>, observer: &mut O) -> Verdict {
        let weighing = Weighing { value: self.worth(offer.disclosed), threshold: self.threshold };
        observer.weighed(R::SIDE, weighing);
        match weighing.surplus() {
            Some(surplus) => Verdict::Acceptable(surplus),
            None => Verdict::Rejected,
        }
    }

    /// EI of what an offer discloses, in this user's eyes. If it continues what was heard
    /// last, only the new part is weighed, so that a negotiation weighs each condition once.
    fn worth(&mut self, disclosed: Disclosed<'a>) -> Impact {
        let (known, value) = if disclosed.continues(self.heard.disclosed) {
            (self.heard.disclosed.conditions.len(), self.heard.value)
        } else {
            (0, Impact(0))
        };
        let more = disclosed.impact_beyond(known, self.user.profile(), self.activation, self.aggregation);
        let value = value.plus(more);
        self.heard = Heard { disclosed, value };
        value
    }

    /// Whether this user has an offer of this depth at all, made or still to be made.
    #[must_use]
    pub fn has_offer(&self, depth: usize) -> bool {
        let conditions = self.user.status().conditions().len();
        let offers = if self.willing { conditions.saturating_add(1) } else { conditions };
        depth <= offers
    }

    /// Whether this user has an offer of this depth that it has not made yet.
    #[must_use]
    pub fn has_yet_to_offer(&self, depth: usize) -> bool {
        self.offers_made < depth && self.has_offer(depth)
    }

    /// How many offers this user has made.
    #[must_use]
    pub fn offers_made(&self) -> usize {
        self.offers_made
    }
}

/// A goal and the first `depth` true conditions of its sender, on the side `S`.
#[derive(Clone)]
pub struct Offer<'a, S: Role> {
    depth: usize,
    disclosed: Disclosed<'a>,
    role: PhantomData<S>,
}

impl<'a, S: Role> Offer<'a, S> {
    /// How many conditions it discloses, the willingness included. At least 1.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// The disclosed conditions, in order of disclosure.
    #[must_use]
    pub fn conditions(&self) -> &'a [Condition] {
        self.disclosed.conditions
    }

    /// The goal that it asks for.
    #[must_use]
    pub fn goal(&self) -> Implication<'a> {
        self.disclosed.goal
    }

    /// What it discloses beyond the offer before.
    #[must_use]
    pub fn discloses(&self) -> Disclosure {
        match self.disclosed.conditions.last() {
            Some(&condition) if self.depth == self.disclosed.conditions.len() => {
                Disclosure::Condition(condition)
            }
            _ => Disclosure::Willingness,
        }
    }
}

/// What a receiver thinks of an offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is worth more to the receiver than its own complete offer, by this much.
    Acceptable(Surplus),
    /// It is not.
    Rejected,
}
