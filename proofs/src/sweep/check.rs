//! Properties over all pairs of a domain.

use std::collections::BTreeMap;

use selfneg_core::Options;

use super::counts::smaller;
use super::domain::Domain;
use super::grain::{Detail, Grain};
use super::pair::Pair;
use super::{Class, Progress, SweepError, Tally, sweep};
use crate::property::Judgement;

/// A property of a case under a variant. [`Grain`] says on what it may depend to be
/// checked on one pair of each class.
#[derive(Clone, Copy, Debug)]
pub struct Check<P> {
    /// What a class says of it.
    pub property: P,
    /// The variant.
    pub options: Options,
}

/// A property's verdict over a whole domain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checked {
    /// The pairs covered: all of the domain.
    pub pairs: u128,
    /// How many of them meet the property's premise.
    pub nonvacuous: u128,
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
    P: Fn(&Class<'_>, &Options) -> Judgement + Sync,
{
    let mut by_grain: BTreeMap<Grain, Vec<(usize, &Check<P>)>> = BTreeMap::new();
    for (place, check) in checks.iter().enumerate() {
        by_grain.entry(Grain::of(&check.options, detail)).or_default().push((place, check));
    }
    let mut verdicts = BTreeMap::new();
    for (grain, checks) in &by_grain {
        let new = || Checking { checks, findings: vec![Findings::default(); checks.len()] };
        let swept = sweep(domain, grain, new, progress)?;
        for ((place, _), Findings { nonvacuous, failing, counterexample }) in
            checks.iter().zip(swept.tally.findings)
        {
            let (pairs, classes) = (swept.pairs, swept.classes);
            verdicts.insert(*place, Checked { pairs, nonvacuous, failing, counterexample, classes });
        }
    }
    Ok(verdicts.into_values().collect())
}

#[derive(Clone, Default)]
struct Findings {
    nonvacuous: u128,
    failing: u128,
    counterexample: Option<Pair>,
}

struct Checking<'a, P> {
    checks: &'a [(usize, &'a Check<P>)],
    findings: Vec<Findings>,
}

impl<P> Tally for Checking<'_, P>
where
    P: Fn(&Class<'_>, &Options) -> Judgement + Sync,
{
    fn take(&mut self, class: &Class<'_>) {
        for ((_, check), findings) in self.checks.iter().zip(&mut self.findings) {
            let judgement = (check.property)(class, &check.options);
            if judgement != Judgement::Vacuous {
                findings.nonvacuous += class.multiplicity;
            }
            if judgement == Judgement::Fails {
                findings.failing += class.multiplicity;
                if findings.counterexample.as_ref().is_none_or(|smallest| class.pair < smallest) {
                    findings.counterexample = Some(class.pair.clone());
                }
            }
        }
    }

    fn merge(self, other: Self) -> Self {
        let findings = self.findings.into_iter().zip(other.findings).map(|(a, b)| Findings {
            nonvacuous: a.nonvacuous + b.nonvacuous,
            failing: a.failing + b.failing,
            counterexample: smaller(a.counterexample, b.counterexample),
        });
        Self { findings: findings.collect(), ..self }
    }
}
