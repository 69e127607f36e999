//! One decision among a current user and any number of interrupters.

use std::fmt;
use std::str::FromStr;

use selfneg_core::policy::{self, Arrival, Pairing};
use selfneg_core::{
    Activation, Case, Conclusion, Fallback, Impact, Options, Outcome, RulesError, TooManyConditions,
    UnknownName, User,
};
use selfneg_model::{BeatsGraph, Condorcet, most_welfare, welfare};

use crate::binding::{BoundRules, BoundUser};
use crate::transcript::{Recorder, Round};

/// How bilateral negotiations make a decision among several interrupters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Policy {
    /// The published one, for one or two interrupters.
    Published,
    /// Whoever beats everyone else, for any number.
    Condorcet,
}

impl Policy {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Published, Self::Condorcet];

    /// `published` or `condorcet`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Published => "published",
            Self::Condorcet => "condorcet",
        }
    }

    /// The default: `published` for one or two interrupters, `condorcet` for more.
    #[must_use]
    pub const fn default_for(interrupters: usize) -> Self {
        if interrupters <= 2 { Self::Published } else { Self::Condorcet }
    }
}

impl fmt::Display for Policy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Policy {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        Self::ALL.into_iter().find(|policy| policy.name() == name).ok_or(UnknownName)
    }
}

/// A decision with all that led to it. Users are numbered by arrival: 0 is the current
/// one, 1 the first interrupter.
#[derive(Clone, Debug)]
pub struct Decision {
    /// The policy in force.
    pub policy: Policy,
    /// The protocol variant in force.
    pub options: Options,
    /// The user whom the negotiations gave precedence; `None` is no agreement.
    pub agreement: Option<usize>,
    /// Whom the robot serves.
    pub served: usize,
    /// Without agreement: the users among whom the fallback chose.
    pub candidates: Vec<usize>,
    /// W of serving each user: what its complete offer is worth to all of them together.
    pub welfare: Vec<Impact>,
    /// The bilateral negotiations, in the order in which they were held.
    pub negotiations: Vec<HeldNegotiation>,
}

/// A bilateral negotiation that was held.
#[derive(Clone, Debug)]
pub struct HeldNegotiation {
    /// Who played the current side.
    pub current: usize,
    /// Who played the interrupting side.
    pub interrupting: usize,
    /// The variant; only the real current user has willingness.
    pub options: Options,
    /// How it ended.
    pub conclusion: Conclusion,
    /// How it went.
    pub rounds: Vec<Round>,
}

impl Decision {
    /// The rounds of all negotiations held.
    #[must_use]
    pub fn rounds(&self) -> u64 {
        self.negotiations.iter().map(|held| u64::from(held.conclusion.rounds)).sum()
    }

    /// The outcome's name, as in the published logs, for a decision among `users` users:
    /// `current`, `no-agreement`, and `interrupting` for two or `interrupting_1`,
    /// `interrupting_2`, ... for more.
    #[must_use]
    pub fn outcome_name(&self, users: usize) -> String {
        match self.agreement {
            None => Outcome::NoAgreement.name().to_owned(),
            Some(0) => "current".to_owned(),
            Some(_) if users == 2 => "interrupting".to_owned(),
            Some(interrupter) => format!("interrupting_{interrupter}"),
        }
    }
}

