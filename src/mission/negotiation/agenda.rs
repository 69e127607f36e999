//! Which bilateral negotiation is next, and what they all come to.
//!
//! The policies take a function that holds a negotiation at once. Here negotiations take
//! many events, so the policy is asked again after each one, with the outcomes so far; the
//! first pair that it asks for and that has none is next.

use selfneg_core::Outcome;
use selfneg_core::policy::{self, Arrival};
use selfneg_model::{Condorcet, Precedence};

use crate::precedence::Policy;

/// What the policy says. Participants are numbered by arrival; 0 is the current user if
/// there is one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Agenda {
    /// These two are to negotiate; the first is on the current side.
    Next(usize, usize),
    /// This participant has precedence.
    Agreement(usize),
    /// Nobody has; the fallback chooses among these.
    NoAgreement(Vec<usize>),
}

/// The policy for so many participants: the one asked for, if it has a rule for them.
pub(super) fn policy_for(asked: Option<Policy>, participants: usize) -> Policy {
    let interrupters = participants.saturating_sub(1);
    match asked {
        Some(Policy::Published) | None => Policy::default_for(interrupters),
        Some(Policy::Condorcet) => Policy::Condorcet,
    }
}

/// Asks the policy. `outcome` is the outcome between two participants, if there is one yet.
pub(super) fn agenda(
    policy: Policy,
    participants: usize,
    mut outcome: impl FnMut(usize, usize) -> Option<Outcome>,
) -> Agenda {
    let mut next = None;
    let mut ask = |earlier: usize, later: usize| match (outcome(earlier, later), next) {
        (Some(outcome), _) => outcome,
        (None, missing) => {
            next = missing.or(Some((earlier, later)));
            Outcome::NoAgreement
        }
    };
    let result = match (policy, participants) {
        (Policy::Published, 3) => {
            match policy::published(|pair| ask(number(pair.current()), number(pair.interrupting()))) {
                Some(winner) => Agenda::Agreement(number(winner)),
                None => Agenda::NoAgreement(vec![0, 1, 2]),
            }
        }
        _ => match Condorcet::negotiate(participants, &mut ask).precedence() {
            Precedence::Agreement(winner) => Agenda::Agreement(winner),
            Precedence::NoAgreement { candidates } => Agenda::NoAgreement(candidates),
        },
    };
    next.map_or(result, |(earlier, later)| Agenda::Next(earlier, later))
}

fn number(arrival: Arrival) -> usize {
    match arrival {
        Arrival::A => 0,
        Arrival::B => 1,
        Arrival::C => 2,
    }
}

#[cfg(test)]
mod tests {
    use selfneg_core::policy::published;
    use selfneg_core::{Outcome, Side};
    use selfneg_model::{Condorcet, Precedence};

    use super::{Agenda, agenda, number};
    use crate::precedence::Policy;

    const OUTCOMES: [Outcome; 3] =
        [Outcome::Agreement(Side::Current), Outcome::Agreement(Side::Interrupting), Outcome::NoAgreement];

    /// Holds what the agenda asks for, one at a time.
    fn stepped(
        policy: Policy,
        users: usize,
        of: impl Fn(usize, usize) -> Outcome,
    ) -> (Agenda, Vec<(usize, usize)>) {
        let mut held: Vec<(usize, usize)> = Vec::new();
        loop {
            let known = |a, b| held.contains(&(a, b)).then(|| of(a, b));
            match agenda(policy, users, known) {
                Agenda::Next(a, b) => held.push((a, b)),
                done => return (done, held),
            }
        }
    }

    #[test]
    fn one_at_a_time_is_the_same_as_all_at_once() {
        for ab in OUTCOMES {
            for ac in OUTCOMES {
                for bc in OUTCOMES {
                    let of = |a, b| match (a, b) {
                        (0, 1) => ab,
                        (0, 2) => ac,
                        _ => bc,
                    };
                    let mut order = Vec::new();
                    let whole = published(|pair| {
                        let two = (number(pair.current()), number(pair.interrupting()));
                        order.push(two);
                        of(two.0, two.1)
                    });
                    let expected =
                        whole.map_or(Agenda::NoAgreement(vec![0, 1, 2]), |w| Agenda::Agreement(number(w)));
                    assert_eq!(stepped(Policy::Published, 3, of), (expected, order));

                    let expected = match Condorcet::negotiate(3, of).precedence() {
                        Precedence::Agreement(winner) => Agenda::Agreement(winner),
                        Precedence::NoAgreement { candidates } => Agenda::NoAgreement(candidates),
                    };
                    assert_eq!(stepped(Policy::Condorcet, 3, of).0, expected);
                }
            }
        }
    }
}
