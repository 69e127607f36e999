//! What would have changed a decision: the smallest change to what the users are, rank or
//! came as, by which the robot would have served somebody else.
//!
//! Found by trying: every single change is made and the case is decided again by
//! [`precedence::decide`](crate::precedence::decide), so each answer is itself a decision,
//! and *no single change* means that all of them were tried. The single changes are
//!
//! - **withheld**: one true condition of one user is not true, or withheld;
//! - **added**: one condition that the rules list and that is not true of a user is true. It is
//!   disclosed last if that suffices, else as late as suffices: every place is tried;
//! - **rank**: one user ranks one disposition higher or lower, anywhere on the
//!   [scale](Counterfactuals::scale);
//! - **order**: the current user and one interrupter come in each other's place.
//!
//! A change is smaller than another if it consists of fewer single changes; if of as many, if
//! the sum of their [sizes](Edit::size) is less (a rank counts each step, everything else 1);
//! if that is equal too, by the order of [`Kind`], then of arrival, then of the rules.
//!
//! If no single change of anybody's data does it, two at a time are tried, withheld, added
//! (disclosed last only) and rank, the smaller sums first, up to [`MAX_PAIRS`] pairs.

mod edit;
mod pairs;

use selfneg_core::{Disposition, Options, Rank};

pub use edit::{Edit, Kind};
pub use pairs::{MAX_PAIRS, Pairs};

use crate::binding::{BoundRules, BoundUser, END_OF_GOAL};
use crate::precedence::{Policy, PrecedenceError, decide};

/// The paper's highest rank: the scale of a case reaches at least so far.
const PAPERS_HIGHEST: u8 = 5;

/// What was decided among whom.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// The robot's rules.
    pub rules: &'a BoundRules,
    /// Everybody who took part, by arrival, the current user first.
    pub users: &'a [BoundUser],
    /// The protocol variant in force, with the current user's willingness.
    pub options: Options,
    /// The policy in force.
    pub policy: Policy,
}

/// A change that changes whom the robot serves.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Counterfactual {
    /// The sum of the sizes of its edits.
    pub size: u64,
    /// One, or two of different things.
    pub edits: Vec<Edit>,
    /// Whom the robot would then serve, by real arrival.
    pub served: usize,
    /// Whether by agreement; otherwise by the fallback.
    pub agreement: bool,
}

/// What would have changed a decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counterfactuals {
    /// Whom the robot serves as things are.
    pub served: usize,
    /// Ranks from 0 to this were tried: 5, or the highest that a user of the case has.
    pub scale: u8,
    /// All single changes that change whom the robot serves, the smallest first: for each
    /// condition of each user one, for each rank the nearest that does it.
    pub single: Vec<Counterfactual>,
    /// Of two at a time.
    pub pairs: Pairs,
    /// How many changed cases were decided, pairs included.
    pub decided: u64,
}

impl Counterfactuals {
    /// Finds them.
    ///
    /// # Errors
    /// [`PrecedenceError`] if the case itself cannot be decided.
    pub fn of(question: &Question<'_>) -> Result<Self, PrecedenceError> {
        Self::with_at_most(question, MAX_PAIRS)
    }

    /// The same with another limit on the number of pairs that are tried.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn with_at_most(question: &Question<'_>, pairs: u64) -> Result<Self, PrecedenceError> {
        let mut trial = Trial::new(question)?;
        let mut single = Vec::new();
        for user in 0..question.users.len() {
            single.extend(trial.withheld(user)?);
            single.extend(trial.added(user)?);
            single.extend(trial.ranked(user)?);
        }
        let data = !single.is_empty();
        for with in 1..question.users.len() {
            single.extend(trial.first_of([Edit::Order { with }])?);
        }
        single.sort_by_key(key);
        let pairs = if data { Pairs::NotNeeded } else { trial.pairs(pairs)? };
        Ok(Self { served: trial.served, scale: trial.scale, single, pairs, decided: trial.decided })
    }

    /// What this user alone could have changed by other data, so that the robot would have
    /// served the user; or, if it did serve the user, somebody else. No pairs, no order.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn by_own_data(question: &Question<'_>, user: usize) -> Result<Self, PrecedenceError> {
        let mut trial = Trial::new(question)?;
        trial.wanted = (trial.served != user).then_some(user);
        let mut single = trial.withheld(user)?;
        single.extend(trial.added(user)?);
        single.extend(trial.ranked(user)?);
        single.sort_by_key(key);
        Ok(Self {
            served: trial.served,
            scale: trial.scale,
            single,
            pairs: Pairs::NotNeeded,
            decided: trial.decided,
        })
    }

    /// The smallest change of all, if one was found.
    #[must_use]
    pub fn smallest(&self) -> Option<&Counterfactual> {
        self.single.first().or(match &self.pairs {
            Pairs::Found(found) => Some(found),
            Pairs::NotNeeded | Pairs::NoneOf { .. } | Pairs::NoneOfTheFirst { .. } => None,
        })
    }

    /// The single changes of one kind, the smallest first; of one user's data, or of
    /// anybody's.
    pub fn of_kind(&self, kind: Kind, user: Option<usize>) -> impl Iterator<Item = &Counterfactual> {
        self.single.iter().filter(move |found| {
            found.edits.iter().all(|edit| edit.kind() == kind && (user.is_none() || edit.user() == user))
        })
    }
}

