//! A check that has not been seen failing is not a check: for each property an engine (or a
//! policy) that is broken in the one way that the property is there to notice. Literal
//! enumeration of a small domain must notice it, and must find nothing wrong with the
//! engine that robots run.

use std::sync::atomic::{AtomicU32, Ordering};

use selfneg_core::policy::Arrival;
use selfneg_core::{
    Aggregation, Conclusion, Condition, Disclosure, Ending, Impact, Observer, Options, Outcome, QuitRule,
    Ruling, Side, TieRule, Weighing,
};
use selfneg_proofs::case::OpenCase;
use selfneg_proofs::engine::{Core, Engine};
use selfneg_proofs::enumeration::Domain;
use selfneg_proofs::expected::expected_of_policy;
use selfneg_proofs::measure;
use selfneg_proofs::property::Property;
use selfneg_proofs::property::policy::{Bilateral, Policy, PolicyProperty, Published};
use selfneg_proofs::report::{verify_over, verify_policy};

const SMALL: &[Domain] = &[Domain::TWO, Domain::SHARED_TWO];
const HIGH: &[Domain] = &[Domain::THREE_HIGH];

fn default() -> Options {
    Options::default()
}

/// Enumeration of `domains` bears out the expected verdict on the real engine, and not on
/// `double`.
fn kills<E: Engine + Sync>(property: Property, options: Options, domains: &[Domain], double: &E) {
    let real = verify_over(property, &options, &Core, domains);
    assert!(real.is_as_expected(), "the real engine, {options}: {real:?}");
    let broken = verify_over(property, &options, double, domains);
    assert_ne!(broken.verdict, broken.expected, "{property} does not notice the double under {options}");
}

/// An engine made of a function from the case and what the real engine concludes.
struct Concludes<F>(F);

impl<F: Fn(&OpenCase<'_>, &Options, Conclusion) -> Conclusion> Engine for Concludes<F> {
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion {
        (self.0)(case, options, Core.negotiate(case, options, observer))
    }
}

/// The real engine's conclusion with another outcome.
fn with(outcome: Outcome, conclusion: Conclusion) -> Conclusion {
    Conclusion { outcome, ..conclusion }
}

/// Has each user quit twice when there is no agreement.
struct QuitsTwice;

impl Engine for QuitsTwice {
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion {
        let mut conclusion = Core.negotiate(case, options, observer);
        if conclusion.ending == Ending::BothQuit {
            for side in [Side::Current, Side::Interrupting] {
                conclusion.rounds += 1;
                observer.quit(conclusion.rounds, side);
            }
        }
        conclusion
    }
}

#[test]
fn termination() {
    kills(Property::Termination, default(), SMALL, &QuitsTwice);
}

/// Takes the first quit for the end.
struct EndsAtFirstQuit;

struct UntilQuit<'o, O> {
    inner: &'o mut O,
    ended: Option<u32>,
}

impl<O: Observer> Observer for UntilQuit<'_, O> {
    fn offer(&mut self, round: u32, sender: Side, depth: usize, discloses: Disclosure) {
        if self.ended.is_none() {
            self.inner.offer(round, sender, depth, discloses);
        }
    }
    fn quit(&mut self, round: u32, sender: Side) {
        if self.ended.is_none() {
            self.inner.quit(round, sender);
            self.ended = Some(round);
        }
    }
}

impl Engine for EndsAtFirstQuit {
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion {
        let mut until = UntilQuit { inner: observer, ended: None };
        let conclusion = Core.negotiate(case, options, &mut until);
        match until.ended {
            Some(rounds) => Conclusion { outcome: Outcome::NoAgreement, rounds, ending: conclusion.ending },
            None => conclusion,
        }
    }
}

#[test]
fn exact_termination() {
    kills(Property::ExactTermination, default(), SMALL, &EndsAtFirstQuit);
}

/// Lets the current user win when each accepts first at the same depth.
fn favours_current(case: &OpenCase<'_>, options: &Options, conclusion: Conclusion) -> Conclusion {
    let depth = |side| measure::acceptance(case, options, side).map(|acceptance| acceptance.depth);
    match (depth(Side::Current), depth(Side::Interrupting)) {
        (Some(c), Some(i)) if c == i => with(Outcome::Agreement(Side::Current), conclusion),
        _ => conclusion,
    }
}

#[test]
fn closed_form() {
    kills(Property::ClosedForm, default(), SMALL, &Concludes(favours_current));
}

#[test]
fn role_symmetry_exception() {
    kills(Property::RoleSymmetryException, default(), SMALL, &Concludes(favours_current));
}

/// Knows no tie rule but the default.
struct IgnoresTieRule;

impl Engine for IgnoresTieRule {
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion {
        Core.negotiate(case, &Options { tie: TieRule::FirstSender, ..*options }, observer)
    }
}

#[test]
fn role_symmetry() {
    for tie in [TieRule::Fallback, TieRule::Surplus] {
        let domains = &[Domain::THREE_HIGH, Domain::TWO_WIDE];
        kills(Property::RoleSymmetry, Options { tie, ..default() }, domains, &IgnoresTieRule);
    }
}

