//! How often a variant of the protocol does what, over all pairs of a domain.

use std::cmp::Ordering;

use selfneg_core::{Options, Outcome, Side};

use super::domain::Domain;
use super::grain::{Detail, Grain};
use super::pair::Pair;
use super::{Class, Progress, SweepError, Tally, sweep};

/// What one variant does with all ordered pairs of a domain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counts {
    /// All pairs of the domain.
    pub pairs: u128,
    /// How many classes were told apart. The engine ran on one pair of each, in both
    /// roles.
    pub classes: u64,
    /// Pairs that agree on the current user.
    pub agreement_current: u128,
    /// Pairs that agree on the interrupting user.
    pub agreement_interrupting: u128,
    /// Pairs without agreement.
    pub no_agreement: u128,
    /// Pairs whose agreed winner (or whether there is one) changes when the two users
    /// swap their roles.
    pub role_dependent: u128,
    /// A smallest role-dependent pair.
    pub role_dependent_pair: Option<Pair>,
    /// Regret where the protocol agreed.
    pub regret_agreed: Regret,
    /// Regret where the fallback decided.
    pub regret_fallback: Regret,
}

/// The pairs in which serving the other user would have more welfare.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Regret {
    /// How many.
    pub pairs: u128,
    /// The largest regret, in ranks. 0 if there are no such pairs.
    pub max: u64,
    /// A smallest pair with the largest regret.
    pub pair: Option<Pair>,
}

impl Counts {
    /// Sweeps a domain with one variant.
    ///
    /// # Errors
    /// [`SweepError`], none of which a correct reduction yields.
    pub fn of(
        domain: &Domain,
        options: &Options,
        detail: Detail,
        progress: &(dyn Fn(Progress) + Sync),
    ) -> Result<Self, SweepError> {
        let new = || Counting { options: *options, counts: Self::none() };
        let swept = sweep(domain, &Grain::of(options, detail), new, progress)?;
        Ok(Self { classes: swept.classes, ..swept.tally.counts })
    }

    fn none() -> Self {
        Self {
            pairs: 0,
            classes: 0,
            agreement_current: 0,
            agreement_interrupting: 0,
            no_agreement: 0,
            role_dependent: 0,
            role_dependent_pair: None,
            regret_agreed: Regret::default(),
            regret_fallback: Regret::default(),
        }
    }

    /// Pairs that are not served with the most welfare.
    #[must_use]
    pub fn suboptimal(&self) -> u128 {
        self.regret_agreed.pairs + self.regret_fallback.pairs
    }

    /// The largest regret, whatever its cause, in ranks.
    #[must_use]
    pub fn max_regret(&self) -> u64 {
        self.regret_agreed.max.max(self.regret_fallback.max)
    }

    /// A smallest pair with the largest regret.
    #[must_use]
    pub fn max_regret_pair(&self) -> Option<&Pair> {
        let mut worst = None;
        for regret in [&self.regret_agreed, &self.regret_fallback] {
            if regret.max == self.max_regret() {
                worst = smaller(worst, regret.pair.as_ref());
            }
        }
        worst
    }
}

impl Regret {
    fn take(&mut self, pair: &Pair, multiplicity: u128, regret: u64) {
        if regret > 0 {
            self.pairs += multiplicity;
            if regret > self.max {
                self.max = regret;
                self.pair = Some(pair.clone());
            } else if regret == self.max && self.pair.as_ref().is_none_or(|smallest| pair < smallest) {
                self.pair = Some(pair.clone());
            }
        }
    }

    fn merge(self, other: Self) -> Self {
        let pairs = self.pairs + other.pairs;
        let pair = match self.max.cmp(&other.max) {
            Ordering::Less => other.pair,
            Ordering::Equal => smaller(self.pair, other.pair),
            Ordering::Greater => self.pair,
        };
        Self { pairs, max: self.max.max(other.max), pair }
    }
}

/// The smaller of two, if there are two.
pub(super) fn smaller<P: Ord>(a: Option<P>, b: Option<P>) -> Option<P> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (one, other) => one.or(other),
    }
}

struct Counting {
    options: Options,
    counts: Counts,
}

impl Tally for Counting {
    fn take(&mut self, class: &Class<'_>) {
        let Class { pair, case, multiplicity } = class;
        let decision = case.decide(&self.options, &mut ());
        let outcome = decision.conclusion.outcome;
        let counts = &mut self.counts;
        counts.pairs += multiplicity;
        match outcome {
            Outcome::Agreement(Side::Current) => counts.agreement_current += multiplicity,
            Outcome::Agreement(Side::Interrupting) => counts.agreement_interrupting += multiplicity,
            Outcome::NoAgreement => counts.no_agreement += multiplicity,
        }
        let swapped = case.swapped().negotiate(&self.options).outcome;
        if outcome.winner() != swapped.winner().map(Side::other) {
            counts.role_dependent += multiplicity;
            if counts.role_dependent_pair.as_ref().is_none_or(|smallest| *pair < smallest) {
                counts.role_dependent_pair = Some((*pair).clone());
            }
        }
        let regret = case.welfare(&self.options).regret(decision.served).0;
        match outcome {
            Outcome::Agreement(_) => counts.regret_agreed.take(pair, *multiplicity, regret),
            Outcome::NoAgreement => counts.regret_fallback.take(pair, *multiplicity, regret),
        }
    }

    fn merge(self, other: Self) -> Self {
        let (a, b) = (self.counts, other.counts);
        let counts = Counts {
            pairs: a.pairs + b.pairs,
            classes: a.classes + b.classes,
            agreement_current: a.agreement_current + b.agreement_current,
            agreement_interrupting: a.agreement_interrupting + b.agreement_interrupting,
            no_agreement: a.no_agreement + b.no_agreement,
            role_dependent: a.role_dependent + b.role_dependent,
            role_dependent_pair: smaller(a.role_dependent_pair, b.role_dependent_pair),
            regret_agreed: a.regret_agreed.merge(b.regret_agreed),
            regret_fallback: a.regret_fallback.merge(b.regret_fallback),
        };
        Self { options: self.options, counts }
    }
}
