//! How finely a sweep tells pairs of users apart.

use selfneg_core::{Aggregation, Options, TieRule};

/// Whether a sweep merges all that it may.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Detail {
    /// As few classes as the grain allows.
    #[default]
    Merged,
    /// Classes of their own for statuses that set a user another task, and for each
    /// user's gain from the other's complete offer: some forty times as
    /// many at the paper's size, so that the engine runs on more pairs.
    ByPattern,
}

/// Which differences between pairs a sweep keeps.
///
/// Two pairs of one class agree in
///
/// - the numbers of conditions of the two users;
/// - for each user, the depth at which it first accepts the other's offer, as the
///   interrupting user and as a current user of this willingness (or that it never does);
/// - for each user, whether the other's complete offer is worth more, the same or less
///   to it than its own, without willingness and with it;
/// - the difference of the two welfares;
/// - with [`surplus`](Self::surplus): if both accept at the same depth, in either
///   distribution of the roles, whose surplus there is larger.
///
/// So they agree in everything that the protocol or the fallback does with them, in
/// both roles: outcome, rounds and regret. A property of one run, or of the two runs
/// with swapped roles, that depends on nothing else may be checked on one pair of each
/// class. What compares a run with that of *altered* users (hiding a condition, another
/// order) may not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Grain {
    /// How ranks add up.
    pub aggregation: Aggregation,
    /// The willingness of whoever is the current user.
    pub willingness: u8,
    /// Whether surpluses are compared, as the tie rule of that name does.
    pub surplus: bool,
    /// Whether classes are merged further than the two users' sides apart allow.
    pub detail: Detail,
}

impl Grain {
    /// The coarsest grain of this detail that serves a variant.
    #[must_use]
    pub fn of(options: &Options, detail: Detail) -> Self {
        Self {
            aggregation: options.aggregation,
            willingness: options.willingness,
            surplus: options.tie == TieRule::Surplus,
            detail,
        }
    }

    /// Whether the classes of this grain may be used for a variant: one of its
    /// willingness, or of none and without comparing surpluses (a current user who is
    /// willing accepts later, so another tie is compared).
    #[must_use]
    pub fn serves(&self, options: &Options) -> bool {
        let compares = options.tie == TieRule::Surplus;
        self.aggregation == options.aggregation
            && (options.willingness == self.willingness || options.willingness == 0 && !compares)
            && (self.surplus || !compares)
    }
}
