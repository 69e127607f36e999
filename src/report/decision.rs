//! The recorded decisions, with their negotiations round by round.

use std::time::Duration;

use selfneg_core::Condition;

use super::who::Who;
use crate::binding::END_OF_GOAL;
use crate::explain::{Explained, Section};
use crate::trace::schema::evidence::{self, record, round};
use crate::trace::schema::personal::{self, disclosed, reply};
use crate::trace::{Entry, Open, Recording, Step};

/// A decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// From 1, in the trace.
    pub number: u64,
    /// Since the run's begin.
    pub at: Duration,
    /// What was decided, in a few words: "Alice keeps precedence".
    pub headline: String,
    /// What people ask about it.
    pub question: String,
    /// The answer, the most important sentence first.
    pub answer: Vec<String>,
    /// The smallest change that would have changed it, in a sentence, if one was found.
    pub smallest_change: Option<String>,
    /// What else is said of it, but for what `why` holds.
    pub sections: Vec<Section>,
    /// What decided it.
    pub why: Why,
}

/// What decided.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Why {
    /// Negotiations, or the fallback after them.
    Negotiated(Negotiated),
    /// An emergency.
    Emergency(Emergency),
}

/// A decision among users.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Negotiated {
    /// By arrival, the current user first.
    pub parties: Vec<Party>,
    /// The policy among several interrupters.
    pub policy: String,
    /// The protocol variant, as `quit/aggregation/tie/fallback/willingness`.
    pub variant: String,
    /// In the order in which they were held.
    pub negotiations: Vec<Negotiation>,
    /// What serving whom is worth, if the data are there and the decision is right.
    pub welfare: Option<Welfare>,
}

/// What serving whom is worth to all who took part, in ranks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Welfare {
    /// Pseudonym, name and welfare, by arrival.
    pub of_serving: Vec<(u32, String, u64)>,
    /// What the decision lost against the best.
    pub regret: u64,
}

/// Somebody who takes part in a decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Party {
    /// The pseudonym's number.
    pub user: u32,
    /// Name or pseudonym.
    pub name: String,
    /// What is asked for, if the trace says.
    pub goal: Option<String>,
    /// The robot serves this user.
    pub served: bool,
}

/// An emergency that was found certain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Emergency {
    /// Its category's name or number.
    pub category: String,
    /// What it rests on, in a sentence.
    pub evidence: String,
    /// Negotiations that it broke off.
    pub broken_off: Vec<Negotiation>,
}

/// A negotiation between two users.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Negotiation {
    /// Name or pseudonym of who played the current side.
    pub current: String,
    /// Of who played the interrupting side, the first sender.
    pub interrupting: String,
    /// How it ended; `None`: it was broken off.
    pub ending: Option<Ending>,
    /// In order.
    pub rounds: Vec<Round>,
}

/// How a negotiation ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ending {
    /// Whose offer was agreed upon; `None`: no agreement.
    pub winner: Option<String>,
    /// The rounds as the trace counts them.
    pub rounds: u32,
    /// Why it ended, in a sentence.
    pub sentence: String,
}

/// A round.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Round {
    /// From 1.
    pub number: u32,
    /// Since the run's begin.
    pub at: Duration,
    /// Name or pseudonym of the user for whom the robot spoke.
    pub sender: String,
    /// Of the other.
    pub receiver: String,
    /// What happened.
    pub act: Act,
    /// This round settled it: it is the last one of a negotiation with an agreement.
    pub decisive: bool,
}

/// What happened in a round.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Act {
    /// One more condition was disclosed.
    Offer {
        /// How many the sender has disclosed now.
        depth: u64,
        /// The new one, if the trace tells it.
        discloses: Option<String>,
        /// What the offer is worth to the receiver, and the receiver's own complete offer in
        /// its own eyes, if the trace tells them.
        worth: Option<(u64, u64)>,
        /// The answer.
        verdict: evidence::Verdict,
    },
    /// The sender had no further offer.
    Quit,
}

/// All decisions of a recording, with the explanations of those that were explained.
pub(super) fn decisions(recording: &Recording, who: &Who, explained: &[Explained]) -> Vec<Decision> {
    let mut clerk = Clerk {
        who,
        conditions: condition_names(recording),
        goals: Vec::new(),
        held: Vec::new(),
        decided: Vec::new(),
    };
    for entry in &recording.entries {
        clerk.enter(entry);
    }
    let mut decided = clerk.decided;
    for explained in explained {
        let number = match explained {
            Explained::Public(public) => public.open.decision,
            Explained::User(own) => own.decision,
            Explained::Auditor(auditor) => auditor.open.decision,
        };
        if let Some(decision) = decided.iter_mut().find(|decision| decision.number == number) {
            decision.explain(explained, who);
        }
    }
    decided
}

