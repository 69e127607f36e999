//! The harnesses' bodies. Each asserts what the table of expected verdicts says, for every
//! variant that it says it of, and covers each outcome that it claims to reach.

use selfneg_core::policy::Arrival;
use selfneg_core::{Condition, Fallback, Options, Outcome, QuitRule, Rank, Side, TieRule};

use super::witness::refuted;
use super::{
    APART, DISPOSITIONS, GOAL, Layout, SHARED, SHORT, Source, choose, draw_case, draw_options, draw_ranks,
};
use crate::case::{OpenCase, OpenUser};
use crate::engine::Core;
use crate::expected::{Verdict, expected};
use crate::property::policy::{Bilateral, Policy, PolicyProperty, Published};
use crate::property::{Judgement, Property, Second, Trial, closed_form as closed_form_of};
use crate::transcript::{Memory, Round};

/// Under Kani a cover property of the line where it stands, which is why it is a macro.
macro_rules! cover {
    ($source:expr, $condition:expr, $what:literal) => {{
        #[cfg(kani)]
        kani::cover!($condition, $what);
        #[cfg(not(kani))]
        if $condition {
            $source.covered($what);
        }
    }};
}

/// What a body saw, for its covers.
struct Seen {
    judgement: Judgement,
    options: Options,
    outcome: Outcome,
}

impl Seen {
    const NOTHING: Self = Self {
        judgement: Judgement::Vacuous,
        options: Options {
            quit: QuitRule::Exhausted,
            aggregation: selfneg_core::Aggregation::PerCondition,
            tie: TieRule::FirstSender,
            fallback: Fallback::FirstCome,
            willingness: 0,
        },
        outcome: Outcome::NoAgreement,
    };

    fn held(&self) -> bool {
        matches!(self.judgement, Judgement::Holds)
    }

    fn held_with(&self, outcome: Outcome) -> bool {
        self.held() && self.outcome == outcome
    }

    fn held_under(&self, quit: QuitRule) -> bool {
        self.held()
            && matches!(
                (self.options.quit, quit),
                (QuitRule::Exhausted, QuitRule::Exhausted) | (QuitRule::Literal, QuitRule::Literal)
            )
    }
}

const CURRENT: Outcome = Outcome::Agreement(Side::Current);
const INTERRUPTING: Outcome = Outcome::Agreement(Side::Interrupting);

fn judge(property: Property, case: &OpenCase<'_>, second: Second<'_>, options: Options) -> Judgement {
    let (mut first_room, mut second_room) = ([Round::BLANK; 12], [Round::BLANK; 12]);
    let mut memory = Memory { first: &mut first_room, second: &mut second_room };
    property.check(&Core, &Trial { case: *case, second, options }, &mut memory)
}

/// Asserts a one-run property for every variant of which it is expected to hold.
fn holds<S: Source + ?Sized>(source: &mut S, property: Property, layout: &Layout) -> Seen {
    let options = draw_options(source);
    if matches!(expected(property, &options), Verdict::Fails) {
        return Seen::NOTHING;
    }
    let seen = draw_case(source, layout, |_, case| {
        let judgement = judge(property, case, Second { case: *case, side: Side::Current }, options);
        Seen { judgement, options, outcome: closed_form_of(case, &options) }
    });
    let seen = seen.unwrap_or(Seen::NOTHING);
    assert!(!matches!(seen.judgement, Judgement::Fails), "a case refutes what should hold");
    seen
}