/// Counts its calls, and it shows.
#[derive(Default)]
struct Moody(AtomicU32);

impl Engine for Moody {
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion {
        let conclusion = Core.negotiate(case, options, observer);
        Conclusion { rounds: conclusion.rounds + self.0.fetch_add(1, Ordering::Relaxed), ..conclusion }
    }
}

#[test]
fn determinism() {
    kills(Property::Determinism, default(), SMALL, &Moody::default());
}

/// Never agrees.
fn stubborn(_: &OpenCase<'_>, _: &Options, conclusion: Conclusion) -> Conclusion {
    with(Outcome::NoAgreement, conclusion)
}

#[test]
fn unanimity() {
    kills(Property::Unanimity, default(), SMALL, &Concludes(stubborn));
}

/// Takes the winner for the loser.
fn inverted(_: &OpenCase<'_>, _: &Options, conclusion: Conclusion) -> Conclusion {
    match conclusion.outcome {
        Outcome::Agreement(side) => with(Outcome::Agreement(side.other()), conclusion),
        Outcome::NoAgreement => conclusion,
    }
}

#[test]
fn one_sided_optimality() {
    kills(Property::OneSidedOptimality, default(), SMALL, &Concludes(inverted));
}

/// Tells the observer other totals than the receiver weighed.
struct Weighs<F>(F);

struct Reweighed<'o, O, F> {
    inner: &'o mut O,
    edit: F,
}

impl<O: Observer, F: Fn(Side, Weighing) -> Weighing> Observer for Reweighed<'_, O, F> {
    fn offer(&mut self, round: u32, sender: Side, depth: usize, discloses: Disclosure) {
        self.inner.offer(round, sender, depth, discloses);
    }
    fn weighed(&mut self, receiver: Side, weighing: Weighing) {
        self.inner.weighed(receiver, (self.edit)(receiver, weighing));
    }
    fn ruled(&mut self, receiver: Side, ruling: Ruling) {
        self.inner.ruled(receiver, ruling);
    }
    fn quit(&mut self, round: u32, sender: Side) {
        self.inner.quit(round, sender);
    }
    fn concluded(&mut self, conclusion: Conclusion) {
        self.inner.concluded(conclusion);
    }
}

impl<F: Fn(&OpenCase<'_>, Side, Weighing) -> Weighing> Engine for Weighs<F> {
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion {
        let edit = |receiver, weighing| (self.0)(case, receiver, weighing);
        Core.negotiate(case, options, &mut Reweighed { inner: observer, edit })
    }
}

/// Weighs how many conditions the sender still has.
fn peeks(case: &OpenCase<'_>, receiver: Side, weighing: Weighing) -> Weighing {
    let secret = u64::try_from(case.user(receiver.other()).conditions().len()).unwrap_or(u64::MAX);
    Weighing { value: Impact(weighing.value.0 + secret), ..weighing }
}

#[test]
fn decision_locality() {
    kills(Property::DecisionLocality, default(), SMALL, &Weighs(peeks));
}

/// Breaks off as soon as the current user has a certain condition, disclosed or not.
fn prejudiced(case: &OpenCase<'_>, _: &Options, conclusion: Conclusion) -> Conclusion {
    match case.current.conditions().contains(&Condition(2)) {
        true => with(Outcome::NoAgreement, conclusion),
        false => conclusion,
    }
}

#[test]
fn transcript_locality() {
    kills(Property::TranscriptLocality, default(), HIGH, &Concludes(prejudiced));
}

/// Discloses one more condition after an offer was accepted.
struct Blurts;

struct GoesOn<'o, O> {
    inner: &'o mut O,
    depth: usize,
}

impl<O: Observer> Observer for GoesOn<'_, O> {
    fn offer(&mut self, round: u32, sender: Side, depth: usize, discloses: Disclosure) {
        self.depth = depth;
        self.inner.offer(round, sender, depth, discloses);
    }
    fn weighed(&mut self, receiver: Side, weighing: Weighing) {
        self.inner.weighed(receiver, weighing);
    }
    fn ruled(&mut self, receiver: Side, ruling: Ruling) {
        self.inner.ruled(receiver, ruling);
    }
    fn quit(&mut self, round: u32, sender: Side) {
        self.inner.quit(round, sender);
    }
    fn concluded(&mut self, conclusion: Conclusion) {
        if let Outcome::Agreement(side) = conclusion.outcome {
            self.inner.offer(conclusion.rounds, side, self.depth + 1, Disclosure::Condition(Condition(0)));
        }
        self.inner.concluded(conclusion);
    }
}

impl Engine for Blurts {
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion {
        Core.negotiate(case, options, &mut GoesOn { inner: observer, depth: 0 })
    }
}

#[test]
fn bounded_disclosure() {
    kills(Property::BoundedDisclosure, default(), SMALL, &Blurts);
}

/// Gives the robot to the user with fewer conditions.
fn rewards_having_less(case: &OpenCase<'_>, _: &Options, conclusion: Conclusion) -> Conclusion {
    let side = match case.current.conditions().len() <= case.interrupting.conditions().len() {
        true => Side::Current,
        false => Side::Interrupting,
    };
    with(Outcome::Agreement(side), conclusion)
}

