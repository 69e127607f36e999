//! What is true of the self-negotiation protocol, and the engines that check it.

pub mod sweep;
