//! How much welfare a protocol variant loses at most, and on average, over a whole domain.
//!
//! Two methods that share no code: the exhaustive sweep runs the engine on whole-number
//! ranks, and the worst case over real-valued ranks is a set of certified linear programmes.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::ops::RangeInclusive;

use indexmap::IndexMap;
use selfneg_core::{Options, Side};
use selfneg_model::exact::{Rational, decimal, rational};
use selfneg_model::worst_case::{self, Instance, Person, WorstCase, WorstCaseError, worst_case};
use selfneg_model::{Cause, Decided, Impacts, Regret};
use selfneg_proofs::sweep::{
    Class, Detail, Domain, DomainError, Grain, Pair, Progress as SweepProgress, SweepError, Tally, sweep,
};
use serde::Serialize;

/// What a variant loses over a domain.
#[derive(Clone, Debug)]
pub struct RegretSurvey {
    /// How many dispositions there are, each activated by one condition.
    pub dispositions: usize,
    /// The ranks that a user may give.
    pub ranks: RangeInclusive<u8>,
    /// The variant.
    pub options: Options,
    /// All ordered pairs of users with whole-number ranks.
    pub pairs: u128,
    /// How many classes the sweep ran the engine on.
    pub classes: u64,
    /// What whole-number ranks lose, by cause.
    pub whole: BTreeMap<Cause, Lost>,
    /// What real-valued ranks lose at most, by cause.
    pub real: WorstCase,
}

/// What one cause loses over all pairs with whole-number ranks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lost {
    /// Pairs that end in this way.
    pub pairs: u128,
    /// Those of them that lose anything.
    pub losing: u128,
    /// What they lose in sum, in ranks.
    pub total: u128,
    /// The most that one of them loses, in ranks.
    pub most: u64,
    /// A smallest pair that loses the most.
    pub pair: Option<Pair>,
}

/// Why there is no survey.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RegretError {
    /// The sweep takes no such domain.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// The sweep failed.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// The worst case could not be proved.
    #[error(transparent)]
    WorstCase(#[from] WorstCaseError),
}

/// How far a survey is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// The sweep covers pairs, counted in thousandths of all.
    Sweep(u64),
    /// Linear programmes are solved for pairs of statuses.
    Programmes {
        /// Pairs of statuses that are done.
        done: usize,
        /// All of them.
        total: usize,
    },
}

impl RegretSurvey {
    /// Sweeps the whole-number ranks of a domain and proves the worst case over the real ones.
    ///
    /// # Errors
    /// [`RegretError`].
    pub fn of(
        dispositions: usize,
        ranks: RangeInclusive<u8>,
        options: Options,
        progress: &(dyn Fn(Progress) + Sync),
    ) -> Result<Self, RegretError> {
        if dispositions > worst_case::MAX_DISPOSITIONS {
            return Err(WorstCaseError::Dispositions { found: dispositions }.into());
        }
        let domain = Domain::one_to_one(dispositions, ranks.clone())?;
        let swept = sweep(
            &domain,
            &Grain::of(&options, Detail::Merged),
            || Losses { options, by_cause: BTreeMap::new() },
            &|swept| {
                if let SweepProgress::Pairs { done, total } = swept {
                    let thousandths = done.saturating_mul(1000) / total.max(1);
                    progress(Progress::Sweep(u64::try_from(thousandths).unwrap_or(1000)));
                }
            },
        )?;
        let real = worst_case(dispositions, ranks.clone(), &options, &|done, total| {
            progress(Progress::Programmes { done, total });
        })?;
        Ok(Self {
            dispositions,
            ranks,
            options,
            pairs: swept.pairs,
            classes: swept.classes,
            whole: swept.tally.by_cause,
            real,
        })
    }

    /// The most that any pair with whole-number ranks loses.
    #[must_use]
    pub fn whole_max(&self) -> u64 {
        self.whole.values().map(|lost| lost.most).max().unwrap_or(0)
    }

