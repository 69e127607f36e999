//! The largest regret over all real-valued ranks of a domain.
//!
//! Two statuses and the path of a negotiation's verdicts make a *way*: what each user weighs
//! is then linear in the ranks, so all cases that go this way are the points of a polytope,
//! and the largest regret among them is a small linear programme. A verdict to accept is a
//! strict inequality. So a way counts only if some point satisfies all of them strictly,
//! which a second programme decides; then the supremum of the way is the maximum of its
//! closure, and a third programme decides whether it is attained.
//!
//! For whole-number ranks a strict inequality leaves a distance of at least 1; the maximum
//! under that bounds every exhaustive sweep over whole ranks from above.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use num_traits::{Signed, Zero};
use selfneg_core::{Fallback, Options, Outcome, Ruling, Side};
use thiserror::Error;

use crate::exact::{Attempt, LinearProgramme, Rational, SolveError, Variable, rational, solve};
use crate::protocol_graph::{Move, ProtocolGraph};
use crate::regret::Cause;

/// The most dispositions of a domain.
pub const MAX_DISPOSITIONS: usize = 10;

/// The worst that a protocol variant can do to users who rank `dispositions` dispositions,
/// each activated by one condition, conditions disclosed in the dispositions' order.
#[derive(Clone, Debug)]
pub struct WorstCase {
    /// Ways that were looked at: statuses up to symmetry times paths of verdicts.
    pub ways: usize,
    /// Ways that some ranks make a negotiation go.
    pub possible: usize,
    /// Linear programmes that were solved and certified.
    pub programmes: usize,
    /// Whether every bound is proved with gap 0.
    pub certified: bool,
    /// What each cause can lose at most.
    pub by_cause: BTreeMap<Cause, Worst>,
}

/// What one cause can lose at most.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Worst {
    /// The supremum of regret over real-valued ranks, in ranks. At least 0.
    pub supremum: Rational,
    /// Whether some ranks attain it.
    pub attained: bool,
    /// What whole-number ranks cannot exceed.
    pub whole: Rational,
    /// A case that attains the supremum, or comes close to it if none does. `None` if the
    /// cause loses nothing.
    pub instance: Option<Instance>,
}

/// A case of real-valued ranks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instance {
    /// The user being served.
    pub current: Person,
    /// The user who interrupts.
    pub interrupting: Person,
    /// How the negotiation ends.
    pub outcome: Outcome,
    /// The case's regret, in ranks.
    pub regret: Rational,
}

/// A user of the domain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Person {
    /// True conditions; condition d activates disposition d.
    pub conditions: Vec<usize>,
    /// Ranks by disposition.
    pub ranks: Vec<Rational>,
}

/// Why there is no worst case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum WorstCaseError {
    /// None, or more than [`MAX_DISPOSITIONS`].
    #[error("{found} dispositions, expected 1 to {MAX_DISPOSITIONS}")]
    Dispositions {
        /// How many were asked for.
        found: usize,
    },
    /// The range of ranks is empty.
    #[error("no rank lies in {lowest}..={highest}")]
    NoRanks {
        /// The range's start.
        lowest: u8,
        /// The range's end.
        highest: u8,
    },
    /// A programme could not be solved or certified.
    #[error("statuses {current:?} and {interrupting:?}: {error}")]
    Unsolved {
        /// The current user's conditions, as bits.
        current: u16,
        /// The interrupting user's conditions, as bits.
        interrupting: u16,
        /// What went wrong.
        error: SolveFailure,
    },
}

/// What went wrong with a programme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SolveFailure {
    /// The solver or the certification failed.
    #[error("a linear programme could not be solved and certified")]
    Solver,
    /// A programme that must be feasible is not: a defect.
    #[error("a linear programme that must be feasible is not")]
    Contradiction,
}

impl From<SolveError> for SolveFailure {
    fn from(_: SolveError) -> Self {
        Self::Solver
    }
}

