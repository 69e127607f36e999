//! Each decision once more, from its inputs alone, and what it is worth to everybody.

use selfneg_core::{Activation, Options, Side};
use selfneg_model::{Decided, Impacts, Regret};
use serde::Serialize;

use super::finding::{Log, Place, conditions};
use super::property::Property;
use crate::binding::BoundUser;
use crate::case::{
    Inputs, NegotiatedCase, RecordedDecision, RecordedEvent, RecordedNegotiation, RecordedRound,
};
use crate::precedence::{HeldNegotiation, Policy, PrecedenceError, decide};
use crate::transcript::{Event, Round};

/// Whether a decision, made again, is the recorded one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Redecided {
    /// In every round.
    Same,
    /// Not in every round.
    Differs,
    /// It could not be made again.
    Unchecked,
}

/// What a decision is worth to all who took part, in ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Welfare {
    /// The welfare of serving whom the robot served.
    pub served: u64,
    /// The largest welfare.
    pub optimum: u64,
    /// What the decision lost.
    pub regret: u64,
    /// What lost it, as `selfneg optimum` names it.
    pub cause: &'static str,
}

/// Whether a case, made again, is the recorded one; for those who want no findings.
pub(crate) fn redecided(case: &NegotiatedCase) -> Redecided {
    case.inputs.as_ref().map_or(Redecided::Unchecked, |inputs| check(case, inputs, &mut Log::default()))
}

/// Decides a case again and holds every round against the recorded one.
pub(super) fn check(case: &NegotiatedCase, inputs: &Inputs, log: &mut Log) -> Redecided {
    let recorded = &case.recorded;
    let at = Place::entry(recorded.index, recorded.at).of_decision(Some(recorded.decision));
    let again = match inputs.decide() {
        Ok(again) => again,
        Err(error) => {
            log.broken(Property::Redecision, at, format!("it cannot be made again: {error}"));
            return Redecided::Differs;
        }
    };
    let mut same = true;
    let mut differs = |log: &mut Log, at: Place, what: String| {
        same = false;
        log.broken(Property::Redecision, at, what);
    };
    let user = |place: usize| recorded.participants.get(place);
    let name = |user: Option<&crate::mission::UserId>| {
        user.map_or_else(|| "nobody".to_owned(), |user| format!("user {}", user.0))
    };
    let agreed = again.agreement.and_then(user);
    if recorded.agreement.as_ref() != agreed {
        let said = name(recorded.agreement.as_ref());
        differs(
            log,
            at,
            format!("precedence is given to {said}; made again, the decision gives it to {}", name(agreed)),
        );
    }
    if Some(&recorded.served) != user(again.served) {
        let (said, so) = (name(Some(&recorded.served)), name(user(again.served)));
        differs(log, at, format!("{said} is served; made again, the decision serves {so}"));
    }
    for negotiation in &recorded.negotiations {
        let held = again.negotiations.iter().find(|held| {
            user(held.current) == Some(&negotiation.current)
                && user(held.interrupting) == Some(&negotiation.interrupting)
        });
        let outcome = match held {
            Some(held) => compare(recorded, negotiation, held, inputs),
            // Held for a policy that was in force before somebody left.
            None => match alone(recorded, negotiation, inputs) {
                Some(Ok(held)) => compare(recorded, negotiation, &held, inputs),
                Some(Err(error)) => Err((at, format!("it cannot be made again: {error}"))),
                None => Err((at, "a negotiation with somebody who takes no part".to_owned())),
            },
        };
        if let Err((at, what)) = outcome {
            differs(log, at, format!("{}: {what}", super::protocol::pair(negotiation)));
        }
    }
    if !same {
        return Redecided::Differs;
    }
    log.held(Property::Redecision);
    Redecided::Same
}

/// A negotiation of two of the participants, apart from the decision.
fn alone(
    recorded: &RecordedDecision,
    negotiation: &RecordedNegotiation,
    inputs: &Inputs,
) -> Option<Result<HeldNegotiation, PrecedenceError>> {
    let current = recorded.place_of(negotiation.current)?;
    let interrupting = recorded.place_of(negotiation.interrupting)?;
    let two = [inputs.users.get(current)?.clone(), inputs.users.get(interrupting)?.clone()];
    let willingness = if current == 0 { inputs.options.willingness } else { 0 };
    let options = Options { willingness, ..inputs.options };
    match decide(&inputs.rules, &two, options, Policy::Published) {
        Ok(decision) => decision
            .negotiations
            .into_iter()
            .next()
            .map(|held| Ok(HeldNegotiation { current, interrupting, ..held })),
        Err(error) => Some(Err(error)),
    }
}

