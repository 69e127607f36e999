//! Who wins, and whether it should be that user.

use selfneg_core::{Options, Outcome, QuitRule, Side, TieRule};

use crate::case::OpenCase;
use crate::engine::Engine;
use crate::measure::{self, Acceptance};
use crate::property::{Judgement, Trial};
use crate::transcript::Memory;

/// The outcome from the least depths of acceptance and the numbers of offers alone.
///
/// Under the quit rule `exhausted` every offer gets its turn, so the smaller depth wins
/// and the tie rule decides equal ones. Under `literal` a user's offer of depth k is made
/// only if nobody has ended the negotiation before: the interrupting user's if k is at
/// most both numbers of offers (its first one in any case), the current user's if k is at
/// most the other's number and *below* its own, since it is the receiver of the
/// interrupting user's offer of that depth first. A reply to a held offer is made whatever
/// the quit rule.
#[must_use]
pub fn closed_form(case: &OpenCase<'_>, options: &Options) -> Outcome {
    let by_current = measure::acceptance(case, options, Side::Current);
    let by_interrupting = measure::acceptance(case, options, Side::Interrupting);
    let current = measure::offers(case, options, Side::Current);
    let interrupting = measure::offers(case, options, Side::Interrupting);
    let (deepest_current, deepest_interrupting) = match options.quit {
        QuitRule::Exhausted => (current, interrupting),
        QuitRule::Literal => {
            (least(current.saturating_sub(1), interrupting), least(interrupting, most(current, 1)))
        }
    };
    let made_by_current = within(by_current, deepest_current);
    let made_by_interrupting = within(by_interrupting, deepest_interrupting);
    match (made_by_interrupting, made_by_current) {
        (None, None) => Outcome::NoAgreement,
        (None, Some(_)) => Outcome::Agreement(Side::Current),
        (Some(i), Some(c)) if c.depth < i.depth => Outcome::Agreement(Side::Current),
        (Some(i), _) => match by_current {
            Some(c) if c.depth == i.depth => tie(options.tie, i, c),
            Some(_) | None => Outcome::Agreement(Side::Interrupting),
        },
    }
}

fn within(acceptance: Option<Acceptance>, deepest: usize) -> Option<Acceptance> {
    match acceptance {
        Some(acceptance) if acceptance.depth <= deepest => Some(acceptance),
        Some(_) | None => None,
    }
}

fn tie(rule: TieRule, interrupting: Acceptance, current: Acceptance) -> Outcome {
    match rule {
        TieRule::FirstSender => Outcome::Agreement(Side::Interrupting),
        TieRule::Surplus if interrupting.surplus > current.surplus => Outcome::Agreement(Side::Interrupting),
        TieRule::Surplus if current.surplus > interrupting.surplus => Outcome::Agreement(Side::Current),
        TieRule::Surplus | TieRule::Fallback => Outcome::NoAgreement,
    }
}

fn least(a: usize, b: usize) -> usize {
    if a < b { a } else { b }
}

fn most(a: usize, b: usize) -> usize {
    if a > b { a } else { b }
}

pub(super) fn closed_form_is_engine<E: Engine>(
    engine: &E,
    trial: &Trial<'_>,
    _: &mut Memory<'_>,
) -> Judgement {
    let outcome = engine.negotiate(&trial.case, &trial.options, &mut ()).outcome;
    Judgement::from_bool(outcome == closed_form(&trial.case, &trial.options))
}

/// The winners with the parts as they are and swapped, both by their part in the case as
/// it is.
fn both_ways<E: Engine>(engine: &E, trial: &Trial<'_>) -> (Option<Side>, Option<Side>) {
    let straight = engine.negotiate(&trial.case, &trial.options, &mut ()).outcome.winner();
    let swapped = engine.negotiate(&trial.case.swapped(), &trial.options, &mut ()).outcome.winner();
    (straight, swapped.map(Side::other))
}

pub(super) fn role_symmetry<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    match both_ways(engine, trial) {
        (None, None) => Judgement::Vacuous,
        (straight, swapped) => Judgement::from_bool(straight == swapped),
    }
}

pub(super) fn role_symmetry_exception<E: Engine>(
    engine: &E,
    trial: &Trial<'_>,
    _: &mut Memory<'_>,
) -> Judgement {
    let (straight, swapped) = both_ways(engine, trial);
    let by_current = measure::acceptance(&trial.case, &trial.options, Side::Current);
    let by_interrupting = measure::acceptance(&trial.case, &trial.options, Side::Interrupting);
    match (by_current, by_interrupting) {
        (Some(c), Some(i)) if c.depth == i.depth => {
            Judgement::from_bool(straight == Some(Side::Interrupting) && swapped == Some(Side::Current))
        }
        _ if straight.is_none() && swapped.is_none() => Judgement::Vacuous,
        _ => Judgement::from_bool(straight == swapped),
    }
}

pub(super) fn unanimity<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    let both_prefer = |better| {
        measure::prefers(&trial.case, trial.options.aggregation, Side::Current, better)
            && measure::prefers(&trial.case, trial.options.aggregation, Side::Interrupting, better)
    };
    let better = if both_prefer(Side::Current) {
        Side::Current
    } else if both_prefer(Side::Interrupting) {
        Side::Interrupting
    } else {
        return Judgement::Vacuous;
    };
    Judgement::from_bool(engine.serve(&trial.case, &trial.options) == better)
}

pub(super) fn one_sided_optimality<E: Engine>(
    engine: &E,
    trial: &Trial<'_>,
    _: &mut Memory<'_>,
) -> Judgement {
    let outcome = engine.negotiate(&trial.case, &trial.options, &mut ()).outcome;
    let Some(winner) = outcome.winner() else { return Judgement::Vacuous };
    let accepts = |side| measure::acceptance(&trial.case, &trial.options, side).is_some();
    if accepts(Side::Current) == accepts(Side::Interrupting) {
        return Judgement::Vacuous;
    }
    let welfare = |side| measure::welfare(&trial.case, trial.options.aggregation, side);
    Judgement::from_bool(welfare(winner) >= welfare(winner.other()))
}
