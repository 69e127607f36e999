//! Question, answer and negotiations in words, from the open records; who is called what is up
//! to the caller.

use selfneg_core::{Fallback, TieRule};

use super::open::{Basis, Bilateral, Emergency, Negotiated, OpenDecision};
use super::told::{counted, listed};

/// Says why, with the names that a level allows.
pub(super) struct Speaker<'a> {
    /// What a pseudonym is called.
    pub(super) name: &'a dyn Fn(u32) -> String,
    /// What an emergency's category is called.
    pub(super) category: &'a dyn Fn(u32) -> String,
}

impl Speaker<'_> {
    fn names(&self, users: &[u32]) -> String {
        let names: Vec<String> = users.iter().map(|&user| (self.name)(user)).collect();
        listed(&names)
    }

    /// Why was Bob made to wait?
    pub(super) fn question(&self, decision: &OpenDecision) -> String {
        let when = format!("Decision {}, at {}: ", decision.decision, super::told::clock(decision.at_s));
        match decision.waiting.as_slice() {
            [] => format!("{when}why did an emergency go first?"),
            [one] => format!("{when}why was {} made to wait?", (self.name)(*one)),
            several => format!("{when}why were {} made to wait?", self.names(several)),
        }
    }

    /// Because.
    pub(super) fn answer(&self, decision: &OpenDecision) -> Vec<String> {
        match &decision.basis {
            Basis::Emergency(emergency) => self.by_emergency(emergency),
            Basis::Negotiated(negotiated) => self.by_negotiation(decision, negotiated),
        }
    }

    fn by_emergency(&self, emergency: &Emergency) -> Vec<String> {
        let what = (self.category)(emergency.category);
        let proof = match emergency.evidence {
            "sensed" => "the robot's own sensors showed it",
            "verified" => "a document that was checked showed it",
            "claimed" => "somebody said so",
            _ => "the record does not say what it rests on",
        };
        if emergency.certain {
            vec![
                format!("An emergency was certain ({what}): {proof}, which is what this category asks for."),
                "An emergency goes before everybody's requests; nobody's data are weighed for it.".to_owned(),
            ]
        } else {
            vec![
                format!("The robot took an emergency for certain ({what}): {proof}."),
                "That is not what this category asks for: the robot should not have acted on it.".to_owned(),
            ]
        }
    }

    fn by_negotiation(&self, decision: &OpenDecision, negotiated: &Negotiated) -> Vec<String> {
        let served = decision.served.map_or_else(|| "nobody".to_owned(), self.name);
        let first = negotiated.participants.first().copied();
        let mut answer = vec![match (negotiated.was_serving, first) {
            (true, first) if first == decision.served => {
                format!("The robot was serving {served} and stayed with {served}.")
            }
            (true, Some(first)) => {
                format!("The robot was serving {} and turned to {served}.", (self.name)(first))
            }
            _ => format!("The robot served {served} first."),
        }];
        answer.extend(match negotiated.negotiations.as_slice() {
            [one] => self.between_two(one, negotiated),
            _ => self.among_many(decision, negotiated),
        });
        if !negotiated.agreement {
            answer.push(match negotiated.fallback {
                Some(Fallback::FirstCome) => {
                    format!(
                        "Then the rule is first come, first served, and {served} was first{}.",
                        among(negotiated)
                    )
                }
                Some(Fallback::Utilitarian) => format!(
                    "Then the rule is to serve whoever's request is worth most to all of them together by \
                     their own ethical profiles, and that was {served}'s."
                ),
                None => "The record does not say by which rule it was then decided.".to_owned(),
            });
        }
        answer
    }

    fn between_two(&self, one: &Bilateral, negotiated: &Negotiated) -> Vec<String> {
        let (current, interrupting) = ((self.name)(one.current), (self.name)(one.interrupting));
        vec![
            format!(
                "It had negotiated with itself, speaking for {current} and for {interrupting} in turn, each \
                 time from that user's own ethical profile."
            ),
            self.ending(one, negotiated.tie),
        ]
    }

    /// How a negotiation ended.
    pub(super) fn ending(&self, one: &Bilateral, tie: Option<TieRule>) -> String {
        let rounds = counted(one.rounds, "round");
        let sides =
            one.winner.zip(one.loser()).map(|(winner, loser)| ((self.name)(winner), (self.name)(loser)));
        match (one.ending.as_str(), sides) {
            ("accepted", Some((winner, loser))) => {
                format!("After {rounds} {loser}'s side accepted what was offered for {winner}.")
            }
            ("held-offer-stands", Some((winner, loser))) => format!(
                "After {rounds} {loser}'s side would accept what was offered for {winner}; as much was then \
                 offered for {loser}, and {winner}'s side rejected it."
            ),
            ("tie", Some((winner, loser))) => format!(
                "After {rounds} each side would have accepted what was offered for the other; {loser}'s \
                 side gains more by that than {winner}'s would, so {winner} has precedence."
            ),
            ("tie", None) if tie == Some(TieRule::Surplus) => format!(
                "After {rounds} each side would have accepted what was offered for the other, and both would \
                 have gained the same: no agreement."
            ),
            ("tie", None) => format!(
                "After {rounds} each side would have accepted what was offered for the other, which by this \
                 robot's rules is no agreement."
            ),
            ("both-quit", None) => format!(
                "After {rounds} neither side had accepted any offer, and neither had more to disclose: no \
                 agreement."
            ),
            ("literal-quit", None) => format!(
                "After {rounds} one side had nothing to reply that discloses more, which by this robot's \
                 rules ends the negotiation without agreement."
            ),
            _ => "How the negotiation ended is not recorded.".to_owned(),
        }
    }

    fn among_many(&self, decision: &OpenDecision, negotiated: &Negotiated) -> Vec<String> {
        let served = decision.served.map_or_else(|| "nobody".to_owned(), self.name);
        let everybody = self.names(&negotiated.participants);
        let mut reasons = vec![format!(
            "It had negotiated with itself for {everybody}, two at a time, each time from their own ethical \
             profiles."
        )];
        reasons.push(match (negotiated.policy, negotiated.agreement) {
            (Some("condorcet"), true) => format!("{served} won against everybody else."),
            (Some("condorcet"), false) => "Nobody won against everybody else.".to_owned(),
            (Some("published"), true) => format!("{}: {served}.", self.published(negotiated)),
            (Some("published"), false) => {
                format!("{}; that gave no agreement.", self.published(negotiated))
            }
            _ => "By which policy these were put together is not recorded.".to_owned(),
        });
        reasons
    }

    /// Why the published policy looks where it does.
    fn published(&self, negotiated: &Negotiated) -> String {
        let [current, first, second] = negotiated.participants.as_slice() else {
            return "The policy for three users decided it".to_owned();
        };
        let winner = |a: u32, b: u32| {
            let held = negotiated.negotiations.iter().find(|one| (one.current, one.interrupting) == (a, b));
            held.and_then(|one| one.winner)
        };
        let name = |user: &u32| (self.name)(*user);
        match (winner(*current, *first), winner(*current, *second)) {
            (None, _) => format!(
                "{} and {} did not agree, so what counts is who won between {} and {}",
                name(current),
                name(first),
                name(current),
                name(second)
            ),
            (_, None) => format!(
                "{} and {} did not agree, so what counts is who won between {} and {}",
                name(current),
                name(second),
                name(current),
                name(first)
            ),
            (Some(a), Some(b)) if a == *current && b == *current => {
                "What counts is who won against both others".to_owned()
            }
            (Some(a), Some(b)) if a == *current || b == *current => {
                let winner = if a == *current { b } else { a };
                let other = if winner == *first { second } else { first };
                format!(
                    "Only {} won against {} and had to win against {} too",
                    name(&winner),
                    name(current),
                    name(other)
                )
            }
            (Some(_), Some(_)) => format!(
                "Both others won against {}, so what counts is who won between these two",
                name(current)
            ),
        }
    }

    /// Each negotiation in a sentence, if there are several.
    pub(super) fn negotiations(&self, negotiated: &Negotiated) -> Vec<String> {
        if negotiated.negotiations.len() < 2 {
            return Vec::new();
        }
        let told = |one: &Bilateral| {
            let (current, interrupting) = ((self.name)(one.current), (self.name)(one.interrupting));
            let winner = one
                .winner
                .map_or_else(|| "no agreement".to_owned(), |winner| format!("{} won", (self.name)(winner)));
            format!("Between {current} and {interrupting}: {winner}. {}", self.ending(one, negotiated.tie))
        };
        negotiated.negotiations.iter().map(told).collect()
    }
}

/// Under `condorcet` the fallback may choose among some of the users only.
fn among(negotiated: &Negotiated) -> &'static str {
    match negotiated.policy {
        Some("condorcet") if negotiated.participants.len() > 2 => {
            " among those whom nobody outside their group won against"
        }
        _ => "",
    }
}
