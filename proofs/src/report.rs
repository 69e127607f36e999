//! One property, one variant, one way of checking: the rows of the table of verdicts.

use std::time::{Duration, Instant};

use selfneg_core::{Fallback, Options, Side};

use crate::counterexample::{Counterexample, guarded};
use crate::engine::Engine;
use crate::enumeration::{Domain, enumerate, enumerate_policy, outcome_triples};
use crate::expected::{Verdict, expected, looks_at_fallback};
use crate::property::policy::{Policy, PolicyProperty};
use crate::property::{Judgement, Property, Second, Trial};
use crate::random;
use crate::sweep::{self, Detail, SweepError};
use crate::transcript::Memory;
use crate::variant::variants;

/// A way of checking a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Every case of [`Domain::of`] the property.
    Enumeration,
    /// So many random cases, from this seed.
    Random {
        /// How many.
        cases: u32,
        /// From which seed.
        seed: u64,
    },
}

/// What one way of checking says of one property under one variant.
#[derive(Clone, Debug)]
pub struct Report {
    /// The property's name.
    pub property: &'static str,
    /// The variant.
    pub options: Options,
    /// [`Verdict::Fails`] with a counterexample, [`Verdict::Holds`] if none was found.
    pub verdict: Verdict,
    /// What the table expects.
    pub expected: Verdict,
    /// `sweep`, `enumeration`, `random` or `outcomes`.
    pub method: &'static str,
    /// Over what.
    pub domain: String,
    /// How many cases, or pairs of cases, were looked at.
    pub cases: u128,
    /// How many classes these cases were covered by: the engine ran on one of each. `None`
    /// if it ran on every case.
    pub classes: Option<u64>,
    /// How many of them met the property's premise.
    pub nonvacuous: u128,
    /// How many of them refute it, where that was counted.
    pub failing: Option<u128>,
    /// The smallest that does, or what a random one shrank to.
    pub counterexample: Option<Counterexample>,
    /// How long it took.
    pub time: Duration,
}

impl Report {
    /// Whether the verdict bears out the expected one. Random cases cannot establish that
    /// a property fails by finding nothing, so then they say nothing against it either;
    /// enumeration that meets no premise at all bears nothing out.
    #[must_use]
    pub fn is_as_expected(&self) -> bool {
        match (self.verdict, self.expected) {
            (Verdict::Holds, Verdict::Fails) => self.method == "random",
            (Verdict::Fails, Verdict::Holds) => false,
            (Verdict::Holds, Verdict::Holds) => self.method == "random" || self.nonvacuous > 0,
            (Verdict::Fails, Verdict::Fails) => true,
        }
    }
}

/// Checks `property` under `options` in the way of `method`.
pub fn verify<E: Engine + Sync>(property: Property, options: &Options, engine: &E, method: Method) -> Report {
    match method {
        Method::Enumeration => verify_over(property, options, engine, Domain::of(property, options)),
        Method::Random { cases, seed } => {
            let start = Instant::now();
            let search = random::search(property, engine, options, cases, seed);
            Report {
                property: property.name(),
                options: *options,
                verdict: verdict(search.counterexample.as_ref()),
                expected: expected(property, options),
                method: "random",
                domain: random::DOMAIN.to_owned(),
                cases: search.cases,
                classes: None,
                nonvacuous: search.nonvacuous,
                failing: None,
                counterexample: search.counterexample,
                time: start.elapsed(),
            }
        }
    }
}

/// Checks `property` under every variant, in the way of `method`. Variants that differ in
/// what the property does not look at ([`looks_at_fallback`]) share one run.
pub fn verify_every_variant<E: Engine + Sync>(property: Property, engine: &E, method: Method) -> Vec<Report> {
    let mut reports: Vec<Report> = Vec::new();
    for options in variants() {
        let shared = Options { fallback: Fallback::FirstCome, ..options };
        let before = match looks_at_fallback(property) {
            true => None,
            false => reports.iter().find(|report| report.options == shared).cloned(),
        };
        reports.push(match before {
            Some(report) => Report {
                options,
                counterexample: report.counterexample.map(|found| Counterexample { options, ..found }),
                time: Duration::ZERO,
                ..report
            },
            None => verify(property, &options, engine, method),
        });
    }
    reports
}

/// Checks `property` under `options` on every case of `domains`.
pub fn verify_over<E: Engine + Sync>(
    property: Property,
    options: &Options,
    engine: &E,
    domains: &[Domain],
) -> Report {
    let start = Instant::now();
    let tally = enumerate(property, engine, domains, options);
    let names: Vec<&str> = domains.iter().map(|domain| domain.name).collect();
    Report {
        property: property.name(),
        options: *options,
        verdict: verdict(tally.smallest.as_ref()),
        expected: expected(property, options),
        method: "enumeration",
        domain: names.join("; "),
        cases: tally.cases,
        classes: None,
        nonvacuous: tally.nonvacuous,
        failing: Some(tally.failing),
        counterexample: tally.smallest,
        time: start.elapsed(),
    }
}