impl Decision {
    fn explain(&mut self, explained: &Explained, who: &Who) {
        let told = explained.told();
        self.question = told.question.clone();
        self.answer = told.answer.clone();
        // What the page draws itself is left out.
        let drawn = |section: &&Section| {
            !["Who took part", "The negotiations", "What serving whom is worth"]
                .contains(&section.title.as_str())
                && !section.title.to_lowercase().ends_with("round by round")
        };
        self.sections = told.sections.iter().filter(drawn).cloned().collect();
        let (Explained::Auditor(auditor), Why::Negotiated(negotiated)) = (explained, &mut self.why) else {
            return;
        };
        if auditor.counterfactual.as_ref().is_some_and(|found| found.smallest.is_some()) {
            let section = self.sections.iter().find(|section| section.title == "What would have changed it");
            self.smallest_change = section.and_then(|section| section.sentences.first().cloned());
        }
        for (negotiation, transcript) in negotiated.negotiations.iter_mut().zip(&auditor.transcripts) {
            for (round, told) in negotiation.rounds.iter_mut().zip(&transcript.rounds) {
                if let (Act::Offer { discloses, .. }, Some(name)) = (&mut round.act, &told.discloses)
                    && name != END_OF_GOAL
                {
                    *discloses = Some(format!("“{name}”"));
                }
            }
        }
        negotiated.welfare = auditor.welfare.as_ref().map(|welfare| Welfare {
            of_serving: welfare
                .of_serving
                .iter()
                .map(|(user, worth)| (*user, who.user(*user), *worth))
                .collect(),
            regret: welfare.regret,
        });
    }
}

/// The names of the rules' conditions, by their place; none if the rules are not there.
fn condition_names(recording: &Recording) -> Vec<String> {
    let Ok(rules) = recording.mission_rules() else { return Vec::new() };
    let bound = rules.bound();
    let all = (0..bound.conditions()).map_while(|nth| u16::try_from(nth).ok());
    all.map(|nth| bound.condition_name(Condition(nth)).to_owned()).collect()
}

struct Clerk<'r> {
    who: &'r Who,
    conditions: Vec<String>,
    /// Who asks for which goal.
    goals: Vec<(u32, u32)>,
    /// Since the last decision.
    held: Vec<Negotiation>,
    decided: Vec<Decision>,
}

