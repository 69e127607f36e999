//! Every property of the self-negotiation protocol, stated once.

pub mod case;
pub mod engine;
pub mod measure;
pub mod property;
pub mod transcript;
pub mod counterexample;
pub mod variant;
#[cfg(not(kani))]
pub mod enumeration;
