//! One user's managers without a mission: what the mission's memory held of a user, made again
//! from what the user said.
//!
//! For those who decide a recorded decision again. What comes out are copies, which nobody
//! wipes.

use selfneg_core::{Condition, Rank};

use super::context_ethics::{ContextEthicsManager, Update};
use super::event::{GoalId, UserId};
use super::record::Unusable;
use super::specification::MissionRules;
use super::user_data::UserData;
use crate::input::Truth;

/// A user's own context and ethics manager.
#[derive(Debug)]
pub(crate) struct Recollection {
    user: UserId,
    context: ContextEthicsManager,
}

/// What a user's side of a negotiation works with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Snapshot {
    pub(crate) goal: GoalId,
    /// A rank for each disposition of the rules.
    pub(crate) ranks: Vec<Rank>,
    /// The true conditions in their order of disclosure, with their names if the rules do not
    /// list them.
    pub(crate) conditions: Vec<(Condition, Option<String>)>,
    /// How often the goal, in the user's context, names each disposition.
    pub(crate) mentions: Vec<u8>,
}

impl Recollection {
    /// A manager that has accepted these data.
    pub(crate) fn of(user: UserId, data: &UserData, rules: &MissionRules) -> Result<Self, Unusable> {
        let mut recollection = Self { user, context: ContextEthicsManager::new(rules) };
        recollection.context.update(Update::Data(data), user, rules, |_| ())?;
        Ok(recollection)
    }

    /// An attribute of the context has a new value.
    pub(crate) fn hear_context(
        &mut self,
        attribute: &str,
        value: &str,
        rules: &MissionRules,
    ) -> Result<(), Unusable> {
        self.context.update(Update::Context(attribute, value), self.user, rules, |_| ())
    }

    /// The user says something new about a condition.
    pub(crate) fn hear_status(
        &mut self,
        condition: &str,
        truth: Truth,
        rules: &MissionRules,
    ) -> Result<(), Unusable> {
        self.context.update(Update::Status(condition, truth), self.user, rules, |_| ())
    }

    /// What a negotiation that begins now works with.
    pub(crate) fn snapshot(&self, goal: GoalId, rules: &MissionRules) -> Snapshot {
        let named = |condition| (condition, self.context.unlisted_name(condition).map(str::to_owned));
        let mut ranks = self.context.active_ranks(rules).to_vec();
        ranks.resize(rules.bound().dispositions(), Rank(0));
        Snapshot {
            goal,
            ranks,
            conditions: self.context.true_conditions(rules).map(named).collect(),
            mentions: rules.mentions(goal, self.context.goal_context(goal, rules)).to_vec(),
        }
    }
}