#[test]
fn gaining_last() {
    kills(Property::GainingLast, default(), SMALL, &Concludes(rewards_having_less));
}

#[test]
fn hiding_needs_mutual_deference() {
    kills(Property::HidingNeedsDeference, default(), HIGH, &Concludes(rewards_having_less));
}

#[test]
fn sorted_hide_proofness() {
    kills(Property::SortedHideProofness, default(), SMALL, &Concludes(rewards_having_less));
}

/// Looks at nothing but who discloses the condition of the least number first.
fn first_condition_decides(case: &OpenCase<'_>, _: &Options, conclusion: Conclusion) -> Conclusion {
    match case.current.conditions().first() <= case.interrupting.conditions().first() {
        true => with(Outcome::Agreement(Side::Current), conclusion),
        false => with(Outcome::Agreement(Side::Interrupting), conclusion),
    }
}

#[test]
fn order_needs_mutual_deference() {
    let double = Concludes(first_condition_decides);
    kills(Property::OrderNeedsDeference, default(), &[Domain::THREE_ORDERED], &double);
}

// These three fail on the real engine: the double is one on which they hold, so that the
// counterexample is missing.

#[test]
fn hide_proofness() {
    kills(Property::HideProofness, default(), HIGH, &Concludes(stubborn));
}

#[test]
fn order_independence() {
    kills(Property::OrderIndependence, default(), &[Domain::THREE_ORDERED], &Concludes(stubborn));
}

#[test]
fn misreport_proofness() {
    kills(Property::MisreportProofness, default(), SMALL, &Concludes(stubborn));
}

/// Adds up in two bits.
fn saturates(_: &OpenCase<'_>, _: Side, weighing: Weighing) -> Weighing {
    Weighing { value: Impact(weighing.value.0.min(3)), ..weighing }
}

#[test]
fn no_overflow() {
    kills(Property::NoOverflow, default(), SMALL, &Weighs(saturates));
}

/// What the published code does with a user without conditions.
fn crashes(case: &OpenCase<'_>, _: &Options, conclusion: Conclusion) -> Conclusion {
    assert!(!case.interrupting.conditions().is_empty(), "no offer: this panic is part of the test");
    conclusion
}

#[test]
fn no_panic() {
    kills(Property::NoPanic, default(), &[Domain::SHARED_TWO], &Concludes(crashes));
}

/// The literal quit rule under the published one's name: what a variant's row guards
/// against.
struct AlwaysLiteral;

impl Engine for AlwaysLiteral {
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion {
        Core.negotiate(case, &Options { quit: QuitRule::Literal, ..*options }, observer)
    }
}

#[test]
fn mixed_up_variants() {
    kills(Property::ClosedForm, default(), SMALL, &AlwaysLiteral);
    kills(Property::Unanimity, default(), SMALL, &AlwaysLiteral);
}

/// Takes one aggregation for the other.
struct AlwaysPerCondition;

impl Engine for AlwaysPerCondition {
    fn negotiate<O: Observer>(&self, case: &OpenCase<'_>, options: &Options, observer: &mut O) -> Conclusion {
        Core.negotiate(case, &Options { aggregation: Aggregation::PerCondition, ..*options }, observer)
    }
}

#[test]
fn mixed_up_aggregations() {
    let options = Options { aggregation: Aggregation::PerDisposition, ..default() };
    kills(Property::NoOverflow, options, SMALL, &AlwaysPerCondition);
    kills(Property::ClosedForm, options, SMALL, &AlwaysPerCondition);
}

/// A policy made of a function.
struct Chooses<F>(F);

impl<F: Fn(Bilateral) -> Option<Arrival>> Policy for Chooses<F> {
    fn choose(&self, outcomes: Bilateral) -> Option<Arrival> {
        (self.0)(outcomes)
    }
}

fn kills_policy<P: Policy + Sync>(property: PolicyProperty, double: &P) {
    let domain = Domain::THREE_LOW;
    let real = verify_policy(
        property,
        &default(),
        &Published,
        &Core,
        &domain,
        expected_of_policy(property, &default()),
    );
    assert!(real.is_as_expected(), "the published policy: {real:?}");
    let broken =
        verify_policy(property, &default(), double, &Core, &domain, expected_of_policy(property, &default()));
    assert_ne!(broken.verdict, broken.expected, "{property} does not notice the double");
}

#[test]
fn condorcet_consistency() {
    kills_policy(
        PolicyProperty::CondorcetConsistency,
        &Chooses(|outcomes| match Published.choose(outcomes) {
            Some(Arrival::C) => Some(Arrival::B),
            chosen => chosen,
        }),
    );
}

#[test]
fn agreement_has_cause() {
    kills_policy(PolicyProperty::AgreementHasCause, &Chooses(|_| Some(Arrival::A)));
}

#[test]
fn unbeaten_service() {
    kills_policy(PolicyProperty::UnbeatenService, &Chooses(|_| None));
}
