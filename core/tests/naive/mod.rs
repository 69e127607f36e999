//! What the engine must come to, computed without it: impacts as plain sums over sets and
//! lists, and for every variant a closed form in place of a state machine.
#![allow(dead_code, reason = "each test file takes the part it needs")]
#![allow(
    clippy::expect_used,
    clippy::unreachable,
    reason = "clippy looks for tests only in functions marked so"
)]

use std::collections::BTreeSet;

use selfneg_core::{Aggregation, Conclusion, Ending, Fallback, Options, Outcome, QuitRule, Side, TieRule};

use crate::situation::{Person, Situation};

fn at(list: &[u8], index: u16) -> u128 {
    list.get(usize::from(index)).copied().map_or(0, u128::from)
}

/// EI of `sender`'s offer of depth `depth` in the eyes of `eyes`.
pub(crate) fn impact(
    rows: &[Vec<u16>],
    sender: &Person,
    depth: usize,
    eyes: &Person,
    aggregation: Aggregation,
) -> u128 {
    let activated = sender
        .status
        .iter()
        .take(depth)
        .filter_map(|&condition| rows.get(usize::from(condition)))
        .flatten()
        .copied();
    match aggregation {
        Aggregation::PerCondition => activated.map(|d| at(&sender.mentions, d) * at(&eyes.ranks, d)).sum(),
        Aggregation::PerDisposition => {
            let activated: BTreeSet<u16> = activated.collect();
            let implied: BTreeSet<u16> = (0..=u16::MAX)
                .zip(&sender.mentions)
                .filter_map(|(d, &mentions)| (mentions > 0).then_some(d))
                .collect();
            activated.intersection(&implied).map(|&d| at(&eyes.ranks, d)).sum()
        }
    }
}

/// What one user's offers look like to the other.
pub(crate) struct Outlook {
    /// How many offers this user has.
    pub(crate) offers: usize,
    /// The depth of its first offer that the other one accepts, if there is one.
    pub(crate) accepted_at: Option<usize>,
}

impl Outlook {
    pub(crate) fn of(situation: &Situation, sender: Side, options: &Options) -> Self {
        let offers = offers(situation, sender, options);
        let to_exceed = threshold(situation, sender.other(), options);
        let accepted_at = (1..=offers).find(|&depth| value(situation, sender, depth, options) > to_exceed);
        Self { offers, accepted_at }
    }
}

pub(crate) fn offers(situation: &Situation, side: Side, options: &Options) -> usize {
    let willing = side == Side::Current && options.willingness > 0;
    situation.person(side).status.len() + usize::from(willing)
}

/// What the other user thinks `sender`'s offer of depth `depth` is worth.
pub(crate) fn value(situation: &Situation, sender: Side, depth: usize, options: &Options) -> u128 {
    let [sender, eyes] = [situation.person(sender), situation.person(sender.other())];
    impact(&situation.rows, sender, depth, eyes, options.aggregation)
}

/// What `side`'s own complete offer is worth to it.
pub(crate) fn threshold(situation: &Situation, side: Side, options: &Options) -> u128 {
    let person = situation.person(side);
    let own = impact(&situation.rows, person, person.status.len(), person, options.aggregation);
    match side {
        Side::Current => own + u128::from(options.willingness),
        Side::Interrupting => own,
    }
}

/// Outcome, rounds and ending under any variant, from the two first accepted depths and
/// the two numbers of offers alone.
///
/// Turn `k` of the interrupter comes after `k - 1` turns of the current user, turn `k` of
/// the current user after `k` of the interrupter. Under `exhausted` a user has one turn
/// more than it has offers, its quit, and then none. Under `literal` the current user ends
/// it on hearing the offer whose depth is its own number of offers (the first, if it has
/// none), round 2c - 1, and the interrupter likewise, round 2a (round 1, if it has none).
pub(crate) fn conclusion(situation: &Situation, options: &Options) -> Conclusion {
    let i = Outlook::of(situation, Side::Interrupting, options);
    let c = Outlook::of(situation, Side::Current, options);
    let end = |outcome, rounds: usize, ending| Conclusion {
        outcome,
        rounds: u32::try_from(rounds).expect("a few hundred rounds"),
        ending,
    };

    let (round_of_i, round_of_c, without_agreement);
    match options.quit {
        QuitRule::Exhausted => {
            round_of_i = i.accepted_at.map(|k| k + (k - 1).min(c.offers + 1));
            round_of_c = c.accepted_at.map(|k| k + k.min(i.offers + 1));
            without_agreement = end(Outcome::NoAgreement, i.offers + c.offers + 2, Ending::BothQuit);
        }
        QuitRule::Literal => {
            let current_ends = (2 * c.offers.max(1) - 1, Ending::LiteralQuit(Side::Current));
            let interrupter_ends = ((2 * i.offers).max(1), Ending::LiteralQuit(Side::Interrupting));
            let (last, ending) = if i.offers == 0 || interrupter_ends.0 < current_ends.0 {
                interrupter_ends
            } else {
                current_ends
            };
            round_of_i = i.accepted_at.map(|k| 2 * k - 1).filter(|&round| round <= last);
            round_of_c = c.accepted_at.map(|k| 2 * k).filter(|&round| round <= last);
            without_agreement = end(Outcome::NoAgreement, last, ending);
        }
    }

    match (round_of_i, round_of_c) {
        (None, None) => without_agreement,
        (Some(round), c_round) if c_round.is_none_or(|c_round| round < c_round) => {
            let depth = i.accepted_at.expect("it has a round");
            let held = options.tie != TieRule::FirstSender && depth <= c.offers;
            if !held {
                return end(Outcome::Agreement(Side::Interrupting), round, Ending::Accepted);
            }
            if c.accepted_at != Some(depth) {
                return end(Outcome::Agreement(Side::Interrupting), round + 1, Ending::HeldOfferStands);
            }
            let gain_of = |receiver: Side| {
                value(situation, receiver.other(), depth, options) - threshold(situation, receiver, options)
            };
            let outcome = match (options.tie, gain_of(Side::Current).cmp(&gain_of(Side::Interrupting))) {
                (TieRule::Surplus, std::cmp::Ordering::Greater) => Outcome::Agreement(Side::Interrupting),
                (TieRule::Surplus, std::cmp::Ordering::Less) => Outcome::Agreement(Side::Current),
                _ => Outcome::NoAgreement,
            };
            end(outcome, round + 1, Ending::Tie)
        }
        (_, Some(round)) => end(Outcome::Agreement(Side::Current), round, Ending::Accepted),
        (Some(_), None) => unreachable!("is_none_or(None) holds"),
    }
}

/// W of serving `side`.
pub(crate) fn welfare(situation: &Situation, side: Side, aggregation: Aggregation) -> u128 {
    let served = situation.person(side);
    [Side::Current, Side::Interrupting]
        .map(|eyes| impact(&situation.rows, served, served.status.len(), situation.person(eyes), aggregation))
        .iter()
        .sum()
}

/// Whom the robot serves.
pub(crate) fn served(situation: &Situation, options: &Options) -> Side {
    match (conclusion(situation, options).outcome, options.fallback) {
        (Outcome::Agreement(side), _) => side,
        (Outcome::NoAgreement, Fallback::FirstCome) => Side::Current,
        (Outcome::NoAgreement, Fallback::Utilitarian) => {
            let [current, interrupting] =
                [Side::Current, Side::Interrupting].map(|side| welfare(situation, side, options.aggregation));
            if interrupting > current { Side::Interrupting } else { Side::Current }
        }
    }
}