    /// The supremum over real-valued ranks, of all causes.
    #[must_use]
    pub fn real_max(&self) -> Rational {
        self.real.by_cause.values().map(|worst| worst.supremum.clone()).max().unwrap_or_else(|| rational(0))
    }

    /// The same for people, who are told if it is not attained.
    #[must_use]
    pub fn real_max_text(&self) -> String {
        let attained = |worst: &worst_case::Worst| worst.attained && worst.supremum == self.real_max();
        let supremum = self.real_max().to_string();
        if self.real.by_cause.values().any(attained) { supremum } else { format!("below {supremum}") }
    }

    /// Whether everything is proved, and no pair of the sweep loses more than the linear
    /// programmes allow it.
    #[must_use]
    pub fn consistent(&self) -> bool {
        let within = |(cause, lost): (&Cause, &Lost)| match self.real.by_cause.get(cause) {
            Some(worst) => rational(lost.most) <= worst.whole && worst.whole <= worst.supremum,
            None => lost.most == 0,
        };
        self.real.certified && self.whole.iter().all(within)
    }

    /// Whether every bound for whole numbers is met by some pair of the sweep.
    #[must_use]
    pub fn tight(&self) -> bool {
        self.real.by_cause.iter().all(|(cause, worst)| {
            let most = self.whole.get(cause).map_or(0, |lost| lost.most);
            worst.whole.floor() == rational(most)
        })
    }

    /// Pairs that lose anything.
    #[must_use]
    pub fn losing(&self) -> u128 {
        self.whole.values().map(|lost| lost.losing).sum()
    }

    /// What a pair loses on average, in ranks.
    #[must_use]
    pub fn mean(&self) -> Rational {
        let total: u128 = self.whole.values().map(|lost| lost.total).sum();
        rational(total) / rational(self.pairs.max(1))
    }

    fn causes(&self) -> BTreeSet<Cause> {
        self.whole.keys().chain(self.real.by_cause.keys()).copied().collect()
    }

    /// The worst instance, of whichever cause.
    fn instance(&self) -> Option<(&Cause, &worst_case::Worst)> {
        let worst = self.real.by_cause.iter().filter(|(_, worst)| worst.instance.is_some());
        worst.max_by(|(_, a), (_, b)| a.supremum.cmp(&b.supremum))
    }

    /// For people.
    #[must_use]
    pub fn tell(&self) -> String {
        let mut text = String::new();
        let _ = writeln!(
            text,
            "{} dispositions, ranks {}..={}: {} ordered pairs of users with whole-number ranks, covered by {} \
             classes.\nVariant {}.\n",
            self.dispositions,
            self.ranks.start(),
            self.ranks.end(),
            self.pairs,
            self.classes,
            self.options
        );
        let _ = writeln!(
            text,
            "{:18}  {:>16}  {:>16}  {:>13}  {:>13}  {:>13}",
            "", "", "", "largest,", "certified", "supremum,"
        );
        let _ = writeln!(
            text,
            "{:18}  {:>16}  {:>16}  {:>13}  {:>13}  {:>13}",
            "cause", "pairs", "losing", "whole ranks", "bound for it", "real ranks"
        );
        for cause in self.causes() {
            let lost = self.whole.get(&cause).cloned().unwrap_or_default();
            let (whole, real) = match self.real.by_cause.get(&cause) {
                Some(worst) => (worst.whole.to_string(), supremum_text(worst)),
                None => ("-".to_owned(), "-".to_owned()),
            };
            let _ = writeln!(
                text,
                "{:18}  {:>16}  {:>16}  {:>13}  {whole:>13}  {real:>13}",
                cause, lost.pairs, lost.losing, lost.most
            );
        }
        let _ = writeln!(
            text,
            "\nOn average a pair loses {} ranks; {} of {} pairs lose anything.",
            decimal(&self.mean(), 6),
            self.losing(),
            self.pairs
        );
        let _ = writeln!(
            text,
            "{} linear programmes for {} ways that a negotiation can go, of which {} are possible: {}.",
            self.real.programmes,
            self.real.ways,
            self.real.possible,
            if self.real.certified {
                "every bound is certified exactly"
            } else {
                "NOT every bound is certified"
            }
        );
        text.push_str(&self.explanation());
        for (cause, worst) in &self.real.by_cause {
            if let Some(instance) = &worst.instance {
                tell_instance(&mut text, *cause, worst, instance);
            }
        }
        text
    }

