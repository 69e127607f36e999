//! What a mission is told beforehand: goals, capabilities, emergencies, inference rules,
//! normative profiles, limits.

use std::collections::BTreeMap;

use selfneg_core::{Activation, Condition, Implication, Options, Rank, RulesError};
use serde::{Deserialize, Serialize};

use super::event::{CategoryId, GoalId};
use crate::binding::{BoundRules, END_OF_GOAL};
use crate::input::{InputError, Rules};
use crate::precedence::Policy;

/// The mission's plain, serialisable settings, by name. The protocol variant and the policy
/// are given beside it, to [`MissionRules::new`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Specification {
    /// What the robot can do.
    pub capabilities: Vec<String>,
    /// What it can be asked for.
    pub goals: Vec<Goal>,
    /// Which emergencies it knows.
    pub emergencies: Vec<Category>,
    /// Which conditions follow from the context; at most 64 rules.
    pub inferences: Vec<Inference>,
    /// For users who gave no profile: context label, and a rank for each disposition.
    pub normative: BTreeMap<String, BTreeMap<String, u8>>,
    /// When the current user's willingness to be interrupted counts.
    pub willingness: Willingness,
    /// How much there may be of everything.
    pub limits: Limits,
}

/// A goal and its decomposition.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Goal {
    /// Its name, as in the ethical implications.
    pub name: String,
    /// The capabilities that it needs.
    pub needs: Vec<String>,
    /// Its tasks, in order.
    pub tasks: Vec<Task>,
    /// Ethical implications in particular contexts. The first that applies to the user
    /// replaces the goal's general one.
    pub implications: Vec<ContextImplication>,
}

/// A task: a part of a goal after which the robot is at a safe point.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Task {
    /// Its name.
    pub name: String,
    /// Its actions, in order; at least one.
    pub actions: Vec<String>,
    /// Whether it may be left before its end.
    pub interruptible: bool,
}

/// The dispositions that a goal implies in a context.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct ContextImplication {
    /// The attribute of the user's context.
    pub attribute: String,
    /// The value that it must have.
    pub value: String,
    /// What the goal then implies.
    pub dispositions: Vec<String>,
}

/// A condition that follows from the context.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Inference {
    /// The attribute of the user's context.
    pub attribute: String,
    /// The value that it must have.
    pub value: String,
    /// The condition, which is then true of a user who has said nothing about it.
    pub condition: String,
}

/// What makes an emergency certain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Proof {
    /// The robot's own sensors.
    Sensed,
    /// A checked document.
    Verified,
}

/// A predefined kind of emergency.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Category {
    /// Its name.
    pub name: String,
    /// The graver goes first.
    pub gravity: u8,
    /// What makes it certain.
    pub proof: Proof,
    /// What the robot then does.
    pub goal: String,
}

/// Being close to the end of the goal: the variant's willingness N holds for a current user
/// from some progress on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Willingness {
    /// The share of the goal's actions that must be done, in percent.
    pub from_percent: u8,
}

impl Default for Willingness {
    fn default() -> Self {
        Self { from_percent: 80 }
    }
}

/// The mission's memory is allocated once, of this size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Limits {
    /// Users whose data may be held at a time, the current one included; at least 2.
    pub users: u8,
    /// Open requests.
    pub requests: u8,
    /// Certain emergencies that wait.
    pub emergencies: u8,
    /// Profiles of a user.
    pub profiles: u8,
    /// Conditions of a user.
    pub conditions: u16,
    /// Attributes of a user's context.
    pub attributes: u8,
    /// The deferral that goes to human staff instead; at least 1.
    pub deferrals: u8,
    /// The time to answer a question for data, in milliseconds.
    pub data_within_ms: u32,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            users: 8,
            requests: 32,
            emergencies: 8,
            profiles: 8,
            conditions: 64,
            attributes: 16,
            deferrals: 3,
            data_within_ms: 2_000,
        }
    }
}

