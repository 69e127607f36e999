//! What any program should be: deterministic, exact, total.

use selfneg_core::{Disclosure, Observer, Options, Side, Weighing};

use super::locality::same_user;
use crate::case::OpenCase;
use crate::engine::Engine;
use crate::measure;
use crate::property::{Judgement, Trial};
use crate::transcript::{Memory, Recorder};

pub(super) fn determinism<E: Engine>(engine: &E, trial: &Trial<'_>, memory: &mut Memory<'_>) -> Judgement {
    let copy = &trial.second.case;
    if !same_user(&trial.case.current, &copy.current)
        || !same_user(&trial.case.interrupting, &copy.interrupting)
    {
        return Judgement::Vacuous;
    }
    let mut first = Recorder::new(memory.first);
    let conclusion = engine.negotiate(&trial.case, &trial.options, &mut first);
    let mut second = Recorder::new(memory.second);
    let again = engine.negotiate(copy, &trial.options, &mut second);
    Judgement::from_bool(first.is_same(&second) && conclusion == again)
}

/// Sums what each offer discloses, and compares.
struct Sums<'a> {
    case: &'a OpenCase<'a>,
    options: &'a Options,
    in_current_eyes: u64,
    in_interrupting_eyes: u64,
    weighed: bool,
    exact: bool,
}

impl Observer for Sums<'_> {
    fn offer(&mut self, _: u32, sender: Side, depth: usize, _: Disclosure) {
        let eyes = self.case.user(sender.other());
        let more = measure::marginal_impact(
            self.case.activation,
            self.options.aggregation,
            eyes,
            self.case.user(sender),
            depth.saturating_sub(1),
        );
        let total = match sender {
            Side::Current => &mut self.in_interrupting_eyes,
            Side::Interrupting => &mut self.in_current_eyes,
        };
        *total = total.saturating_add(more);
    }

    fn weighed(&mut self, receiver: Side, weighing: Weighing) {
        let value = match receiver {
            Side::Current => self.in_current_eyes,
            Side::Interrupting => self.in_interrupting_eyes,
        };
        self.weighed = true;
        self.exact &= weighing.value.0 == value
            && weighing.threshold.0 == measure::threshold(self.case, self.options, receiver)
            && value < measure::TOTAL_BOUND
            && weighing.threshold.0 < measure::TOTAL_BOUND;
    }
}

pub(super) fn no_overflow<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    let mut sums = Sums {
        case: &trial.case,
        options: &trial.options,
        in_current_eyes: 0,
        in_interrupting_eyes: 0,
        weighed: false,
        exact: true,
    };
    engine.negotiate(&trial.case, &trial.options, &mut sums);
    match sums.weighed {
        true => Judgement::from_bool(sums.exact),
        false => Judgement::Vacuous,
    }
}

/// Whoever checks this must turn a panic into [`Judgement::Fails`]; Kani does so itself.
pub(super) fn no_panic<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    let conclusion = engine.negotiate(&trial.case, &trial.options, &mut ());
    let served = engine.serve(&trial.case, &trial.options);
    Judgement::from_bool(conclusion.outcome.winner().is_none_or(|winner| winner == served))
}