    fn explanation(&self) -> String {
        if !self.consistent() {
            return "The sweep and the linear programmes contradict each other.\n".to_owned();
        }
        let mut text = String::from(if self.tight() {
            "The sweep meets every bound for whole ranks: the two methods agree.\n"
        } else {
            "No pair of the sweep exceeds its bound, but not every bound is met: the programmes let ranks be \
             fractions.\n"
        });
        let strict = self.real.by_cause.values().any(|worst| worst.whole < worst.supremum);
        if strict {
            text.push_str(
                "Where real ranks can lose more: to accept takes strictly more, which for whole ranks is 1 more, \
                 for real ones as little as one likes.\n",
            );
        }
        text
    }

    /// The JSON document.
    #[must_use]
    pub fn record(&self) -> RegretRecord {
        let by_cause = self.causes().into_iter().map(|cause| {
            let lost = self.whole.get(&cause).cloned().unwrap_or_default();
            let worst = self.real.by_cause.get(&cause);
            let record = CauseRecord {
                pairs: lost.pairs,
                losing: lost.losing,
                total: lost.total,
                integer_max: lost.most,
                integer_bound: worst.map(|worst| worst.whole.to_string()),
                lp_max: worst.map(|worst| worst.supremum.to_string()),
                attained: worst.map(|worst| worst.attained),
                instance: worst.and_then(|worst| {
                    worst.instance.as_ref().map(|instance| InstanceRecord::new(instance, worst.attained))
                }),
            };
            (cause.name(), record)
        });
        RegretRecord {
            domain: DomainRecord {
                dispositions: self.dispositions,
                lowest_rank: *self.ranks.start(),
                highest_rank: *self.ranks.end(),
                pairs: self.pairs,
            },
            variant: self.options.to_string(),
            integer_max: self.whole_max(),
            lp_max: self.real_max().to_string(),
            certified: self.real.certified,
            consistent: self.consistent(),
            tight: self.tight(),
            lps: self.real.programmes,
            ways: self.real.ways,
            possible_ways: self.real.possible,
            classes: self.classes,
            losing: self.losing(),
            mean: self.mean().to_string(),
            instance: self.instance().and_then(|(_, worst)| {
                worst.instance.as_ref().map(|instance| InstanceRecord::new(instance, worst.attained))
            }),
            by_cause: by_cause.collect(),
        }
    }
}

fn supremum_text(worst: &worst_case::Worst) -> String {
    if worst.attained { worst.supremum.to_string() } else { format!("below {}", worst.supremum) }
}

fn tell_instance(text: &mut String, cause: Cause, worst: &worst_case::Worst, instance: &Instance) {
    let how = if worst.attained { "attains it" } else { "comes close" };
    let _ = writeln!(
        text,
        "\n{cause}: {} ({}, regret {}) {how}:",
        supremum_text(worst),
        instance.outcome,
        instance.regret
    );
    for (role, person) in [("current", &instance.current), ("interrupting", &instance.interrupting)] {
        let conditions: Vec<String> = person.conditions.iter().map(|&d| disposition_name(d)).collect();
        let ranks: Vec<String> = person.ranks.iter().map(ToString::to_string).collect();
        let _ = writeln!(text, "  {role:12}  is {:18}  ranks {}", conditions.join(" "), ranks.join(" "));
    }
}

/// The paper counts dispositions from 1.
fn disposition_name(disposition: usize) -> String {
    format!("d{}", disposition.saturating_add(1))
}

