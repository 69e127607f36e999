//! Who would be best for whom.

use selfneg_core::{Activation, Aggregation, User, impact_of_serving};

/// For every two users, what serving the one is worth in the eyes of the other: the ethical
/// impact of its complete offer, in ranks. Users are numbered by arrival, from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Impacts {
    /// By user in whose eyes, then by user served.
    rows: Vec<Vec<u64>>,
}

impl Impacts {
    /// The impacts among `users`. The willingness to be interrupted does not count.
    #[must_use]
    pub fn among(users: &[User<'_>], activation: Activation<'_>, aggregation: Aggregation) -> Self {
        let row = |eyes: &User<'_>| {
            users.iter().map(|served| impact_of_serving(served, eyes, activation, aggregation).0).collect()
        };
        Self { rows: users.iter().map(row).collect() }
    }

    /// Takes the impacts themselves: one row for each user in whose eyes, one entry in it
    /// for each user served. `None` if they do not make a square.
    #[must_use]
    pub fn of_rows(rows: Vec<Vec<u64>>) -> Option<Self> {
        let square = rows.iter().all(|row| row.len() == rows.len());
        square.then_some(Self { rows })
    }

    /// How many users there are.
    #[must_use]
    pub fn users(&self) -> usize {
        self.rows.len()
    }

    /// What serving `served` is worth in the eyes of `eyes`; 0 for users that are not there.
    #[must_use]
    pub fn of_serving(&self, served: usize, eyes: usize) -> u64 {
        self.rows.get(eyes).and_then(|row| row.get(served)).copied().unwrap_or(0)
    }

    /// What serving each user is worth in the eyes of `eyes`, by arrival.
    #[must_use]
    pub fn in_eyes_of(&self, eyes: usize) -> &[u64] {
        self.rows.get(eyes).map_or(&[], Vec::as_slice)
    }

    /// W of serving `served`: the sum over all users.
    #[must_use]
    pub fn welfare(&self, served: usize) -> u64 {
        (0..self.users()).map(|eyes| self.of_serving(served, eyes)).fold(0, u64::saturating_add)
    }

    /// The users of whom serving has the most welfare, by arrival.
    #[must_use]
    pub fn optimal(&self) -> Vec<usize> {
        let most = (0..self.users()).map(|served| self.welfare(served)).max();
        (0..self.users()).filter(|&served| Some(self.welfare(served)) == most).collect()
    }
}
