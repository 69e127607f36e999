//! What an auditor is told: everything that the trace holds of a decision, and what follows.

use selfneg_core::{Disclosure, Ruling};
use serde::{Serialize, Serializer};

use super::auditor_text;
use super::open::OpenDecision;
use super::own::own_worth;
use super::told::Told;
use crate::audit::Redecided;
use crate::binding::{BoundUser, END_OF_GOAL};
use crate::case::{Inputs, RecordedDecision, RecordedEvent};
use crate::counterfactual::{Counterfactual, Counterfactuals, Edit, Pairs, Question};
use crate::disclosure::{self, Least};
use crate::mission::{Disclosed, UserId};
use crate::precedence::Decision;

/// A decision for the auditor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditorDecision {
    /// What is open.
    #[serde(flatten)]
    pub open: OpenDecision,
    /// Whether it was made again.
    pub redecided: Redecided,
    /// The emergency's name, if one decided and has one.
    pub emergency: Option<String>,
    /// Everybody who took part, by arrival; empty of an emergency.
    pub users: Vec<Participant>,
    /// The rounds of each negotiation, as recorded.
    pub transcripts: Vec<Transcript>,
    /// Why what follows is not there: what could not be read, or that the decision is not the
    /// one that the rules give.
    pub missing: Option<String>,
    /// What would have changed it.
    pub counterfactual: Option<WhatIf>,
    /// How much was disclosed, against the least, in the order of the negotiations held.
    pub disclosure: Vec<DisclosedBySide>,
    /// What serving whom is worth.
    pub welfare: Option<Welfare>,
    /// In sentences.
    pub told: Told,
}

/// Somebody who took part, with what was theirs when it was decided.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Participant {
    /// The pseudonym.
    pub user: u32,
    /// The name.
    pub name: String,
    /// What the user asked for.
    pub goal: String,
    /// The true conditions in their order of disclosure.
    pub conditions: Vec<String>,
    /// The ranks in the active context: disposition, rank.
    #[serde(serialize_with = "as_object")]
    pub ranks: Vec<(String, u8)>,
    /// The own complete offer in the user's own eyes.
    pub own_worth: u64,
    /// What being close to the goal added to that.
    pub willingness: u8,
}

/// A negotiation round by round.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Transcript {
    /// The current side.
    pub current: u32,
    /// The interrupting side.
    pub interrupting: u32,
    /// The rounds.
    pub rounds: Vec<TranscriptRound>,
}

/// One round.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TranscriptRound {
    /// From 1.
    pub round: u32,
    /// Who sends.
    pub sender: u32,
    /// Who receives.
    pub receiver: u32,
    /// How many conditions the sender has disclosed now; none: it quit.
    pub depth: Option<u64>,
    /// The new one, or "end of goal" for willingness, if it can be read.
    pub discloses: Option<String>,
    /// The offer in the receiver's eyes, if it can be read.
    pub value: Option<u64>,
    /// The receiver's own complete offer in the receiver's eyes, if it can be read.
    pub threshold: Option<u64>,
    /// `accept`, `reject` or `hold`; none of a quit.
    pub verdict: Option<&'static str>,
}

/// What would have changed the decision.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct WhatIf {
    /// The smallest change, if one was found.
    pub smallest: Option<Changed>,
    /// Every single change that does it, the smallest first.
    pub single: Vec<Changed>,
    /// Of two changes at a time: `not-needed`, `found`, `none` or `none-of-the-first`.
    pub pairs: &'static str,
    /// The smallest pair, if no single change of data does it and a pair was found.
    pub pair: Option<Changed>,
    /// How many pairs were tried, if none does.
    pub pairs_tried: u64,
    /// Ranks from 0 to this were tried.
    pub scale: u8,
    /// How many changed cases were decided.
    pub decided: u64,
    /// For each user who had to wait: the smallest change of that user's own data by which
    /// it would have been served.
    pub by_own_data: Vec<OwnWay>,
}

