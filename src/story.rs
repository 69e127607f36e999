//! A decision told to people: who offers what, what the receiver weighs, and why it ends.

use std::fmt::Write as _;

use selfneg_core::{Disclosure, Ending, Fallback, Outcome, Ruling, Side, TieRule};

use crate::binding::{BoundRules, BoundUser};
use crate::precedence::{Decision, HeldNegotiation, Policy};
use crate::transcript::{Event, Round};

/// Tells a decision among `users` as it happened.
#[must_use]
pub fn tell(decision: &Decision, users: &[BoundUser], rules: &BoundRules) -> String {
    let teller = Teller { decision, users, rules };
    let mut story = teller.opening();
    for (nth, held) in decision.negotiations.iter().enumerate() {
        story.push('\n');
        if decision.negotiations.len() > 1 {
            let _ = writeln!(
                story,
                "Negotiation {}: between {} and {}, who offers first.\n",
                nth.saturating_add(1),
                teller.name(held.current),
                teller.name(held.interrupting)
            );
        }
        for round in &held.rounds {
            story.push_str(&teller.round(held, round));
        }
        let _ = writeln!(story, "\n{}", teller.ending(held));
    }
    if decision.negotiations.len() > 1 {
        let _ = writeln!(story, "\nTogether: {}.", teller.together());
    }
    let _ = writeln!(story, "\n{}\n\n{}", teller.closing(), teller.variant());
    story
}

struct Teller<'a> {
    decision: &'a Decision,
    users: &'a [BoundUser],
    rules: &'a BoundRules,
}

