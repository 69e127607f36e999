//! What one user may be told: only what is that user's own, beside what anybody may.

use selfneg_core::{Activation, Aggregation, Condition, Disposition, Rank, impact_of_serving};
use serde::Serialize;

use super::open::{Basis, Negotiated, OpenDecision, OtherOrder};
use super::public::{checked, other_order};
use super::reason::Speaker;
use super::told::{Told, clock, counted, listed};
use crate::audit::Redecided;
use crate::binding::BoundUser;
use crate::case::{Inputs, RecordedDecision, RecordedEvent, RecordedNegotiation};
use crate::counterfactual::{Counterfactuals, Edit, Kind, Question};
use selfneg_core::Ruling;

/// A decision for one user who took part. Of the others it holds that they exist, and their
/// side's verdicts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OwnDecision {
    /// Its number among all decisions of the trace, from 1.
    pub decision: u64,
    /// When, in simulated seconds since the run's begin.
    pub at_s: f64,
    /// The user's own pseudonym.
    pub user: u32,
    /// Whether it is this user whom the robot serves by it.
    pub served: bool,
    /// How many others took part; of an emergency none.
    pub others: usize,
    /// `agreement`, `first-come`, `utilitarian`, `emergency` or `unknown`.
    pub by: &'static str,
    /// Whether the decision, made again, is the same.
    pub redecided: Redecided,
    /// What can be known of the other order of arrival without anybody's data.
    pub other_order: OtherOrder,
    /// The user's own part; none of an emergency, nor where it cannot be read.
    pub own: Option<OwnPart>,
    /// In sentences.
    pub told: Told,
}

/// What is this user's own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OwnPart {
    /// What the user asked for.
    pub goal: String,
    /// The true conditions in their order of disclosure.
    pub conditions: Vec<String>,
    /// How many of them were disclosed, in the negotiation in which it were most.
    pub disclosed: usize,
    /// What the own complete offer is worth in the user's own eyes, in ranks.
    pub own_worth: u64,
    /// What being close to the goal adds to that.
    pub willingness: u8,
    /// The ranks that add up to the worth: disposition, rank.
    pub made_of: Vec<(String, u8)>,
    /// How many offers of others this user's side accepted, those held included.
    pub accepted: usize,
    /// How many it rejected.
    pub rejected: usize,
    /// How many of the offers made for this user were accepted, those held included.
    pub were_accepted: usize,
    /// How many were rejected.
    pub were_rejected: usize,
    /// What other data of this user alone would have changed; none where the decision could
    /// not be made again.
    pub would_have_changed: Option<OwnChanges>,
}

/// What of the user's own would have changed whether the user is served.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct OwnChanges {
    /// A true condition: had it not been true, or been withheld.
    pub withheld: Option<String>,
    /// A condition: had it been true.
    pub added: Option<String>,
    /// Of that: before which of the user's own it would have to be disclosed; none: last.
    pub added_before: Option<String>,
    /// Whether some other rank of some disposition would have. Which one, and by how much,
    /// is not said: it would tell what others disclosed.
    pub rank: bool,
}

/// What an explanation for one user is made from.
pub(super) struct Source<'a> {
    pub(super) open: &'a OpenDecision,
    pub(super) redecided: Redecided,
    pub(super) recorded: Option<&'a RecordedDecision>,
    pub(super) inputs: Option<&'a Inputs>,
    pub(super) user: u32,
}

impl OwnDecision {
    pub(super) fn new(source: &Source<'_>) -> Self {
        let Source { open, redecided, user, .. } = *source;
        let served = open.served == Some(user);
        let own = source.own();
        let (others, by, other_order) = match &open.basis {
            Basis::Emergency(_) => (0, "emergency", OtherOrder::NotKnown),
            Basis::Negotiated(negotiated) => {
                let others = negotiated.participants.iter().filter(|&&other| other != user).count();
                let by = match (negotiated.agreement, negotiated.fallback) {
                    (true, _) => "agreement",
                    (false, Some(fallback)) => fallback.name(),
                    (false, None) => "unknown",
                };
                (others, by, negotiated.other_order)
            }
        };
        let mut decision = Self {
            decision: open.decision,
            at_s: open.at_s,
            user,
            served,
            others,
            by,
            redecided,
            other_order,
            own,
            told: Told::default(),
        };
        decision.told = decision.tell(source);
        decision
    }

