//! What anybody may be told.

use serde::Serialize;

use super::open::{Basis, OpenDecision, OtherOrder};
use super::reason::Speaker;
use super::told::{Told, counted};
use crate::audit::Redecided;

/// A decision for anybody: made from the open records alone, and whether the decision, made
/// again, is the same.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PublicDecision {
    /// What is open.
    #[serde(flatten)]
    pub open: OpenDecision,
    /// Whether it was made again.
    pub redecided: Redecided,
    /// In sentences.
    pub told: Told,
}

impl PublicDecision {
    pub(super) fn new(open: OpenDecision, redecided: Redecided) -> Self {
        let speaker = Speaker {
            name: &|user| format!("user {user}"),
            category: &|category| format!("category {category} of the robot's specification"),
        };
        let mut told =
            Told { question: speaker.question(&open), answer: speaker.answer(&open), sections: Vec::new() };
        let mut more = Vec::new();
        if let Basis::Negotiated(negotiated) = &open.basis {
            told.section("The negotiations", speaker.negotiations(negotiated));
            more.push(format!("The decision took {}.", counted(negotiated.rounds, "round")));
            more.extend(other_order(negotiated.other_order));
        }
        more.push(checked(redecided).to_owned());
        told.section("More", more);
        Self { open, redecided, told }
    }
}

/// What can be said of the other order of arrival without anybody's data.
pub(super) fn other_order(answer: OtherOrder) -> Option<String> {
    match answer {
        OtherOrder::Same => {
            Some("Had the two come in the other order, it would have been the same.".to_owned())
        }
        OtherOrder::Other => {
            Some("Had the two come in the other order, the other one would have been served.".to_owned())
        }
        OtherOrder::NotKnown => None,
    }
}

/// Whether it was made again, in words.
pub(super) fn checked(redecided: Redecided) -> &'static str {
    match redecided {
        Redecided::Same => "The decision was checked: made again by the recorded rules, it is the same.",
        Redecided::Differs => {
            "The decision was checked, and is wrong: made again by the recorded rules, it is another one. \
             Either the robot did not follow its rules or the record is false."
        }
        Redecided::Unchecked => {
            "The decision was not checked here: what it was made from cannot be read, or not all of it."
        }
    }
}