/// Finds and proves the worst case over all ranks in a range. `progress` is told how many
/// pairs of statuses are done, and of how many.
///
/// # Errors
/// [`WorstCaseError`].
pub fn worst_case(
    dispositions: usize,
    ranks: RangeInclusive<u8>,
    options: &Options,
    progress: &dyn Fn(usize, usize),
) -> Result<WorstCase, WorstCaseError> {
    let (lowest, highest) = ranks.into_inner();
    if dispositions == 0 || dispositions > MAX_DISPOSITIONS {
        return Err(WorstCaseError::Dispositions { found: dispositions });
    }
    if lowest > highest {
        return Err(WorstCaseError::NoRanks { lowest, highest });
    }
    let statuses = StatusPair::up_to_symmetry(dispositions);
    let mut search = Search {
        dispositions,
        lowest: rational(lowest),
        highest: rational(highest),
        options: *options,
        found: WorstCase { ways: 0, possible: 0, programmes: 0, certified: true, by_cause: BTreeMap::new() },
    };
    for (done, pair) in statuses.iter().enumerate() {
        progress(done, statuses.len());
        search.pair(pair).map_err(|error| WorstCaseError::Unsolved {
            current: pair.current,
            interrupting: pair.interrupting,
            error,
        })?;
    }
    progress(statuses.len(), statuses.len());
    Ok(search.found)
}

/// Both users' true conditions, as bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct StatusPair {
    current: u16,
    interrupting: u16,
}

impl StatusPair {
    /// One pair of statuses for all that differ by names of dispositions only: what counts
    /// is which of the disclosed conditions, in their order, the receiver has too.
    fn up_to_symmetry(dispositions: usize) -> Vec<Self> {
        let mut kinds: BTreeMap<(Vec<bool>, Vec<bool>), Self> = BTreeMap::new();
        let all = 1_u16 << dispositions;
        for current in 0..all {
            for interrupting in 0..all {
                let pair = Self { current, interrupting };
                let heard =
                    |side: Side| -> Vec<bool> { pair.of(side).map(|d| pair.has(side.other(), d)).collect() };
                kinds.entry((heard(Side::Current), heard(Side::Interrupting))).or_insert(pair);
            }
        }
        kinds.into_values().collect()
    }

    fn bits(self, side: Side) -> u16 {
        match side {
            Side::Current => self.current,
            Side::Interrupting => self.interrupting,
        }
    }

    fn has(self, side: Side, disposition: usize) -> bool {
        self.bits(side) >> disposition & 1 == 1
    }

    /// The conditions of a side, in order of disclosure.
    fn of(self, side: Side) -> impl Iterator<Item = usize> {
        (0..MAX_DISPOSITIONS).filter(move |&disposition| self.has(side, disposition))
    }

    fn count(self, side: Side) -> usize {
        self.of(side).count()
    }
}

/// A sum of ranks: a whole number times a rank, for each user and disposition, plus a
/// constant. Stands for a constraint or an objective.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Sum {
    /// Current user's dispositions, then the interrupting user's.
    factors: [Vec<i32>; 2],
    constant: i32,
}

impl Sum {
    fn zero(dispositions: usize) -> Self {
        Self { factors: [vec![0; dispositions], vec![0; dispositions]], constant: 0 }
    }

    fn add(&mut self, eyes: Side, disposition: usize, times: i32) {
        let [current, interrupting] = &mut self.factors;
        let factors = match eyes {
            Side::Current => current,
            Side::Interrupting => interrupting,
        };
        if let Some(factor) = factors.get_mut(disposition) {
            *factor += times;
        }
    }

    fn minus(mut self, other: &Self) -> Self {
        for (mine, theirs) in self.factors.iter_mut().flatten().zip(other.factors.iter().flatten()) {
            *mine -= theirs;
        }
        self.constant -= other.constant;
        self
    }

    fn at(&self, point: &[Rational]) -> Rational {
        let terms = self.factors.iter().flatten().zip(point);
        terms.map(|(&factor, rank)| rational(factor) * rank).sum::<Rational>() + rational(self.constant)
    }
}

/// What a way demands of the ranks.
#[derive(Clone, Debug)]
struct Way {
    cause: Cause,
    outcome: Outcome,
    /// Sums that must be positive.
    positive: Vec<Sum>,
    /// Sums that must not be positive.
    not_positive: Vec<Sum>,
    /// Sums that must be 0.
    zero: Vec<Sum>,
    /// W of the user who is not served minus W of the one who is.
    regret: Sum,
}

