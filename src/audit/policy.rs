//! Whether a decision follows from the bilateral outcomes, and was made by the rules of the
//! header.

use selfneg_core::policy::{self, Arrival};
use selfneg_core::{Fallback, Options, Outcome, Side};
use selfneg_model::{Condorcet, Precedence};

use super::finding::{Log, Place};
use super::property::Property;
use crate::case::{RecordedDecision, RecordedNegotiation};
use crate::mission::UserId;
use crate::precedence::Policy;

/// No mission holds more: their number is one byte of its limits.
const MAX_PARTICIPANTS: usize = 255;

/// The rules that the header puts in force.
#[derive(Clone, Copy, Debug)]
pub(super) struct InForce {
    pub(super) options: Options,
    pub(super) policy: Option<Policy>,
}

/// Checks one decision. `current` is the user whom the robot served before it, if it served
/// one.
pub(super) fn check(decision: &RecordedDecision, current: Option<UserId>, in_force: &InForce, log: &mut Log) {
    let at = Place::entry(decision.index, decision.at).of_decision(Some(decision.decision));
    let participants = &decision.participants;
    let policy = crate::case::policy_for(in_force.policy, participants.len());
    if decision.options == Some(in_force.options) && decision.policy == Some(policy) {
        log.held(Property::RulesInForce);
    } else {
        let what = format!(
            "decided by {} and policy {}, where the header puts {} and {policy} in force",
            decision.options.map_or_else(|| "an unknown variant".to_owned(), |options| options.to_string()),
            decision.policy.map_or("unknown", Policy::name),
            in_force.options,
        );
        log.broken(Property::RulesInForce, at, what);
    }
    match follows(decision, current, policy, in_force.options) {
        Ok(()) => log.held(Property::Policy),
        Err(what) => log.broken(Property::Policy, at, what),
    }
}

fn follows(
    decision: &RecordedDecision,
    current: Option<UserId>,
    policy: Policy,
    options: Options,
) -> Result<(), String> {
    let participants = &decision.participants;
    let mut distinct = participants.clone();
    distinct.sort_unstable();
    distinct.dedup();
    if participants.len() < 2 || distinct.len() != participants.len() {
        return Err("a decision among fewer than two users".to_owned());
    }
    if participants.len() > MAX_PARTICIPANTS {
        return Err(format!("a decision among {} users, more than any robot holds", participants.len()));
    }
    if let Some(current) = current
        && participants.first() != Some(&current)
    {
        return Err(format!("user {} is being served, and is not the first who takes part", current.0));
    }
    for held in &decision.negotiations {
        check_sides(held, decision, current, options)?;
    }
    let rounds: u64 = decision
        .negotiations
        .iter()
        .filter_map(|held| held.end.as_ref())
        .map(|end| u64::from(end.rounds))
        .sum();
    if rounds != u64::from(decision.rounds) {
        return Err(format!("it counts {} rounds, its negotiations have {rounds}", decision.rounds));
    }
    let mut missing = None;
    let mut outcome = |earlier: usize, later: usize| {
        outcome_of(decision, earlier, later).unwrap_or_else(|| {
            missing = missing.or(Some((earlier, later)));
            Outcome::NoAgreement
        })
    };
    let (agreement, candidates) = match (policy, participants.len()) {
        (Policy::Published, 3) => {
            let winner = policy::published(|pair| outcome(place(pair.current()), place(pair.interrupting())));
            (winner.map(place), vec![0, 1, 2])
        }
        (_, users) => match Condorcet::negotiate(users, &mut outcome).precedence() {
            Precedence::Agreement(winner) => (Some(winner), Vec::new()),
            Precedence::NoAgreement { candidates } => (None, candidates),
        },
    };
    let user = |place: usize| participants.get(place).copied();
    if let Some((earlier, later)) = missing {
        let [earlier, later] = [earlier, later].map(|place| named(user(place)));
        return Err(format!("the policy needs a negotiation of {earlier} and {later}, and there is none"));
    }
    let agreed = agreement.and_then(user);
    if decision.agreement != agreed {
        let (said, so) = (named(decision.agreement), named(agreed));
        return Err(format!("precedence is given to {said}, by the bilateral outcomes it is {so}'s"));
    }
    let may_be_served: Vec<UserId> = match (agreed, options.fallback) {
        (Some(winner), _) => vec![winner],
        (None, Fallback::FirstCome) => {
            candidates.first().and_then(|&first| user(first)).into_iter().collect()
        }
        // Whose welfare is the largest is personal: made again with the inputs.
        (None, Fallback::Utilitarian) => candidates.iter().filter_map(|&candidate| user(candidate)).collect(),
    };
    if !may_be_served.contains(&decision.served) {
        let names: Vec<String> = may_be_served.iter().map(|&one| named(Some(one))).collect();
        return Err(format!(
            "{} is served, by the bilateral outcomes and the fallback it is {}",
            named(Some(decision.served)),
            names.join(" or ")
        ));
    }
    Ok(())
}

/// The earlier arrival is on the current side, and only the user being served has willingness.
fn check_sides(
    held: &RecordedNegotiation,
    decision: &RecordedDecision,
    current: Option<UserId>,
    options: Options,
) -> Result<(), String> {
    let places = [held.current, held.interrupting].map(|user| decision.place_of(user));
    let [Some(earlier), Some(later)] = places else {
        return Err("a negotiation with somebody who takes no part".to_owned());
    };
    if earlier >= later {
        return Err(format!(
            "user {} came before user {}, and plays the interrupting side",
            held.interrupting.0, held.current.0
        ));
    }
    let may_be_willing = current == Some(held.current);
    let willing = held.willingness;
    if willing != 0 && (!may_be_willing || willing != u32::from(options.willingness)) {
        return Err(format!("willingness {willing} of user {}, which the rules do not have", held.current.0));
    }
    Ok(())
}

fn outcome_of(decision: &RecordedDecision, earlier: usize, later: usize) -> Option<Outcome> {
    let (earlier, later) = (decision.participants.get(earlier)?, decision.participants.get(later)?);
    let held =
        decision.negotiations.iter().find(|held| held.current == *earlier && held.interrupting == *later)?;
    Some(match held.end.as_ref()?.winner {
        Some(winner) if winner == *earlier => Outcome::Agreement(Side::Current),
        Some(winner) if winner == *later => Outcome::Agreement(Side::Interrupting),
        _ => Outcome::NoAgreement,
    })
}

fn named(user: Option<UserId>) -> String {
    user.map_or_else(|| "nobody".to_owned(), |user| format!("user {}", user.0))
}

fn place(arrival: Arrival) -> usize {
    match arrival {
        Arrival::A => 0,
        Arrival::B => 1,
        Arrival::C => 2,
    }
}
