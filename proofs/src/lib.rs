//! Every property of the self-negotiation protocol, stated once, and the engines that
//! check it.
//!
//! A property is a function of an engine, a case and a variant of the protocol
//! ([`property::Property`]); what is expected of it under each variant is a table of rules
//! with reasons ([`expected`](expected::expected)). The exhaustive sweep of whole domains
//! ([`mod@sweep`]), literal enumeration of small ones ([`enumeration`]), random search over
//! large users ([`random`]) and Kani ([`harness`]) call the same functions, and [`report`]
//! says what came of it.
//!
//! ```
//! use selfneg_core::{Options, TieRule};
//! use selfneg_proofs::engine::Core;
//! use selfneg_proofs::expected::Verdict;
//! use selfneg_proofs::property::Property;
//! use selfneg_proofs::report::{Method, verify};
//!
//! // "Swapping who interrupts leaves the agreed winner unchanged": false as published.
//! let report = verify(Property::RoleSymmetry, &Options::default(), &Core, Method::Enumeration);
//! assert_eq!(report.verdict, Verdict::Fails);
//! let counterexample = report.counterexample.expect("what refutes it");
//! assert_eq!(counterexample.users.iter().map(|user| user.conditions.len()).sum::<usize>(), 2);
//!
//! // With a tie rule that does not look at who interrupts, it holds.
//! let options = Options { tie: TieRule::Surplus, ..Options::default() };
//! let report = verify(Property::RoleSymmetry, &options, &Core, Method::Enumeration);
//! assert_eq!((report.verdict, report.failing), (Verdict::Holds, Some(0)));
//! ```
//!
//! The crate's README has the whole table, over which domains it was established, and what
//! has never been run.

pub mod case;
#[cfg(not(kani))]
pub mod counterexample;
pub mod engine;
#[cfg(not(kani))]
pub mod enumeration;
pub mod expected;
pub mod harness;
#[cfg(not(kani))]
pub mod kani_log;
pub mod measure;
pub mod property;
#[cfg(not(kani))]
pub mod random;
#[cfg(not(kani))]
pub mod report;
#[cfg(not(kani))]
pub mod shrink;
#[cfg(not(kani))]
pub mod sweep;
pub mod transcript;
pub mod variant;
