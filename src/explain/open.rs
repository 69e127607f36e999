//! What the open part of a trace says of a decision: nothing here is anybody's data.

use selfneg_core::{Fallback, QuitRule, TieRule};
use serde::Serialize;

use crate::case::{Case, RecordedDecision, RecordedEmergency, RecordedEvent, RecordedNegotiation};
use crate::mission::{Evidence, UserId};
use crate::precedence::Policy;
use crate::trace::schema::evidence::{self, record::Record};
use crate::trace::{Entry, Open, Recording, Step};

/// A decision by pseudonyms.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OpenDecision {
    /// Its number among all decisions of the trace, from 1.
    pub decision: u64,
    /// When, in simulated seconds since the run's begin.
    pub at_s: f64,
    /// Whom the robot serves by it; none by an emergency.
    pub served: Option<u32>,
    /// Who has to wait because of it.
    pub waiting: Vec<u32>,
    /// What it rests on.
    #[serde(flatten)]
    pub basis: Basis,
}

/// What a decision rests on.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Basis {
    /// Users, or the robot for them, negotiated.
    Negotiated(Negotiated),
    /// An emergency was certain.
    Emergency(Emergency),
}

/// A decision among users.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Negotiated {
    /// Everybody who took part, by arrival.
    pub participants: Vec<u32>,
    /// Whether the robot was serving the first of them.
    pub was_serving: bool,
    /// Whether it is an agreement; otherwise the fallback decided.
    pub agreement: bool,
    /// `published` or `condorcet`, if the record says so.
    pub policy: Option<&'static str>,
    /// The protocol variant, if the record says so.
    pub variant: Option<String>,
    /// The rounds of all negotiations.
    pub rounds: u32,
    /// The negotiations, in the order in which they ended.
    pub negotiations: Vec<Bilateral>,
    /// What can be known, from this alone, of the other order of arrival.
    pub other_order: OtherOrder,
    /// How it was settled without agreement.
    #[serde(skip)]
    pub fallback: Option<Fallback>,
    /// What happens when each would accept the other's offer.
    #[serde(skip)]
    pub tie: Option<TieRule>,
}

/// One negotiation between two.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Bilateral {
    /// The current side.
    pub current: u32,
    /// The interrupting side.
    pub interrupting: u32,
    /// Who won, if anybody.
    pub winner: Option<u32>,
    /// How many rounds it took.
    pub rounds: u32,
    /// `accepted`, `held-offer-stands`, `tie`, `both-quit` or `literal-quit`; empty if the
    /// trace ends before.
    pub ending: String,
}

impl Bilateral {
    /// Who lost, if anybody won.
    pub(super) fn loser(&self) -> Option<u32> {
        self.winner.map(|winner| if winner == self.current { self.interrupting } else { self.current })
    }
}

/// A decision by an emergency.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Emergency {
    /// Its category, by its number in the robot's specification.
    pub category: u32,
    /// `sensed`, `verified`, `claimed`, or `unknown` if the record does not say.
    pub evidence: &'static str,
    /// Whether this evidence is what the category asks for.
    pub certain: bool,
}

/// Whether it would have been the same if the two had come in each other's place: what
/// follows, for every pair of users, from the verdicts alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OtherOrder {
    /// The same user would have been served.
    Same,
    /// The other one would have been served.
    Other,
    /// That depends on data that are nobody else's to know.
    NotKnown,
}

impl OpenDecision {
    /// What the open records say of a case.
    pub(super) fn of(recording: &Recording, case: &Case) -> Self {
        match case {
            Case::Negotiated(case) => negotiated(recording, &case.recorded),
            Case::Emergency(emergency) => by_emergency(recording, emergency),
        }
    }
}

fn negotiated(recording: &Recording, recorded: &RecordedDecision) -> OpenDecision {
    let participants: Vec<u32> = recorded.participants.iter().map(|user| user.0).collect();
    let served = recorded.served.0;
    let negotiations: Vec<Bilateral> = recorded.negotiations.iter().map(bilateral).collect();
    OpenDecision {
        decision: recorded.decision,
        at_s: recorded.at.as_secs_f64(),
        served: Some(served),
        waiting: participants.iter().copied().filter(|&user| user != served).collect(),
        basis: Basis::Negotiated(Negotiated {
            was_serving: being_served(recording, recorded.index) == recorded.participants.first().copied(),
            agreement: recorded.agreement.is_some(),
            policy: recorded.policy.map(Policy::name),
            variant: recorded.options.map(|options| options.to_string()),
            rounds: recorded.rounds,
            other_order: other_order(recorded),
            fallback: recorded.options.map(|options| options.fallback),
            tie: recorded.options.map(|options| options.tie),
            participants,
            negotiations,
        }),
    }
}