/// How a user could have been served by other data of its own.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct OwnWay {
    /// Whose.
    pub user: u32,
    /// The smallest single change, if one does it.
    pub smallest: Option<Changed>,
}

/// A change and what comes of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Changed {
    /// The changes, one or two.
    pub changes: Vec<Change>,
    /// The sum of their sizes: a rank counts each step, everything else 1.
    pub size: u64,
    /// Who would then be served.
    pub served: u32,
    /// Whether by agreement.
    pub agreement: bool,
}

/// One change, by name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "change")]
pub enum Change {
    /// A true condition is not true, or withheld.
    Withheld {
        /// Whose.
        user: u32,
        /// Which.
        condition: String,
    },
    /// A condition is true.
    Added {
        /// Whose.
        user: u32,
        /// Which.
        condition: String,
        /// Before which of the user's own it is disclosed; none: last.
        before: Option<String>,
    },
    /// A rank is another one.
    Rank {
        /// Whose.
        user: u32,
        /// Of what.
        disposition: String,
        /// What it is.
        from: u8,
        /// What it would be.
        to: u8,
    },
    /// The current user and an interrupter come in each other's place.
    Order {
        /// The interrupter.
        user: u32,
    },
}

/// What one side of a negotiation disclosed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DisclosedBySide {
    /// Whose conditions.
    pub sender: u32,
    /// Whose side heard them.
    pub receiver: u32,
    /// How many were disclosed.
    pub disclosed: usize,
    /// Of how many.
    pub conditions: usize,
    /// Whether this side won.
    pub won: bool,
    /// How few would have been accepted; none: not even all.
    pub least: Option<usize>,
    /// Whether `least` is exact; otherwise fewer may do.
    pub exact: bool,
    /// Which would have done.
    pub sufficient: Vec<String>,
}

/// What serving whom is worth to all of them together, in ranks.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Welfare {
    /// W of serving each user, by arrival.
    #[serde(serialize_with = "as_object")]
    pub of_serving: Vec<(u32, u64)>,
    /// W of whom the robot serves.
    pub served: u64,
    /// The largest W.
    pub best: u64,
    /// How much less the served one's is.
    pub regret: u64,
}

/// Pairs as one JSON object.
fn as_object<K: Serialize, V: Serialize, S: Serializer>(
    pairs: &[(K, V)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().map(|(key, value)| (key, value)))
}

/// What an explanation for the auditor is made from.
pub(super) struct Source<'a> {
    pub(super) open: OpenDecision,
    pub(super) redecided: Redecided,
    pub(super) recorded: Option<&'a RecordedDecision>,
    pub(super) inputs: Option<&'a Inputs>,
    pub(super) again: Option<Decision>,
    /// Why there are no inputs.
    pub(super) unreadable: Option<String>,
    pub(super) emergency: Option<String>,
    /// Names by pseudonym, as far as they can be read.
    pub(super) names: &'a dyn Fn(u32) -> String,
}

impl AuditorDecision {
    pub(super) fn new(source: Source<'_>) -> Self {
        let consequences = match (source.recorded, source.inputs, &source.again) {
            (Some(recorded), Some(inputs), Some(again)) if source.redecided == Redecided::Same => {
                Some(Consequences { recorded, inputs, again })
            }
            _ => None,
        };
        let missing = match (source.redecided, source.unreadable) {
            (_, Some(why)) => Some(why),
            (Redecided::Differs, None) if source.recorded.is_some() => {
                Some("the recorded decision is not the one that the recorded rules give".to_owned())
            }
            _ => None,
        };
        let transcripts =
            source.recorded.map_or_else(Vec::new, |recorded| transcripts(recorded, source.inputs));
        let users = source
            .recorded
            .zip(source.inputs)
            .map_or_else(Vec::new, |(recorded, inputs)| participants(recorded, inputs));
        let mut decision = Self {
            open: source.open,
            redecided: source.redecided,
            emergency: source.emergency,
            users,
            transcripts,
            missing,
            counterfactual: consequences.as_ref().and_then(Consequences::what_if),
            disclosure: consequences.as_ref().map_or_else(Vec::new, Consequences::disclosure),
            welfare: consequences.as_ref().map(Consequences::welfare),
            told: Told::default(),
        };
        decision.told = auditor_text::tell(&decision, source.names);
        decision
    }
}

