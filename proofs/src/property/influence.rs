//! What a user can change by having, hiding, ordering or reporting something else.

use selfneg_core::{Condition, Side};

use super::locality::{same_conditions, same_goal, same_ranks, same_user};
use crate::case::{OpenCase, OpenUser};
use crate::engine::Engine;
use crate::measure;
use crate::property::{Judgement, Trial};
use crate::transcript::Memory;

fn winner<E: Engine>(engine: &E, case: &OpenCase<'_>, trial: &Trial<'_>) -> Option<Side> {
    engine.negotiate(case, &trial.options, &mut ()).outcome.winner()
}

pub(super) fn gaining_last<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    let wins_without = |side: Side| match trial.case.user(side).without_last() {
        Some(user) => winner(engine, &trial.case.with(side, user), trial) == Some(side),
        None => false,
    };
    let current = wins_without(Side::Current);
    let interrupting = wins_without(Side::Interrupting);
    if !current && !interrupting {
        return Judgement::Vacuous;
    }
    let with = winner(engine, &trial.case, trial);
    let kept = |won: bool, side: Side| !won || with == Some(side);
    Judgement::from_bool(kept(current, Side::Current) && kept(interrupting, Side::Interrupting))
}

/// Whether `part` is `whole` with at least one condition left out, in the same order.
fn is_proper_part(part: &[Condition], whole: &[Condition]) -> bool {
    let (mut p, mut w) = (0, 0);
    while let (Some(x), Some(y)) = (part.get(p), whole.get(w)) {
        if x.0 == y.0 {
            p += 1;
        }
        w += 1;
    }
    p == part.len() && part.len() < whole.len()
}

/// Whether both have the same conditions, each once, in whatever order.
fn is_reordering(a: &OpenUser<'_>, b: &OpenUser<'_>) -> bool {
    a.conditions().len() == b.conditions().len()
        && all_within(a.conditions(), b.conditions())
        && all_within(b.conditions(), a.conditions())
}

fn all_within(these: &[Condition], those: &[Condition]) -> bool {
    let mut i = 0;
    while let Some(condition) = these.get(i) {
        let mut j = 0;
        let mut found = false;
        while let Some(other) = those.get(j) {
            found |= other.0 == condition.0;
            j += 1;
        }
        if !found {
            return false;
        }
        i += 1;
    }
    true
}

/// The user on the altered side before and after, if the other one is the same.
fn altered<'a>(trial: &Trial<'a>) -> Option<(OpenUser<'a>, OpenUser<'a>)> {
    let side = trial.second.side;
    let other = side.other();
    let before = *trial.case.user(side);
    let after = *trial.second.case.user(side);
    match same_user(trial.case.user(other), trial.second.case.user(other)) && same_goal(&before, &after) {
        true => Some((before, after)),
        false => None,
    }
}

/// Whether hiding made the user win; `None` if nothing was hidden or it wins anyway.
fn hiding_helps<E: Engine>(engine: &E, trial: &Trial<'_>) -> Option<bool> {
    let side = trial.second.side;
    let (before, after) = altered(trial)?;
    if !same_ranks(&before, &after) || !is_proper_part(after.conditions(), before.conditions()) {
        return None;
    }
    match winner(engine, &trial.case, trial) == Some(side) {
        true => None,
        false => Some(winner(engine, &trial.second.case, trial) == Some(side)),
    }
}

pub(super) fn hide_proofness<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    match hiding_helps(engine, trial) {
        None => Judgement::Vacuous,
        Some(helps) => Judgement::from_bool(!helps),
    }
}

pub(super) fn hiding_needs_deference<E: Engine>(
    engine: &E,
    trial: &Trial<'_>,
    _: &mut Memory<'_>,
) -> Judgement {
    match hiding_helps(engine, trial) {
        None | Some(false) => Judgement::Vacuous,
        Some(true) => Judgement::from_bool(measure::mutual_deference(&trial.case, &trial.options)),
    }
}

/// Whether what the conditions of the user on `side` add in the other's eyes never rises.
fn discloses_best_first(trial: &Trial<'_>, side: Side) -> bool {
    let sender = trial.case.user(side);
    let eyes = trial.case.user(side.other());
    let adds = |index| {
        measure::marginal_impact(trial.case.activation, trial.options.aggregation, eyes, sender, index)
    };
    let mut i = 1;
    while i < sender.conditions().len() {
        if adds(i) > adds(i - 1) {
            return false;
        }
        i += 1;
    }
    true
}

pub(super) fn sorted_hide_proofness<E: Engine>(
    engine: &E,
    trial: &Trial<'_>,
    memory: &mut Memory<'_>,
) -> Judgement {
    match discloses_best_first(trial, Side::Current) && discloses_best_first(trial, Side::Interrupting) {
        true => hide_proofness(engine, trial, memory),
        false => Judgement::Vacuous,
    }
}

/// Whether the order changed the outcome; `None` if it is not only the order that differs.
fn order_matters<E: Engine>(engine: &E, trial: &Trial<'_>) -> Option<bool> {
    let (before, after) = altered(trial)?;
    if !same_ranks(&before, &after) || !is_reordering(&before, &after) || same_conditions(&before, &after) {
        return None;
    }
    let outcome = engine.negotiate(&trial.case, &trial.options, &mut ()).outcome;
    Some(engine.negotiate(&trial.second.case, &trial.options, &mut ()).outcome != outcome)
}

pub(super) fn order_independence<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    match order_matters(engine, trial) {
        None => Judgement::Vacuous,
        Some(matters) => Judgement::from_bool(!matters),
    }
}

pub(super) fn order_needs_deference<E: Engine>(
    engine: &E,
    trial: &Trial<'_>,
    _: &mut Memory<'_>,
) -> Judgement {
    match order_matters(engine, trial) {
        None | Some(false) => Judgement::Vacuous,
        Some(true) => Judgement::from_bool(measure::mutual_deference(&trial.case, &trial.options)),
    }
}

pub(super) fn misreport_proofness<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    let side = trial.second.side;
    match altered(trial) {
        Some((before, after)) if same_conditions(&before, &after) && !same_ranks(&before, &after) => {}
        Some(_) | None => return Judgement::Vacuous,
    }
    if engine.serve(&trial.case, &trial.options) == side {
        return Judgement::Vacuous;
    }
    Judgement::from_bool(engine.serve(&trial.second.case, &trial.options) != side)
}
