//! The negotiations and decisions of a trace, put together from its records.

use std::collections::BTreeMap;

use super::recorded::{
    RecordedDecision, RecordedEmergency, RecordedEnd, RecordedEvent, RecordedNegotiation, RecordedRound,
    Worth, evidence_of, is_certain, options_in, ruling,
};
use crate::mission::{Disclosed, UserId};
use crate::trace::schema::evidence::{self, record::Record};
use crate::trace::schema::personal::{self, disclosed, reply};
use crate::trace::{Entry, Open, Recording, Step};

/// Every negotiation of a trace, and what they led to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Docket {
    /// The decisions among users, each with the negotiations that it rests on.
    pub decisions: Vec<RecordedDecision>,
    /// The emergencies that were found certain.
    pub emergencies: Vec<RecordedEmergency>,
    /// Negotiations that no decision rests on: broken off, or with somebody who left before
    /// the decision, or still under way when the trace ends.
    pub without_decision: Vec<RecordedNegotiation>,
    /// The places of rounds and ends that belong to no negotiation.
    pub stray: Vec<u64>,
}

impl Docket {
    /// Reads off a trace what is recorded of its negotiations.
    #[must_use]
    pub fn of(recording: &Recording) -> Self {
        let mut clerk = Clerk {
            recording,
            docket: Self::default(),
            under_way: None,
            settled: Vec::new(),
            of_user: BTreeMap::new(),
            told: 0,
        };
        for entry in &recording.entries {
            if let Step::Reply { open: Open::Record(open), personal, .. } = &entry.step
                && let Some(record) = &open.record
            {
                clerk.note(entry, record, personal);
            }
        }
        clerk.close()
    }
}

struct Clerk<'r> {
    recording: &'r Recording,
    docket: Docket,
    under_way: Option<RecordedNegotiation>,
    /// Those that ended since the last decision; nothing in place of those whose users have not
    /// all stayed.
    settled: Vec<Option<RecordedNegotiation>>,
    /// Where in `settled` each user's are: a forged trace may have any number of both.
    of_user: BTreeMap<UserId, Vec<usize>>,
    /// Decisions so far.
    told: u64,
}