impl Clerk<'_> {
    fn enter(&mut self, entry: &Entry) {
        match &entry.step {
            Step::Event { open, .. } => {
                if let Some(evidence::event::Event::Request(request)) = &open.event {
                    self.goals.retain(|(user, _)| *user != request.user);
                    self.goals.push((request.user, request.goal));
                }
            }
            Step::Reply { open: Open::Record(record), personal, .. } => {
                if let Some(record) = &record.record {
                    self.record(entry.at, record, personal);
                }
            }
            Step::Reply { .. } => {}
        }
    }

    fn record(&mut self, at: Duration, record: &record::Record, personal: &[personal::Reply]) {
        use record::Record;
        match record {
            Record::NegotiationStarted(started) => self.held.push(Negotiation {
                current: self.who.user(started.current),
                interrupting: self.who.user(started.interrupting),
                ending: None,
                rounds: Vec::new(),
            }),
            Record::Round(round) => {
                let round = self.round(at, round, personal);
                if let Some(negotiation) = self.held.last_mut() {
                    negotiation.rounds.push(round);
                }
            }
            Record::NegotiationEnded(ended) => self.ended(ended),
            Record::NegotiationsDropped(_) => {
                let dropped = std::mem::take(&mut self.held);
                if let Some(Decision { why: Why::Emergency(emergency), .. }) = self.decided.last_mut() {
                    emergency.broken_off.extend(dropped);
                }
            }
            Record::Decided(decided) => {
                let negotiations = std::mem::take(&mut self.held);
                self.decide(
                    at,
                    self.headline(decided),
                    Why::Negotiated(self.negotiated(decided, negotiations)),
                );
            }
            Record::EmergencyDecided(known) => {
                let category = self.who.emergency(known.category);
                let emergency =
                    Emergency { evidence: rests_on(known.evidence()), category, broken_off: Vec::new() };
                let headline = format!("the emergency goes first ({})", emergency.category);
                self.decide(at, headline, Why::Emergency(emergency));
            }
            _ => {}
        }
    }

    fn decide(&mut self, at: Duration, headline: String, why: Why) {
        let number = u64::try_from(self.decided.len()).map_or(u64::MAX, |before| before.saturating_add(1));
        let (question, answer, smallest_change, sections) = Default::default();
        self.decided.push(Decision {
            number,
            at,
            headline,
            question,
            answer,
            smallest_change,
            sections,
            why,
        });
    }

    fn round(&self, at: Duration, round: &evidence::Round, personal: &[personal::Reply]) -> Round {
        let act = match &round.round {
            Some(round::Round::Offer(offer)) => {
                let disclosed = personal.iter().find_map(|reply| match reply.reply.as_ref()? {
                    reply::Reply::Disclosed(what) => Some(self.disclosed(what)),
                    _ => None,
                });
                let worth = personal.iter().find_map(|reply| match reply.reply.as_ref()? {
                    reply::Reply::Worth(worth) => Some((worth.value, worth.threshold)),
                    _ => None,
                });
                Act::Offer { depth: offer.depth, discloses: disclosed, worth, verdict: offer.verdict() }
            }
            Some(round::Round::Quit(_)) | None => Act::Quit,
        };
        Round {
            number: round.number,
            at,
            sender: self.who.user(round.sender),
            receiver: self.who.user(round.receiver),
            act,
            decisive: false,
        }
    }

    fn disclosed(&self, what: &personal::Disclosed) -> String {
        match what.disclosed {
            Some(disclosed::Disclosed::Listed(nth)) => {
                let name = usize::try_from(nth).ok().and_then(|nth| self.conditions.get(nth));
                name.map_or_else(|| format!("condition {nth} of the rules"), |name| format!("“{name}”"))
            }
            Some(disclosed::Disclosed::Unlisted(_)) => "a condition that no rule lists".to_owned(),
            Some(disclosed::Disclosed::Willingness(_)) => "being close to the end of the goal".to_owned(),
            None => "something that this program does not know".to_owned(),
        }
    }

    fn ended(&mut self, ended: &evidence::NegotiationEnded) {
        let winner = ended.winner.map(|winner| self.who.user(winner));
        let loser = ended.winner.map(|winner| {
            let loser = if winner == ended.current { ended.interrupting } else { ended.current };
            self.who.user_first(loser)
        });
        let sentence = match (ended.ending.as_str(), &winner, loser) {
            ("accepted", Some(winner), Some(loser)) => format!("{loser} accepted the offer of {winner}."),
            ("held-offer-stands", Some(winner), Some(loser)) => format!(
                "{loser} would have accepted and made an offer of the same depth first; {winner} rejected \
                 that, so the held offer stands."
            ),
            ("tie", Some(_), Some(_)) => {
                "Each would accept the other's offer; the one whose receiver gains more wins.".to_owned()
            }
            ("tie", ..) => "Each would accept the other's offer, which is no agreement.".to_owned(),
            ("both-quit", ..) => "Both ran out of offers.".to_owned(),
            ("literal-quit", ..) => {
                "One rejected an offer and had none of its own left that discloses more (literal quit rule)."
                    .to_owned()
            }
            (other, ..) => format!("It ended: {other}."),
        };
        let Some(negotiation) = self.held.last_mut() else { return };
        if winner.is_some()
            && let Some(last) = negotiation.rounds.last_mut()
        {
            last.decisive = true;
        }
        negotiation.ending = Some(Ending { winner, rounds: ended.rounds, sentence });
    }

    fn headline(&self, decided: &evidence::Decided) -> String {
        let keeps = decided.participants.first() == Some(&decided.served);
        let verb = if keeps { "keeps" } else { "gets" };
        format!("{} {verb} precedence", self.who.user_first(decided.served))
    }

    fn negotiated(&self, decided: &evidence::Decided, negotiations: Vec<Negotiation>) -> Negotiated {
        let goal = |user: u32| {
            let (_, goal) = self.goals.iter().find(|(asking, _)| *asking == user)?;
            Some(self.who.goal(*goal))
        };
        let party = |user: &u32| Party {
            user: *user,
            name: self.who.user(*user),
            goal: goal(*user),
            served: *user == decided.served,
        };
        let options = decided.options.clone().unwrap_or_default();
        Negotiated {
            parties: decided.participants.iter().map(party).collect(),
            policy: decided.policy.clone(),
            variant: variant(&options),
            negotiations,
            welfare: None,
        }
    }
}

/// A protocol variant as the command line writes it.
#[must_use]
pub(super) fn variant(options: &evidence::Options) -> String {
    let evidence::Options { quit, aggregation, tie, fallback, willingness } = options;
    format!("{quit}/{aggregation}/{tie}/{fallback}/w{willingness}")
}

fn rests_on(evidence: evidence::Evidence) -> String {
    match evidence {
        evidence::Evidence::Claimed => "Somebody said so.",
        evidence::Evidence::Sensed => "The robot’s own sensors said so.",
        evidence::Evidence::Verified => "A document was checked.",
        evidence::Evidence::Unspecified => "The trace does not say what it rested on.",
    }
    .to_owned()
}
