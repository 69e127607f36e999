//! How a negotiation runs: how long, and what each round discloses.

use selfneg_core::{Conclusion, Disclosure, Observer, Options, Outcome, Ruling, Side, Weighing};

use crate::case::OpenCase;
use crate::engine::Engine;
use crate::measure;
use crate::property::{Judgement, Trial};
use crate::transcript::Memory;

/// One round for each offer, and one for each to quit.
fn longest(case: &OpenCase<'_>, options: &Options) -> u64 {
    let offers = |side| u64::try_from(measure::offers(case, options, side)).unwrap_or(u64::MAX);
    offers(Side::Current).saturating_add(offers(Side::Interrupting)).saturating_add(2)
}

/// Counts the rounds it is told of, so that a conclusion cannot claim fewer.
struct Count(u64);

impl Observer for Count {
    fn offer(&mut self, _: u32, _: Side, _: usize, _: Disclosure) {
        self.0 += 1;
    }
    fn quit(&mut self, _: u32, _: Side) {
        self.0 += 1;
    }
}

pub(super) fn termination<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    let mut count = Count(0);
    let conclusion = engine.negotiate(&trial.case, &trial.options, &mut count);
    Judgement::from_bool(
        count.0 == u64::from(conclusion.rounds) && count.0 <= longest(&trial.case, &trial.options),
    )
}

pub(super) fn exact_termination<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    let mut count = Count(0);
    let conclusion = engine.negotiate(&trial.case, &trial.options, &mut count);
    let reached = count.0 == longest(&trial.case, &trial.options);
    Judgement::from_bool(reached == (conclusion.outcome == Outcome::NoAgreement))
}

/// Where a round is in the order that an observer is promised.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    Between,
    Offered,
    Weighed,
    Concluded,
}

/// Watches what is disclosed.
struct Watch<'a> {
    case: &'a OpenCase<'a>,
    options: &'a Options,
    disclosed_current: usize,
    disclosed_interrupting: usize,
    rounds: u32,
    phase: Phase,
    accepted: bool,
    kept: bool,
}

impl Watch<'_> {
    fn expect(&mut self, holds: bool) {
        self.kept &= holds;
    }

    fn begin_round(&mut self, round: u32) {
        self.rounds = self.rounds.saturating_add(1);
        self.expect(round == self.rounds && self.phase == Phase::Between && !self.accepted);
    }
}

impl Observer for Watch<'_> {
    fn offer(&mut self, round: u32, sender: Side, depth: usize, discloses: Disclosure) {
        self.begin_round(round);
        let before = match sender {
            Side::Current => &mut self.disclosed_current,
            Side::Interrupting => &mut self.disclosed_interrupting,
        };
        let index = *before;
        *before = depth;
        let next = match self.case.user(sender).conditions().get(index) {
            Some(&condition) => discloses == Disclosure::Condition(condition),
            None => discloses == Disclosure::Willingness,
        };
        let has_it = depth <= measure::offers(self.case, self.options, sender);
        self.expect(next && has_it && index.checked_add(1) == Some(depth));
        self.phase = Phase::Offered;
    }

    fn weighed(&mut self, _: Side, _: Weighing) {
        self.expect(self.phase == Phase::Offered);
        self.phase = Phase::Weighed;
    }

    fn ruled(&mut self, _: Side, ruling: Ruling) {
        self.expect(self.phase == Phase::Weighed);
        self.accepted = ruling == Ruling::Accept;
        self.phase = Phase::Between;
    }

    fn quit(&mut self, round: u32, _: Side) {
        self.begin_round(round);
    }

    fn concluded(&mut self, conclusion: Conclusion) {
        self.expect(self.phase == Phase::Between && conclusion.rounds == self.rounds);
        self.phase = Phase::Concluded;
    }
}

pub(super) fn bounded_disclosure<E: Engine>(engine: &E, trial: &Trial<'_>, _: &mut Memory<'_>) -> Judgement {
    let mut watch = Watch {
        case: &trial.case,
        options: &trial.options,
        disclosed_current: 0,
        disclosed_interrupting: 0,
        rounds: 0,
        phase: Phase::Between,
        accepted: false,
        kept: true,
    };
    engine.negotiate(&trial.case, &trial.options, &mut watch);
    let disclosed = watch.disclosed_current > 0 || watch.disclosed_interrupting > 0;
    match watch.kept && watch.phase == Phase::Concluded {
        true if !disclosed => Judgement::Vacuous,
        kept => Judgement::from_bool(kept),
    }
}
