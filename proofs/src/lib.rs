//! Every property of the self-negotiation protocol, stated once.

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
pub mod transcript;
pub mod variant;