/// Why a specification was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SpecificationError {
    /// The rules themselves.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The engine refused the rules.
    #[error("rules: {0}")]
    Rules(#[from] RulesError),
    /// A goal without an ethical implication, or an emergency without a goal.
    #[error("{place}: goal {goal:?} is not listed")]
    UnlistedGoal {
        /// Where it is named.
        place: String,
        /// The goal.
        goal: String,
    },
    /// A disposition or condition that the rules do not have.
    #[error("{place}: {name:?} is not in the rules")]
    Unknown {
        /// Where it is named.
        place: String,
        /// What.
        name: String,
    },
    /// A goal without tasks, or a task without actions.
    #[error("goal {0:?}: expected at least one task, and at least one action in each")]
    NothingToDo(String),
    /// The same name twice.
    #[error("{0:?} is specified twice")]
    Twice(String),
    /// A limit below its least value, or more of something than fits.
    #[error("{what}: expected {expected}")]
    Size {
        /// Of what.
        what: &'static str,
        /// How much it may be.
        expected: &'static str,
    },
}

/// A checked specification together with the robot's rules, by index.
#[derive(Clone, Debug)]
pub struct MissionRules {
    bound: BoundRules,
    pub(super) specification: Specification,
    pub(super) options: Options,
    pub(super) policy: Option<Policy>,
    goals: Vec<BoundGoal>,
    categories: Vec<GoalId>,
    inferred: Vec<Condition>,
    normative: Vec<(String, Vec<Rank>)>,
}

#[derive(Clone, Debug)]
struct BoundGoal {
    within_capabilities: bool,
    general: Vec<u8>,
    in_context: Vec<Vec<u8>>,
}

impl MissionRules {
    /// Checks a specification against the robot's rules. Without a policy, each decision
    /// takes the default for its number of interrupters; so it does where the published
    /// policy has no rule for so many.
    ///
    /// # Errors
    /// [`SpecificationError`] if they do not fit together.
    pub fn new(
        rules: &Rules,
        specification: Specification,
        options: Options,
        policy: Option<Policy>,
    ) -> Result<Self, SpecificationError> {
        let bound = BoundRules::new(rules.clone())?;
        Activation::new(&bound.rows())?;
        let limits = specification.limits;
        let size = |wrong, what, expected| match wrong {
            true => Err(SpecificationError::Size { what, expected }),
            false => Ok(()),
        };
        size(limits.users < 2, "limits: users", "at least 2")?;
        size(limits.requests < limits.users, "limits: requests", "at least as many as users")?;
        size(limits.deferrals < 1, "limits: deferrals", "at least 1")?;
        size(specification.inferences.len() > 64, "inferences", "at most 64")?;
        size(specification.goals.len() > usize::from(u16::MAX), "goals", "at most 65,535")?;
        size(specification.emergencies.len() > usize::from(u16::MAX), "emergencies", "at most 65,535")?;
        let most = bound.conditions().saturating_add(usize::from(limits.conditions));
        size(most > usize::from(u16::MAX), "limits: conditions", "65,535 with those of the rules")?;

        let mut goals = Vec::new();
        for goal in &specification.goals {
            goals.push(BoundGoal::new(goal, &bound, &specification)?);
        }
        let mut categories = Vec::new();
        for category in &specification.emergencies {
            let at = specification.goals.iter().position(|goal| goal.name == category.goal);
            let goal = at.and_then(|at| u16::try_from(at).ok()).ok_or_else(|| {
                let place = format!("emergency {:?}", category.name);
                SpecificationError::UnlistedGoal { place, goal: category.goal.clone() }
            })?;
            categories.push(GoalId(goal));
        }
        let unknown = |place: &str, name: &str| {
            let (place, name) = (place.to_owned(), name.to_owned());
            SpecificationError::Unknown { place, name }
        };
        let mut inferred = Vec::new();
        for inference in &specification.inferences {
            let condition = bound.condition(&inference.condition);
            inferred.push(condition.ok_or_else(|| unknown("inferences", &inference.condition))?);
        }
        let mut normative = Vec::new();
        for (label, profile) in &specification.normative {
            let mut ranks = vec![Rank(0); bound.dispositions()];
            for (name, rank) in profile {
                let slot = bound.disposition(name).and_then(|d| ranks.get_mut(usize::from(d.0)));
                *slot.ok_or_else(|| unknown("normative", name))? = Rank(*rank);
            }
            normative.push((label.clone(), ranks));
        }
        Ok(Self { bound, specification, options, policy, goals, categories, inferred, normative })
    }

    /// The goal of this name.
    #[must_use]
    pub fn goal(&self, name: &str) -> Option<GoalId> {
        let at = self.specification.goals.iter().position(|goal| goal.name == name)?;
        u16::try_from(at).ok().map(GoalId)
    }

