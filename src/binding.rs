//! From names to the engine's indices, and back.

use indexmap::{IndexMap, IndexSet};
use selfneg_core::{
    Condition, Disposition, EthicalProfile, Implication, MAX_ITEMS, Rank, Status, TooManyConditions,
};

use crate::input::{InputError, Rules, User};

/// The condition that stands for willingness to be interrupted in the published folders.
/// It is special only where no rule activates anything by it.
pub const END_OF_GOAL: &str = "end of goal";

/// Where a user's goal comes from.
#[derive(Clone, Debug)]
pub enum GoalChoice {
    /// The user's own `goal.json`.
    OwnFile,
    /// This goal, whatever the file says; `origin` names the option for messages.
    Instead {
        /// The goal.
        goal: String,
        /// Who says so.
        origin: String,
    },
}

/// Rules by index. Users of one decision are bound to the same rules, which learn the
/// conditions that only users name.
#[derive(Clone, Debug)]
pub struct BoundRules {
    dispositions: IndexSet<String>,
    conditions: IndexSet<String>,
    activation: Vec<Vec<Disposition>>,
    implications: IndexMap<String, Vec<u8>>,
    source: Rules,
}

/// A user by index.
#[derive(Clone, Debug)]
pub struct BoundUser {
    /// The user's name.
    pub name: String,
    /// The goal that the user wants.
    pub goal: String,
    /// Whether the status says "end of goal": true, which is willingness 1 of the
    /// current user and nothing else.
    pub end_of_goal: bool,
    ranks: Vec<Rank>,
    conditions: Vec<Condition>,
    mentions: Vec<u8>,
}

impl BoundRules {
    /// Gives every disposition and condition of the rules an index.
    ///
    /// # Errors
    /// [`InputError::TooMany`] beyond the engine's limits.
    pub fn new(rules: Rules) -> Result<Self, InputError> {
        let mut dispositions = IndexSet::new();
        let mut conditions = IndexSet::new();
        let mut activation = Vec::new();
        let mut implications = IndexMap::new();
        for (condition, activated) in &rules.activation {
            conditions.insert(condition.clone());
            let row: IndexSet<Disposition> = activated
                .iter()
                .map(|name| index(&mut dispositions, name).map(Disposition))
                .collect::<Option<_>>()
                .ok_or_else(|| too_many(&rules.activation_file, "dispositions"))?;
            activation.push(row.into_iter().collect());
        }
        for (goal, implied) in &rules.implications {
            let mut mentions: Vec<u8> = Vec::new();
            for name in implied {
                let at = index(&mut dispositions, name)
                    .ok_or_else(|| too_many(&rules.implications_file, "dispositions"))?;
                let at = usize::from(at);
                if mentions.len() <= at {
                    mentions.resize(at.saturating_add(1), 0);
                }
                if let Some(count) = mentions.get_mut(at) {
                    *count = count.checked_add(1).ok_or_else(|| InputError::TooMany {
                        file: rules.implications_file.clone(),
                        what: "mentions of a disposition under one goal",
                        limit: usize::from(u8::MAX),
                    })?;
                }
            }
            implications.insert(goal.clone(), mentions);
        }
        if conditions.len() > MAX_ITEMS {
            return Err(too_many(&rules.activation_file, "conditions"));
        }
        Ok(Self { dispositions, conditions, activation, implications, source: rules })
    }

    /// Gives a user's conditions and ranks their indices.
    ///
    /// # Errors
    /// [`InputError`] if the goal is not listed or missing, or there are more conditions
    /// than the engine takes.
    pub fn bind(&mut self, user: &User, goal: &GoalChoice) -> Result<BoundUser, InputError> {
        let (goal, origin) = match (goal, &user.goal) {
            (GoalChoice::Instead { goal, origin }, _) => (goal.clone(), origin.clone()),
            (GoalChoice::OwnFile, Some(goal)) => (goal.clone(), user.files.goal.display().to_string()),
            (GoalChoice::OwnFile, None) => {
                return Err(InputError::NoGoal { file: user.files.goal.clone() });
            }
        };
        let Some(mentions) = self.implications.get(&goal).cloned() else {
            return Err(InputError::UnlistedGoal {
                origin,
                goal,
                file: self.source.implications_file.clone(),
                known: self.source.goals(),
            });
        };
        let mut end_of_goal = false;
        let mut conditions = Vec::new();
        for name in user.true_conditions() {
            if name == END_OF_GOAL && !self.activates(name) {
                end_of_goal = true;
                continue;
            }
            let at = index(&mut self.conditions, name)
                .ok_or_else(|| too_many(&user.files.status, "conditions"))?;
            conditions.push(Condition(at));
        }
        let mut ranks = vec![Rank(0); self.dispositions.len()];
        for (name, rank) in &user.profile {
            if let Some(slot) = self.dispositions.get_index_of(name).and_then(|at| ranks.get_mut(at)) {
                *slot = *rank;
            }
        }
        Ok(BoundUser { name: user.name.clone(), goal, end_of_goal, ranks, conditions, mentions })
    }

