//! Which parts of what is personal the robot commits to, and whether they are as committed.

use std::collections::BTreeMap;

use prost::Message as _;

use super::recording::{Entry, Recording, Step};
use super::schema::evidence::Committed;
use super::schema::personal::{Input, Reply, UserData, input, reply};
use crate::seal::commitment::{Fact, verify};

/// A part of what is personal, as it is committed to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Part {
    index: u64,
    user: u32,
    what: Committed,
    data: Vec<u8>,
}

impl Part {
    fn key(&self) -> (u64, u32, i32) {
        (self.index, self.user, self.what.into())
    }

    pub(super) fn as_fact(&self) -> Fact<'_> {
        Fact { index: self.index, user: self.user, what: self.what, data: &self.data }
    }
}

/// What of an event's personal half.
pub(super) fn of_input(personal: &Input) -> Vec<Part> {
    let Some(user) = personal.user else { return Vec::new() };
    let part = |what, data| Part { index: personal.index, user, what, data };
    match &personal.input {
        Some(input::Input::Data(data)) => {
            let profiles = UserData { profiles: data.profiles.clone(), ..UserData::default() };
            let status = UserData { status: data.status.clone(), ..UserData::default() };
            let context = UserData { context: data.context.clone(), ..UserData::default() };
            vec![
                part(Committed::Profiles, profiles.encode_to_vec()),
                part(Committed::Status, status.encode_to_vec()),
                part(Committed::Context, context.encode_to_vec()),
            ]
        }
        Some(input::Input::Context(_) | input::Input::Status(_)) => {
            vec![part(Committed::Change, personal.encode_to_vec())]
        }
        Some(input::Input::Place(_)) | None => Vec::new(),
    }
}

/// What of a reply's personal half.
pub(super) fn of_reply(personal: &Reply) -> Option<Part> {
    let (user, Some(reply::Reply::Disclosed(disclosed))) = (personal.user?, &personal.reply) else {
        return None;
    };
    Some(Part { index: personal.index, user, what: Committed::Condition, data: disclosed.encode_to_vec() })
}

/// What became of one commitment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Commitment {
    /// The data are there, and are those that were committed to.
    Holds,
    /// The data are there, and are others: the robot knew one thing and wrote another.
    Fails,
    /// The data or the salt are not there, or not readable.
    Closed,
    /// The data are there, and nothing commits to them.
    Missing,
}

impl Recording {
    /// Every commitment of the trace, and every part that there should be one to: its index,
    /// whose and what it is, and whether it holds. Meant for a sealed trace; others have none.
    #[must_use]
    pub fn commitments(&self) -> Vec<(u64, u32, Committed, Commitment)> {
        let parts = self.entries.iter().flat_map(parts);
        let mut parts: BTreeMap<_, _> = parts.map(|part| (part.key(), part)).collect();
        let salts = self.openings.iter().map(|opening| {
            ((opening.index, opening.user, i32::from(opening.what())), opening.salt.as_slice())
        });
        let salts: BTreeMap<_, _> = salts.collect();
        let mut judged = Vec::new();
        for commitment in &self.commitments {
            let key = (commitment.index, commitment.user, i32::from(commitment.what()));
            let salt = salts.get(&key).and_then(|salt| (*salt).try_into().ok());
            let state = match (parts.remove(&key), salt) {
                (Some(part), Some(salt)) if verify(&commitment.commitment, &part.as_fact(), &salt) => {
                    Commitment::Holds
                }
                (Some(_), Some(_)) => Commitment::Fails,
                _ => Commitment::Closed,
            };
            judged.push((commitment.index, commitment.user, commitment.what(), state));
        }
        judged
            .extend(parts.into_values().map(|part| (part.index, part.user, part.what, Commitment::Missing)));
        judged
    }
}

fn parts(entry: &Entry) -> Vec<Part> {
    match &entry.step {
        Step::Event { personal, .. } => personal.as_ref().map(of_input).unwrap_or_default(),
        Step::Reply { personal, .. } => personal.iter().filter_map(of_reply).collect(),
    }
}
