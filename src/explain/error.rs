//! Why something cannot be explained.

use super::Level;

/// Why something cannot be explained.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExplainError {
    /// There is no decision of that number.
    #[error("decision {asked}: {}", expected_decision(*there))]
    NoSuchDecision {
        /// The number.
        asked: u64,
        /// How many there are.
        there: usize,
    },
    /// The personal part is not there or cannot be read.
    #[error(
        "the level {level} needs the personal part of the trace, which it does not hold; expected --level public"
    )]
    NothingPersonal {
        /// The level.
        level: Level,
    },
    /// The personal part is sealed, and no key fits.
    #[error(
        "the level {level} needs the personal part of the trace, which is sealed{}; expected --identity with a private key that fits",
        sealed_to(recipients)
    )]
    Locked {
        /// The level.
        level: Level,
        /// To whom it is sealed, as far as the trace says.
        recipients: Vec<String>,
    },
    /// Nobody is called so.
    #[error("no user {asked:?} in the trace; expected one of {}", numbers(known))]
    NoSuchUser {
        /// What was asked for.
        asked: String,
        /// The pseudonyms there are.
        known: Vec<u32>,
    },
    /// Several people are called so.
    #[error("{asked:?} is the name of several users; expected one of {}", numbers(known))]
    SeveralUsers {
        /// What was asked for.
        asked: String,
        /// Their pseudonyms.
        known: Vec<u32>,
    },
    /// The user has nothing to do with it.
    #[error("decision {decision} does not concern user {user}")]
    NotConcerned {
        /// The pseudonym.
        user: u32,
        /// The number.
        decision: u64,
    },
}

fn expected_decision(there: usize) -> String {
    match there {
        0 => "the trace has no decision".to_owned(),
        1 => "the trace has one decision, expected 1".to_owned(),
        there => format!("the trace has {there} decisions, expected a number from 1 to {there}"),
    }
}

fn sealed_to(recipients: &[String]) -> String {
    if recipients.is_empty() { String::new() } else { format!(" to {}", recipients.join(", ")) }
}

fn numbers(users: &[u32]) -> String {
    let users: Vec<String> = users.iter().map(u32::to_string).collect();
    users.join(", ")
}
