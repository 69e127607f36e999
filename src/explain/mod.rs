//! A trace's decisions explained to people: why was Bob made to wait?
//!
//! Three levels, and what a value of each type can hold is what that level may say:
//!
//! - [`PublicDecision`]: for anybody. Pseudonyms, how the negotiations ended, by which rule,
//!   and whether the decision, made again, is the same; read off the open records.
//! - [`OwnDecision`]: for one user. That user's own data, and of the others no more than their
//!   side's verdicts.
//! - [`AuditorDecision`]: everything, with what would have changed the decision
//!   ([`counterfactual`](crate::counterfactual)) and how much was disclosed for it
//!   ([`disclosure`](crate::disclosure)).
//!
//! ```no_run
//! use selfneg::explain::{Audience, explain};
//! use selfneg::trace::open;
//!
//! let opened = open(&std::fs::read("trace.mcap")?, &[])?;
//! for decision in explain(&opened.recording, Audience::Public, None)? {
//!     println!("{}", decision.told().text());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Each is a typed value that holds its sentences too ([`Told`]), so that it can be printed,
//! written as JSON or laid out on a page. `docs/explain.md` says what each level leaves out and
//! why.

mod auditor;
mod auditor_text;
mod error;
mod open;
mod own;
mod public;
mod reason;
mod told;

use std::fmt;
use std::str::FromStr;

use selfneg_core::UnknownName;
use serde::Serialize;

pub use auditor::{
    AuditorDecision, Change, Changed, DisclosedBySide, OwnWay, Participant, Transcript, TranscriptRound,
    Welfare, WhatIf,
};
pub use error::ExplainError;
pub use open::{Basis, Bilateral, Emergency, Negotiated, OpenDecision, OtherOrder};
pub use own::{OwnChanges, OwnDecision, OwnPart};
pub use public::PublicDecision;
pub use told::{Section, Told};

use crate::audit::{Redecided, redecided};
use crate::case::{Case, NegotiatedCase};
use crate::trace::schema::evidence::event::Event;
use crate::trace::{Recording, Step};

/// For whom.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// Anybody.
    Public,
    /// One user.
    User,
    /// The auditor.
    Auditor,
}

impl Level {
    /// All three, the least first.
    pub const ALL: [Self; 3] = [Self::Public, Self::User, Self::Auditor];

    /// `public`, `user` or `auditor`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Public => "public",
            Self::User => "user",
            Self::Auditor => "auditor",
        }
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Level {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        Self::ALL.into_iter().find(|level| level.name() == name).ok_or(UnknownName)
    }
}

/// For whom, and if for a user, for which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Audience {
    /// Anybody.
    Public,
    /// The user of this pseudonym.
    User(u32),
    /// The auditor.
    Auditor,
}

impl Audience {
    /// Its level.
    #[must_use]
    pub const fn level(self) -> Level {
        match self {
            Self::Public => Level::Public,
            Self::User(_) => Level::User,
            Self::Auditor => Level::Auditor,
        }
    }
}

/// One decision explained at one level.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Explained {
    /// For anybody.
    Public(PublicDecision),
    /// For one user.
    User(OwnDecision),
    /// For the auditor.
    Auditor(Box<AuditorDecision>),
}

impl Explained {
    /// The sentences.
    #[must_use]
    pub fn told(&self) -> &Told {
        match self {
            Self::Public(decision) => &decision.told,
            Self::User(decision) => &decision.told,
            Self::Auditor(decision) => &decision.told,
        }
    }

    /// Whether the decision is not the one that the recorded rules give.
    #[must_use]
    pub fn is_wrong(&self) -> bool {
        let redecided = match self {
            Self::Public(decision) => decision.redecided,
            Self::User(decision) => decision.redecided,
            Self::Auditor(decision) => decision.redecided,
        };
        redecided == Redecided::Differs
    }
}