/// Asserts a two-run property for every variant of which it is expected to hold, with the
/// second cases that `alter` makes of the first in `ways` ways (up to 4).
fn holds_twice<S: Source + ?Sized>(
    source: &mut S,
    property: Property,
    ways: u8,
    alter: impl FnOnce(&mut S, u8, &OpenUser<'_>, &mut [Rank; DISPOSITIONS], &mut [Condition; 3]) -> usize,
) -> Seen {
    let options = draw_options(source);
    if matches!(expected(property, &options), Verdict::Fails) {
        return Seen::NOTHING;
    }
    let seen = draw_case(source, &SHORT, |source, case| {
        choose(source, 2, |source, side| {
            let side = if side == 0 { Side::Current } else { Side::Interrupting };
            choose(source, ways, |source, way| {
                let mut ranks = copy_of(case.user(side).ranks());
                let mut conditions = [Condition(0); 3];
                let count = alter(source, way, case.user(side), &mut ranks, &mut conditions);
                let altered = match (count, &conditions) {
                    (0, _) => OpenUser::new(&ranks, &[], GOAL),
                    (1, [a, ..]) => OpenUser::new(&ranks, std::slice::from_ref(a), GOAL),
                    (2, [two @ .., _]) => OpenUser::new(&ranks, two, GOAL),
                    (_, all) => OpenUser::new(&ranks, all, GOAL),
                };
                let Ok(altered) = altered else { return Seen::NOTHING };
                let second = Second { case: case.with(side, altered), side };
                let judgement = judge(property, case, second, options);
                Seen { judgement, options, outcome: closed_form_of(case, &options) }
            })
        })
    });
    let seen = seen.unwrap_or(Seen::NOTHING);
    assert!(!matches!(seen.judgement, Judgement::Fails), "a case refutes what should hold");
    seen
}

fn copy_of(ranks: &[Rank]) -> [Rank; DISPOSITIONS] {
    let mut copy = [Rank(0); DISPOSITIONS];
    let mut i = 0;
    while let (Some(place), Some(&rank)) = (copy.get_mut(i), ranks.get(i)) {
        *place = rank;
        i += 1;
    }
    copy
}

fn copy_conditions(from: &[Condition], to: &mut [Condition; 3]) -> usize {
    let mut i = 0;
    while let (Some(place), Some(&condition)) = (to.get_mut(i), from.get(i)) {
        *place = condition;
        i += 1;
    }
    i
}

/// Leaves out the condition at `hidden`, if there is one.
fn hide(hidden: u8, user: &OpenUser<'_>, conditions: &mut [Condition; 3]) -> usize {
    let (mut from, mut to) = (0, 0);
    while let Some(&condition) = user.conditions().get(from) {
        if from != usize::from(hidden) {
            if let Some(place) = conditions.get_mut(to) {
                *place = condition;
            }
            to += 1;
        }
        from += 1;
    }
    to
}

/// Discloses the first two conditions in each other's place.
fn swap(user: &OpenUser<'_>, conditions: &mut [Condition; 3]) -> usize {
    let count = copy_conditions(user.conditions(), conditions);
    if count >= 2 {
        let [first, second, _] = conditions;
        std::mem::swap(first, second);
    }
    count
}

/// Keeps none or one of the conditions and goes on with one of two others.
fn other_tail(way: u8, user: &OpenUser<'_>, conditions: &mut [Condition; 3]) -> usize {
    let (kept, tail) = match way {
        0 => (0, Condition(2)),
        1 => (1, Condition(2)),
        2 => (0, Condition(5)),
        _ => (1, Condition(5)),
    };
    let count = copy_conditions(user.conditions(), conditions);
    let kept = if kept < count { kept } else { count };
    if let Some(place) = conditions.get_mut(kept) {
        *place = tail;
    }
    kept + 1
}

pub(super) fn termination<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::Termination, &APART);
    cover!(source, seen.held_with(CURRENT), "the current user wins");
    cover!(source, seen.held_with(INTERRUPTING), "the interrupting user wins");
    cover!(source, seen.held_with(Outcome::NoAgreement), "no agreement");
    cover!(source, seen.held_under(QuitRule::Literal), "under the literal quit rule");
}

pub(super) fn exact_termination<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::ExactTermination, &APART);
    cover!(source, seen.held_with(CURRENT), "the current user wins");
    cover!(source, seen.held_with(INTERRUPTING), "the interrupting user wins");
    cover!(source, seen.held_with(Outcome::NoAgreement), "no agreement");
}

pub(super) fn closed_form<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::ClosedForm, &APART);
    let literal = seen.held_under(QuitRule::Literal);
    let exhausted = seen.held_under(QuitRule::Exhausted);
    cover!(source, exhausted && seen.outcome == CURRENT, "the current user wins");
    cover!(source, exhausted && seen.outcome == INTERRUPTING, "the interrupting user wins");
    cover!(source, exhausted && seen.outcome == Outcome::NoAgreement, "no agreement");
    cover!(source, literal && seen.outcome == CURRENT, "literal: the current user wins");
    cover!(source, literal && seen.outcome == INTERRUPTING, "literal: the interrupting user wins");
    cover!(source, literal && seen.outcome == Outcome::NoAgreement, "literal: no agreement");
    cover!(source, seen.held() && seen.options.tie == TieRule::Fallback, "tie fallback");
    cover!(source, seen.held() && seen.options.tie == TieRule::Surplus, "tie surplus");
    cover!(source, seen.held() && seen.options.willingness == 2, "willingness");
}