/// Why no decision was made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PrecedenceError {
    /// There is nobody to negotiate with.
    #[error("nobody interrupts: expected a current user and at least one interrupter")]
    NobodyInterrupts,
    /// The published policy has no rule for so many.
    #[error("the policy published is for one or two interrupters, found {0}; expected condorcet")]
    PublishedForTwo(usize),
    /// The engine refused the rules.
    #[error("rules: {0}")]
    Rules(#[from] RulesError),
    /// The engine refused a status.
    #[error("status: {0}")]
    Status(#[from] TooManyConditions),
}

/// Decides who of `users` (the first one is being served) gets precedence.
///
/// # Errors
/// [`PrecedenceError`] for fewer than two users, or more than three under the published
/// policy.
pub fn decide(
    rules: &BoundRules,
    users: &[BoundUser],
    options: Options,
    policy: Policy,
) -> Result<Decision, PrecedenceError> {
    let rows = rules.rows();
    let activation = Activation::new(&rows)?;
    let users: Vec<User<'_>> = users.iter().map(BoundUser::user).collect::<Result<_, _>>()?;
    let [_, interrupters @ ..] = users.as_slice() else {
        return Err(PrecedenceError::NobodyInterrupts);
    };
    let mut hall = Hall { users: &users, activation, options, held: Vec::new() };
    let (agreement, candidates) = match (policy, interrupters) {
        (_, []) => return Err(PrecedenceError::NobodyInterrupts),
        (Policy::Published, [_]) => (Pairing::AB.winner(hall.pair(0, 1)).map(by_arrival), vec![0, 1]),
        (Policy::Published, [_, _]) => {
            let winner = policy::published(|pairing| {
                hall.pair(by_arrival(pairing.current()), by_arrival(pairing.interrupting()))
            });
            (winner.map(by_arrival), vec![0, 1, 2])
        }
        (Policy::Published, more) => return Err(PrecedenceError::PublishedForTwo(more.len())),
        (Policy::Condorcet, _) => {
            match Condorcet::negotiate(users.len(), |earlier, later| hall.pair(earlier, later)).precedence() {
                selfneg_model::Precedence::Agreement(winner) => (Some(winner), Vec::new()),
                selfneg_model::Precedence::NoAgreement { candidates } => (None, candidates),
            }
        }
    };
    let worth: Vec<Impact> =
        users.iter().map(|served| welfare(served, &users, activation, options.aggregation)).collect();
    let served = match (agreement, options.fallback) {
        (Some(winner), _) => winner,
        (None, Fallback::FirstCome) => candidates.first().copied().unwrap_or(0),
        (None, Fallback::Utilitarian) => {
            most_welfare(&candidates, |user| worth.get(user).copied().unwrap_or_default()).unwrap_or(0)
        }
    };
    let candidates = if agreement.is_some() { Vec::new() } else { candidates };
    Ok(Decision { policy, options, agreement, served, candidates, welfare: worth, negotiations: hall.held })
}

/// Who beats whom if every two of `users` negotiate, the earlier arrival as the current one.
///
/// # Errors
/// [`PrecedenceError`] if the engine refuses the rules or a status.
pub fn beats(
    rules: &BoundRules,
    users: &[BoundUser],
    options: Options,
) -> Result<BeatsGraph, PrecedenceError> {
    let rows = rules.rows();
    let activation = Activation::new(&rows)?;
    let users: Vec<User<'_>> = users.iter().map(BoundUser::user).collect::<Result<_, _>>()?;
    let mut hall = Hall { users: &users, activation, options, held: Vec::new() };
    let condorcet = Condorcet::negotiate(users.len(), |earlier, later| hall.pair(earlier, later));
    Ok(condorcet.beats().clone())
}

/// Where bilateral negotiations are held.
struct Hall<'u> {
    users: &'u [User<'u>],
    activation: Activation<'u>,
    options: Options,
    held: Vec<HeldNegotiation>,
}

impl Hall<'_> {
    /// Holds the negotiation of these two. Somebody who is not there does not agree.
    fn pair(&mut self, current: usize, interrupting: usize) -> Outcome {
        let (Some(&a), Some(&b)) = (self.users.get(current), self.users.get(interrupting)) else {
            return Outcome::NoAgreement;
        };
        let willingness = if current == 0 { self.options.willingness } else { 0 };
        let options = Options { willingness, ..self.options };
        let case = Case { activation: self.activation, current: a, interrupting: b };
        let mut recorder = Recorder::default();
        let conclusion = case.negotiation(&options).run(&mut recorder);
        let rounds = recorder.rounds;
        self.held.push(HeldNegotiation { current, interrupting, options, conclusion, rounds });
        conclusion.outcome
    }
}

fn by_arrival(arrival: Arrival) -> usize {
    match arrival {
        Arrival::A => 0,
        Arrival::B => 1,
        Arrival::C => 2,
    }
}
