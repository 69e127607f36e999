//! What would have been best for everyone, with exact evidence, beside what was decided.

use std::fmt::Write as _;

use indexmap::IndexMap;
use selfneg_core::Options;
use selfneg_model::exact::{Rational, decimal, rational};
use selfneg_model::lottery::{self, Lottery, LotteryError, NashLottery};
use selfneg_model::order::{self, Order, OrderError, PairCosts, Proof};
use selfneg_model::{BeatsGraph, Decided, Impacts, Regret};
use serde::Serialize;

use crate::precedence::Decision;

/// A decision beside the optima of its case.
#[derive(Clone, Debug)]
pub struct Optimum {
    /// The users' names, by arrival.
    pub names: Vec<String>,
    /// Who would be best for whom.
    pub impacts: Impacts,
    /// The protocol variant in force.
    pub options: Options,
    /// Whom the robot serves.
    pub served: usize,
    /// What that lost.
    pub regret: Regret,
    /// The lottery of the largest expected welfare.
    pub utilitarian: Lottery,
    /// The lottery under which the user who expects least expects most.
    pub egalitarian: Lottery,
    /// The lottery of the largest product of expectations.
    pub nash: NashLottery,
    /// The order of the least waiting, weighted by welfare.
    pub waiting: Result<Order, OrderError>,
    /// The order that overrules the fewest bilateral agreements.
    pub agreements: Result<Order, OrderError>,
}

/// What is known of a case before its optima.
#[derive(Clone, Copy)]
pub struct Situation<'a> {
    /// The users' names, by arrival.
    pub names: &'a [String],
    /// Who would be best for whom.
    pub impacts: &'a Impacts,
    /// The protocol variant in force.
    pub options: Options,
    /// The decision; `None` if there is one user only, who is served.
    pub decision: Option<&'a Decision>,
    /// Who beats whom.
    pub beats: &'a BeatsGraph,
    /// How long it takes to serve each user, by arrival; 1 for those that are missing.
    pub times: &'a [u64],
}

impl Optimum {
    /// Finds and proves all optima.
    ///
    /// # Errors
    /// [`LotteryError`] without users, with more than [`lottery::MAX_USERS`], or if nothing
    /// can be proved. An order that cannot be found is no error here.
    pub fn of(situation: &Situation<'_>) -> Result<Self, LotteryError> {
        let Situation { names, impacts, options, decision, beats, times } = *situation;
        let beat = |winner: usize, loser: usize| {
            decision.is_some_and(|decision| {
                decision.negotiations.iter().any(|held| {
                    let sides = (held.current, held.interrupting);
                    let won = held.conclusion.outcome.winner().map(|side| match side {
                        selfneg_core::Side::Current => held.current,
                        selfneg_core::Side::Interrupting => held.interrupting,
                    });
                    won == Some(winner) && (sides == (winner, loser) || sides == (loser, winner))
                })
            })
        };
        let decided = Decided {
            agreement: decision.and_then(|decision| decision.agreement),
            served: decision.map_or(0, |decision| decision.served),
            beat: &beat,
            willingness: options.willingness,
        };
        Ok(Self {
            names: names.to_vec(),
            impacts: impacts.clone(),
            options,
            served: decided.served,
            regret: Regret::of(impacts, &decided),
            utilitarian: lottery::utilitarian(impacts)?,
            egalitarian: lottery::egalitarian(impacts)?,
            nash: lottery::nash(impacts)?,
            waiting: order::best(&PairCosts::waiting(impacts, times)),
            agreements: order::best(&PairCosts::overruling(beats)),
        })
    }

    /// Whether the largest welfare is proved by the linear programme's certificate.
    #[must_use]
    pub fn verified(&self) -> bool {
        let most = self.impacts.optimal().first().map(|&best| rational(self.impacts.welfare(best)));
        self.utilitarian.value == self.utilitarian.bound && most.as_ref() == Some(&self.utilitarian.value)
    }

    fn name(&self, user: usize) -> &str {
        self.names.get(user).map_or("?", String::as_str)
    }