/// Denominators of ranks to show to people.
const READABLE: [u8; 7] = [1, 2, 4, 5, 10, 20, 50];

impl Way {
    /// Whether users with these ranks negotiate in this way.
    fn is_taken_at(&self, point: &[Rational]) -> bool {
        self.positive.iter().all(|sum| sum.at(point).is_positive())
            && self.not_positive.iter().all(|sum| !sum.at(point).is_positive())
            && self.zero.iter().all(|sum| sum.at(point).is_zero())
    }
}

struct Search {
    dispositions: usize,
    lowest: Rational,
    highest: Rational,
    options: Options,
    found: WorstCase,
}

/// The largest value of a programme and a point that attains it.
struct Best {
    value: Rational,
    point: Vec<Rational>,
}

impl Search {
    fn pair(&mut self, pair: &StatusPair) -> Result<(), SolveFailure> {
        let willing = usize::from(self.options.willingness > 0);
        let offers = [pair.count(Side::Current) + willing, pair.count(Side::Interrupting)];
        let [current, interrupting] = offers;
        let graph = ProtocolGraph::of(current, interrupting, &self.options);
        for (moves, outcome) in graph.ways() {
            for way in self.ways(*pair, &moves, outcome) {
                self.way(*pair, &way)?;
            }
        }
        Ok(())
    }

    /// What `offer`'s first `depth` conditions are worth to the other user, minus what that
    /// one's own complete offer is. Positive: acceptable.
    fn utility(&self, pair: StatusPair, sender: Side, depth: usize) -> Sum {
        let receiver = sender.other();
        let mut sum = Sum::zero(self.dispositions);
        for disposition in pair.of(sender).take(depth) {
            sum.add(receiver, disposition, 1);
        }
        for disposition in pair.of(receiver) {
            sum.add(receiver, disposition, -1);
        }
        if receiver == Side::Current {
            sum.constant -= i32::from(self.options.willingness);
        }
        sum
    }

    /// The ways that take these moves: an agreement is one of two, by whether the winner
    /// would have accepted the loser's complete offer.
    fn ways(&self, pair: StatusPair, moves: &[Move], outcome: Outcome) -> Vec<Way> {
        let mut way = Way {
            cause: Cause::Fallback,
            outcome,
            positive: Vec::new(),
            not_positive: Vec::new(),
            zero: Vec::new(),
            regret: Sum::zero(self.dispositions),
        };
        // Ranks are not negative, so what is worth too little was so at every lesser depth.
        let mut rejected: [Option<Sum>; 2] = [None, None];
        let mut held: Option<Sum> = None;
        for taken in moves {
            let Move::Offer { sender, depth, ruling, held_surplus } = *taken else { continue };
            let utility = self.utility(pair, sender, depth);
            match ruling {
                Ruling::Reject => {
                    let [by_current, by_interrupting] = &mut rejected;
                    match sender.other() {
                        Side::Current => *by_current = Some(utility),
                        Side::Interrupting => *by_interrupting = Some(utility),
                    }
                }
                Ruling::Hold => {
                    held = Some(utility.clone());
                    way.positive.push(utility);
                }
                Ruling::Accept => {
                    if let Some((held, order)) = held.take().zip(held_surplus) {
                        match order {
                            Ordering::Greater => way.positive.push(held.minus(&utility)),
                            Ordering::Less => way.positive.push(utility.clone().minus(&held)),
                            Ordering::Equal => way.zero.push(held.minus(&utility)),
                        }
                    }
                    way.positive.push(utility);
                }
            }
        }
        way.not_positive.extend(rejected.into_iter().flatten());
        let served = match (outcome, self.options.fallback) {
            (Outcome::Agreement(winner), _) => winner,
            (Outcome::NoAgreement, Fallback::FirstCome) => Side::Current,
            // Whoever is served has the most welfare: nothing is lost, by definition.
            (Outcome::NoAgreement, Fallback::Utilitarian) => return vec![way],
        };
        for eyes in [Side::Current, Side::Interrupting] {
            for disposition in pair.of(served.other()) {
                way.regret.add(eyes, disposition, 1);
            }
            for disposition in pair.of(served) {
                way.regret.add(eyes, disposition, -1);
            }
        }
        match outcome {
            Outcome::NoAgreement => vec![way],
            Outcome::Agreement(winner) => {
                let loser = winner.other();
                let would_accept = self.utility(pair, loser, pair.count(loser));
                let mut one_sided = way.clone();
                one_sided.cause =
                    if self.options.willingness == 0 { Cause::AgreedAndOptimal } else { Cause::Willingness };
                one_sided.not_positive.push(would_accept.clone());
                way.cause = Cause::MutualDeference;
                way.positive.push(would_accept);
                vec![one_sided, way]
            }
        }
    }

