//! Whether a recorded decision, made again from the recorded data, is the same.

use selfneg_core::{Outcome, Side};
use serde::Serialize;

use crate::case::{Case, Inputs, RecordedDecision, RecordedEvent, RecordedNegotiation, RecordedRound, Worth};
use crate::precedence::{Decision, HeldNegotiation};
use crate::transcript::{Event, Round};

/// Whether a decision, made again, is the recorded one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Redecided {
    /// To the last round.
    Same,
    /// It is not: the robot did not decide by its rules, or the trace is false.
    Differs,
    /// Not everything that it takes could be read.
    Unchecked,
}

/// Makes a decision again, where its data can be read.
pub(super) fn redecided(case: &Case) -> (Redecided, Option<Decision>) {
    match case {
        Case::Emergency(emergency) if emergency.certain => (Redecided::Same, None),
        Case::Emergency(_) => (Redecided::Differs, None),
        Case::Negotiated(case) => {
            match case.inputs.as_ref().ok().and_then(|inputs| Some((inputs, inputs.decide().ok()?))) {
                None => (Redecided::Unchecked, None),
                Some((inputs, decision)) if is_same(&case.recorded, inputs, &decision) => {
                    (Redecided::Same, Some(decision))
                }
                Some((_, decision)) => (Redecided::Differs, Some(decision)),
            }
        }
    }
}

fn is_same(recorded: &RecordedDecision, inputs: &Inputs, again: &Decision) -> bool {
    recorded.policy == Some(again.policy)
        && recorded.served_place() == Some(again.served)
        && recorded.agreement_place() == again.agreement
        && recorded.agreement.is_some() == again.agreement.is_some()
        && u64::from(recorded.rounds) == again.rounds()
        && recorded.negotiations.len() == again.negotiations.len()
        && again.negotiations.iter().all(|held| {
            recorded.negotiations.iter().any(|one| is_same_negotiation(one, held, recorded, inputs))
        })
}

fn is_same_negotiation(
    one: &RecordedNegotiation,
    held: &HeldNegotiation,
    recorded: &RecordedDecision,
    inputs: &Inputs,
) -> bool {
    let places = (recorded.place_of(one.current), recorded.place_of(one.interrupting));
    let winner = match held.conclusion.outcome {
        Outcome::Agreement(Side::Current) => Some(one.current),
        Outcome::Agreement(Side::Interrupting) => Some(one.interrupting),
        Outcome::NoAgreement => None,
    };
    places == (Some(held.current), Some(held.interrupting))
        && one.end.as_ref().is_some_and(|end| {
            end.winner == winner
                && end.rounds == held.conclusion.rounds
                && end.ending == held.conclusion.ending.name()
        })
        && one.rounds.len() == held.rounds.len()
        && one
            .rounds
            .iter()
            .zip(&held.rounds)
            .all(|(round, again)| is_same_round(round, again, one, held, inputs))
}

fn is_same_round(
    round: &RecordedRound,
    again: &Round,
    one: &RecordedNegotiation,
    held: &HeldNegotiation,
    inputs: &Inputs,
) -> bool {
    let (sender, place) = match again.sender {
        Side::Current => (one.current, held.current),
        Side::Interrupting => (one.interrupting, held.interrupting),
    };
    let event = match again.event {
        Event::Quit => Some(RecordedEvent::Quit),
        Event::Offer { depth, discloses, weighing, ruling } => {
            u64::try_from(depth).ok().map(|depth| RecordedEvent::Offer {
                depth,
                verdict: Some(ruling),
                discloses: Some(inputs.disclosed(place, discloses)),
                worth: Some(Worth { value: weighing.value.0, threshold: weighing.threshold.0 }),
            })
        }
    };
    round.number == again.number && round.sender == sender && Some(round.event) == event
}
