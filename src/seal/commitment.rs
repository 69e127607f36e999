//! Commitments: what a robot knew of a person, fixed when it knew it, shown later or never.
//!
//! A commitment is a digest of the data and of a fresh salt. Who has the salt and the data can
//! show that these were the data; without the salt nothing can be guessed from it, not even
//! among few possible data.

use super::chain::{Digest, Parts};
use crate::trace::schema::evidence::Committed;

const CONTEXT: &str = "selfneg trace 1 commitment";

/// What keeps a commitment's data from being guessed.
pub type Salt = [u8; 32];

/// What is committed to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fact<'a> {
    /// Of which event or record.
    pub index: u64,
    /// Of which user, by pseudonym.
    pub user: u32,
    /// What of it.
    pub what: Committed,
    /// The protobuf bytes of that part.
    pub data: &'a [u8],
}

/// The commitment to a fact.
#[must_use]
pub fn commit(fact: &Fact<'_>, salt: &Salt) -> Digest {
    let mut parts = Parts::of(CONTEXT);
    let what = u64::from(i32::from(fact.what).unsigned_abs());
    parts.bytes(salt).number(what).number(fact.index).number(u64::from(fact.user)).bytes(fact.data);
    parts.digest()
}

/// Whether `commitment` was made to this fact with this salt.
#[must_use]
pub fn verify(commitment: &[u8], fact: &Fact<'_>, salt: &Salt) -> bool {
    commit(fact, salt) == *commitment
}