    fn way(&mut self, pair: StatusPair, way: &Way) -> Result<(), SolveFailure> {
        self.found.ways += 1;
        let Some(closed) = self.maximum(way, &Goal::Regret { distance: 0 })? else { return Ok(()) };
        let strict = if way.positive.is_empty() {
            None
        } else {
            let strict = self.maximum(way, &Goal::Strictness { regret: None })?;
            let strict = strict.ok_or(SolveFailure::Contradiction)?;
            if !strict.value.is_positive() {
                return Ok(());
            }
            Some(strict)
        };
        self.found.possible += 1;
        let nothing =
            Worst { supremum: Rational::zero(), attained: true, whole: Rational::zero(), instance: None };
        let known = self.found.by_cause.entry(way.cause).or_insert(nothing).clone();
        if closed.value > known.whole {
            let whole = self.maximum(way, &Goal::Regret { distance: 1 })?;
            if let Some(whole) = whole
                && let Some(worst) = self.found.by_cause.get_mut(&way.cause)
                && whole.value > worst.whole
            {
                worst.whole = whole.value;
            }
        }
        if closed.value < known.supremum
            || !closed.value.is_positive()
            || (closed.value == known.supremum && known.attained)
        {
            return Ok(());
        }
        let (attained, point) = match strict {
            None => (true, closed.point.clone()),
            Some(strict) => {
                let goal = Goal::Strictness { regret: Some(closed.value.clone()) };
                let best = self.maximum(way, &goal)?.ok_or(SolveFailure::Contradiction)?;
                if best.value.is_positive() {
                    (true, best.point)
                } else {
                    (false, between(&closed.point, &strict.point, 1))
                }
            }
        };
        let at_least = if attained { closed.value.clone() } else { &closed.value - hundredths(20) };
        let mut starts = vec![point];
        if let Some(whole) = self.maximum(way, &Goal::Regret { distance: 1 })? {
            // Where strict inequalities keep their distance, rounding breaks none.
            starts.push(between(&closed.point, &whole.point, 10));
            starts.push(whole.point);
        }
        let point = self.readable(way, starts, &at_least);
        if !way.is_taken_at(&point) {
            return Err(SolveFailure::Contradiction);
        }
        let instance = self.instance(pair, way, &point);
        if let Some(worst) = self.found.by_cause.get_mut(&way.cause)
            && (closed.value > worst.supremum || attained)
        {
            worst.supremum = closed.value;
            worst.attained = attained;
            worst.instance = Some(instance);
        }
        Ok(())
    }

    /// The first of these points that fractions for people come close to, so that they go
    /// the same way and lose no less than `at_least`. If none, the first of them.
    fn readable(&self, way: &Way, points: Vec<Vec<Rational>>, at_least: &Rational) -> Vec<Rational> {
        for denominator in READABLE.map(rational) {
            for point in &points {
                let ranks = point.iter().take(2 * self.dispositions);
                let rounded: Vec<Rational> =
                    ranks.map(|rank| (rank * &denominator).round() / &denominator).collect();
                let in_range = rounded.iter().all(|rank| *rank >= self.lowest && *rank <= self.highest);
                if in_range && way.is_taken_at(&rounded) && way.regret.at(&rounded) >= *at_least {
                    return rounded;
                }
            }
        }
        points.into_iter().next().unwrap_or_default()
    }