/// Checks every property of `properties` that a sweep may check ([`is_swept`]), under every
/// variant, on all pairs of `domain`. Variants that differ in what a property does not look
/// at share their cases.
///
/// # Errors
/// [`SweepError`], none of which a correct reduction yields.
pub fn verify_swept<E: Engine + Sync>(
    properties: &[Property],
    engine: &E,
    domain: &sweep::Domain,
    progress: &(dyn Fn(sweep::Progress) + Sync),
) -> Result<Vec<Report>, SweepError> {
    let name = domain.to_string();
    let mut asked: Vec<(Property, Options)> = Vec::new();
    let mut checks = Vec::new();
    for &property in properties.iter().filter(|&&property| is_swept(property)) {
        for options in variants() {
            let judge = move |class: &sweep::Class<'_>, options: &Options| {
                let Ok(case) = class.pair.open(class.case.activation) else { return Judgement::Fails };
                let second = Second { case, side: Side::Current };
                let trial = Trial { case, second, options: *options };
                let mut memory = Memory { first: &mut [], second: &mut [] };
                guarded(property, engine, &trial, &mut memory)
            };
            if looks_at_fallback(property) || options.fallback == Fallback::FirstCome {
                checks.push(sweep::Check { property: judge, options });
                asked.push((property, options));
            }
        }
    }
    let start = Instant::now();
    let checked = sweep::check(domain, &checks, Detail::Merged, progress)?;
    // One sweep answers all, so its time is spread over them.
    let time = start.elapsed().checked_div(u32::try_from(asked.len()).unwrap_or(u32::MAX));
    let mut reports = Vec::new();
    for ((property, options), checked) in asked.into_iter().zip(checked) {
        let fallbacks: &[Fallback] =
            if looks_at_fallback(property) { &[options.fallback] } else { Fallback::ALL };
        for &fallback in fallbacks {
            let options = Options { fallback, ..options };
            let counterexample = checked.counterexample.as_ref().map(|pair| Counterexample {
                activation: domain.rows().iter().map(|row| row.to_vec()).collect(),
                users: vec![pair.current.owned(), pair.interrupting.owned()],
                altered: None,
                options,
            });
            reports.push(Report {
                property: property.name(),
                options,
                verdict: verdict(counterexample.as_ref()),
                expected: expected(property, &options),
                method: "sweep",
                domain: name.clone(),
                cases: checked.pairs,
                classes: Some(checked.classes),
                nonvacuous: checked.nonvacuous,
                failing: Some(checked.failing),
                counterexample,
                time: time.unwrap_or_default(),
            });
        }
    }
    Ok(reports)
}

/// Whether a property depends on nothing but what all pairs of a class of the sweep share
/// ([`sweep::Grain`]): then one pair of each class stands for all of it.
///
/// What looks at single totals or at the transcript (`no-overflow`, `bounded-disclosure`),
/// or compares with altered users (hiding, another order, a further condition), does not.
#[must_use]
pub const fn is_swept(property: Property) -> bool {
    matches!(
        property,
        Property::Termination
            | Property::ExactTermination
            | Property::ClosedForm
            | Property::RoleSymmetry
            | Property::RoleSymmetryException
            | Property::Unanimity
            | Property::OneSidedOptimality
    )
}

/// Checks a property of `policy` on every triple of outcomes and on every three users of
/// `domain`. A property that holds, holds for the triples; one that fails is refuted by
/// three users.
///
/// `expected` is what the table says, for the published policy
/// [`expected_of_policy`](crate::expected::expected_of_policy).
pub fn verify_policy<P: Policy + Sync, E: Engine + Sync>(
    property: PolicyProperty,
    options: &Options,
    policy: &P,
    engine: &E,
    domain: &Domain,
    expected: Verdict,
) -> Report {
    let start = Instant::now();
    let triples = outcome_triples();
    let judgements: Vec<Judgement> = triples.iter().map(|&triple| property.check(policy, triple)).collect();
    let count = |which: fn(&Judgement) -> bool| judgements.iter().filter(|j| which(j)).map(|_| 1_u128).sum();
    let failing: u128 = count(|&judgement| judgement == Judgement::Fails);
    if failing == 0 {
        return Report {
            property: property.name(),
            options: *options,
            verdict: Verdict::Holds,
            expected,
            method: "outcomes",
            domain: "every triple of bilateral outcomes".to_owned(),
            classes: None,
            cases: judgements.iter().map(|_| 1_u128).sum(),
            nonvacuous: count(|&judgement| judgement != Judgement::Vacuous),
            failing: Some(failing),
            counterexample: None,
            time: start.elapsed(),
        };
    }
    let tally = enumerate_policy(property, policy, engine, domain, options);
    Report {
        property: property.name(),
        options: *options,
        verdict: verdict(tally.smallest.as_ref()),
        expected,
        method: "enumeration",
        domain: domain.name.to_owned(),
        cases: tally.cases,
        classes: None,
        nonvacuous: tally.nonvacuous,
        failing: Some(tally.failing),
        counterexample: tally.smallest,
        time: start.elapsed(),
    }
}

fn verdict(counterexample: Option<&Counterexample>) -> Verdict {
    match counterexample {
        Some(_) => Verdict::Fails,
        None => Verdict::Holds,
    }
}
