//! What people are called: by name where the trace tells it, else by pseudonym.

use std::collections::BTreeMap;

use crate::trace::Recording;

/// Names of users, goals and emergencies.
#[derive(Clone, Debug, Default)]
pub struct Who {
    users: BTreeMap<u32, String>,
    goals: Vec<String>,
    emergencies: Vec<String>,
}

impl Who {
    /// The names in a recording.
    #[must_use]
    pub fn of(recording: &Recording) -> Self {
        let mut users: BTreeMap<u32, String> = BTreeMap::new();
        for participant in &recording.participants {
            let name = if participant.name.is_empty() { &participant.person } else { &participant.name };
            if !name.is_empty() {
                users.insert(participant.user, name.clone());
            }
        }
        let specification = recording.header.specification.as_ref();
        let goals = specification.map(|specification| &specification.goals);
        let emergencies = specification.map(|specification| &specification.emergencies);
        Self {
            users,
            goals: goals.into_iter().flatten().map(|goal| goal.name.clone()).collect(),
            emergencies: emergencies.into_iter().flatten().map(|known| known.name.clone()).collect(),
        }
    }

    /// A user, in the midst of a sentence.
    #[must_use]
    pub fn user(&self, pseudonym: u32) -> String {
        self.users.get(&pseudonym).cloned().unwrap_or_else(|| format!("user {pseudonym}"))
    }

    /// A user, at the begin of a sentence.
    #[must_use]
    pub fn user_first(&self, pseudonym: u32) -> String {
        self.users.get(&pseudonym).cloned().unwrap_or_else(|| format!("User {pseudonym}"))
    }

    /// Whether anybody is known by name.
    #[must_use]
    pub fn knows_names(&self) -> bool {
        !self.users.is_empty()
    }

    /// A goal, by its number.
    #[must_use]
    pub fn goal(&self, goal: u32) -> String {
        named(&self.goals, goal).unwrap_or_else(|| format!("goal {goal}"))
    }

    /// An emergency category, by its number.
    #[must_use]
    pub fn emergency(&self, category: u32) -> String {
        named(&self.emergencies, category).unwrap_or_else(|| format!("emergency of category {category}"))
    }
}

fn named(names: &[String], number: u32) -> Option<String> {
    let name = names.get(usize::try_from(number).ok()?)?;
    (!name.is_empty()).then(|| name.clone())
}