    fn tell(&self, source: &Source<'_>) -> Told {
        let when = format!("Decision {}, at {}: ", self.decision, clock(self.at_s));
        let question = match (self.served, self.others) {
            (true, 1) => "why was another user made to wait for you?",
            (true, _) => "why were other users made to wait for you?",
            (false, _) => "why did you have to wait?",
        };
        let answer = match &source.open.basis {
            Basis::Emergency(_) => {
                let speaker = Speaker {
                    name: &|_| "a user".to_owned(),
                    category: &|category| format!("category {category} of the robot's specification"),
                };
                speaker.answer(source.open)
            }
            Basis::Negotiated(negotiated) => self.answer(source, negotiated),
        };
        let mut told = Told { question: format!("{when}{question}"), answer, sections: Vec::new() };
        if let Some(own) = &self.own {
            told.section("What of yours was used", own.used());
            told.section("What would have changed it", self.changed(own));
        } else if matches!(source.open.basis, Basis::Negotiated(_)) {
            told.section(
                "What of yours was used",
                vec!["Your own data cannot be read here (any more).".to_owned()],
            );
        }
        told.section(
            "More",
            vec![
                checked(self.redecided).to_owned(),
                "What other users told the robot is not said here, and to them nothing of what you told it."
                    .to_owned(),
            ],
        );
        told
    }

    fn answer(&self, source: &Source<'_>, negotiated: &Negotiated) -> Vec<String> {
        let was_first = negotiated.participants.first() == Some(&self.user);
        let another = if self.others == 1 { "another user" } else { "other users" };
        let mut answer =
            vec![match (self.served, was_first && negotiated.was_serving, negotiated.was_serving) {
                (true, true, _) => "The robot was serving you and stayed with you.".to_owned(),
                (true, false, true) => "The robot was serving another user and turned to you.".to_owned(),
                (true, false, false) => "The robot served you first.".to_owned(),
                (false, true, _) => "The robot was serving you and turned to another user.".to_owned(),
                (false, false, true) if source.stayed(negotiated) => {
                    "The robot was serving another user and stayed with that user.".to_owned()
                }
                (false, false, _) => "The robot served another user first.".to_owned(),
            }];
        answer.push(format!(
            "It had negotiated with itself, speaking for you and for {another} in turn: for you from your own \
             ethical profile, for {another} from theirs."
        ));
        answer.push(match (self.by, self.served, self.others) {
            ("agreement", true, 1) => {
                "The other side accepted what was offered for you, because by the other user's own profile it \
                 weighs more than the other user's own request."
                    .to_owned()
            }
            ("agreement", false, 1) => {
                "Your side accepted what was offered for the other user, because by your own profile it \
                 weighs more than your own request."
                    .to_owned()
            }
            ("agreement", true, _) => {
                "The negotiations, held two at a time, gave you precedence.".to_owned()
            }
            ("agreement", false, _) => {
                "The negotiations, held two at a time, gave another user precedence.".to_owned()
            }
            ("first-come", true, _) => {
                "There was no agreement. Then the rule is first come, first served, and you were first."
                    .to_owned()
            }
            ("first-come", false, _) => {
                "There was no agreement. Then the rule is first come, first served, and another user was \
                 first."
                    .to_owned()
            }
            ("utilitarian", true, _) => {
                "There was no agreement. Then the rule is to serve whoever's request is worth most to all \
                 together by their own profiles, and that was yours."
                    .to_owned()
            }
            ("utilitarian", false, _) => {
                "There was no agreement. Then the rule is to serve whoever's request is worth most to all \
                 together by their own profiles, and that was another user's."
                    .to_owned()
            }
            _ => "The record does not say by which rule it was decided.".to_owned(),
        });
        answer
    }

