//! The auditor's explanation in sentences.

use super::auditor::{
    AuditorDecision, Change, Changed, DisclosedBySide, Transcript, TranscriptRound, WhatIf,
};
use super::open::Basis;
use super::public::checked;
use super::reason::Speaker;
use super::told::{Told, counted, listed};
use crate::binding::END_OF_GOAL;

/// What is said to the auditor.
pub(super) fn tell(decision: &AuditorDecision, name: &dyn Fn(u32) -> String) -> Told {
    let category = |category: u32| match &decision.emergency {
        Some(name) => name.clone(),
        None => format!("category {category}"),
    };
    let speaker = Speaker { name, category: &category };
    let teller = Teller { decision, name };
    let mut told = Told {
        question: speaker.question(&decision.open),
        answer: speaker.answer(&decision.open),
        sections: Vec::new(),
    };
    told.answer.extend(teller.decisive());
    told.section("Who took part", teller.who());
    if let Basis::Negotiated(negotiated) = &decision.open.basis {
        let endings = speaker.negotiations(negotiated);
        for (nth, transcript) in decision.transcripts.iter().enumerate() {
            let title = match decision.transcripts.len() {
                1 => "Round by round".to_owned(),
                _ => format!(
                    "{} and {}, round by round",
                    name(transcript.current),
                    name(transcript.interrupting)
                ),
            };
            let mut rounds = teller.rounds(transcript);
            rounds.extend(endings.get(nth).cloned());
            told.section(&title, rounds);
        }
    }
    told.section("What would have changed it", teller.what_if());
    told.section("How much was disclosed", teller.disclosure());
    told.section("What serving whom is worth", teller.welfare());
    let mut more = vec![checked(decision.redecided).to_owned()];
    more.extend(decision.missing.as_ref().map(|why| {
        format!("So nothing can be said of what would have changed it, of the least disclosure and of welfare: {why}.")
    }));
    told.section("More", more);
    told
}

/// A kind of change, in words.
struct Kind {
    is: fn(&Change) -> bool,
    one: &'static str,
    none: &'static str,
}

const KINDS: [Kind; 4] = [
    Kind {
        is: |change| matches!(change, Change::Withheld { .. }),
        one: "With one condition less",
        none: "No single condition less",
    },
    Kind {
        is: |change| matches!(change, Change::Added { .. }),
        one: "With one condition more",
        none: "No single condition more",
    },
    Kind {
        is: |change| matches!(change, Change::Rank { .. }),
        one: "With one other rank",
        none: "No single other rank",
    },
    Kind {
        is: |change| matches!(change, Change::Order { .. }),
        one: "In another order of arrival",
        none: "No other order of arrival",
    },
];

/// Whether a change is one of this kind.
fn is_like(changed: &Changed, example: &Change) -> bool {
    let kind = KINDS.iter().find(|kind| (kind.is)(example));
    kind.is_some_and(|kind| changed.changes.iter().all(kind.is))
}

fn more(count: usize) -> String {
    match count {
        0 => String::new(),
        count => format!(" ({} of this kind)", counted(count, "more change")),
    }
}

struct Teller<'a> {
    decision: &'a AuditorDecision,
    name: &'a dyn Fn(u32) -> String,
}

