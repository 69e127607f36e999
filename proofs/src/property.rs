//! Every property of the protocol, stated once.
//!
//! A statement is a function of an engine, a case, a variant and, for a two-run property,
//! a second case that whoever checks it chooses; it neither allocates nor panics, and says
//! whether the case bears it out. Kani, literal enumeration and random search call the
//! same functions.

mod course;
mod influence;
mod locality;
mod result;
mod soundness;

pub mod policy;

pub use locality::Locality;
pub use result::closed_form;

use selfneg_core::{Options, Side};

use crate::case::OpenCase;
use crate::engine::Engine;
use crate::transcript::Memory;

/// What one case says of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judgement {
    /// The case satisfies it.
    Holds,
    /// The case does not meet its premise, so it says nothing.
    Vacuous,
    /// The case refutes it.
    Fails,
}

impl Judgement {
    /// [`Holds`](Self::Holds) or [`Fails`](Self::Fails).
    #[must_use]
    pub const fn from_bool(holds: bool) -> Self {
        if holds { Self::Holds } else { Self::Fails }
    }
}

/// How the second case of a two-run property differs from the first. The one who checks
/// the property chooses the second case; a case that does not differ so is vacuous.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alteration {
    /// No second case: the statement derives whatever it needs from the first.
    None,
    /// Nothing differs but the place in memory.
    Copied,
    /// One user hides at least one of its true conditions.
    Hidden,
    /// One user discloses its conditions in another order.
    Reordered,
    /// One user reports other ranks.
    Misreported,
    /// One user has other conditions after those that it discloses in the first case.
    Undisclosed,
    /// One user has any other ranks and conditions, and the same goal.
    Replaced,
}

/// The second case of a two-run property.
#[derive(Clone, Copy)]
pub struct Second<'a> {
    /// The case.
    pub case: OpenCase<'a>,
    /// The side on which it differs from the first.
    pub side: Side,
}

/// What a statement is about: one case, a second one, and the variant.
#[derive(Clone, Copy)]
pub struct Trial<'a> {
    /// The case.
    pub case: OpenCase<'a>,
    /// The second case. Without one ([`Alteration::None`]) it is not looked at.
    pub second: Second<'a>,
    /// The variant of the protocol.
    pub options: Options,
}

/// Declares the properties with their texts.
macro_rules! properties {
    ($( $(#[$doc:meta])* $variant:ident = $name:literal, $alteration:ident, $check:path,
        $statement:literal, vacuous $vacuous:literal; )+) => {
        /// A property of the protocol between two users.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Property { $( #[doc = $statement] $(#[$doc])* $variant, )+ }

        impl Property {
            /// Every property, in the order of the tables.
            pub const ALL: &'static [Self] = &[ $( Self::$variant, )+ ];

            /// Its name in tables and on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $( Self::$variant => $name, )+ }
            }

            /// What it says, in one sentence.
            #[must_use]
            pub const fn statement(self) -> &'static str {
                match self { $( Self::$variant => $statement, )+ }
            }

            /// Which cases say nothing about it.
            #[must_use]
            pub const fn vacuous(self) -> &'static str {
                match self { $( Self::$variant => $vacuous, )+ }
            }

            /// What second case it needs.
            #[must_use]
            pub const fn alteration(self) -> Alteration {
                match self { $( Self::$variant => Alteration::$alteration, )+ }
            }

            /// What `trial` says of it, with `engine` doing the negotiating. `memory` is
            /// for two transcripts; only properties that compare them write to it.
            pub fn check<E: Engine>(self, engine: &E, trial: &Trial<'_>, memory: &mut Memory<'_>) -> Judgement {
                match self { $( Self::$variant => $check(engine, trial, memory), )+ }
            }
        }
    };
}