    fn changed(&self, own: &OwnPart) -> Vec<String> {
        let mut sentences: Vec<String> = other_order(self.other_order).into_iter().collect();
        let Some(changes) = &own.would_have_changed else { return sentences };
        let then =
            if self.served { "another user would have been served" } else { "you would have been served" };
        match &changes.withheld {
            Some(condition) => sentences
                .push(format!("Had {condition:?} not been true of you, or had you withheld it, {then}.")),
            None if own.conditions.is_empty() => {}
            None => sentences.push("Withholding any one condition would not have changed it.".to_owned()),
        }
        sentences.push(match (&changes.added, &changes.added_before) {
            (Some(condition), None) => format!("Had {condition:?} been true of you too, {then}."),
            (Some(condition), Some(before)) => {
                format!("Had {condition:?} been true of you too, and disclosed before {before:?}, {then}.")
            }
            (None, _) => "No single condition more of the robot's list would have changed it.".to_owned(),
        });
        sentences.push(if changes.rank {
            "Another rank in your own profile would have changed it. Which one is not said, because that would \
             tell what others disclosed."
                .to_owned()
        } else {
            "No other rank in your own profile would have changed it by itself.".to_owned()
        });
        sentences
    }
}

impl OwnPart {
    fn used(&self) -> Vec<String> {
        let quoted: Vec<String> =
            self.conditions.iter().take(self.disclosed).map(|name| format!("{name:?}")).collect();
        let mut sentences = vec![match (self.disclosed, self.conditions.len()) {
            (_, 0) => "You told of no condition that is true of you, so nothing was disclosed.".to_owned(),
            (0, _) => "Nothing that is true of you was disclosed.".to_owned(),
            (1, 1) => format!("What is true of you was disclosed: {}.", listed(&quoted)),
            (some, many) if some == many => {
                format!("All {many} conditions that are true of you were disclosed: {}.", listed(&quoted))
            }
            (some, many) => {
                format!(
                    "Of {many} conditions that are true of you {some} {} disclosed: {}.",
                    if some == 1 { "was" } else { "were" },
                    listed(&quoted)
                )
            }
        }];
        let parts: Vec<String> = self.made_of.iter().map(|(name, rank)| format!("{name:?} {rank}")).collect();
        sentences.push(if parts.is_empty() {
            format!("By your own profile your own request ({}) weighs {}.", self.goal, self.own_worth)
        } else {
            format!(
                "By your own profile your own request ({}) weighs {}: {}.",
                self.goal,
                self.own_worth,
                listed(&parts)
            )
        });
        if self.willingness > 0 {
            sentences.push(format!("Being close to your goal added {} to that.", self.willingness));
        }
        sentences.extend(match (self.accepted, self.rejected) {
            (0, 0) => None,
            (1, 0) => Some(
                "Your side heard 1 offer made for another user; it is worth more to you than your own \
                 request."
                    .to_owned(),
            ),
            (0, rejected) => Some(format!(
                "Your side heard {} made for others; none is worth more to you than your own request.",
                counted(rejected, "offer")
            )),
            (accepted, rejected) => Some(format!(
                "Your side heard {} made for others; {accepted} of them {} worth more to you than \
                 your own request.",
                counted(accepted.saturating_add(rejected), "offer"),
                if accepted == 1 { "is" } else { "are" }
            )),
        });
        sentences.extend(match (self.were_accepted, self.were_rejected) {
            (0, 0) => None,
            (0, 1) => Some("The 1 offer made for you was rejected.".to_owned()),
            (1, 0) => Some("The 1 offer made for you was accepted.".to_owned()),
            (0, rejected) => Some(format!("All {rejected} offers made for you were rejected.")),
            (accepted, rejected) => Some(format!(
                "Of {} made for you {accepted} {} accepted.",
                counted(accepted.saturating_add(rejected), "offer"),
                if accepted == 1 { "was" } else { "were" }
            )),
        });
        sentences
    }
}

