//! The exhaustive sweep: all ordered pairs of users of a [`Domain`], in classes that
//! count how many pairs they stand for.
//!
//! The users of the paper's size make 10^12 ordered pairs. Given both statuses, each
//! user's verdicts depend on its own ranks only, so the two sides are counted apart and
//! multiplied; pairs in which the protocol and the fallback cannot but do the same, in
//! both roles, are one class ([`Grain`] says when). One pair of every class, a smallest,
//! is a [`Class`] for a [`Tally`] to look at, usually by running the engine. The
//! multiplicities are exact, and a sweep whose multiplicities do not add up to the
//! domain's size is an error.
//!
//! ```
//! use selfneg_core::Options;
//! use selfneg_proofs::sweep::{Counts, Detail, Domain};
//!
//! let domain = Domain::one_to_one(4, 1..=3)?;
//! let counts = Counts::of(&domain, &Options::default(), Detail::Merged, &|_| ())?;
//! assert_eq!(counts.pairs, 1_679_616);
//! assert_eq!(counts.agreement_current + counts.agreement_interrupting + counts.no_agreement, counts.pairs);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//!
//! A domain has at most 16 dispositions and fewer than 2^64 users, so that every count
//! fits 128 bits. Within that, time and memory go into the patterns of two statuses,
//! whose number grows exponentially with the dispositions, while ranks cost a low power
//! of their number. With ranks 1..=5, one condition each, the default variant and two
//! cores, counting took about 0.02 s for 6 dispositions, 0.05 s for 7, 0.2 s for 8, 1 s
//! for 10, 3 s for 12, and 15 s and 0.8 GB for 14. 16 dispositions with ranks 0..=1 took
//! 90 s and 4 GB. The published activation (ten conditions, six dispositions) took 0.3 s.
//! [`Detail::ByPattern`] costs an engine run for each of its many classes: 0.4 s for 6
//! dispositions, 2 s for 7, 9 s for 8.

mod check;
mod classes;
mod counts;
mod domain;
mod grain;
mod pair;
mod pattern;
mod table;

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use selfneg_core::{Case, RulesError, TooManyConditions};
use thiserror::Error;

pub use check::{Check, Checked, check};
pub use counts::{Counts, Regret};
pub use domain::{Domain, DomainError, MAX_DISPOSITIONS, MAX_PER_DISPOSITION};
pub use grain::{Detail, Grain};
pub use pair::{Pair, Person};

use classes::Parts;
use pattern::Patterns;

/// A class of pairs, by one of them.
#[derive(Clone, Copy)]
pub struct Class<'a> {
    /// A pair of the class with the smallest sum of ranks.
    pub pair: &'a Pair,
    /// The same as the engine takes it.
    pub case: Case<'a>,
    /// How many pairs the class has.
    pub multiplicity: u128,
}

/// What a sweep gathers. Classes come in any order and from several threads, each of
/// which has a tally of its own.
pub trait Tally: Send {
    /// Takes in one class.
    fn take(&mut self, class: &Class<'_>);

    /// Joins what two threads gathered.
    #[must_use]
    fn merge(self, other: Self) -> Self;
}

/// How far a sweep is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Each user's side is being counted.
    Sides {
        /// Tasks that pairs of statuses set their users, done.
        done: usize,
        /// All of them.
        total: usize,
    },
    /// Pairs are being covered.
    Pairs {
        /// Pairs covered.
        done: u128,
        /// All pairs of the domain.
        total: u128,
    },
}

/// What came out of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Swept<T> {
    /// What was gathered.
    pub tally: T,
    /// How many classes there are.
    pub classes: u64,
    /// How many pairs they stand for: all of the domain.
    pub pairs: u128,
}

/// A sweep is not to be relied on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The multiplicities do not add up: a defect of the reduction.
    #[error("the classes stand for {covered} pairs, the domain has {pairs}")]
    NotCovered {
        /// The sum of the multiplicities.
        covered: u128,
        /// The size of the domain.
        pairs: u128,
    },
    /// The engine refused the domain's activation.
    #[error("the engine refuses the activation: {0}")]
    Activation(RulesError),
    /// The engine refused a status.
    #[error("the engine refuses a status: {0}")]
    Status(TooManyConditions),
}

/// Covers all ordered pairs of a domain. Every thread starts from a tally of `new`;
/// `progress` is called from any thread, with `done` ascending.
///
/// # Errors
/// [`SweepError`], none of which a correct reduction yields.
pub fn sweep<T: Tally>(
    domain: &Domain,
    grain: &Grain,
    new: impl Fn() -> T + Sync,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Swept<T>, SweepError> {
    let activation = domain.activation().map_err(SweepError::Activation)?;
    let patterns = Patterns::of(domain, grain.aggregation);
    let total = patterns.tasks.len();
    let counted = Counter::from(0_usize);
    let tables = table::tables(domain, grain, &patterns, &|| {
        counted.add(1, |done| progress(Progress::Sides { done, total }));
    });
    let parts = Parts { domain, grain, tables: &tables };
    let total = domain.pairs();
    let covered = Counter::from(0_u128);
    let swept = patterns
        .by_lengths
        .par_iter()
        .with_max_len(1)
        .map(|patterns| {
            let mut swept = Swept { tally: new(), classes: 0, pairs: 0 };
            parts.classes(patterns, |pair, multiplicity| {
                let case = pair.case(activation)?;
                swept.tally.take(&Class { pair, case, multiplicity });
                swept.classes += 1;
                swept.pairs += multiplicity;
                Ok(())
            })?;
            covered.add(swept.pairs, |done| progress(Progress::Pairs { done, total }));
            Ok(swept)
        })
        .try_reduce_with(|a, b| {
            Ok(Swept {
                tally: a.tally.merge(b.tally),
                classes: a.classes + b.classes,
                pairs: a.pairs + b.pairs,
            })
        })
        .unwrap_or_else(|| Ok(Swept { tally: new(), classes: 0, pairs: 0 }))
        .map_err(SweepError::Status)?;
    if swept.pairs != total {
        return Err(SweepError::NotCovered { covered: swept.pairs, pairs: total });
    }
    Ok(swept)
}

/// A sum that several threads add to, told in ascending order.
struct Counter<N>(Mutex<N>);

impl<N> From<N> for Counter<N> {
    fn from(start: N) -> Self {
        Self(Mutex::new(start))
    }
}

impl<N: Copy + std::ops::AddAssign> Counter<N> {
    fn add(&self, more: N, tell: impl FnOnce(N)) {
        let mut sum = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *sum += more;
        tell(*sum);
    }
}
