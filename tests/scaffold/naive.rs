//! A second opinion: the published protocol on names, as plainly as it can be written and
//! without a line of the engine. Exhausted quits, first sender wins ties, every condition
//! counts.

use std::collections::HashMap;

/// A user of the `of_letters` rules: each condition activates one disposition of its own, and
/// every goal implies all of them, so a condition is worth its rank.
#[derive(Clone, Debug)]
pub(crate) struct Naive {
    pub(crate) name: String,
    pub(crate) conditions: String,
    pub(crate) ranks: HashMap<char, u64>,
    /// The condition "end of goal" is true: worth 1 to this user while it is the current one.
    pub(crate) end_of_goal: bool,
}

impl Naive {
    /// `ranks` as in `Place::user`.
    pub(crate) fn new(name: &str, conditions: &str, ranks: &str) -> Self {
        let ranks = ranks
            .split_whitespace()
            .map(|one| (one.chars().next().unwrap(), one.split_at(1).1.parse().unwrap()))
            .collect();
        Self { name: name.to_owned(), conditions: conditions.to_owned(), ranks, end_of_goal: false }
    }

    fn worth(&self, condition: char) -> u64 {
        if condition == '!' { 0 } else { self.ranks.get(&condition).copied().unwrap_or(0) }
    }

    fn ranks_of(&self, conditions: &[char]) -> u64 {
        conditions.iter().map(|&condition| self.worth(condition)).sum()
    }
}

/// The winner as the logs name it, and the rounds.
pub(crate) fn negotiate(current: &Naive, interrupting: &Naive) -> (&'static str, u64) {
    // '!' is the end of the goal.
    let mut own: Vec<char> = current.conditions.chars().collect();
    let bonus = u64::from(current.end_of_goal);
    if current.end_of_goal {
        own.push('!');
    }
    let others: Vec<char> = interrupting.conditions.chars().collect();
    let (mut told_by_current, mut told_by_interrupting) = (0, 0);
    let (mut current_quit, mut interrupting_quit) = (false, false);
    let mut interrupting_sends = true;
    let mut round = 0;
    loop {
        round += 1;
        if interrupting_sends {
            if told_by_interrupting == others.len() {
                interrupting_quit = true;
            } else {
                told_by_interrupting += 1;
                let offer = &others[..told_by_interrupting];
                if current.ranks_of(offer) > current.ranks_of(&own) + bonus {
                    return ("interrupting", round);
                }
            }
        } else if told_by_current == own.len() {
            current_quit = true;
        } else {
            told_by_current += 1;
            if interrupting.ranks_of(&own[..told_by_current]) > interrupting.ranks_of(&others) {
                return ("current", round);
            }
        }
        if current_quit && interrupting_quit {
            return ("no-agreement", round);
        }
        interrupting_sends = if current_quit {
            true
        } else if interrupting_quit {
            false
        } else {
            !interrupting_sends
        };
    }
}

/// The published policy for three users: outcome, and the rounds of the first negotiation.
pub(crate) fn negotiate_three(a: &Naive, b: &Naive, c: &Naive) -> (&'static str, u64) {
    let (ab, rounds) = negotiate(a, b);
    let (ac, _) = negotiate(a, c);
    let name = |outcome: &str, interrupter: &'static str| match outcome {
        "current" => "current",
        "interrupting" => interrupter,
        _ => "no-agreement",
    };
    let bc = || match negotiate(b, c).0 {
        "current" => "interrupting_1",
        "interrupting" => "interrupting_2",
        _ => "no-agreement",
    };
    let outcome = match (ab, ac) {
        ("no-agreement", _) => name(ac, "interrupting_2"),
        (_, "no-agreement") => name(ab, "interrupting_1"),
        ("current", "current") => "current",
        ("interrupting", "interrupting") => bc(),
        ("interrupting", _) if bc() == "interrupting_1" => "interrupting_1",
        (_, "interrupting") if bc() == "interrupting_2" => "interrupting_2",
        _ => "no-agreement",
    };
    (outcome, rounds)
}
