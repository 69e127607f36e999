//! The rules and users that a command is about, read from their folders.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use clap::Args;

use super::CommandError;
use crate::binding::{BoundRules, BoundUser, GoalChoice};
use crate::input::{Rules, User};
use crate::lint::{lint_rules, lint_user};

/// Goals given in place of those of the folders.
#[derive(Debug, Args)]
pub(super) struct GoalOptions {
    /// Take this as the current user's goal, whatever its goal.json says
    #[arg(long, value_name = "GOAL")]
    current_goal: Option<String>,
    /// Take this as the interrupters' goal; given several times, one for each in order
    #[arg(long, value_name = "GOAL")]
    interrupting_goal: Vec<String>,
}

/// The folders of a case: the rules, the current user, and who interrupts.
#[derive(Debug, Args)]
pub(super) struct Folders {
    /// Folder of the rules (disposition activation and ethical implications)
    #[arg(long, value_name = "DIR")]
    rules: PathBuf,
    /// Folder of the user being served
    #[arg(long, value_name = "DIR")]
    current: PathBuf,
    /// Folders of the users who interrupt, in order of arrival
    #[arg(long, value_name = "DIR", required = true, num_args = 1..)]
    interrupting: Vec<PathBuf>,
    #[command(flatten)]
    goals: GoalOptions,
}

impl Folders {
    /// Reads them all.
    pub(super) fn read(&self) -> Result<Present, CommandError> {
        let users = std::iter::once(&self.current).chain(&self.interrupting);
        Present::read(&self.rules, users, &self.goals)
    }

    /// How many users interrupt.
    pub(super) fn interrupters(&self) -> usize {
        self.interrupting.len()
    }
}

/// Everybody who is present, the current user first.
pub(super) struct Present {
    pub(super) rules: BoundRules,
    pub(super) users: Vec<BoundUser>,
    /// What stands out in the folders.
    pub(super) warnings: Vec<String>,
}

impl Present {
    /// Reads the rules and the user folders, the current user's first. Names are the
    /// folders' names.
    pub(super) fn read<'p>(
        rules: &Path,
        folders: impl IntoIterator<Item = &'p PathBuf>,
        goals: &GoalOptions,
    ) -> Result<Self, CommandError> {
        let folders: Vec<&PathBuf> = folders.into_iter().collect();
        let goals = goals.of_users(folders.len())?;
        let source = Rules::read(rules)?;
        let mut findings = lint_rules(&source);
        let mut rules = BoundRules::new(source.clone())?;
        let mut names = HashSet::new();
        let mut users = Vec::new();
        for (folder, goal) in folders.into_iter().zip(&goals) {
            let user = User::read(folder)?;
            if !names.insert(user.name.clone()) {
                return Err(CommandError::Arguments(format!(
                    "{}: a second user named {:?}, expected folders of different names",
                    folder.display(),
                    user.name
                )));
            }
            users.push(rules.bind(&user, goal)?);
            findings.extend(lint_user(&source, &user, false));
        }
        Ok(Self { rules, users, warnings: findings.iter().map(ToString::to_string).collect() })
    }
}

impl GoalOptions {
    /// Where each user's goal comes from, the current user's first.
    fn of_users(&self, users: usize) -> Result<Vec<GoalChoice>, CommandError> {
        let choice = |goal: Option<&String>, option: &str| match goal {
            Some(goal) => GoalChoice::Instead { goal: goal.clone(), origin: option.to_owned() },
            None => GoalChoice::OwnFile,
        };
        let interrupters = users.saturating_sub(1);
        let given = self.interrupting_goal.len();
        if given > 1 && given != interrupters {
            return Err(CommandError::Arguments(format!(
                "--interrupting-goal: given {given} times for {interrupters} interrupters, expected once for \
                 all of them or once for each"
            )));
        }
        let mut goals = vec![choice(self.current_goal.as_ref(), "--current-goal")];
        for nth in 0..interrupters {
            let goal = self.interrupting_goal.get(if given == 1 { 0 } else { nth });
            goals.push(choice(goal, "--interrupting-goal"));
        }
        Ok(goals)
    }
}