pub(super) fn closed_form_shared<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::ClosedForm, &SHARED);
    let set = seen.options.aggregation == selfneg_core::Aggregation::PerDisposition;
    cover!(source, seen.held_with(CURRENT), "the current user wins");
    cover!(source, seen.held_with(INTERRUPTING), "the interrupting user wins");
    cover!(source, seen.held_with(Outcome::NoAgreement), "no agreement");
    cover!(source, seen.held() && set && seen.outcome == CURRENT, "per disposition: the current user wins");
    cover!(
        source,
        seen.held() && set && seen.outcome == INTERRUPTING,
        "per disposition: the interrupting user wins"
    );
}

pub(super) fn determinism<S: Source + ?Sized>(source: &mut S) {
    // The altered user is a copy of the first one in other memory.
    let seen = holds_twice(source, Property::Determinism, 1, |_, _, user, _, conditions| {
        copy_conditions(user.conditions(), conditions)
    });
    cover!(source, seen.held_with(CURRENT), "the current user wins");
    cover!(source, seen.held_with(INTERRUPTING), "the interrupting user wins");
    cover!(source, seen.held_with(Outcome::NoAgreement), "no agreement");
}

pub(super) fn role_symmetry<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::RoleSymmetry, &APART);
    cover!(source, seen.held_with(CURRENT), "the current user wins both times");
    cover!(source, seen.held_with(INTERRUPTING), "the interrupting user wins both times");
}

pub(super) fn role_symmetry_exception<S: Source + ?Sized>(source: &mut S) {
    let mut deferring = false;
    let options = draw_options(source);
    if matches!(expected(Property::RoleSymmetryException, &options), Verdict::Fails) {
        return;
    }
    let seen = draw_case(source, &APART, |_, case| {
        let of = |side| crate::measure::acceptance(case, &options, side);
        if let (Some(c), Some(i)) = (of(Side::Current), of(Side::Interrupting)) {
            deferring = c.depth == i.depth;
        }
        let second = Second { case: *case, side: Side::Current };
        let judgement = judge(Property::RoleSymmetryException, case, second, options);
        Seen { judgement, options, outcome: closed_form_of(case, &options) }
    });
    let seen = seen.unwrap_or(Seen::NOTHING);
    assert!(!matches!(seen.judgement, Judgement::Fails), "a case refutes what should hold");
    cover!(source, seen.held() && deferring, "each accepts first at the same depth");
    cover!(source, seen.held_with(CURRENT), "the current user wins both times");
    cover!(source, seen.held_with(INTERRUPTING) && !deferring, "the interrupting user wins both times");
}

pub(super) fn unanimity<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::Unanimity, &APART);
    cover!(source, seen.held_with(CURRENT), "the current user wins");
    cover!(source, seen.held_with(INTERRUPTING), "the interrupting user wins");
    cover!(source, seen.held_with(Outcome::NoAgreement), "the fallback serves whom both prefer");
    cover!(source, seen.held_under(QuitRule::Literal), "under the literal quit rule");
}

pub(super) fn one_sided_optimality<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::OneSidedOptimality, &APART);
    cover!(source, seen.held_with(CURRENT), "the current user wins");
    cover!(source, seen.held_with(INTERRUPTING), "the interrupting user wins");
}

pub(super) fn decision_locality<S: Source + ?Sized>(source: &mut S) {
    let seen = holds_twice(source, Property::DecisionLocality, 4, |source, way, user, ranks, conditions| {
        *ranks = draw_ranks(source);
        other_tail(way, user, conditions)
    });
    cover!(source, seen.held_under(QuitRule::Exhausted), "an offer in common");
    cover!(source, seen.held_under(QuitRule::Literal), "an offer in common, literal");
}

