//! The protocol's options: each ambiguity between the paper's text and the published
//! system is one named choice, and the default is the published system.

use core::fmt;

/// Declares an enum whose values have the names that the command line, the reports and
/// the JSON use.
macro_rules! named {
    (
        $(#[$meta:meta])*
        pub enum $name:ident { $( $(#[$vmeta:meta])* $variant:ident = $text:literal, )+ }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $name { $( $(#[$vmeta])* $variant, )+ }

        impl $name {
            /// Every value, the default first.
            pub const ALL: &'static [Self] = &[ $( Self::$variant, )+ ];

            /// The value's name as written in a variant.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $( Self::$variant => $text, )+ }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(self.name())
            }
        }

        impl core::str::FromStr for $name {
            type Err = UnknownName;

            fn from_str(name: &str) -> Result<Self, UnknownName> {
                match name { $( $text => Ok(Self::$variant), )+ _ => Err(UnknownName) }
            }
        }
    };
}

/// A name that no value of the option has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownName;

impl fmt::Display for UnknownName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no value of this option has that name")
    }
}

impl core::error::Error for UnknownName {}

named! {
    /// When a user quits.
    pub enum QuitRule {
        /// A user quits in its turn once it has no further offer; the other goes on
        /// alone. What the published implementation does.
        #[default]
        Exhausted = "exhausted",
        /// The paper's formula: the receiver of offer `i` ends the negotiation in the
        /// very round in which it rejects and `i` is at least its own number of offers;
        /// a first sender without offers ends it in round 1.
        Literal = "literal",
    }
}

named! {
    /// How the ranks of an offer add up.
    pub enum Aggregation {
        /// Every disclosed condition adds its dispositions' ranks, so two conditions
        /// that activate one disposition count twice. The published implementation.
        #[default]
        PerCondition = "per-condition",
        /// The implication is a set: each disposition counts once. The paper's
        /// definition.
        PerDisposition = "per-disposition",
    }
}

named! {
    /// What happens when each user would accept the other's offer of the same depth.
    pub enum TieRule {
        /// Whoever sends first (the interrupting user) wins. The published system.
        #[default]
        FirstSender = "first-sender",
        /// Such a tie is no agreement.
        Fallback = "fallback",
        /// The offer whose receiver gains more by it wins; equal gains: no agreement.
        Surplus = "surplus",
    }
}

named! {
    /// Whom the robot serves without agreement.
    pub enum Fallback {
        /// First come, first served: the current user stays.
        #[default]
        FirstCome = "first-come",
        /// The user with more welfare; equal: the current one. It weighs both complete
        /// offers inside the robot, so decision locality is not claimed for it.
        Utilitarian = "utilitarian",
    }
}

/// One variant of the protocol. The default is the published system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Options {
    /// When a user quits.
    pub quit: QuitRule,
    /// How ranks add up.
    pub aggregation: Aggregation,
    /// Who wins a tie of equal depth.
    pub tie: TieRule,
    /// Whom to serve without agreement.
    pub fallback: Fallback,
    /// N > 0: the current user gets one more true condition, last, that activates
    /// nothing for anyone else and is worth N on its own complete offer in its own eyes.
    /// It does not count in welfare. (The paper's *willingness to be interrupted*; the
    /// published folders call it "end of goal", with N = 1.)
    pub willingness: u8,
}

/// Written as `exhausted/per-condition/first-sender/first-come/w0`.
impl fmt::Display for Options {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}/{}/{}/w{}", self.quit, self.aggregation, self.tie, self.fallback, self.willingness)
    }
}