    /// The emergency category of this name.
    #[must_use]
    pub fn category(&self, name: &str) -> Option<CategoryId> {
        let at = self.specification.emergencies.iter().position(|category| category.name == name)?;
        u16::try_from(at).ok().map(CategoryId)
    }

    /// The specification in force.
    #[must_use]
    pub fn specification(&self) -> &Specification {
        &self.specification
    }

    /// The protocol variant in force.
    #[must_use]
    pub fn options(&self) -> Options {
        self.options
    }

    /// The policy asked for, if one was.
    #[must_use]
    pub fn policy(&self) -> Option<Policy> {
        self.policy
    }

    /// The robot's rules, with their names.
    #[must_use]
    pub fn bound(&self) -> &BoundRules {
        &self.bound
    }

    pub(super) fn limits(&self) -> &Limits {
        &self.specification.limits
    }

    pub(super) fn tasks(&self, goal: GoalId) -> &[Task] {
        self.specification.goals.get(usize::from(goal.0)).map_or(&[], |goal| &goal.tasks)
    }

    /// Whether the robot has what the goal needs; `None` for a goal that is not specified.
    pub(super) fn within_capabilities(&self, goal: GoalId) -> Option<bool> {
        self.goals.get(usize::from(goal.0)).map(|goal| goal.within_capabilities)
    }

    pub(super) fn category_of(&self, category: CategoryId) -> Option<(&Category, GoalId)> {
        let at = usize::from(category.0);
        Some((self.specification.emergencies.get(at)?, *self.categories.get(at)?))
    }

    pub(super) fn contexts_of(&self, goal: GoalId) -> &[ContextImplication] {
        self.specification.goals.get(usize::from(goal.0)).map_or(&[], |goal| &goal.implications)
    }

    /// The goal's implication: the one of its `in_context`-th context, or the general one.
    pub(super) fn implication(&self, goal: GoalId, in_context: Option<usize>) -> Implication<'_> {
        Implication::new(self.mentions(goal, in_context))
    }

    /// How often that implication names each disposition.
    pub(super) fn mentions(&self, goal: GoalId, in_context: Option<usize>) -> &[u8] {
        let goal = self.goals.get(usize::from(goal.0));
        let special = in_context.and_then(|nth| goal?.in_context.get(nth));
        special.or(goal.map(|goal| &goal.general)).map_or(&[][..], Vec::as_slice)
    }

    /// The conditions that the inference rules infer, in their order.
    pub(super) fn inferred(&self) -> &[Condition] {
        &self.inferred
    }

    pub(super) fn normative(&self) -> &[(String, Vec<Rank>)] {
        &self.normative
    }

    /// Whether a condition is nobody's to state: how close a goal is to its end is known
    /// from the goal itself.
    pub(super) fn is_measured(&self, condition: &str) -> bool {
        condition == END_OF_GOAL && !self.bound.activates(condition)
    }
}

impl BoundGoal {
    fn new(
        goal: &Goal,
        bound: &BoundRules,
        specification: &Specification,
    ) -> Result<Self, SpecificationError> {
        if specification.goals.iter().filter(|other| other.name == goal.name).count() > 1 {
            return Err(SpecificationError::Twice(goal.name.clone()));
        }
        if goal.tasks.is_empty() || goal.tasks.iter().any(|task| task.actions.is_empty()) {
            return Err(SpecificationError::NothingToDo(goal.name.clone()));
        }
        let general = bound.mentions(&goal.name).ok_or_else(|| SpecificationError::UnlistedGoal {
            place: "ethical implications".to_owned(),
            goal: goal.name.clone(),
        })?;
        let mut in_context = Vec::new();
        for implication in &goal.implications {
            let mut mentions = vec![0_u8; bound.dispositions()];
            for name in &implication.dispositions {
                let slot = bound.disposition(name).and_then(|d| mentions.get_mut(usize::from(d.0)));
                let count = slot.ok_or_else(|| SpecificationError::Unknown {
                    place: format!("goal {:?}", goal.name),
                    name: name.clone(),
                })?;
                *count = count.saturating_add(1);
            }
            in_context.push(mentions);
        }
        let has = |need: &String| specification.capabilities.contains(need);
        Ok(Self { within_capabilities: goal.needs.iter().all(has), general: general.to_vec(), in_context })
    }
}