fn bilateral(negotiation: &RecordedNegotiation) -> Bilateral {
    let end = negotiation.end.as_ref();
    Bilateral {
        current: negotiation.current.0,
        interrupting: negotiation.interrupting.0,
        winner: end.and_then(|end| end.winner).map(|winner| winner.0),
        rounds: end.map_or(0, |end| end.rounds),
        ending: end.map_or_else(String::new, |end| end.ending.clone()),
    }
}

fn by_emergency(recording: &Recording, emergency: &RecordedEmergency) -> OpenDecision {
    OpenDecision {
        decision: emergency.decision,
        at_s: emergency.at.as_secs_f64(),
        served: None,
        waiting: deferred_by(recording, emergency),
        basis: Basis::Emergency(Emergency {
            category: emergency.category,
            evidence: match emergency.evidence {
                Some(Evidence::Sensed) => "sensed",
                Some(Evidence::Verified) => "verified",
                Some(Evidence::Claimed) => "claimed",
                None => "unknown",
            },
            certain: emergency.certain,
        }),
    }
}

/// The record of an entry, if it is one.
fn record(entry: &Entry) -> Option<&Record> {
    match &entry.step {
        Step::Reply { open: Open::Record(open), .. } => open.record.as_ref(),
        _ => None,
    }
}

/// Whom the robot is serving before this place.
fn being_served(recording: &Recording, index: u64) -> Option<UserId> {
    let before = recording.entries.get(..usize::try_from(index).ok()?)?;
    let latest = before.iter().rev().filter_map(record).find_map(|record| match record {
        Record::GoalStarted(started) => Some(started.served.and_then(|served| served.served)),
        Record::GoalEnded(_) => Some(None),
        _ => None,
    });
    match latest.flatten() {
        Some(evidence::served::Served::User(user)) => Some(UserId(user)),
        _ => None,
    }
}

/// Who is made to wait by this emergency, until the robot has done what it asks for.
fn deferred_by(recording: &Recording, emergency: &RecordedEmergency) -> Vec<u32> {
    let mut waiting = Vec::new();
    let after = usize::try_from(emergency.index).ok().and_then(|index| recording.entries.get(index..));
    for record in after.unwrap_or_default().iter().filter_map(record) {
        match record {
            Record::Deferred(deferred) if deferred.why() == evidence::Waiting::Emergency => {
                waiting.push(deferred.user);
            }
            Record::GoalEnded(ended) => {
                let ended = ended.served.and_then(|served| served.served);
                if ended == Some(evidence::served::Served::Emergency(emergency.category)) {
                    break;
                }
            }
            _ => {}
        }
    }
    waiting.sort_unstable();
    waiting.dedup();
    waiting
}