    fn named(&self, users: &[usize]) -> Vec<String> {
        users.iter().map(|&user| self.name(user).to_owned()).collect()
    }

    fn by_name<V>(&self, of: impl Fn(usize) -> V) -> IndexMap<String, V> {
        self.names.iter().enumerate().map(|(user, name)| (name.clone(), of(user))).collect()
    }

    /// For people.
    #[must_use]
    pub fn tell(&self) -> String {
        let mut text = String::from("What serving whom is worth, in ranks:\n\n");
        self.table(&mut text);
        let best = self.named(&self.impacts.optimal());
        let _ = writeln!(text, "\nMost welfare: {}.", best.join(", "));
        let _ = writeln!(
            text,
            "Served: {}, regret {} ({}; variant {}).",
            self.name(self.served),
            self.regret.amount,
            self.regret.cause,
            self.options
        );
        let _ = writeln!(
            text,
            "\nWhom to serve first:\n  most welfare expected: {}, {}",
            self.lottery_text(&self.utilitarian.shares),
            worth(&self.utilitarian, "welfare")
        );
        let _ = writeln!(
            text,
            "  best for who expects least: {}, {}",
            self.lottery_text(&self.egalitarian.shares),
            worth(&self.egalitarian, "the least expectation")
        );
        let _ = writeln!(
            text,
            "  largest product of expectations: {}, {}",
            self.lottery_text(&self.nash.shares),
            if self.nash.factor == rational(1) {
                "proved optimal".to_owned()
            } else {
                format!(
                    "proved within a factor of {} of the best geometric mean",
                    decimal(&self.nash.factor, 9)
                )
            }
        );
        let _ = writeln!(text, "\nIn which order:");
        self.order_line(&mut text, "least waiting, weighted by welfare", "waiting", &self.waiting);
        self.order_line(&mut text, "fewest agreements overruled", "overruled", &self.agreements);
        text
    }

    fn table(&self, text: &mut String) {
        let served: Vec<usize> = (0..self.impacts.users()).collect();
        let label = self.names.iter().map(|name| name.chars().count()).max().unwrap_or(0).max(14);
        let width = |user: usize| self.name(user).chars().count().max(7);
        let mut line = |label_text: &str, cell: &dyn Fn(usize) -> String| {
            let _ = write!(text, "{label_text:label$}");
            for &user in &served {
                let _ = write!(text, "  {:>width$}", cell(user), width = width(user));
            }
            text.push('\n');
        };
        line("in the eyes of", &|user| self.name(user).to_owned());
        for eyes in 0..self.impacts.users() {
            line(self.name(eyes), &|user| self.impacts.of_serving(user, eyes).to_string());
        }
        line("welfare", &|user| self.impacts.welfare(user).to_string());
    }

    fn lottery_text(&self, shares: &[Rational]) -> String {
        let certain = shares.iter().position(|share| *share == rational(1));
        if let Some(user) = certain {
            return self.name(user).to_owned();
        }
        let with_chance = shares.iter().enumerate().filter(|(_, share)| **share != rational(0));
        let parts: Vec<String> =
            with_chance.map(|(user, share)| format!("{} {}", self.name(user), short(share))).collect();
        parts.join(", ")
    }

    fn order_line(&self, text: &mut String, what: &str, unit: &str, order: &Result<Order, OrderError>) {
        let _ = match order {
            Ok(order) => {
                let proof = match order.proof {
                    Proof::Pairs => "every two are in the better order".to_owned(),
                    Proof::Relaxation => {
                        format!("the linear programme proves at least {}", order.relaxation)
                    }
                    Proof::DynamicProgramming => format!(
                        "the linear programme proves only {}, dynamic programming the rest",
                        order.relaxation
                    ),
                };
                let users = self.named(&order.users).join(", ");
                writeln!(text, "  {what}: {users} ({unit} {}; {proof})", order.cost)
            }
            Err(error) => writeln!(text, "  {what}: none, {error}"),
        };
    }