/// The first round that differs, or the end.
fn compare(
    decision: &RecordedDecision,
    recorded: &RecordedNegotiation,
    again: &HeldNegotiation,
    inputs: &Inputs,
) -> Result<(), (Place, String)> {
    let of_decision = |place: Place| place.of_decision(Some(decision.decision));
    let mut rounds = again.rounds.iter();
    for round in &recorded.rounds {
        let at = of_decision(Place::entry(round.index, round.at)).in_round(round.number);
        let Some(expected) = rounds.next() else {
            return Err((at, format!("recorded is {}; made again, it is over before", tell(round))));
        };
        if let Some(difference) = difference(recorded, round, expected, again, inputs) {
            return Err((at, difference));
        }
    }
    let at = of_decision(Place::entry(recorded.index, recorded.at));
    if let Some(missing) = rounds.next() {
        let at = at.in_round(missing.number);
        let what = format!("it stops before round {}, which comes when it is made again", missing.number);
        return Err((at, what));
    }
    let Some(end) = &recorded.end else { return Ok(()) };
    let winner = again.conclusion.outcome.winner().map(|side| match side {
        Side::Current => recorded.current,
        Side::Interrupting => recorded.interrupting,
    });
    if (end.winner, end.ending.as_str()) != (winner, again.conclusion.ending.name()) {
        let named = |user: Option<crate::mission::UserId>| {
            user.map_or_else(|| "nobody".to_owned(), |user| format!("user {}", user.0))
        };
        let what = format!(
            "won by {} ({}); made again, by {} ({})",
            named(end.winner),
            end.ending,
            named(winner),
            again.conclusion.ending.name()
        );
        return Err((Place { entry: Some(end.index), ..at }, what));
    }
    Ok(())
}

fn difference(
    negotiation: &RecordedNegotiation,
    recorded: &RecordedRound,
    again: &Round,
    held: &HeldNegotiation,
    inputs: &Inputs,
) -> Option<String> {
    let (sender, place) = match again.sender {
        Side::Current => (negotiation.current, held.current),
        Side::Interrupting => (negotiation.interrupting, held.interrupting),
    };
    let expected = match again.event {
        Event::Quit => format!("user {} quits", sender.0),
        Event::Offer { depth, ruling, .. } => {
            format!(
                "user {} offers {}, {}",
                sender.0,
                conditions(u64::try_from(depth).unwrap_or(u64::MAX)),
                ruled(ruling)
            )
        }
    };
    let what = tell(recorded);
    if recorded.number != again.number || what != expected {
        return Some(format!("recorded is {what}; made again, {expected}"));
    }
    let (RecordedEvent::Offer { discloses, worth, .. }, Event::Offer { discloses: disclosed, weighing, .. }) =
        (recorded.event, again.event)
    else {
        return None;
    };
    if discloses.is_some_and(|discloses| discloses != inputs.disclosed(place, disclosed)) {
        return Some(format!("user {} discloses another condition than when it is made again", sender.0));
    }
    let totals = (weighing.value.0, weighing.threshold.0);
    worth
        .is_some_and(|worth| (worth.value, worth.threshold) != totals)
        .then(|| "the receiver's totals are others than when it is made again".to_owned())
}

fn tell(round: &RecordedRound) -> String {
    let sender = round.sender.0;
    match round.event {
        RecordedEvent::Quit => format!("user {sender} quits"),
        RecordedEvent::Unknown => format!("user {sender} does nothing"),
        RecordedEvent::Offer { depth, verdict, .. } => {
            let verdict = verdict.map_or("without a verdict", ruled);
            format!("user {sender} offers {}, {verdict}", conditions(depth))
        }
    }
}

const fn ruled(ruling: selfneg_core::Ruling) -> &'static str {
    match ruling {
        selfneg_core::Ruling::Accept => "accepted",
        selfneg_core::Ruling::Reject => "rejected",
        selfneg_core::Ruling::Hold => "held",
    }
}

/// What the recorded decision is worth.
pub(super) fn welfare(recorded: &RecordedDecision, inputs: &Inputs) -> Option<Welfare> {
    let rows = inputs.rules.rows();
    let activation = Activation::new(&rows).ok()?;
    let users: Vec<selfneg_core::User<'_>> =
        inputs.users.iter().map(BoundUser::user).collect::<Result<_, _>>().ok()?;
    let impacts = Impacts::among(&users, activation, inputs.options.aggregation);
    let beat = |winner: usize, loser: usize| {
        let place = |user| recorded.place_of(user);
        recorded.negotiations.iter().any(|held| {
            let sides = (place(held.current), place(held.interrupting));
            let won = held.end.as_ref().and_then(|end| end.winner).and_then(place);
            won == Some(winner)
                && (sides == (Some(winner), Some(loser)) || sides == (Some(loser), Some(winner)))
        })
    };
    let served = recorded.served_place()?;
    let decided = Decided {
        agreement: recorded.agreement_place(),
        served,
        beat: &beat,
        willingness: inputs.options.willingness,
    };
    let regret = Regret::of(&impacts, &decided);
    let optimum = impacts.optimal().first().map(|&best| impacts.welfare(best))?;
    Some(Welfare {
        served: impacts.welfare(served),
        optimum,
        regret: regret.amount,
        cause: regret.cause.name(),
    })
}
