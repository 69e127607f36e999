//! What a decision can depend on: two runs that differ in what nobody was shown.

use selfneg_core::{Condition, Options, QuitRule, Ruling, Side, TieRule};

use crate::case::{OpenCase, OpenUser};
use crate::engine::Engine;
use crate::measure;
use crate::property::{Judgement, Trial};
use crate::transcript::{Memory, Recorder};

/// Whether the first `depth` conditions of both are the same; a user with fewer is taken
/// to have disclosed all it has.
fn same_prefix(a: &[Condition], b: &[Condition], depth: usize) -> bool {
    let mut i = 0;
    while i < depth {
        match (a.get(i), b.get(i)) {
            (Some(x), Some(y)) if x.0 == y.0 => i += 1,
            (None, None) => return true,
            _ => return false,
        }
    }
    true
}

pub(super) fn same_ranks(a: &OpenUser<'_>, b: &OpenUser<'_>) -> bool {
    let mut i = 0;
    while let (Some(x), Some(y)) = (a.ranks().get(i), b.ranks().get(i)) {
        if x.0 != y.0 {
            return false;
        }
        i += 1;
    }
    a.ranks().len() == b.ranks().len()
}

pub(super) fn same_goal(a: &OpenUser<'_>, b: &OpenUser<'_>) -> bool {
    let mut i = 0;
    while let (Some(x), Some(y)) = (a.goal().get(i), b.goal().get(i)) {
        if x != y {
            return false;
        }
        i += 1;
    }
    a.goal().len() == b.goal().len()
}

pub(super) fn same_conditions(a: &OpenUser<'_>, b: &OpenUser<'_>) -> bool {
    a.conditions().len() == b.conditions().len()
        && same_prefix(a.conditions(), b.conditions(), a.conditions().len())
}

pub(super) fn same_user(a: &OpenUser<'_>, b: &OpenUser<'_>) -> bool {
    same_ranks(a, b) && same_goal(a, b) && same_conditions(a, b)
}

pub(super) fn decision_locality<E: Engine>(
    engine: &E,
    trial: &Trial<'_>,
    memory: &mut Memory<'_>,
) -> Judgement {
    let side = trial.second.side;
    let before = trial.case.user(side);
    let after = trial.second.case.user(side);
    if !same_user(trial.case.user(side.other()), trial.second.case.user(side.other()))
        || !same_goal(before, after)
    {
        return Judgement::Vacuous;
    }
    let mut first = Recorder::new(memory.first);
    engine.negotiate(&trial.case, &trial.options, &mut first);
    let mut second = Recorder::new(memory.second);
    engine.negotiate(&trial.second.case, &trial.options, &mut second);
    if !first.is_complete() || !second.is_complete() {
        return Judgement::Fails;
    }
    let mut judgement = Judgement::Vacuous;
    let (mut i, mut j) = (0, 0);
    // Depths rise in both transcripts, so one pass meets every depth that both have.
    while let (Some(a), Some(b)) = (first.round(i), second.round(j)) {
        if a.sender != side || a.depth == 0 {
            i += 1;
        } else if b.sender != side || b.depth == 0 {
            j += 1;
        } else if a.depth != b.depth || !same_prefix(before.conditions(), after.conditions(), a.depth) {
            break;
        } else {
            // Whether an acceptable offer is held is not the verdict: see the tie rules.
            let rejected = |ruling| ruling == Some(Ruling::Reject);
            if a.weighing != b.weighing || rejected(a.ruling) != rejected(b.ruling) {
                return Judgement::Fails;
            }
            judgement = Judgement::Holds;
            i += 1;
            j += 1;
        }
    }
    judgement
}

/// What a user must not change for the transcript to stay, from how far the first run
/// went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Locality {
    /// How many conditions it has disclosed: they must stay, in their place.
    pub disclosed: usize,
    /// The most conditions that it may have.
    pub most: usize,
    /// The fewest conditions that it may have.
    pub fewest: usize,
}

impl Locality {
    /// What must stay of the user on `side`, which made `offers` offers and then
    /// `has_quit` or not, while the other's deepest acceptable offer was `accepted_depth`
    /// deep (0: none).
    #[must_use]
    pub fn of(
        case: &OpenCase<'_>,
        options: &Options,
        side: Side,
        offers: usize,
        has_quit: bool,
        accepted_depth: usize,
    ) -> Self {
        let conditions = case.user(side).conditions().len();
        let own_offers = measure::offers(case, options, side);
        let willing = own_offers.saturating_sub(conditions);
        let disclosed = if offers < conditions { offers } else { conditions };
        let holds_offers = options.tie != TieRule::FirstSender;
        let owed_no_reply = holds_offers && own_offers < accepted_depth;
        if options.quit == QuitRule::Literal {
            return Self { disclosed, most: conditions, fewest: conditions };
        }
        let most = if has_quit || offers > conditions {
            conditions
        } else if owed_no_reply {
            accepted_depth.saturating_sub(1).saturating_sub(willing)
        } else {
            usize::MAX
        };
        Self { disclosed, most, fewest: disclosed }
    }
}

pub(super) fn transcript_locality<E: Engine>(
    engine: &E,
    trial: &Trial<'_>,
    memory: &mut Memory<'_>,
) -> Judgement {
    let side = trial.second.side;
    let before = trial.case.user(side);
    let after = trial.second.case.user(side);
    if !same_user(trial.case.user(side.other()), trial.second.case.user(side.other()))
        || !same_goal(before, after)
        || !same_ranks(before, after)
        || measure::threshold(&trial.case, &trial.options, side)
            != measure::threshold(&trial.second.case, &trial.options, side)
    {
        return Judgement::Vacuous;
    }
    let mut first = Recorder::new(memory.first);
    let conclusion = engine.negotiate(&trial.case, &trial.options, &mut first);
    let locality = Locality::of(
        &trial.case,
        &trial.options,
        side,
        first.offers_by(side),
        first.has_quit(side),
        accepted_depth(&first, side.other()),
    );
    let conditions = after.conditions();
    if conditions.len() > locality.most
        || conditions.len() < locality.fewest
        || !same_prefix(before.conditions(), conditions, locality.disclosed)
        || same_conditions(before, after)
    {
        return Judgement::Vacuous;
    }
    let mut second = Recorder::new(memory.second);
    let again = engine.negotiate(&trial.second.case, &trial.options, &mut second);
    Judgement::from_bool(first.is_same(&second) && conclusion == again)
}

/// The depth of the offer of `sender` that was accepted or held; 0 if none was.
fn accepted_depth(transcript: &Recorder<'_>, sender: Side) -> usize {
    let mut i = 0;
    while let Some(round) = transcript.round(i) {
        if round.sender == sender && matches!(round.ruling, Some(Ruling::Accept | Ruling::Hold)) {
            return round.depth;
        }
        i += 1;
    }
    0
}