    /// The JSON document.
    #[must_use]
    pub fn record(&self) -> OptimumRecord {
        OptimumRecord {
            impacts: self.by_name(|eyes| self.by_name(|served| self.impacts.of_serving(served, eyes))),
            welfare: self.by_name(|served| self.impacts.welfare(served)),
            optimal: self.named(&self.impacts.optimal()),
            served: self.name(self.served).to_owned(),
            regret: self.regret.amount,
            cause: self.regret.cause.name(),
            variant: self.options.to_string(),
            certificate: CertificateRecord {
                verified: self.verified(),
                gap: (&self.utilitarian.bound - &self.utilitarian.value).to_string(),
                value: self.utilitarian.value.to_string(),
                bound: self.utilitarian.bound.to_string(),
            },
            utilitarian: self.lottery_record(&self.utilitarian),
            egalitarian: self.lottery_record(&self.egalitarian),
            nash: NashRecord {
                lottery: self.shares_record(&self.nash.shares),
                factor: self.nash.factor.to_string(),
                indifferent: self.named(&self.nash.indifferent),
            },
            order: OrdersRecord {
                waiting: self.order_record(&self.waiting),
                agreements: self.order_record(&self.agreements),
            },
        }
    }

    fn shares_record(&self, shares: &[Rational]) -> IndexMap<String, String> {
        self.by_name(|user| shares.get(user).map_or_else(|| "0".to_owned(), ToString::to_string))
    }

    fn lottery_record(&self, lottery: &Lottery) -> LotteryRecord {
        LotteryRecord {
            lottery: self.shares_record(&lottery.shares),
            value: lottery.value.to_string(),
            gap: (&lottery.bound - &lottery.value).to_string(),
        }
    }

    fn order_record(&self, order: &Result<Order, OrderError>) -> OrderRecord {
        match order {
            Ok(order) => OrderRecord::Found {
                users: self.named(&order.users),
                cost: order.cost,
                relaxation: order.relaxation.to_string(),
                relaxation_gap: (rational(order.cost) - &order.relaxation).to_string(),
                proof: match order.proof {
                    Proof::Pairs => "pairs",
                    Proof::Relaxation => "linear-programme",
                    Proof::DynamicProgramming => "dynamic-programming",
                },
            },
            Err(error) => OrderRecord::NotFound { limit: error.to_string() },
        }
    }
}

fn worth(lottery: &Lottery, what: &str) -> String {
    let gap = &lottery.bound - &lottery.value;
    if gap == rational(0) {
        format!("{what} {} (proved optimal, gap 0)", short(&lottery.value))
    } else {
        format!("{what} {} (proved within {} of the best)", short(&lottery.value), short(&gap))
    }
}

/// Fractions of long numbers say nothing to people.
fn short(number: &Rational) -> String {
    let exact = number.to_string();
    if exact.len() <= 9 { exact } else { format!("about {}", decimal(number, 4)) }
}

/// What `selfneg optimum --json` prints. Rational numbers are written `p/q`.
#[derive(Debug, Serialize)]
pub struct OptimumRecord {
    impacts: IndexMap<String, IndexMap<String, u64>>,
    welfare: IndexMap<String, u64>,
    optimal: Vec<String>,
    served: String,
    regret: u64,
    cause: &'static str,
    variant: String,
    certificate: CertificateRecord,
    utilitarian: LotteryRecord,
    egalitarian: LotteryRecord,
    nash: NashRecord,
    order: OrdersRecord,
}

#[derive(Debug, Serialize)]
struct CertificateRecord {
    verified: bool,
    gap: String,
    value: String,
    bound: String,
}

#[derive(Debug, Serialize)]
struct LotteryRecord {
    lottery: IndexMap<String, String>,
    value: String,
    gap: String,
}

#[derive(Debug, Serialize)]
struct NashRecord {
    lottery: IndexMap<String, String>,
    factor: String,
    indifferent: Vec<String>,
}

#[derive(Debug, Serialize)]
struct OrdersRecord {
    waiting: OrderRecord,
    agreements: OrderRecord,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum OrderRecord {
    Found { users: Vec<String>, cost: u64, relaxation: String, relaxation_gap: String, proof: &'static str },
    NotFound { limit: String },
}