/// Which of two single changes is the smaller.
fn key(found: &Counterfactual) -> (u64, Option<(Kind, Edit)>) {
    (found.size, found.edits.first().map(|edit| (edit.kind(), *edit)))
}

/// Decides changed cases and counts them.
struct Trial<'a> {
    question: Question<'a>,
    served: usize,
    /// Whom a change is to have served; `None`: anybody else.
    wanted: Option<usize>,
    scale: u8,
    decided: u64,
}

impl<'a> Trial<'a> {
    fn new(question: &Question<'a>) -> Result<Self, PrecedenceError> {
        let served = decide(question.rules, question.users, question.options, question.policy)?.served;
        let ranks = question.users.iter().flat_map(BoundUser::ranks).map(|rank| rank.0);
        let scale = ranks.max().unwrap_or(0).max(PAPERS_HIGHEST);
        Ok(Self { question: *question, served, wanted: None, scale, decided: 0 })
    }

    /// What comes of all these changes together, if it is what is looked for.
    fn changed(&mut self, edits: &[Edit]) -> Result<Option<Counterfactual>, PrecedenceError> {
        self.decided = self.decided.saturating_add(1);
        let Question { rules, options, policy, .. } = self.question;
        let mut users = self.question.users.to_vec();
        for edit in edits {
            edit.apply(&mut users);
        }
        let decision = decide(rules, &users, options, policy)?;
        let served = edits.iter().rev().fold(decision.served, |place, edit| edit.who_is_at(place));
        let changed = self.wanted.map_or(served != self.served, |wanted| served == wanted);
        Ok(changed.then(|| Counterfactual {
            size: edits.iter().map(|edit| edit.size()).sum(),
            edits: edits.to_vec(),
            served,
            agreement: decision.agreement.is_some(),
        }))
    }

    /// The first of these that changes the decision.
    fn first_of(
        &mut self,
        edits: impl IntoIterator<Item = Edit>,
    ) -> Result<Option<Counterfactual>, PrecedenceError> {
        for edit in edits {
            if let Some(found) = self.changed(&[edit])? {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// For each true condition.
    fn withheld(&mut self, user: usize) -> Result<Vec<Counterfactual>, PrecedenceError> {
        let mut found = Vec::new();
        for edit in withholdings(self.question, user) {
            found.extend(self.first_of([edit])?);
        }
        Ok(found)
    }

    /// For each condition that could be true: disclosed as late as possible.
    fn added(&mut self, user: usize) -> Result<Vec<Counterfactual>, PrecedenceError> {
        let places = self.question.users.get(user).map_or(0, |user| user.conditions().len());
        let mut found = Vec::new();
        for edit in additions(self.question, user) {
            let Edit::Added { condition, .. } = edit else { continue };
            let earlier = (0..places).rev().map(|place| Edit::Added { user, condition, before: Some(place) });
            found.extend(self.first_of(std::iter::once(edit).chain(earlier))?);
        }
        Ok(found)
    }

    /// For each disposition: the nearest rank.
    fn ranked(&mut self, user: usize) -> Result<Vec<Counterfactual>, PrecedenceError> {
        let mut found = Vec::new();
        for (disposition, from) in ranks(self.question, user) {
            found.extend(self.first_of(others(user, disposition, from, self.scale))?);
        }
        Ok(found)
    }
}

/// A user's true conditions, each withheld.
fn withholdings<'a>(question: Question<'a>, user: usize) -> impl Iterator<Item = Edit> + 'a {
    let conditions = question.users.get(user).map_or(&[][..], |user| user.conditions());
    conditions.iter().map(move |&condition| Edit::Withheld { user, condition })
}

/// The rules' conditions that are not true of a user, each disclosed last.
fn additions<'a>(question: Question<'a>, user: usize) -> impl Iterator<Item = Edit> + 'a {
    let rules = question.rules;
    let present = question.users.get(user).map_or(&[][..], |user| user.conditions());
    // What stands for willingness is the robot's to measure, and no condition.
    let is_condition = |name: &str| name != END_OF_GOAL || rules.activates(name);
    rules
        .listed()
        .filter(move |condition| {
            !present.contains(condition) && is_condition(rules.condition_name(*condition))
        })
        .map(move |condition| Edit::Added { user, condition, before: None })
}

/// A user's ranks.
fn ranks<'a>(question: Question<'a>, user: usize) -> impl Iterator<Item = (Disposition, Rank)> + 'a {
    let ranks = question.users.get(user).map_or(&[][..], |user| user.ranks());
    (0..=u16::MAX).map(Disposition).zip(ranks.iter().copied())
}

/// All other ranks on the scale, the nearest first; of two that are as near, the higher.
fn others(user: usize, disposition: Disposition, from: Rank, scale: u8) -> impl Iterator<Item = Edit> {
    (1..=scale).flat_map(move |step| {
        let higher = from.0.checked_add(step).filter(|&to| to <= scale);
        let lower = from.0.checked_sub(step);
        let to = move |to| Edit::Rank { user, disposition, from, to: Rank(to) };
        higher.into_iter().chain(lower).map(to)
    })
}