impl Clerk<'_> {
    fn note(&mut self, entry: &Entry, record: &Record, personal: &[personal::Reply]) {
        match record {
            Record::NegotiationStarted(started) => {
                self.docket.without_decision.extend(self.under_way.take());
                self.under_way = Some(RecordedNegotiation {
                    index: entry.index,
                    at: entry.at,
                    current: UserId(started.current),
                    interrupting: UserId(started.interrupting),
                    willingness: started.willingness,
                    rounds: Vec::new(),
                    end: None,
                });
            }
            Record::Round(round) => match &mut self.under_way {
                Some(negotiation) => negotiation.rounds.push(recorded_round(entry, round, personal)),
                None => self.docket.stray.push(entry.index),
            },
            Record::NegotiationEnded(ended) => match self.under_way.take() {
                Some(mut negotiation) => {
                    negotiation.end = Some(RecordedEnd {
                        index: entry.index,
                        sides: (UserId(ended.current), UserId(ended.interrupting)),
                        winner: ended.winner.map(UserId),
                        rounds: ended.rounds,
                        ending: ended.ending.clone(),
                    });
                    for user in [negotiation.current, negotiation.interrupting] {
                        self.of_user.entry(user).or_default().push(self.settled.len());
                    }
                    self.settled.push(Some(negotiation));
                }
                None => self.docket.stray.push(entry.index),
            },
            Record::Closed(evidence::Closed { user, .. })
            | Record::Deferred(evidence::Deferred { user, .. }) => {
                self.leave(UserId(*user));
            }
            Record::NegotiationsDropped(_) => self.drop_all(),
            Record::Decided(decided) => self.decide(entry, decided),
            Record::EmergencyDecided(known) => self.find_certain(entry, *known),
            _ => {}
        }
    }

    /// What was settled with somebody who leaves counts no more.
    fn leave(&mut self, user: UserId) {
        let with = |negotiation: &RecordedNegotiation| {
            negotiation.current == user || negotiation.interrupting == user
        };
        for place in self.of_user.remove(&user).unwrap_or_default() {
            self.docket.without_decision.extend(self.settled.get_mut(place).and_then(Option::take));
        }
        self.docket.without_decision.extend(self.under_way.take_if(|one| with(one)));
    }

    fn drop_all(&mut self) {
        let settled = self.take_settled();
        self.docket.without_decision.extend(settled);
        self.docket.without_decision.extend(self.under_way.take());
    }

    fn take_settled(&mut self) -> Vec<RecordedNegotiation> {
        self.of_user.clear();
        std::mem::take(&mut self.settled).into_iter().flatten().collect()
    }

    fn decide(&mut self, entry: &Entry, decided: &evidence::Decided) {
        let negotiations = self.take_settled();
        self.docket.without_decision.extend(self.under_way.take());
        let decision = self.next();
        self.docket.decisions.push(RecordedDecision {
            decision,
            index: entry.index,
            at: entry.at,
            policy: decided.policy.parse().ok(),
            options: decided.options.as_ref().and_then(options_in),
            participants: decided.participants.iter().copied().map(UserId).collect(),
            agreement: decided.agreement.map(UserId),
            served: UserId(decided.served),
            rounds: decided.rounds,
            negotiations,
        });
    }

    fn find_certain(&mut self, entry: &Entry, known: evidence::EmergencyKnown) {
        let specification = self.recording.header.specification.as_ref();
        let place = usize::try_from(known.category).ok();
        let category =
            specification.zip(place).and_then(|(specification, place)| specification.emergencies.get(place));
        let evidence = evidence_of(known.evidence());
        let decision = self.next();
        self.docket.emergencies.push(RecordedEmergency {
            decision,
            index: entry.index,
            at: entry.at,
            category: known.category,
            evidence,
            certain: category.is_some_and(|category| is_certain(category, evidence)),
            gravity: category.map_or(0, |category| category.gravity),
        });
    }

    fn next(&mut self) -> u64 {
        self.told = self.told.saturating_add(1);
        self.told
    }

    fn close(mut self) -> Docket {
        self.drop_all();
        self.docket.without_decision.sort_by_key(|negotiation| negotiation.index);
        self.docket
    }
}

fn recorded_round(entry: &Entry, round: &evidence::Round, personal: &[personal::Reply]) -> RecordedRound {
    use evidence::round::Round as Open;
    let event = match &round.round {
        Some(Open::Offer(offer)) => RecordedEvent::Offer {
            depth: offer.depth,
            verdict: ruling(offer.verdict()),
            discloses: personal.iter().find_map(disclosed_in),
            worth: personal.iter().find_map(worth_in),
        },
        Some(Open::Quit(_)) => RecordedEvent::Quit,
        None => RecordedEvent::Unknown,
    };
    RecordedRound {
        index: entry.index,
        at: entry.at,
        number: round.number,
        sender: UserId(round.sender),
        receiver: UserId(round.receiver),
        event,
    }
}

fn disclosed_in(personal: &personal::Reply) -> Option<Disclosed> {
    let Some(reply::Reply::Disclosed(recorded)) = &personal.reply else { return None };
    match recorded.disclosed.as_ref()? {
        disclosed::Disclosed::Listed(place) => u16::try_from(*place).ok().map(Disclosed::Listed),
        disclosed::Disclosed::Unlisted(place) => u16::try_from(*place).ok().map(Disclosed::Unlisted),
        disclosed::Disclosed::Willingness(_) => Some(Disclosed::Willingness),
    }
}

fn worth_in(personal: &personal::Reply) -> Option<Worth> {
    match &personal.reply {
        Some(reply::Reply::Worth(worth)) => Some(Worth { value: worth.value, threshold: worth.threshold }),
        _ => None,
    }
}