pub(super) fn transcript_locality<S: Source + ?Sized>(source: &mut S) {
    let seen = holds_twice(source, Property::TranscriptLocality, 4, |_, way, user, _, conditions| {
        other_tail(way, user, conditions)
    });
    cover!(source, seen.held_under(QuitRule::Exhausted), "something else is undisclosed");
    cover!(source, seen.held_under(QuitRule::Literal), "something else is undisclosed, literal");
}

pub(super) fn bounded_disclosure<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::BoundedDisclosure, &APART);
    cover!(source, seen.held_with(CURRENT), "the current user wins");
    cover!(source, seen.held_with(INTERRUPTING), "the interrupting user wins");
    cover!(source, seen.held_with(Outcome::NoAgreement), "no agreement");
}

pub(super) fn gaining_last<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::GainingLast, &APART);
    cover!(source, seen.held_with(CURRENT), "the current user still wins");
    cover!(source, seen.held_with(INTERRUPTING), "the interrupting user still wins");
}

pub(super) fn hiding_needs_mutual_deference<S: Source + ?Sized>(source: &mut S) {
    let seen = holds_twice(source, Property::HidingNeedsDeference, 2, |_, way, user, _, conditions| {
        hide(way, user, conditions)
    });
    cover!(source, seen.held_with(CURRENT), "hiding makes the interrupting user win");
    cover!(source, seen.held_with(INTERRUPTING), "hiding makes the current user win");
}

pub(super) fn sorted_hide_proofness<S: Source + ?Sized>(source: &mut S) {
    let seen = holds_twice(source, Property::SortedHideProofness, 2, |_, way, user, _, conditions| {
        hide(way, user, conditions)
    });
    cover!(source, seen.held_under(QuitRule::Exhausted), "hiding does not help");
    cover!(source, seen.held_under(QuitRule::Literal), "hiding does not help, literal");
}

pub(super) fn order_needs_mutual_deference<S: Source + ?Sized>(source: &mut S) {
    let seen = holds_twice(source, Property::OrderNeedsDeference, 1, |_, _, user, _, conditions| {
        swap(user, conditions)
    });
    cover!(source, seen.held_with(CURRENT), "another order takes the current user's win");
    cover!(source, seen.held_with(INTERRUPTING), "another order takes the interrupting user's win");
}

pub(super) fn no_overflow<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::NoOverflow, &SHARED);
    let set = seen.options.aggregation == selfneg_core::Aggregation::PerDisposition;
    cover!(source, seen.held() && set, "per disposition");
    cover!(source, seen.held() && !set, "per condition");
}

pub(super) fn no_panic<S: Source + ?Sized>(source: &mut S) {
    let seen = holds(source, Property::NoPanic, &SHARED);
    cover!(source, seen.held() && seen.options.fallback == Fallback::FirstCome, "first come");
    cover!(source, seen.held() && seen.options.fallback == Fallback::Utilitarian, "utilitarian");
}

fn draw_outcome<S: Source + ?Sized>(source: &mut S) -> Outcome {
    match source.below(3) {
        0 => CURRENT,
        1 => INTERRUPTING,
        _ => Outcome::NoAgreement,
    }
}

fn draw_outcomes<S: Source + ?Sized>(source: &mut S) -> Bilateral {
    Bilateral { ab: draw_outcome(source), ac: draw_outcome(source), bc: draw_outcome(source) }
}

pub(super) fn condorcet_consistency<S: Source + ?Sized>(source: &mut S) {
    let outcomes = draw_outcomes(source);
    let judgement = PolicyProperty::CondorcetConsistency.check(&Published, outcomes);
    assert!(judgement != Judgement::Fails, "a triple of outcomes refutes what should hold");
    let chosen = Published.choose(outcomes);
    let held = judgement == Judgement::Holds;
    cover!(source, held && chosen == Some(Arrival::A), "A beats both");
    cover!(source, held && chosen == Some(Arrival::B), "B beats both");
    cover!(source, held && chosen == Some(Arrival::C), "C beats both");
}

