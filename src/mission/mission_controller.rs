//! The *mission controller*: the one goal that the robot pursues, decomposed into tasks and
//! actions.

use super::event::{ExecutionId, GoalId, Place};
use super::lifecycle::Lifecycle;
use super::record::Served;
use super::specification::{MissionRules, Task};

/// There is room for one goal.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone, PartialEq, Eq, Hash))]
pub(super) struct MissionController {
    pub(super) lifecycle: Lifecycle,
    pub(super) pursuit: Option<Pursuit>,
}

/// A goal being pursued.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Pursuit {
    pub(super) served: Served,
    pub(super) goal: GoalId,
    pub(super) place: Place,
    /// The task that is under way or next.
    pub(super) task: usize,
    /// The action that is under way or next.
    pub(super) action: usize,
    pub(super) execution: Option<ExecutionId>,
    /// Whether the robot waits before a task that may not be interrupted.
    pub(super) held: bool,
}

impl MissionController {
    pub(super) fn new() -> Self {
        Self { lifecycle: Lifecycle::Unconfigured, pursuit: None }
    }

    pub(super) fn start(&mut self, served: Served, goal: GoalId, place: Place) {
        self.pursuit =
            Some(Pursuit { served, goal, place, task: 0, action: 0, execution: None, held: false });
    }

    /// Whether the robot may leave its goal now: it has none, or is between two tasks, or in
    /// one that may be interrupted.
    pub(super) fn is_at_safe_point(&self, rules: &MissionRules) -> bool {
        self.pursuit.as_ref().is_none_or(|pursuit| {
            let between_tasks = pursuit.execution.is_none() && pursuit.action == 0;
            between_tasks || pursuit.current_task(rules).is_none_or(|task| task.interruptible)
        })
    }
}

impl Pursuit {
    pub(super) fn current_task<'a>(&self, rules: &'a MissionRules) -> Option<&'a Task> {
        rules.tasks(self.goal).get(self.task)
    }

    /// The action under way is done. True if it was the goal's last.
    pub(super) fn advance(&mut self, rules: &MissionRules) -> bool {
        self.execution = None;
        self.action = self.action.saturating_add(1);
        let actions = self.current_task(rules).map_or(0, |task| task.actions.len());
        if self.action >= actions {
            self.action = 0;
            self.task = self.task.saturating_add(1);
        }
        self.current_task(rules).is_none()
    }

    /// Real progress: the share of the goal's actions that are done, in percent.
    pub(super) fn percent_done(&self, rules: &MissionRules) -> usize {
        let tasks = rules.tasks(self.goal);
        let all: usize = tasks.iter().map(|task| task.actions.len()).sum();
        let before: usize = tasks.iter().take(self.task).map(|task| task.actions.len()).sum();
        before.saturating_add(self.action).saturating_mul(100).checked_div(all).unwrap_or(0)
    }
}