properties! {
    Termination = "termination", None, course::termination,
        "A negotiation takes at most one round for each offer that a user has, and two more.",
        vacuous "none";
    ExactTermination = "exact-termination", None, course::exact_termination,
        "A negotiation takes exactly one round for each offer and two more if and only if there is no agreement.",
        vacuous "none";
    ClosedForm = "closed-form", None, result::closed_form_is_engine,
        "The outcome is what the least depths of acceptance (and, under the literal quit rule, the numbers of offers) say.",
        vacuous "none";
    Determinism = "determinism", Copied, soundness::determinism,
        "The same users, elsewhere in memory, negotiate the same rounds to the same conclusion.",
        vacuous "the second case is not a copy of the first";
    RoleSymmetry = "role-symmetry", None, result::role_symmetry,
        "Swapping who interrupts leaves the agreed winner unchanged.",
        vacuous "no agreement either way";
    RoleSymmetryException = "role-symmetry-exception", None, result::role_symmetry_exception,
        "Swapping who interrupts changes the agreed winner if and only if each accepts the other's offer first at the same depth, and then the interrupting user wins both times.",
        vacuous "no agreement either way";
    Unanimity = "unanimity", None, result::unanimity,
        "A user whose complete offer both profiles put strictly above the other's is served.",
        vacuous "the profiles do not both put the same offer strictly above the other";
    OneSidedOptimality = "one-sided-optimality", None, result::one_sided_optimality,
        "When exactly one user would accept the other's complete offer, an agreement maximises welfare.",
        vacuous "no agreement, or none or each would accept the other's complete offer";
    DecisionLocality = "decision-locality", Replaced, locality::decision_locality,
        "A verdict, and the totals behind it, depend on the receiver's data and the disclosed offer only: nothing else of the sender changes a bit of them.",
        vacuous "the two runs have no offer in common, or the second case differs on the other side too";
    TranscriptLocality = "transcript-locality", Undisclosed, locality::transcript_locality,
        "Replacing what a user has not disclosed, its own total unchanged, leaves the transcript identical; nothing may be added to a user who had quit, under a tie rule that holds offers nothing to a user who had no offer of a depth at which the other's was accepted, and under the literal quit rule the number of conditions must stay.",
        vacuous "the second case is not such a replacement";
    BoundedDisclosure = "bounded-disclosure", None, course::bounded_disclosure,
        "Each round discloses one more condition of its sender, in the sender's order, or is a quit, and nothing is disclosed after the deciding round.",
        vacuous "nobody has a condition";
    GainingLast = "gaining-last", None, influence::gaining_last,
        "A further true condition, disclosed after the others, never turns a user's win into something else.",
        vacuous "neither user, without its last condition, wins";
    HideProofness = "hide-proofness", Hidden, influence::hide_proofness,
        "Hiding true conditions never makes a user win who did not.",
        vacuous "the user wins anyway, or the second case hides nothing of it";
    HidingNeedsDeference = "hiding-needs-mutual-deference", Hidden, influence::hiding_needs_deference,
        "Hiding true conditions makes a user win who did not only if each would accept the other's complete offer.",
        vacuous "hiding does not make the user win";
    SortedHideProofness = "sorted-hide-proofness", Hidden, influence::sorted_hide_proofness,
        "If both users disclose in non-increasing order of what each condition adds in the receiver's eyes, hiding true conditions never makes a user win who did not.",
        vacuous "as for hide-proofness, or a user discloses in another order";
    OrderIndependence = "order-independence", Reordered, influence::order_independence,
        "The order in which a user discloses its conditions does not change the outcome.",
        vacuous "the second case is not a reordering";
    OrderNeedsDeference = "order-needs-mutual-deference", Reordered, influence::order_needs_deference,
        "The order of disclosure changes the outcome only if each would accept the other's complete offer.",
        vacuous "the order does not change the outcome";
    MisreportProofness = "misreport-proofness", Misreported, influence::misreport_proofness,
        "Reporting other ranks never makes the robot serve a user whom it would not serve.",
        vacuous "the user is served anyway, or the second case differs in more than its ranks";
    NoOverflow = "no-overflow", None, soundness::no_overflow,
        "Every value and threshold weighed is the exact sum of ranks, below 2^48.",
        vacuous "no offer is made";
    NoPanic = "no-panic", None, soundness::no_panic,
        "Negotiating and serving come back, and an agreed winner is served.",
        vacuous "none";
}

impl std::fmt::Display for Property {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl std::str::FromStr for Property {
    type Err = UnknownProperty;

    fn from_str(name: &str) -> Result<Self, UnknownProperty> {
        Self::ALL.iter().copied().find(|property| property.name() == name).ok_or(UnknownProperty)
    }
}

/// A name that no property has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownProperty;

impl std::fmt::Display for UnknownProperty {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("no property has that name")
    }
}

impl std::error::Error for UnknownProperty {}