    fn instance(&self, pair: StatusPair, way: &Way, point: &[Rational]) -> Instance {
        let (current, interrupting) = point.split_at_checked(self.dispositions).unwrap_or((point, &[]));
        let person = |side: Side, ranks: &[Rational]| Person {
            conditions: pair.of(side).collect(),
            ranks: ranks.iter().take(self.dispositions).cloned().collect(),
        };
        Instance {
            current: person(Side::Current, current),
            interrupting: person(Side::Interrupting, interrupting),
            outcome: way.outcome,
            regret: way.regret.at(point),
        }
    }

    /// The maximum, `None` if there is no feasible point.
    fn maximum(&mut self, way: &Way, goal: &Goal) -> Result<Option<Best>, SolveFailure> {
        let programme = self.programme(way, goal);
        self.found.programmes += 1;
        match solve(&programme)? {
            Attempt::Infeasible { .. } => Ok(None),
            Attempt::Feasible { certificate, certified } => {
                self.found.certified &= certified.is_optimal();
                let constant = match goal {
                    Goal::Regret { .. } => rational(way.regret.constant),
                    Goal::Strictness { .. } => Rational::zero(),
                };
                Ok(Some(Best { value: certified.bound + constant, point: certificate.point }))
            }
        }
    }

    /// One variable for each user and disposition, and for strictness one more, last: how
    /// far every strict inequality is from equality, at most 1.
    fn programme(&self, way: &Way, goal: &Goal) -> LinearProgramme {
        let mut programme = LinearProgramme::new();
        let mut ranks = Vec::new();
        let touched = |index: usize| {
            let sums = way.positive.iter().chain(&way.not_positive).chain(&way.zero).chain([&way.regret]);
            sums.into_iter().any(|sum| sum.factors.iter().flatten().nth(index).is_some_and(|&f| f != 0))
        };
        for (index, &gain) in way.regret.factors.iter().flatten().enumerate() {
            let gain = match goal {
                Goal::Regret { .. } => rational(gain),
                Goal::Strictness { .. } => Rational::zero(),
            };
            // A rank that nothing depends on may as well be the lowest.
            let highest = if touched(index) { &self.highest } else { &self.lowest };
            ranks.push(programme.variable(self.lowest.clone(), highest.clone(), gain));
        }
        let terms = |sum: &Sum| -> Vec<(Variable, Rational)> {
            let factors = sum.factors.iter().flatten();
            ranks.iter().zip(factors).map(|(&rank, &factor)| (rank, rational(factor))).collect()
        };
        let limit = |sum: &Sum| -rational(sum.constant);
        for sum in &way.not_positive {
            programme.at_most(terms(sum), limit(sum));
        }
        for sum in &way.zero {
            programme.equal(terms(sum), limit(sum));
        }
        match goal {
            Goal::Regret { distance } => {
                for sum in &way.positive {
                    programme.at_least(terms(sum), limit(sum) + rational(*distance));
                }
            }
            Goal::Strictness { regret } => {
                let distance = programme.variable(rational(0), rational(1), rational(1));
                for sum in &way.positive {
                    let terms = terms(sum).into_iter().chain([(distance, rational(-1))]);
                    programme.at_least(terms, limit(sum));
                }
                if let Some(regret) = regret {
                    programme.at_least(terms(&way.regret), regret + limit(&way.regret));
                }
            }
        }
        programme
    }
}

/// What a way's programme maximises.
enum Goal {
    /// Regret, where strict inequalities keep this distance from equality.
    Regret { distance: u8 },
    /// The least distance of a strict inequality from equality, where regret is at least
    /// this if given.
    Strictness { regret: Option<Rational> },
}

/// The point this many hundredths of the way from the one to the other.
fn between(from: &[Rational], to: &[Rational], way: u8) -> Vec<Rational> {
    from.iter().zip(to).map(|(from, to)| from + (to - from) * hundredths(way)).collect()
}

fn hundredths(count: u8) -> Rational {
    rational(count) / rational(100)
}
