//! A decision as one JSON document.

use indexmap::IndexMap;
use selfneg_core::{Disclosure, Options};
use serde::Serialize;

use crate::binding::{BoundRules, BoundUser, END_OF_GOAL};
use crate::precedence::{Decision, HeldNegotiation};
use crate::transcript::{Event, Round};

/// What `selfneg negotiate --json` prints and `decision.json` holds.
#[derive(Debug, Serialize)]
pub struct DecisionRecord {
    outcome: String,
    served: String,
    rounds: u64,
    policy: &'static str,
    options: OptionsRecord,
    variant: String,
    candidates: Vec<String>,
    welfare: IndexMap<String, u64>,
    negotiations: Vec<NegotiationRecord>,
}

#[derive(Debug, Serialize)]
struct OptionsRecord {
    quit: &'static str,
    aggregation: &'static str,
    tie: &'static str,
    fallback: &'static str,
    willingness: u8,
}

#[derive(Debug, Serialize)]
struct NegotiationRecord {
    current: String,
    interrupting: String,
    outcome: &'static str,
    rounds: u32,
    ending: &'static str,
    transcript: Vec<RoundRecord>,
}

/// The fields of an offer are null in a round that was a quit.
#[derive(Debug, Serialize)]
struct RoundRecord {
    round: u32,
    sender: &'static str,
    event: &'static str,
    depth: Option<usize>,
    discloses: Option<String>,
    value: Option<u64>,
    threshold: Option<u64>,
    verdict: Option<&'static str>,
}

impl DecisionRecord {
    /// The record of a decision among `users`.
    #[must_use]
    pub fn new(decision: &Decision, users: &[BoundUser], rules: &BoundRules) -> Self {
        Self {
            outcome: decision.outcome_name(users.len()),
            served: name(users, decision.served),
            rounds: decision.rounds(),
            policy: decision.policy.name(),
            options: OptionsRecord::new(decision.options),
            variant: decision.options.to_string(),
            candidates: decision.candidates.iter().map(|&user| name(users, user)).collect(),
            welfare: users
                .iter()
                .zip(&decision.welfare)
                .map(|(user, welfare)| (user.name.clone(), welfare.0))
                .collect(),
            negotiations: decision
                .negotiations
                .iter()
                .map(|held| NegotiationRecord::new(held, users, rules))
                .collect(),
        }
    }
}

impl OptionsRecord {
    fn new(options: Options) -> Self {
        Self {
            quit: options.quit.name(),
            aggregation: options.aggregation.name(),
            tie: options.tie.name(),
            fallback: options.fallback.name(),
            willingness: options.willingness,
        }
    }
}

impl NegotiationRecord {
    fn new(held: &HeldNegotiation, users: &[BoundUser], rules: &BoundRules) -> Self {
        Self {
            current: name(users, held.current),
            interrupting: name(users, held.interrupting),
            outcome: held.conclusion.outcome.name(),
            rounds: held.conclusion.rounds,
            ending: held.conclusion.ending.name(),
            transcript: held.rounds.iter().map(|round| RoundRecord::new(round, rules)).collect(),
        }
    }
}

impl RoundRecord {
    fn new(round: &Round, rules: &BoundRules) -> Self {
        let quit = Self {
            round: round.number,
            sender: round.sender.name(),
            event: "quit",
            depth: None,
            discloses: None,
            value: None,
            threshold: None,
            verdict: None,
        };
        match round.event {
            Event::Quit => quit,
            Event::Offer { depth, discloses, weighing, ruling } => Self {
                event: "offer",
                depth: Some(depth),
                discloses: Some(disclosed_name(discloses, rules).to_owned()),
                value: Some(weighing.value.0),
                threshold: Some(weighing.threshold.0),
                verdict: Some(ruling.name()),
                ..quit
            },
        }
    }
}

/// The name of what an offer discloses.
#[must_use]
pub fn disclosed_name(discloses: Disclosure, rules: &BoundRules) -> &str {
    match discloses {
        Disclosure::Condition(condition) => rules.condition_name(condition),
        Disclosure::Willingness => END_OF_GOAL,
    }
}

fn name(users: &[BoundUser], user: usize) -> String {
    users.get(user).map_or_else(|| format!("user {user}"), |user| user.name.clone())
}
