//! A user's data on the way in.
//!
//! Everything here wipes its heap memory when it is dropped, whole capacities included. It
//! cannot wipe what its maker left elsewhere: a file's text, a parser's buffers, the old
//! memory of a `String` or `Vec` that had to grow.

use std::fmt;

use selfneg_core::Rank;
use serde::{Deserialize, Serialize};
use zeroize::{Zeroize, ZeroizeOnDrop};

use crate::input::{Truth, User};

/// Text about a user. It is wiped when dropped, and `Debug` does not show it.
#[derive(Clone, Default, PartialEq, Eq, Hash, Zeroize, ZeroizeOnDrop, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Text(String);

impl Text {
    /// Takes over the memory of `text`.
    #[must_use]
    pub fn new(text: String) -> Self {
        Self(text)
    }

    /// The text itself.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Text {
    fn from(text: &str) -> Self {
        Self(text.to_owned())
    }
}

impl fmt::Debug for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Text(..)")
    }
}

/// A user's ranks in one context.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Zeroize, ZeroizeOnDrop, Serialize, Deserialize)]
pub struct Profile {
    /// The context label: a value of the attribute `location`.
    pub label: Text,
    /// Disposition and rank.
    pub ranks: Vec<(Text, u8)>,
}

/// What a user says of one condition.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Stated {
    /// The condition.
    pub condition: Text,
    /// True, false, or withheld.
    #[serde(with = "truth")]
    pub truth: Truth,
}

impl Zeroize for Stated {
    fn zeroize(&mut self) {
        self.condition.zeroize();
        self.truth = Truth::Withheld;
    }
}

/// Everything that a user tells the robot.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, Zeroize, ZeroizeOnDrop, Serialize, Deserialize)]
pub struct UserData {
    /// Ethical profiles; none at all if the user gave none.
    pub profiles: Vec<Profile>,
    /// Conditions in their order of disclosure.
    pub status: Vec<Stated>,
    /// Context: attribute and value. `location` selects the profile.
    pub context: Vec<(Text, Text)>,
}

impl From<&User> for UserData {
    /// The data of a user folder: the profile of its location, its status, its location.
    fn from(user: &User) -> Self {
        let ranks = user.profile.iter().map(|(name, Rank(rank))| (Text::from(name.as_str()), *rank));
        let stated =
            |(name, truth): &(String, Truth)| Stated { condition: name.as_str().into(), truth: *truth };
        Self {
            profiles: vec![Profile { label: user.location.as_str().into(), ranks: ranks.collect() }],
            status: user.status.iter().map(stated).collect(),
            context: vec![(LOCATION.into(), user.location.as_str().into())],
        }
    }
}

/// The attribute that selects the profile.
pub const LOCATION: &str = "location";

/// A [`Truth`] as in the published folders: true, false, or null if withheld.
pub(super) mod truth {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use crate::input::Truth;

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
    pub(in super::super) fn serialize<S: Serializer>(
        truth: &Truth,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let said = match truth {
            Truth::True => Some(true),
            Truth::False => Some(false),
            Truth::Withheld => None,
        };
        said.serialize(serializer)
    }

    pub(in super::super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Truth, D::Error> {
        Ok(match Option::<bool>::deserialize(deserializer)? {
            Some(true) => Truth::True,
            Some(false) => Truth::False,
            None => Truth::Withheld,
        })
    }
}