/// What follows from the recorded verdicts by the protocol's properties, `role-symmetry` and
/// `closed-form`: a user wins by the depth at which the other accepts, and only where each
/// would accept at the same depth does it matter who came first.
fn other_order(recorded: &RecordedDecision) -> OtherOrder {
    let ([negotiation], Some(options)) = (recorded.negotiations.as_slice(), recorded.options) else {
        return OtherOrder::NotKnown;
    };
    let two = recorded.participants.as_slice() == [negotiation.current, negotiation.interrupting];
    if !two || options.quit != QuitRule::Exhausted || negotiation.willingness != 0 {
        return OtherOrder::NotKnown;
    }
    match (recorded.agreement, options.tie, options.fallback) {
        (None, _, Fallback::FirstCome) => OtherOrder::Other,
        (None, _, Fallback::Utilitarian) => OtherOrder::NotKnown,
        (Some(_), TieRule::Fallback | TieRule::Surplus, _) => OtherOrder::Same,
        (Some(winner), TieRule::FirstSender, _) => {
            let current_quit = negotiation
                .rounds
                .iter()
                .any(|round| round.sender == negotiation.current && round.event == RecordedEvent::Quit);
            // Whoever has run out of offers before has none that would be accepted at that depth.
            if winner == negotiation.current || current_quit {
                OtherOrder::Same
            } else {
                OtherOrder::NotKnown
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};
    use std::time::Duration;

    use selfneg_core::{Options, Rank, Side};

    use super::*;
    use crate::binding::{BoundRules, BoundUser, GoalChoice};
    use crate::case::{RecordedEnd, RecordedRound};
    use crate::input::{Rules, Truth, User, UserFiles};
    use crate::precedence::{Decision, decide};
    use crate::transcript::Event;

    const NAMES: [&str; 3] = ["a", "b", "c"];

    fn rules() -> BoundRules {
        let all = NAMES.map(str::to_owned);
        BoundRules::new(Rules {
            activation: all.iter().map(|name| (name.clone(), vec![name.clone()])).collect(),
            implications: vec![("goal".to_owned(), all.to_vec())],
            activation_file: PathBuf::from("activation"),
            implications_file: PathBuf::from("implications"),
        })
        .unwrap()
    }

    /// Every user: the true conditions in every order, each disposition ranked 0 or 1.
    fn everybody(rules: &mut BoundRules) -> Vec<BoundUser> {
        let mut orders: Vec<Vec<&str>> = vec![Vec::new()];
        let mut at = 0;
        while let Some(order) = orders.get(at).cloned() {
            for name in NAMES.iter().filter(|name| !order.contains(name)) {
                orders.push([order.as_slice(), &[name]].concat());
            }
            at += 1;
        }
        let mut users = Vec::new();
        for order in &orders {
            for ranks in 0..8_u8 {
                let profile = NAMES.iter().enumerate();
                let user = User {
                    name: String::new(),
                    profile: profile.map(|(d, name)| ((*name).to_owned(), Rank(ranks >> d & 1))).collect(),
                    status: order.iter().map(|name| ((*name).to_owned(), Truth::True)).collect(),
                    goal: Some("goal".to_owned()),
                    location: "here".to_owned(),
                    files: UserFiles::of_folder(Path::new("user")),
                };
                users.push(rules.bind(&user, &GoalChoice::OwnFile).unwrap());
            }
        }
        users
    }

    /// The open record of a decision between users 1 and 2.
    fn recorded(decision: &Decision) -> RecordedDecision {
        let user = |place: usize| UserId(u32::try_from(place).unwrap() + 1);
        let held = &decision.negotiations[0];
        let round = |round: &crate::transcript::Round| RecordedRound {
            index: 0,
            at: Duration::ZERO,
            number: round.number,
            sender: if round.sender == Side::Current { UserId(1) } else { UserId(2) },
            receiver: if round.sender == Side::Current { UserId(2) } else { UserId(1) },
            event: match round.event {
                Event::Quit => RecordedEvent::Quit,
                Event::Offer { depth, ruling, .. } => RecordedEvent::Offer {
                    depth: depth.try_into().unwrap(),
                    verdict: Some(ruling),
                    discloses: None,
                    worth: None,
                },
            },
        };
        RecordedDecision {
            decision: 1,
            index: 0,
            at: Duration::ZERO,
            policy: Some(decision.policy),
            options: Some(decision.options),
            participants: vec![UserId(1), UserId(2)],
            agreement: decision.agreement.map(user),
            served: user(decision.served),
            rounds: held.conclusion.rounds,
            negotiations: vec![RecordedNegotiation {
                index: 0,
                at: Duration::ZERO,
                current: UserId(1),
                interrupting: UserId(2),
                willingness: held.options.willingness.into(),
                rounds: held.rounds.iter().map(round).collect(),
                end: Some(RecordedEnd {
                    index: 0,
                    sides: (UserId(1), UserId(2)),
                    winner: decision.agreement.map(user),
                    rounds: held.conclusion.rounds,
                    ending: held.conclusion.ending.name().to_owned(),
                }),
            }],
        }
    }

    #[test]
    fn what_is_said_of_the_other_order_is_so_for_all_pairs() {
        let mut rules = rules();
        let users = everybody(&mut rules);
        let mut said = [0_u32; 3];
        for tie in TieRule::ALL {
            let options = Options { tie: *tie, ..Options::default() };
            for first in &users {
                for second in &users {
                    let decided = |two: [&BoundUser; 2]| {
                        decide(&rules, &two.map(Clone::clone), options, Policy::Published).unwrap()
                    };
                    let decision = decided([first, second]);
                    let answer = other_order(&recorded(&decision));
                    let same_person = decided([second, first]).served != decision.served;
                    match answer {
                        OtherOrder::Same => assert!(same_person, "{decision:#?}"),
                        OtherOrder::Other => assert!(!same_person, "{decision:#?}"),
                        OtherOrder::NotKnown => {}
                    }
                    said[answer as usize] += 1;
                }
            }
        }
        assert_eq!(said.iter().sum::<u32>(), 3 * 128 * 128);
        assert!(said.iter().all(|&count| count > 1_000), "{said:?}");
    }
}