/// Explains the decisions of a trace, or the one of this number (from 1). For a user: those
/// that concern the user.
///
/// # Errors
/// [`ExplainError`] if there is no such decision or user, the decision does not concern the
/// user, or the level needs a personal part that is not there or cannot be read.
pub fn explain(
    recording: &Recording,
    audience: Audience,
    decision: Option<u64>,
) -> Result<Vec<Explained>, ExplainError> {
    if audience != Audience::Public && recording.rules.is_none() {
        return Err(ExplainError::NothingPersonal { level: audience.level() });
    }
    let cases = recording.cases();
    let there = cases.len();
    let wanted: Vec<&Case> =
        cases.iter().filter(|case| decision.is_none_or(|number| case.decision() == number)).collect();
    if let (Some(asked), []) = (decision, wanted.as_slice()) {
        return Err(ExplainError::NoSuchDecision { asked, there });
    }
    if let Audience::User(user) = audience {
        let known = users(recording);
        if !known.contains(&user) {
            return Err(ExplainError::NoSuchUser { asked: user.to_string(), known });
        }
    }
    let explained: Vec<Explained> =
        wanted.into_iter().filter_map(|case| explain_case(recording, case, audience)).collect();
    match (explained.as_slice(), decision, audience) {
        ([], Some(decision), Audience::User(user)) => Err(ExplainError::NotConcerned { user, decision }),
        _ => Ok(explained),
    }
}

/// The pseudonym that somebody means by `2`, `user-2`, `user 2` or, where names can be read, by
/// a name.
///
/// # Errors
/// [`ExplainError`] if nobody is called so, or several people are.
pub fn pseudonym(recording: &Recording, asked: &str) -> Result<u32, ExplainError> {
    let named: Vec<u32> =
        recording.participants.iter().filter(|who| who.name == asked).map(|who| who.user).collect();
    match named.as_slice() {
        [one] => return Ok(*one),
        [] => {}
        several => {
            return Err(ExplainError::SeveralUsers { asked: asked.to_owned(), known: several.to_vec() });
        }
    }
    let known = users(recording);
    let number = asked.strip_prefix("user").map_or(asked, |rest| rest.trim_start_matches(['-', ' ']));
    let found = number.parse().ok().filter(|user| known.contains(user));
    found.ok_or_else(|| ExplainError::NoSuchUser { asked: asked.to_owned(), known })
}

/// Everybody whom the trace says to take part, or who asked for something.
fn users(recording: &Recording) -> Vec<u32> {
    let mut users = recording.header.participants.clone();
    users.extend(recording.entries.iter().filter_map(|entry| match &entry.step {
        Step::Event { open, .. } => match &open.event {
            Some(Event::Request(request)) => Some(request.user),
            _ => None,
        },
        Step::Reply { .. } => None,
    }));
    users.sort_unstable();
    users.dedup();
    users
}

fn explain_case(recording: &Recording, case: &Case, audience: Audience) -> Option<Explained> {
    let open = OpenDecision::of(recording, case);
    let negotiated: Option<&NegotiatedCase> = match case {
        Case::Negotiated(case) => Some(case),
        Case::Emergency(_) => None,
    };
    let redecided = match case {
        Case::Negotiated(case) => redecided(case),
        Case::Emergency(emergency) if emergency.certain => Redecided::Same,
        Case::Emergency(_) => Redecided::Differs,
    };
    let recorded = negotiated.map(|case| &case.recorded);
    let inputs = negotiated.and_then(|case| case.inputs.as_ref().ok());
    match audience {
        Audience::Public => Some(Explained::Public(PublicDecision::new(open, redecided))),
        Audience::User(user) => {
            let concerned = open.served == Some(user) || open.waiting.contains(&user);
            let source = own::Source { open: &open, redecided, recorded, inputs, user };
            concerned.then(|| Explained::User(OwnDecision::new(&source)))
        }
        Audience::Auditor => {
            let name = |user: u32| {
                let known = recording.participants.iter().find(|who| who.user == user);
                known.map_or_else(|| format!("user {user}"), |who| who.name.clone())
            };
            let emergency = match &open.basis {
                Basis::Emergency(emergency) => emergency_name(recording, emergency.category),
                Basis::Negotiated(_) => None,
            };
            Some(Explained::Auditor(Box::new(AuditorDecision::new(auditor::Source {
                open,
                redecided,
                recorded,
                inputs,
                again: inputs.and_then(|inputs| inputs.decide().ok()),
                unreadable: negotiated.and_then(|case| case.inputs.as_ref().err()).map(ToString::to_string),
                emergency,
                names: &name,
            }))))
        }
    }
}

fn emergency_name(recording: &Recording, category: u32) -> Option<String> {
    let specification = recording.header.specification.as_ref()?;
    let category = specification.emergencies.get(usize::try_from(category).ok()?)?;
    (!category.name.is_empty()).then(|| category.name.clone())
}