impl<'a> Teller<'a> {
    fn name(&self, user: usize) -> &'a str {
        self.users.get(user).map_or("?", |user| user.name.as_str())
    }

    fn side(&self, held: &HeldNegotiation, side: Side) -> &'a str {
        self.name(match side {
            Side::Current => held.current,
            Side::Interrupting => held.interrupting,
        })
    }

    fn opening(&self) -> String {
        let mut text = String::new();
        for (nth, user) in self.users.iter().enumerate() {
            let goal = &user.goal;
            let _ = match nth {
                0 => write!(text, "The robot is serving {} (goal: {goal}).", user.name),
                _ => write!(text, " {} interrupts (goal: {goal}).", user.name),
            };
        }
        text.push('\n');
        text
    }

    fn round(&self, held: &HeldNegotiation, round: &Round) -> String {
        let sender = self.side(held, round.sender);
        let receiver = self.side(held, round.sender.other());
        let number = round.number;
        match round.event {
            Event::Quit => {
                let offered = held.rounds.iter().any(|earlier| {
                    earlier.number < number && earlier.sender == round.sender && earlier.event != Event::Quit
                });
                let nothing = if offered { "nothing more" } else { "nothing" };
                format!("Round {number:>2}  {sender} has {nothing} to disclose and quits.\n")
            }
            Event::Offer { discloses, weighing, ruling, .. } => {
                let what = match discloses {
                    Disclosure::Condition(condition) => {
                        format!("discloses {:?}", self.rules.condition_name(condition))
                    }
                    Disclosure::Willingness => "discloses being close to the end of the goal".to_owned(),
                };
                let ruling = match ruling {
                    Ruling::Accept if held.conclusion.ending == Ending::Tie => "would accept too",
                    Ruling::Accept => "accepts",
                    Ruling::Reject => "rejects",
                    Ruling::Hold => {
                        "would accept, but first makes an offer that discloses as many conditions"
                    }
                };
                format!(
                    "Round {number:>2}  {sender} {what}.\n          To {receiver} this offer is worth {}, \
                     {receiver}'s own complete offer {}: {receiver} {ruling}.\n",
                    weighing.value, weighing.threshold
                )
            }
        }
    }

    fn ending(&self, held: &HeldNegotiation) -> String {
        let rounds = match held.conclusion.rounds {
            1 => "1 round".to_owned(),
            rounds => format!("{rounds} rounds"),
        };
        let winner = held.conclusion.outcome.winner().map(|side| self.side(held, side));
        let loser = held.conclusion.outcome.winner().map(|side| self.side(held, side.other()));
        let why = match (held.conclusion.ending, winner, loser) {
            (Ending::Accepted, Some(winner), Some(loser)) => {
                format!("{loser} accepted {winner}'s offer")
            }
            (Ending::HeldOfferStands, Some(winner), Some(loser)) => {
                format!(
                    "{winner} rejected {loser}'s offer, so {winner}'s own, which {loser} would accept, stands"
                )
            }
            (Ending::Tie, Some(winner), Some(loser)) => format!(
                "each would accept the other's offer, and {loser} gains more by that than {winner} would"
            ),
            (Ending::Tie, ..) => match held.options.tie {
                TieRule::Surplus => {
                    "each would accept the other's offer, and both would gain the same by that".to_owned()
                }
                TieRule::Fallback | TieRule::FirstSender => {
                    "each would accept the other's offer, and such a tie is left to the fallback".to_owned()
                }
            },
            (Ending::LiteralQuit(side), ..) if held.conclusion.rounds == 1 && held.rounds_hold_no_offer() => {
                format!("{} had nothing to offer (literal quit rule)", self.side(held, side))
            }
            (Ending::LiteralQuit(side), ..) => {
                let quitter = self.side(held, side);
                format!(
                    "{quitter} rejected an offer, and none of {quitter}'s own discloses more conditions \
                     (literal quit rule)"
                )
            }
            (Ending::BothQuit | Ending::Accepted | Ending::HeldOfferStands, ..) => {
                "both ran out of offers".to_owned()
            }
        };
        match held.conclusion.outcome {
            Outcome::Agreement(side) => {
                format!("Agreement for {} after {rounds}: {why}.", self.side(held, side))
            }
            Outcome::NoAgreement => format!("No agreement after {rounds}: {why}."),
        }
    }

    /// Who beat whom, the most victorious first.
    fn together(&self) -> String {
        let mut victories: Vec<(usize, Vec<&str>)> = Vec::new();
        let mut undecided = Vec::new();
        for held in &self.decision.negotiations {
            let Some(side) = held.conclusion.outcome.winner() else {
                undecided.push(format!("{} and {}", self.name(held.current), self.name(held.interrupting)));
                continue;
            };
            let (winner, loser) = match side {
                Side::Current => (held.current, held.interrupting),
                Side::Interrupting => (held.interrupting, held.current),
            };
            match victories.iter_mut().find(|(user, _)| *user == winner) {
                Some((_, beaten)) => beaten.push(self.name(loser)),
                None => victories.push((winner, vec![self.name(loser)])),
            }
        }
        victories.sort_by_key(|(_, beaten)| std::cmp::Reverse(beaten.len()));
        let mut parts: Vec<String> = victories
            .iter()
            .map(|(winner, beaten)| format!("{} beats {}", self.name(*winner), beaten.join(", ")))
            .collect();
        if !undecided.is_empty() {
            parts.push(format!("no agreement between {}", undecided.join(", ")));
        }
        parts.join("; ")
    }

    fn variant(&self) -> String {
        let policy = match self.users.len() {
            2 => String::new(),
            _ => format!(", policy {}", self.decision.policy),
        };
        let willingness = match self.decision.options.willingness {
            0 => String::new(),
            worth => format!(
                "; {}'s own complete offer includes {worth} for being close to the goal",
                self.name(0)
            ),
        };
        format!("Protocol variant: {}{policy}{willingness}.", self.decision.options)
    }

    /// Why the published policy looks where it does, from the current user's negotiations.
    fn published_reason(&self) -> String {
        let winner = |nth: usize| {
            let held = self.decision.negotiations.get(nth)?;
            Some(match held.conclusion.outcome.winner()? {
                Side::Current => held.current,
                Side::Interrupting => held.interrupting,
            })
        };
        let [current, first, second] = [0, 1, 2].map(|user| self.name(user));
        match (winner(0), winner(1)) {
            (None, _) => format!("{current} and {first} do not agree, so {current} and {second} decide it"),
            (_, None) => format!("{current} and {second} do not agree, so {current} and {first} decide it"),
            (Some(0), Some(0)) => format!("{current} beats both"),
            (Some(0), Some(winner)) | (Some(winner), Some(0)) => {
                let winner = self.name(winner);
                let other = if winner == first { second } else { first };
                format!("{winner} alone beats {current}, and must beat {other} too")
            }
            (Some(_), Some(_)) => {
                format!("both interrupters beat {current}, so {first} and {second} decide it")
            }
        }
    }

    fn closing(&self) -> String {
        let served = self.name(self.decision.served);
        let verb = if self.decision.served == 0 { "keeps" } else { "gets" };
        if self.decision.agreement.is_some() {
            return match (self.users.len(), self.decision.policy) {
                (2, _) => format!("Decision: {served} {verb} precedence."),
                (_, Policy::Published) => {
                    format!("Decision: {}. {served} {verb} precedence.", self.published_reason())
                }
                (_, Policy::Condorcet) => {
                    format!("Decision: {served}, who beats everyone else, {verb} precedence.")
                }
            };
        }
        let among = match self.decision.candidates.as_slice() {
            candidates if candidates.len() == self.users.len() => String::new(),
            candidates => {
                let names: Vec<&str> = candidates.iter().map(|&user| self.name(user)).collect();
                let names = names.join(", ");
                match candidates {
                    [_] => format!(", among those whom nobody beats ({names})"),
                    _ => format!(", among {names}, whom nobody outside this group beats"),
                }
            }
        };
        let fallback = match self.decision.options.fallback {
            Fallback::FirstCome => "first come, first served",
            Fallback::Utilitarian => "whoever's service is worth most to all of them together",
        };
        let worth = match self.decision.options.fallback {
            Fallback::FirstCome => String::new(),
            Fallback::Utilitarian => {
                let worth: Vec<String> = self
                    .decision
                    .candidates
                    .iter()
                    .map(|&user| {
                        let worth = self.decision.welfare.get(user).copied().unwrap_or_default();
                        format!("{} {worth}", self.name(user))
                    })
                    .collect();
                format!(" ({})", worth.join(", "))
            }
        };
        let why = match (self.users.len(), self.decision.policy) {
            (2, _) => "there is no agreement".to_owned(),
            (_, Policy::Published) => format!("{}: no agreement", self.published_reason()),
            (_, Policy::Condorcet) => "nobody beats everyone else".to_owned(),
        };
        format!(
            "Decision: {why}. So the fallback decides: {fallback}{worth}{among}. {served} {verb} precedence."
        )
    }
}

impl HeldNegotiation {
    fn rounds_hold_no_offer(&self) -> bool {
        self.rounds.iter().all(|round| round.event == Event::Quit)
    }
}
