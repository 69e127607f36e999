//! What a decision is measured against: optimal precedence with exact certificates, the worst
//! case of regret over all real-valued ranks, and, among many users, who beats whom.
//!
//! | module | job |
//! | --- | --- |
//! | [`exact`] | linear programmes solved by Clarabel and certified in rationals |
//! | [`lottery`], [`order`] | whom to serve first, and in which order |
//! | [`Regret`] | what a decision lost, and what lost it |
//! | [`protocol_graph`], [`worst_case`] | every way a negotiation can go, and the most it can lose |
//! | [`BeatsGraph`], [`Condorcet`] | who beats whom, and the policy that follows from it |
//! | [`drawing`] | both graphs as DOT and SVG |
//!
//! # The policy `condorcet`
//!
//! ```
//! use selfneg_core::{Outcome, Side};
//! use selfneg_model::{Condorcet, Precedence};
//!
//! // Three users, 0 the current one. Each beats the next: a cycle.
//! let outcome = |earlier: usize, later: usize| match (earlier, later) {
//!     (0, 1) | (1, 2) => Outcome::Agreement(Side::Current),
//!     _ => Outcome::Agreement(Side::Interrupting),
//! };
//! let condorcet = Condorcet::negotiate(3, outcome);
//! assert_eq!(condorcet.precedence(), Precedence::NoAgreement { candidates: vec![0, 1, 2] });
//!
//! // Had user 2 not beaten user 0, user 0 would beat nobody but 1, and nobody would beat 0.
//! let condorcet = Condorcet::negotiate(3, |earlier, later| match (earlier, later) {
//!     (0, 2) => Outcome::NoAgreement,
//!     pair => outcome(pair.0, pair.1),
//! });
//! assert_eq!(condorcet.precedence(), Precedence::NoAgreement { candidates: vec![0] });
//! ```
#![forbid(unsafe_code)]

mod beats;
mod condorcet;
pub mod drawing;
pub mod exact;
mod impacts;
pub mod lottery;
pub mod order;
pub mod protocol_graph;
mod regret;
mod welfare;
pub mod worst_case;

pub use beats::BeatsGraph;
pub use condorcet::{Condorcet, Precedence};
pub use impacts::Impacts;
pub use regret::{Cause, Decided, Regret};
pub use welfare::{most_welfare, welfare};