/// What each cause loses, gathered class by class.
struct Losses {
    options: Options,
    by_cause: BTreeMap<Cause, Lost>,
}

impl Tally for Losses {
    fn take(&mut self, class: &Class<'_>) {
        let decision = class.case.decide(&self.options, &mut ());
        let arrival = |side| usize::from(side == Side::Interrupting);
        let agreement = decision.conclusion.outcome.winner().map(arrival);
        let decided = Decided {
            agreement,
            served: arrival(decision.served),
            beat: &|winner, loser| agreement == Some(winner) && winner != loser,
            willingness: self.options.willingness,
        };
        let users = [class.case.current, class.case.interrupting];
        let impacts = Impacts::among(&users, class.case.activation, self.options.aggregation);
        let Regret { amount, cause } = Regret::of(&impacts, &decided);
        let lost = self.by_cause.entry(cause).or_default();
        lost.pairs += class.multiplicity;
        if amount > 0 {
            lost.losing += class.multiplicity;
            lost.total += class.multiplicity * u128::from(amount);
            let smaller = || lost.pair.as_ref().is_none_or(|known| class.pair < known);
            if amount > lost.most || amount == lost.most && smaller() {
                lost.most = amount;
                lost.pair = Some(class.pair.clone());
            }
        }
    }

    fn merge(mut self, other: Self) -> Self {
        for (cause, theirs) in other.by_cause {
            let mine = self.by_cause.entry(cause).or_default();
            mine.pairs += theirs.pairs;
            mine.losing += theirs.losing;
            mine.total += theirs.total;
            let smaller = match (&mine.pair, &theirs.pair) {
                (Some(mine), Some(theirs)) => theirs < mine,
                (None, theirs) => theirs.is_some(),
                (Some(_), None) => false,
            };
            if theirs.most > mine.most || theirs.most == mine.most && smaller {
                mine.most = theirs.most;
                mine.pair = theirs.pair;
            }
        }
        self
    }
}

/// What `selfneg regret --json` prints. Rational numbers are written `p/q`.
#[derive(Debug, Serialize)]
pub struct RegretRecord {
    domain: DomainRecord,
    variant: String,
    integer_max: u64,
    lp_max: String,
    certified: bool,
    consistent: bool,
    tight: bool,
    lps: usize,
    ways: usize,
    possible_ways: usize,
    classes: u64,
    losing: u128,
    mean: String,
    instance: Option<InstanceRecord>,
    by_cause: IndexMap<&'static str, CauseRecord>,
}

#[derive(Debug, Serialize)]
struct DomainRecord {
    dispositions: usize,
    lowest_rank: u8,
    highest_rank: u8,
    pairs: u128,
}

#[derive(Debug, Serialize)]
struct CauseRecord {
    pairs: u128,
    losing: u128,
    total: u128,
    integer_max: u64,
    integer_bound: Option<String>,
    lp_max: Option<String>,
    attained: Option<bool>,
    instance: Option<InstanceRecord>,
}

#[derive(Debug, Serialize)]
struct InstanceRecord {
    attains: bool,
    outcome: &'static str,
    regret: String,
    current: PersonRecord,
    interrupting: PersonRecord,
}

#[derive(Debug, Serialize)]
struct PersonRecord {
    conditions: Vec<String>,
    ranks: IndexMap<String, String>,
}

impl InstanceRecord {
    fn new(instance: &Instance, attains: bool) -> Self {
        let person = |person: &Person| PersonRecord {
            conditions: person.conditions.iter().map(|&d| disposition_name(d)).collect(),
            ranks: person
                .ranks
                .iter()
                .enumerate()
                .map(|(d, rank)| (disposition_name(d), rank.to_string()))
                .collect(),
        };
        Self {
            attains,
            outcome: instance.outcome.name(),
            regret: instance.regret.to_string(),
            current: person(&instance.current),
            interrupting: person(&instance.interrupting),
        }
    }
}
