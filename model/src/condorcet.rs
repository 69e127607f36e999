//! The policy `condorcet`: precedence among any number of users, by who beats whom.

use selfneg_core::{Outcome, Side};

use crate::beats::BeatsGraph;

/// Whom the bilateral negotiations give precedence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Precedence {
    /// This user beats everyone else.
    Agreement(usize),
    /// Nobody does. The fallback chooses among the candidates, by arrival: the Schwartz
    /// set.
    NoAgreement {
        /// Never empty unless there are no users.
        candidates: Vec<usize>,
    },
}

/// All bilateral negotiations among some users, held.
#[derive(Clone, Debug)]
pub struct Condorcet {
    beats: BeatsGraph,
}

impl Condorcet {
    /// Has every two of `users` users negotiate. `negotiate` gets their numbers by
    /// arrival, the earlier first: that one is the current side.
    pub fn negotiate<F: FnMut(usize, usize) -> Outcome>(users: usize, mut negotiate: F) -> Self {
        let mut beats = BeatsGraph::new(users);
        for earlier in 0..users {
            for later in earlier.saturating_add(1)..users {
                match negotiate(earlier, later) {
                    Outcome::Agreement(Side::Current) => beats.add(earlier, later),
                    Outcome::Agreement(Side::Interrupting) => beats.add(later, earlier),
                    Outcome::NoAgreement => {}
                }
            }
        }
        Self { beats }
    }

    /// Who beats whom.
    #[must_use]
    pub fn beats(&self) -> &BeatsGraph {
        &self.beats
    }

    /// The user who beats everyone else, or the candidates of the fallback.
    #[must_use]
    pub fn precedence(&self) -> Precedence {
        match self.beats.condorcet_winner() {
            Some(winner) => Precedence::Agreement(winner),
            None => Precedence::NoAgreement { candidates: self.beats.schwartz_set() },
        }
    }
}
