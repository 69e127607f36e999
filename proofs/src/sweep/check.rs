//! Properties over all pairs of a domain.

use std::collections::BTreeMap;

use selfneg_core::{Case, Options};

use super::counts::smaller;
use super::domain::Domain;
use super::grain::{Detail, Grain};
use super::pair::Pair;
use super::{Class, Progress, SweepError, Tally, sweep};

/// A property of a case under a variant. [`Grain`] says on what it may depend to be
/// checked on one pair of each class.
#[derive(Clone, Copy, Debug)]
pub struct Check<P> {
    /// Whether it holds of a case.
    pub property: P,
    /// The variant.
    pub options: Options,
}

/// A property's verdict over a whole domain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checked {
    /// The pairs covered: all of the domain.
    pub pairs: u128,
    /// How many of them violate the property.
    pub failing: u128,
    /// A smallest pair that violates it.
    pub counterexample: Option<Pair>,
    /// How many classes the pairs were covered by.
    pub classes: u64,
}

/// Checks each of a list of properties over all pairs of a domain, with one sweep for
/// all variants of a grain. The verdicts are in the order of the list.
///
/// Among the counterexamples with the fewest conditions, and among those with the
/// smallest sum of ranks, which one is given is fixed but otherwise arbitrary.
///
/// # Errors
/// [`SweepError`], none of which a correct reduction yields.
pub fn check<P>(
    domain: &Domain,
    checks: &[Check<P>],
    detail: Detail,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Vec<Checked>, SweepError>
where
    P: Fn(&Case<'_>, &Options) -> bool + Sync,
{
    let mut by_grain: BTreeMap<Grain, Vec<(usize, &Check<P>)>> = BTreeMap::new();
    for (place, check) in checks.iter().enumerate() {
        by_grain.entry(Grain::of(&check.options, detail)).or_default().push((place, check));
    }
    let mut verdicts = BTreeMap::new();
    for (grain, checks) in &by_grain {
        let new = || Checking { checks, failures: vec![Failures::default(); checks.len()] };
        let swept = sweep(domain, grain, new, progress)?;
        for ((place, _), Failures { failing, counterexample }) in checks.iter().zip(swept.tally.failures) {
            let (pairs, classes) = (swept.pairs, swept.classes);
            verdicts.insert(*place, Checked { pairs, failing, counterexample, classes });
        }
    }
    Ok(verdicts.into_values().collect())
}

#[derive(Clone, Default)]
struct Failures {
    failing: u128,
    counterexample: Option<Pair>,
}

struct Checking<'a, P> {
    checks: &'a [(usize, &'a Check<P>)],
    failures: Vec<Failures>,
}

impl<P> Tally for Checking<'_, P>
where
    P: Fn(&Case<'_>, &Options) -> bool + Sync,
{
    fn take(&mut self, class: &Class<'_>) {
        for ((_, check), failures) in self.checks.iter().zip(&mut self.failures) {
            if !(check.property)(&class.case, &check.options) {
                failures.failing += class.multiplicity;
                if failures.counterexample.as_ref().is_none_or(|smallest| class.pair < smallest) {
                    failures.counterexample = Some(class.pair.clone());
                }
            }
        }
    }

    fn merge(self, other: Self) -> Self {
        let failures = self.failures.into_iter().zip(other.failures).map(|(a, b)| Failures {
            failing: a.failing + b.failing,
            counterexample: smaller(a.counterexample, b.counterexample),
        });
        Self { failures: failures.collect(), ..self }
    }
}
