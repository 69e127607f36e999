//! `selfneg negotiate`: one decision, with its transcript.

use std::collections::HashSet;
use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::options::ProtocolOptions;
use super::{CommandError, Report, Status, json};
use crate::binding::{BoundRules, BoundUser, GoalChoice};
use crate::input::{Rules, User};
use crate::lint::{lint_rules, lint_user};
use crate::precedence::{Policy, decide};
use crate::record::DecisionRecord;
use crate::story;

/// Decide who gets precedence, and tell how the negotiation went
#[derive(Debug, Args)]
pub(super) struct Negotiate {
    /// Folder of the rules (disposition activation and ethical implications)
    #[arg(long, value_name = "DIR")]
    rules: PathBuf,
    /// Folder of the user being served
    #[arg(long, value_name = "DIR")]
    current: PathBuf,
    /// Folders of the users who interrupt, in order of arrival
    #[arg(long, value_name = "DIR", required = true, num_args = 1..)]
    interrupting: Vec<PathBuf>,
    /// Take this as the current user's goal, whatever its goal.json says
    #[arg(long, value_name = "GOAL")]
    current_goal: Option<String>,
    /// Take this as the interrupters' goal; given several times, one for each in order
    #[arg(long, value_name = "GOAL")]
    interrupting_goal: Vec<String>,
    /// How bilateral negotiations decide among several interrupters [default: published for
    /// one or two interrupters, condorcet for more]
    #[arg(long, value_name = "POLICY", value_parser = PossibleValuesParser::new(Policy::ALL.iter().map(|value| value.name())).try_map(|name| name.parse::<Policy>()))]
    policy: Option<Policy>,
    /// Print one JSON document instead of the story
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    options: ProtocolOptions,
}

impl Negotiate {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let rules = Rules::read(&self.rules)?;
        let goals = self.goals()?;
        let mut names = HashSet::new();
        let mut bound_rules = BoundRules::new(rules.clone())?;
        let mut users: Vec<BoundUser> = Vec::new();
        let mut findings = lint_rules(&rules);
        for (folder, goal) in std::iter::once(&self.current).chain(&self.interrupting).zip(&goals) {
            let user = User::read(folder)?;
            if !names.insert(user.name.clone()) {
                return Err(CommandError::Arguments(format!(
                    "{}: a second user named {:?}, expected folders of different names",
                    folder.display(),
                    user.name
                )));
            }
            users.push(bound_rules.bind(&user, goal)?);
            findings.extend(lint_user(&rules, &user, false));
        }
        let options = self.options.variant(users.first().is_some_and(|current| current.end_of_goal));
        let policy = self.policy.unwrap_or(Policy::default_for(self.interrupting.len()));
        let decision = decide(&bound_rules, &users, options, policy)?;
        let output = if self.json {
            json(&DecisionRecord::new(&decision, &users, &bound_rules))?
        } else {
            story::tell(&decision, &users, &bound_rules)
        };
        let warnings = findings.iter().map(ToString::to_string).collect();
        Ok(Report { output, warnings, status: Status::Passed })
    }

    /// Where each user's goal comes from, the current user's first.
    fn goals(&self) -> Result<Vec<GoalChoice>, CommandError> {
        let choice = |goal: Option<&String>, option: &str| match goal {
            Some(goal) => GoalChoice::Instead { goal: goal.clone(), origin: option.to_owned() },
            None => GoalChoice::OwnFile,
        };
        let given = self.interrupting_goal.len();
        if given > 1 && given != self.interrupting.len() {
            return Err(CommandError::Arguments(format!(
                "--interrupting-goal: given {given} times for {} interrupters, expected once for all of them \
                 or once for each",
                self.interrupting.len()
            )));
        }
        let mut goals = vec![choice(self.current_goal.as_ref(), "--current-goal")];
        for nth in 0..self.interrupting.len() {
            let goal = self.interrupting_goal.get(if given == 1 { 0 } else { nth });
            goals.push(choice(goal, "--interrupting-goal"));
        }
        Ok(goals)
    }
}
