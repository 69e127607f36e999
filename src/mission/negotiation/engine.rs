//! The *engine*: one round of a bilateral negotiation at a time.
//!
//! The protocol is [`selfneg_core::Negotiation`]. It borrows both users' data, so it cannot
//! lie in the mission between two events; what lies there is how many rounds were played.
//! A round rebuilds the negotiation from the two snapshots and replays those before it: the
//! protocol is deterministic, so this is the same negotiation. A negotiation of n rounds
//! costs n (n + 1) / 2 of them.

use selfneg_core::{Activation, Case, Conclusion, Options, RulesError, Step, TooManyConditions, User};

use super::super::specification::MissionRules;
use super::super::user_managers::UserManagers;
use crate::transcript::{Recorder, Round};

/// A bilateral negotiation under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in super::super) struct Pair {
    /// The current side.
    pub(in super::super) current: super::super::UserId,
    /// The interrupting side.
    pub(in super::super) interrupting: super::super::UserId,
    /// The current side's willingness.
    pub(in super::super) willingness: u8,
    /// How many rounds were played.
    pub(in super::super) rounds: u32,
}

/// The engine refused its input; not for rules and data that the mission has checked.
#[derive(Debug, thiserror::Error)]
pub(in super::super) enum EngineError {
    #[error(transparent)]
    Rules(#[from] RulesError),
    #[error(transparent)]
    Status(#[from] TooManyConditions),
}

/// The engine's view of a user: the two snapshots.
pub(super) fn user<'a>(
    managers: &'a UserManagers,
    rules: &'a MissionRules,
) -> Result<User<'a>, TooManyConditions> {
    let offers = &managers.offers;
    Ok(User::new(managers.impact.profile(), offers.status()?, offers.implication(rules)))
}

/// Plays the next round.
pub(in super::super) fn next_round(
    pair: &Pair,
    current: &UserManagers,
    interrupting: &UserManagers,
    rules: &MissionRules,
) -> Result<(Option<Round>, Option<Conclusion>), EngineError> {
    let rows = rules.bound().rows();
    let case = Case {
        activation: Activation::new(&rows)?,
        current: user(current, rules)?,
        interrupting: user(interrupting, rules)?,
    };
    let options = Options { willingness: pair.willingness, ..rules.options };
    let mut negotiation = case.negotiation(&options);
    for _ in 0..pair.rounds {
        match negotiation.step(&mut ()) {
            Step::Ongoing(next) => negotiation = next,
            Step::Concluded(conclusion) => return Ok((None, Some(conclusion))),
        }
    }
    let mut recorder = Recorder::default();
    let conclusion = match negotiation.step(&mut recorder) {
        Step::Ongoing(_) => None,
        Step::Concluded(conclusion) => Some(conclusion),
    };
    Ok((recorder.rounds.pop(), conclusion))
}