fn participants(recorded: &RecordedDecision, inputs: &Inputs) -> Vec<Participant> {
    let dispositions = 0..inputs.rules.dispositions();
    let names: Vec<&str> = dispositions
        .filter_map(|at| u16::try_from(at).ok())
        .map(|at| inputs.rules.disposition_name(selfneg_core::Disposition(at)))
        .collect();
    let all = recorded.participants.iter().zip(&inputs.users).enumerate();
    all.map(|(place, (user, bound))| Participant {
        user: user.0,
        name: bound.name.clone(),
        goal: bound.goal.clone(),
        conditions: bound
            .conditions()
            .iter()
            .map(|&one| inputs.rules.condition_name(one).to_owned())
            .collect(),
        ranks: names.iter().zip(bound.ranks()).map(|(name, rank)| ((*name).to_owned(), rank.0)).collect(),
        own_worth: own_worth(inputs, bound).unwrap_or_default(),
        willingness: if place == 0 { inputs.options.willingness } else { 0 },
    })
    .collect()
}

fn transcripts(recorded: &RecordedDecision, inputs: Option<&Inputs>) -> Vec<Transcript> {
    let discloses = |sender: UserId, disclosed: Option<Disclosed>| {
        let (inputs, disclosed) = (inputs?, disclosed?);
        if disclosed == Disclosed::Willingness {
            return Some(END_OF_GOAL.to_owned());
        }
        let place = recorded.place_of(sender)?;
        let conditions = inputs.users.get(place)?.conditions();
        let same = |condition: &&selfneg_core::Condition| {
            inputs.disclosed(place, Disclosure::Condition(**condition)) == disclosed
        };
        Some(inputs.rules.condition_name(*conditions.iter().find(same)?).to_owned())
    };
    let told = |round: &crate::case::RecordedRound| {
        let quit = TranscriptRound {
            round: round.number,
            sender: round.sender.0,
            receiver: round.receiver.0,
            depth: None,
            discloses: None,
            value: None,
            threshold: None,
            verdict: None,
        };
        match round.event {
            RecordedEvent::Offer { depth, verdict, discloses: disclosed, worth } => TranscriptRound {
                depth: Some(depth),
                discloses: discloses(round.sender, disclosed),
                value: worth.map(|worth| worth.value),
                threshold: worth.map(|worth| worth.threshold),
                verdict: verdict.map(Ruling::name),
                ..quit
            },
            RecordedEvent::Quit | RecordedEvent::Unknown => quit,
        }
    };
    recorded
        .negotiations
        .iter()
        .map(|one| Transcript {
            current: one.current.0,
            interrupting: one.interrupting.0,
            rounds: one.rounds.iter().map(told).collect(),
        })
        .collect()
}

/// What follows from a decision that was made again.
struct Consequences<'a> {
    recorded: &'a RecordedDecision,
    inputs: &'a Inputs,
    again: &'a Decision,
}

