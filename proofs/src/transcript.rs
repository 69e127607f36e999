//! A negotiation, round by round, in memory that the caller lends.

use selfneg_core::{Conclusion, Disclosure, Observer, Ruling, Side, Weighing};

/// One round as an observer sees it: an offer and what became of it, or a quit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Round {
    /// Its number, from 1.
    pub number: u32,
    /// Who sent.
    pub sender: Side,
    /// The depth of the offer; 0 if the sender quit.
    pub depth: usize,
    /// What the offer disclosed; `None` if the sender quit.
    pub discloses: Option<Disclosure>,
    /// What the receiver weighed.
    pub weighing: Option<Weighing>,
    /// What became of the offer.
    pub ruling: Option<Ruling>,
}

impl Round {
    /// A round that has not been played: what lent memory is filled with.
    pub const BLANK: Self =
        Self { number: 0, sender: Side::Current, depth: 0, discloses: None, weighing: None, ruling: None };
}

/// Memory for the two transcripts that a statement compares. Each part should have room
/// for at least as many rounds as the two users have offers, and two more.
#[derive(Debug)]
pub struct Memory<'m> {
    /// Room for the first.
    pub first: &'m mut [Round],
    /// Room for the second.
    pub second: &'m mut [Round],
}

/// Writes rounds down as they are told.
#[derive(Debug)]
pub struct Recorder<'m> {
    room: &'m mut [Round],
    rounds: usize,
    complete: bool,
}

impl<'m> Recorder<'m> {
    /// A recorder that overwrites `room`.
    pub fn new(room: &'m mut [Round]) -> Self {
        Self { room, rounds: 0, complete: true }
    }

    /// How many rounds were told.
    #[must_use]
    pub fn rounds(&self) -> usize {
        self.rounds
    }

    /// Round `index`, from 0, if it was told and there was room.
    #[must_use]
    pub fn round(&self, index: usize) -> Option<&Round> {
        if index < self.rounds { self.room.get(index) } else { None }
    }

    /// Whether there was room for every round and each was told in the order that
    /// [`Observer`] promises.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.complete
    }

    /// How many offers `side` made.
    #[must_use]
    pub fn offers_by(&self, side: Side) -> usize {
        let mut count = 0;
        let mut i = 0;
        while let Some(round) = self.round(i) {
            if round.sender == side && round.depth > 0 {
                count += 1;
            }
            i += 1;
        }
        count
    }

    /// Whether `side` quit.
    #[must_use]
    pub fn has_quit(&self, side: Side) -> bool {
        let mut i = 0;
        while let Some(round) = self.round(i) {
            if round.sender == side && round.depth == 0 {
                return true;
            }
            i += 1;
        }
        false
    }

    /// Whether both hold the same rounds, bit for bit.
    #[must_use]
    pub fn is_same(&self, other: &Recorder<'_>) -> bool {
        if self.rounds != other.rounds || !self.complete || !other.complete {
            return false;
        }
        let mut i = 0;
        while let (Some(mine), Some(theirs)) = (self.round(i), other.round(i)) {
            if mine != theirs {
                return false;
            }
            i += 1;
        }
        true
    }

    fn push(&mut self, round: Round) {
        match self.room.get_mut(self.rounds) {
            Some(place) => *place = round,
            None => self.complete = false,
        }
        self.rounds += 1;
    }

    fn last(&mut self) -> Option<&mut Round> {
        match self.rounds.checked_sub(1) {
            Some(index) => self.room.get_mut(index),
            None => None,
        }
    }
}

impl Observer for Recorder<'_> {
    fn offer(&mut self, round: u32, sender: Side, depth: usize, discloses: Disclosure) {
        self.push(Round {
            number: round,
            sender,
            depth,
            discloses: Some(discloses),
            weighing: None,
            ruling: None,
        });
    }

    fn weighed(&mut self, receiver: Side, weighing: Weighing) {
        match self.last() {
            Some(round) if round.sender != receiver && round.weighing.is_none() => {
                round.weighing = Some(weighing);
            }
            Some(_) | None => self.complete = false,
        }
    }

    fn ruled(&mut self, receiver: Side, ruling: Ruling) {
        match self.last() {
            Some(round) if round.sender != receiver && round.ruling.is_none() => {
                round.ruling = Some(ruling);
            }
            Some(_) | None => self.complete = false,
        }
    }

    fn quit(&mut self, round: u32, sender: Side) {
        self.push(Round { number: round, sender, depth: 0, discloses: None, weighing: None, ruling: None });
    }

    fn concluded(&mut self, conclusion: Conclusion) {
        let _ = conclusion;
    }
}