impl Teller<'_> {
    fn name(&self, user: u32) -> String {
        (self.name)(user)
    }

    /// The round that decided an agreement between two.
    fn decisive(&self) -> Option<String> {
        let [transcript] = self.decision.transcripts.as_slice() else { return None };
        let Basis::Negotiated(negotiated) = &self.decision.open.basis else { return None };
        let last = transcript.rounds.last()?;
        let (value, threshold) = (last.value?, last.threshold?);
        let (sender, receiver) = (self.name(last.sender), self.name(last.receiver));
        let what = last.discloses.as_ref()?;
        (negotiated.agreement && last.verdict == Some("accept")).then(|| {
            format!(
                "Once {what:?} was disclosed, {sender}'s offer weighed {value} by {receiver}'s profile, and \
                 {receiver}'s own complete offer {threshold}."
            )
        })
    }

    fn who(&self) -> Vec<String> {
        let one = |user: &super::auditor::Participant| {
            let conditions: Vec<String> = user.conditions.iter().map(|name| format!("{name:?}")).collect();
            let true_of = match conditions.as_slice() {
                [] => "no condition is true and not withheld".to_owned(),
                conditions => format!("true: {}", listed(conditions)),
            };
            let willing = match user.willingness {
                0 => String::new(),
                worth => format!(" and {worth} more for being close to the goal"),
            };
            format!(
                "{name} (user {}) asks for {:?}; {true_of}. {name}'s own complete offer weighs {} by {name}'s \
                 profile{willing}.",
                user.user,
                user.goal,
                user.own_worth,
                name = user.name
            )
        };
        self.decision.users.iter().map(one).collect()
    }

    fn rounds(&self, transcript: &Transcript) -> Vec<String> {
        transcript.rounds.iter().map(|round| self.round(round)).collect()
    }

    fn round(&self, round: &TranscriptRound) -> String {
        let (sender, receiver) = (self.name(round.sender), self.name(round.receiver));
        let number = round.round;
        if round.depth.is_none() {
            return format!("Round {number}: {sender} has nothing more to disclose and quits.");
        }
        let what = match round.discloses.as_deref() {
            Some(END_OF_GOAL) => "being close to the goal".to_owned(),
            Some(condition) => format!("{condition:?}"),
            None => "a condition that cannot be read".to_owned(),
        };
        let worth = match (round.value, round.threshold) {
            (Some(value), Some(threshold)) => {
                format!(
                    "To {receiver} the offer weighs {value}, {receiver}'s own complete offer {threshold}: "
                )
            }
            _ => "What it weighs cannot be read: ".to_owned(),
        };
        let verdict = match round.verdict {
            Some("accept") => "accepted",
            Some("hold") => "acceptable, and held until the reply",
            Some("reject") => "rejected",
            _ => "the verdict is not recorded",
        };
        format!("Round {number}: {sender} discloses {what}. {worth}{verdict}.")
    }

    fn what_if(&self) -> Vec<String> {
        let Some(what_if) = &self.decision.counterfactual else { return Vec::new() };
        let mut sentences = Vec::new();
        if let Some(smallest) = &what_if.smallest {
            let same_kind = match smallest.changes.as_slice() {
                [one] => what_if.single.iter().filter(|other| is_like(other, one)).count().saturating_sub(1),
                _ => 0,
            };
            sentences.push(format!("The smallest change: {}{}.", self.changed(smallest), more(same_kind)));
        }
        sentences.extend(KINDS.iter().filter_map(|kind| self.of_kind(kind, what_if)));
        sentences.extend(self.pairs(what_if));
        if self.decision.users.len() > 2 {
            sentences.extend(what_if.by_own_data.iter().map(|way| {
                let whose = self.name(way.user);
                match &way.smallest {
                    Some(smallest) => format!("By {whose}'s own data alone: {}.", self.changed(smallest)),
                    None => {
                        format!("No single change of {whose}'s own data would have had {whose} served.")
                    }
                }
            }));
        }
        sentences.push(format!(
            "Found by deciding {} changed cases again, with ranks from 0 to {}.",
            what_if.decided, what_if.scale
        ));
        sentences
    }

    /// The smallest change of a kind, unless it is told already, and how many there are.
    fn of_kind(&self, kind: &Kind, what_if: &WhatIf) -> Option<String> {
        let mut all = what_if.single.iter().filter(|one| one.changes.iter().all(kind.is));
        let Some(first) = all.next() else {
            return Some(format!("{} would have changed it.", kind.none));
        };
        (what_if.smallest.as_ref() != Some(first))
            .then(|| format!("{}: {}{}.", kind.one, self.changed(first), more(all.count())))
    }

    fn pairs(&self, what_if: &WhatIf) -> Option<String> {
        let tried = what_if.pairs_tried;
        match what_if.pairs {
            "found" => {
                let pair = what_if.pair.as_ref().filter(|pair| what_if.smallest.as_ref() != Some(*pair));
                pair.map(|pair| format!("With two changes of data: {}.", self.changed(pair)))
            }
            "none" => {
                Some(format!("Nor would any two changes of data at once; all {tried} pairs were tried."))
            }
            "none-of-the-first" => Some(format!(
                "Nor would any of the {tried} smallest pairs of such changes; larger pairs were not tried."
            )),
            _ => None,
        }
    }

    fn changed(&self, changed: &Changed) -> String {
        let changes: Vec<String> = changed.changes.iter().map(|change| self.change(change)).collect();
        let by = if changed.agreement { "by agreement" } else { "by the rule without agreement" };
        format!("{}, {} would have been served, {by}", changes.join(", and "), self.name(changed.served))
    }

    fn change(&self, change: &Change) -> String {
        match change {
            Change::Withheld { user, condition } => {
                format!("had {condition:?} not been true of {} (or been withheld)", self.name(*user))
            }
            Change::Added { user, condition, before: None } => {
                format!("had {condition:?} been true of {} too", self.name(*user))
            }
            Change::Added { user, condition, before: Some(before) } => format!(
                "had {condition:?} been true of {} too, and disclosed before {before:?}",
                self.name(*user)
            ),
            Change::Rank { user, disposition, from, to } => {
                format!("had {} ranked {disposition:?} {to} instead of {from}", self.name(*user))
            }
            Change::Order { user } => {
                let current = self.decision.users.first().map_or(0, |first| first.user);
                format!("had {} and {} come in each other's place", self.name(current), self.name(*user))
            }
        }
    }

    fn disclosure(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        for two in self.decision.disclosure.chunks(2) {
            let told: Vec<String> = two
                .iter()
                .map(|side| {
                    let (sender, all) = (self.name(side.sender), counted(side.conditions, "condition"));
                    format!("{} of {sender}'s {all}", side.disclosed)
                })
                .collect();
            let where_held = match (two, self.decision.disclosure.len()) {
                ([one, _], 3..) => {
                    format!("Between {} and {}", self.name(one.sender), self.name(one.receiver))
                }
                _ => "Disclosed".to_owned(),
            };
            let mut sentence = format!("{where_held}: {}.", listed(&told));
            for side in two {
                sentence.push(' ');
                sentence.push_str(&self.least(side));
            }
            sentences.push(sentence);
        }
        sentences
    }

    fn least(&self, side: &DisclosedBySide) -> String {
        let (sender, receiver) = (self.name(side.sender), self.name(side.receiver));
        match side.least {
            None => format!("Not even all that is true of {sender} would {receiver}'s side have accepted."),
            Some(least) => {
                let quoted: Vec<String> = side.sufficient.iter().map(|name| format!("{name:?}")).collect();
                let known = if side.exact { "" } else { " that is known" };
                format!(
                    "The least{known} that {receiver}'s side would have accepted: {} of {sender} ({}).",
                    counted(least, "condition"),
                    listed(&quoted)
                )
            }
        }
    }

    fn welfare(&self) -> Vec<String> {
        let Some(welfare) = &self.decision.welfare else { return Vec::new() };
        let each: Vec<String> = welfare
            .of_serving
            .iter()
            .map(|(user, worth)| format!("{worth} to serve {}", self.name(*user)))
            .collect();
        let verdict = match welfare.regret {
            0 => "Nobody else's request is worth more.".to_owned(),
            regret => format!("The best is worth {regret} more than what was decided."),
        };
        vec![format!("To all of them together, in ranks: {}. {verdict}", each.join(", "))]
    }
}