impl Consequences<'_> {
    fn pseudonym(&self, place: usize) -> u32 {
        self.recorded.participants.get(place).map_or(0, |user| user.0)
    }

    fn what_if(&self) -> Option<WhatIf> {
        let question = Question {
            rules: &self.inputs.rules,
            users: &self.inputs.users,
            options: self.inputs.options,
            policy: self.inputs.policy,
        };
        let found = Counterfactuals::of(&question).ok()?;
        let (pairs, pair, pairs_tried) = match &found.pairs {
            Pairs::NotNeeded => ("not-needed", None, 0),
            Pairs::Found(pair) => ("found", Some(self.changed(pair)), 0),
            Pairs::NoneOf { pairs } => ("none", None, *pairs),
            Pairs::NoneOfTheFirst { pairs } => ("none-of-the-first", None, *pairs),
        };
        let waiting = (0..self.inputs.users.len()).filter(|&place| place != self.again.served);
        let by_own_data = waiting.filter_map(|place| {
            let own = Counterfactuals::by_own_data(&question, place).ok()?;
            Some(OwnWay {
                user: self.pseudonym(place),
                smallest: own.single.first().map(|one| self.changed(one)),
            })
        });
        Some(WhatIf {
            smallest: found.smallest().map(|one| self.changed(one)),
            single: found.single.iter().map(|one| self.changed(one)).collect(),
            pairs,
            pair,
            pairs_tried,
            scale: found.scale,
            decided: found.decided,
            by_own_data: by_own_data.collect(),
        })
    }

    fn changed(&self, found: &Counterfactual) -> Changed {
        Changed {
            changes: found.edits.iter().map(|edit| self.change(*edit)).collect(),
            size: found.size,
            served: self.pseudonym(found.served),
            agreement: found.agreement,
        }
    }

    fn change(&self, edit: Edit) -> Change {
        let rules = &self.inputs.rules;
        let name = |condition| rules.condition_name(condition).to_owned();
        match edit {
            Edit::Withheld { user, condition } => {
                Change::Withheld { user: self.pseudonym(user), condition: name(condition) }
            }
            Edit::Added { user, condition, before } => {
                let own = self.inputs.users.get(user).map_or(&[][..], BoundUser::conditions);
                let before = before.and_then(|at| own.get(at)).copied().map(name);
                Change::Added { user: self.pseudonym(user), condition: name(condition), before }
            }
            Edit::Rank { user, disposition, from, to } => Change::Rank {
                user: self.pseudonym(user),
                disposition: rules.disposition_name(disposition).to_owned(),
                from: from.0,
                to: to.0,
            },
            Edit::Order { with } => Change::Order { user: self.pseudonym(with) },
        }
    }

    fn disclosure(&self) -> Vec<DisclosedBySide> {
        let sides = disclosure::of_decision(&self.inputs.rules, &self.inputs.users, self.again);
        let sides = sides.unwrap_or_default();
        let held = self.again.negotiations.iter().zip(sides);
        let side = |one: disclosure::Disclosed, won: bool| {
            let (exact, sufficient) = match &one.least {
                Least::Exactly(conditions) => (true, conditions.as_slice()),
                Least::AtMost(conditions) => (false, conditions.as_slice()),
                Least::Never => (true, &[][..]),
            };
            let name =
                |condition: &selfneg_core::Condition| self.inputs.rules.condition_name(*condition).to_owned();
            DisclosedBySide {
                sender: self.pseudonym(one.sender),
                receiver: self.pseudonym(one.receiver),
                disclosed: one.disclosed,
                conditions: one.conditions,
                won,
                least: one.least.sufficient(),
                exact,
                sufficient: sufficient.iter().map(name).collect(),
            }
        };
        held.flat_map(|(held, [current, interrupting])| {
            let winner = held.conclusion.outcome.winner();
            [
                side(current, winner == Some(selfneg_core::Side::Current)),
                side(interrupting, winner == Some(selfneg_core::Side::Interrupting)),
            ]
        })
        .collect()
    }

    fn welfare(&self) -> Welfare {
        let of = |place: usize| self.again.welfare.get(place).map_or(0, |worth| worth.0);
        let all = 0..self.inputs.users.len();
        let best = all.clone().map(of).max().unwrap_or(0);
        let served = of(self.again.served);
        Welfare {
            of_serving: all.map(|place| (self.pseudonym(place), of(place))).collect(),
            served,
            best,
            regret: best.saturating_sub(served),
        }
    }
}