impl Source<'_> {
    /// Whether the robot stayed with whom it was serving.
    fn stayed(&self, negotiated: &Negotiated) -> bool {
        negotiated.participants.first().copied() == self.open.served
    }

    fn own(&self) -> Option<OwnPart> {
        let (recorded, inputs) = (self.recorded?, self.inputs?);
        let place = recorded.participants.iter().position(|user| user.0 == self.user)?;
        let me = inputs.users.get(place)?;
        let name = |condition: Condition| inputs.rules.condition_name(condition).to_owned();
        let conditions: Vec<String> = me.conditions().iter().copied().map(name).collect();
        let tally = Tally::of(&recorded.negotiations, self.user);
        Some(OwnPart {
            goal: me.goal.clone(),
            disclosed: tally.disclosed.min(conditions.len()),
            conditions,
            own_worth: own_worth(inputs, me)?,
            willingness: if place == 0 { inputs.options.willingness } else { 0 },
            made_of: made_of(inputs, me),
            accepted: tally.accepted,
            rejected: tally.rejected,
            were_accepted: tally.were_accepted,
            were_rejected: tally.were_rejected,
            would_have_changed: if self.redecided == Redecided::Same { changes(inputs, place) } else { None },
        })
    }
}

/// The user's own complete offer in the user's own eyes. Willingness is not in it.
pub(super) fn own_worth(inputs: &Inputs, me: &BoundUser) -> Option<u64> {
    let rows = inputs.rules.rows();
    let activation = Activation::new(&rows).ok()?;
    let user = me.user().ok()?;
    Some(impact_of_serving(&user, &user, activation, inputs.options.aggregation).0)
}

/// The ranks that add up to it.
fn made_of(inputs: &Inputs, me: &BoundUser) -> Vec<(String, u8)> {
    let rows = inputs.rules.rows();
    let mut seen: Vec<Disposition> = Vec::new();
    let mut parts = Vec::new();
    for condition in me.conditions() {
        for &disposition in rows.get(usize::from(condition.0)).copied().unwrap_or_default() {
            let mentions = me.mentions(disposition);
            let times = match inputs.options.aggregation {
                Aggregation::PerCondition => mentions,
                Aggregation::PerDisposition => u8::from(mentions > 0 && !seen.contains(&disposition)),
            };
            seen.push(disposition);
            let rank = me.ranks().get(usize::from(disposition.0)).copied().unwrap_or(Rank(0));
            let part = (inputs.rules.disposition_name(disposition).to_owned(), rank.0);
            parts.extend((0..times).map(|_| part.clone()));
        }
    }
    parts
}

fn changes(inputs: &Inputs, place: usize) -> Option<OwnChanges> {
    let question = Question {
        rules: &inputs.rules,
        users: &inputs.users,
        options: inputs.options,
        policy: inputs.policy,
    };
    let found = Counterfactuals::by_own_data(&question, place).ok()?;
    let first = |kind| found.of_kind(kind, Some(place)).next().and_then(|one| one.edits.first().copied());
    let name = |condition| inputs.rules.condition_name(condition).to_owned();
    let withheld = match first(Kind::Withheld) {
        Some(Edit::Withheld { condition, .. }) => Some(name(condition)),
        _ => None,
    };
    let (added, added_before) = match first(Kind::Added) {
        Some(Edit::Added { condition, before, .. }) => {
            let own = inputs.users.get(place).map_or(&[][..], BoundUser::conditions);
            (Some(name(condition)), before.and_then(|at| own.get(at)).copied().map(name))
        }
        _ => (None, None),
    };
    Some(OwnChanges { withheld, added, added_before, rank: first(Kind::Rank).is_some() })
}

/// What open verdicts there are about one user's offers, and by one user's side.
#[derive(Default)]
struct Tally {
    disclosed: usize,
    accepted: usize,
    rejected: usize,
    were_accepted: usize,
    were_rejected: usize,
}

impl Tally {
    fn of(negotiations: &[RecordedNegotiation], user: u32) -> Self {
        let mut tally = Self::default();
        for round in negotiations.iter().flat_map(|one| &one.rounds) {
            let RecordedEvent::Offer { depth, verdict, .. } = round.event else { continue };
            let accepted = matches!(verdict, Some(Ruling::Accept | Ruling::Hold));
            if round.sender.0 == user {
                tally.disclosed = tally.disclosed.max(usize::try_from(depth).unwrap_or(usize::MAX));
                let count = if accepted { &mut tally.were_accepted } else { &mut tally.were_rejected };
                *count = count.saturating_add(1);
            } else if round.receiver.0 == user {
                let count = if accepted { &mut tally.accepted } else { &mut tally.rejected };
                *count = count.saturating_add(1);
            }
        }
        tally
    }
}