    /// Learns a condition that only a user names; `None` beyond the engine's limit.
    pub(crate) fn learn(&mut self, condition: &str) -> Option<Condition> {
        index(&mut self.conditions, condition).map(Condition)
    }

    /// Whether the rules activate anything by this condition.
    #[must_use]
    pub fn activates(&self, condition: &str) -> bool {
        let row = self.conditions.get_index_of(condition).and_then(|at| self.activation.get(at));
        row.is_some_and(|row| !row.is_empty())
    }

    /// The index of a condition that the rules, or a user bound to them, have named.
    #[must_use]
    pub fn condition(&self, name: &str) -> Option<Condition> {
        let at = self.conditions.get_index_of(name)?;
        u16::try_from(at).ok().map(Condition)
    }

    /// The index of a disposition that the rules name.
    #[must_use]
    pub fn disposition(&self, name: &str) -> Option<Disposition> {
        let at = self.dispositions.get_index_of(name)?;
        u16::try_from(at).ok().map(Disposition)
    }

    /// How many dispositions the rules name.
    #[must_use]
    pub fn dispositions(&self) -> usize {
        self.dispositions.len()
    }

    /// How many conditions the rules, or users bound to them, have named.
    #[must_use]
    pub fn conditions(&self) -> usize {
        self.conditions.len()
    }

    /// For a listed goal: how often it names each disposition, for
    /// [`Implication::new`](selfneg_core::Implication::new).
    #[must_use]
    pub fn mentions(&self, goal: &str) -> Option<&[u8]> {
        self.implications.get(goal).map(Vec::as_slice)
    }

    /// The condition's name.
    #[must_use]
    pub fn condition_name(&self, condition: Condition) -> &str {
        self.conditions.get_index(usize::from(condition.0)).map_or("?", String::as_str)
    }

    /// The disposition's name.
    #[must_use]
    pub fn disposition_name(&self, disposition: Disposition) -> &str {
        self.dispositions.get_index(usize::from(disposition.0)).map_or("?", String::as_str)
    }

    /// The conditions that the rules themselves list, in their order; users may name more.
    pub fn listed(&self) -> impl Iterator<Item = Condition> {
        (0..=u16::MAX).map(Condition).take(self.activation.len())
    }

    /// The rows of the activation, for [`Activation::new`](selfneg_core::Activation::new).
    #[must_use]
    pub fn rows(&self) -> Vec<&[Disposition]> {
        self.activation.iter().map(Vec::as_slice).collect()
    }
}

impl BoundUser {
    /// A user whose ranks, conditions and goal are by index already.
    pub(crate) fn from_parts(
        name: String,
        goal: String,
        ranks: Vec<Rank>,
        conditions: Vec<Condition>,
        mentions: Vec<u8>,
    ) -> Self {
        Self { name, goal, end_of_goal: false, ranks, conditions, mentions }
    }

    /// The true conditions in their order of disclosure, "end of goal" left out.
    #[must_use]
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// The user's ranks in the active context, one for each disposition of the rules.
    #[must_use]
    pub fn ranks(&self) -> &[Rank] {
        &self.ranks
    }

    /// How often the user's goal names this disposition.
    #[must_use]
    pub fn mentions(&self, disposition: Disposition) -> u8 {
        Implication::new(&self.mentions).mentions(disposition)
    }

    /// The same user with these true conditions, disclosed in this order.
    #[must_use]
    pub fn with_conditions(&self, conditions: Vec<Condition>) -> Self {
        Self { conditions, ..self.clone() }
    }

    /// The same user, ranking one disposition so; unchanged if the profile has no place for
    /// the disposition.
    #[must_use]
    pub fn with_rank(&self, disposition: Disposition, rank: Rank) -> Self {
        let mut user = self.clone();
        if let Some(slot) = user.ranks.get_mut(usize::from(disposition.0)) {
            *slot = rank;
        }
        user
    }

    /// The engine's view of the user.
    ///
    /// # Errors
    /// [`TooManyConditions`]; not for a user that [`BoundRules::bind`] made.
    pub fn user(&self) -> Result<selfneg_core::User<'_>, TooManyConditions> {
        Ok(selfneg_core::User::new(
            EthicalProfile::new(&self.ranks),
            Status::new(&self.conditions)?,
            Implication::new(&self.mentions),
        ))
    }
}

/// The index of `name`, which is added if new; `None` beyond the engine's limit.
fn index(names: &mut IndexSet<String>, name: &str) -> Option<u16> {
    let at = match names.get_index_of(name) {
        Some(at) => at,
        None => names.insert_full(name.to_owned()).0,
    };
    u16::try_from(at).ok().filter(|&at| usize::from(at) < MAX_ITEMS)
}

fn too_many(file: &std::path::Path, what: &'static str) -> InputError {
    InputError::TooMany { file: file.to_owned(), what, limit: MAX_ITEMS }
}