pub(super) fn agreement_has_cause<S: Source + ?Sized>(source: &mut S) {
    let outcomes = draw_outcomes(source);
    let judgement = PolicyProperty::AgreementHasCause.check(&Published, outcomes);
    assert!(judgement != Judgement::Fails, "a triple of outcomes refutes what should hold");
    let chosen = Published.choose(outcomes);
    cover!(source, chosen == Some(Arrival::A), "A is served");
    cover!(source, chosen == Some(Arrival::B), "B is served");
    cover!(source, chosen == Some(Arrival::C), "C is served");
}

/// Asserts, for every variant of which `property` is expected to fail, that one of its
/// witnesses refutes it. The users are concrete, the variant is drawn.
fn fails<S: Source + ?Sized>(source: &mut S, property: Property) -> Option<Options> {
    let options = draw_options(source);
    if matches!(expected(property, &options), Verdict::Holds) {
        return None;
    }
    assert!(refuted(property, &Core, &options), "no witness refutes what should fail");
    Some(options)
}

fn exhausted(seen: Option<Options>) -> bool {
    matches!(seen, Some(Options { quit: QuitRule::Exhausted, .. }))
}

fn literal(seen: Option<Options>) -> bool {
    matches!(seen, Some(Options { quit: QuitRule::Literal, .. }))
}

fn willing(seen: Option<Options>) -> bool {
    matches!(seen, Some(Options { willingness: 1.., quit: QuitRule::Exhausted, .. }))
}

fn unwilling(seen: Option<Options>) -> bool {
    matches!(seen, Some(Options { willingness: 0, quit: QuitRule::Exhausted, .. }))
}

pub(super) fn exact_termination_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::ExactTermination);
    cover!(source, exhausted(seen), "with held offers");
    cover!(source, literal(seen), "under the literal quit rule");
}

pub(super) fn role_symmetry_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::RoleSymmetry);
    cover!(source, unwilling(seen), "by mutual deference at equal depth");
    cover!(source, willing(seen), "by willingness");
    cover!(source, literal(seen), "under the literal quit rule");
}

pub(super) fn role_symmetry_exception_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::RoleSymmetryException);
    cover!(source, unwilling(seen), "with held offers");
    cover!(source, willing(seen), "by willingness");
    cover!(source, literal(seen), "under the literal quit rule");
}

pub(super) fn unanimity_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::Unanimity);
    cover!(source, willing(seen), "by willingness");
    cover!(source, literal(seen), "under the literal quit rule");
}

pub(super) fn one_sided_optimality_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::OneSidedOptimality);
    cover!(source, willing(seen), "by willingness");
}

pub(super) fn hide_proofness_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::HideProofness);
    cover!(source, exhausted(seen), "under the quit rule exhausted");
    cover!(source, literal(seen), "under the literal quit rule");
}

pub(super) fn hiding_needs_mutual_deference_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::HidingNeedsDeference);
    cover!(source, literal(seen), "under the literal quit rule");
}

pub(super) fn sorted_hide_proofness_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::SortedHideProofness);
    cover!(source, exhausted(seen), "per disposition");
}

pub(super) fn order_independence_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::OrderIndependence);
    cover!(source, exhausted(seen), "under the quit rule exhausted");
    cover!(source, literal(seen), "under the literal quit rule");
}

pub(super) fn order_needs_mutual_deference_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::OrderNeedsDeference);
    cover!(source, literal(seen), "under the literal quit rule");
}

pub(super) fn misreport_proofness_fails<S: Source + ?Sized>(source: &mut S) {
    let seen = fails(source, Property::MisreportProofness);
    cover!(source, exhausted(seen), "under the quit rule exhausted");
    cover!(source, literal(seen), "under the literal quit rule");
}

pub(super) fn unbeaten_service_fails<S: Source + ?Sized>(source: &mut S) {
    // A and B do not agree, C beats A, B beats C: the policy serves C.
    let outcomes = Bilateral { ab: Outcome::NoAgreement, ac: INTERRUPTING, bc: CURRENT };
    let judgement = PolicyProperty::UnbeatenService.check(&Published, outcomes);
    assert!(judgement == Judgement::Fails, "the policy should serve whom B beats");
    let drawn = draw_outcomes(source);
    let judgement = PolicyProperty::UnbeatenService.check(&Published, drawn);
    cover!(source, judgement == Judgement::Fails, "somebody beats whom the policy serves");
    cover!(source, judgement == Judgement::Holds, "nobody does");
}
