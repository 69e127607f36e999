//! The self-negotiation protocol: one robot, two users, whose goal comes first.
//!
//! The robot speaks for each user in turn, from that user's own ethical profile. Each
//! round discloses one condition of the sender; the receiver accepts as soon as the offer
//! is worth strictly more, in its own eyes, than its own complete offer. This crate is the
//! part that is proved: `no_std`, no allocation, no dependency, no `unsafe`, no panic.
//!
//! # A complete decision
//!
//! Alice and Bob of the paper's Table I. Alice is with a small child and in urgency, and
//! is being served; Bob is elderly and interrupts.
//!
//! ```
//! use selfneg_core::{
//!     Activation, Case, Condition, Disposition, EthicalProfile, Implication, Options,
//!     Outcome, Rank, Side, Status, User,
//! };
//!
//! // Rules: condition c activates disposition c, and either goal implies all six.
//! let dispositions: Vec<[Disposition; 1]> = (0..6).map(|d| [Disposition(d)]).collect();
//! let rows: Vec<&[Disposition]> = dispositions.iter().map(|row| &row[..]).collect();
//! let activation = Activation::new(&rows)?;
//! let goal = Implication::new(&[1; 6]);
//!
//! let [child, elderly, urgency] = [Condition(0), Condition(1), Condition(3)];
//! let alice_ranks = [4, 2, 2, 3, 5, 3].map(Rank);
//! let alice_status = [child, urgency];
//! let alice = User::new(EthicalProfile::new(&alice_ranks), Status::new(&alice_status)?, goal);
//! let bob_ranks = [5, 4, 3, 3, 3, 1].map(Rank);
//! let bob_status = [elderly];
//! let bob = User::new(EthicalProfile::new(&bob_ranks), Status::new(&bob_status)?, goal);
//!
//! let case = Case { activation, current: alice, interrupting: bob };
//! let conclusion = case.negotiate(&Options::default());
//!
//! // Bob offers first: to Alice "elderly" is worth 2, her own offer 4 + 3. Rejected. Alice
//! // discloses her child: to Bob that is worth 5, his own offer 4. Accepted.
//! assert_eq!(conclusion.outcome, Outcome::Agreement(Side::Current));
//! assert_eq!(conclusion.rounds, 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! To watch it round by round, [`step`](Negotiation::step) a [`Case::negotiation`], or give
//! [`run`](Negotiation::run) an [`Observer`]; [`Case::decide`] adds the fallback. The
//! caller owns all memory; lists may be up to [`MAX_ITEMS`] long.
//!
//! # Where the paper's parts are
//!
//! | paper | here |
//! | --- | --- |
//! | ethical profile, user status | [`EthicalProfile`], [`Status`] |
//! | disposition activation, ethical implication | [`Activation`], [`Implication`] |
//! | offer generator | [`Party::offer`] |
//! | ethical impact analyzer, utility function | [`Party::judge`], [`Weighing`] |
//! | negotiation engine | [`Negotiation`] |
//! | multi-lateral policy | [`policy::published`] |
//!
//! # Cost
//!
//! A negotiation of users with `a` and `c` offers (true conditions, and one more for
//! willingness) takes at most `a + c + 2` rounds.
//! Each condition is weighed once a receiver, in time linear in its activation row; under
//! [`Aggregation::PerDisposition`] also in the conditions disclosed before it, since there
//! is no memory to note them in. [`Activation::new`] is quadratic in the length of a row.
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::arithmetic_side_effects)]

mod decision;
mod impact;
mod observer;
mod options;
mod outcome;
pub mod party;
pub mod policy;
mod protocol;
mod rules;
mod user;
mod welfare;

pub use decision::{Case, Decision};
pub use impact::Impact;
pub use observer::{Disclosure, Observer, Ruling, Surplus, Weighing};
pub use options::{Aggregation, Fallback, Options, QuitRule, TieRule, UnknownName};
pub use outcome::{Conclusion, Ending, Outcome, Side};
pub use party::{Current, Interrupting, Offer, Party, Verdict};
pub use protocol::{Negotiation, Step, Turn};
pub use rules::{Activation, Condition, Disposition, Implication, MAX_ITEMS, RulesError};
pub use user::{EthicalProfile, Rank, Status, TooManyConditions, User};
pub use welfare::{Welfare, impact_of_serving};
