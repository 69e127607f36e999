//! `selfneg optimum`: what would have been best for everyone.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use selfneg_core::Activation;
use selfneg_model::Impacts;

use super::options::ProtocolOptions;
use super::present::{GoalOptions, Present};
use super::{CommandError, Report, Status, json};
use crate::binding::BoundUser;
use crate::optimum::{Optimum as Optima, Situation};
use crate::precedence::{Policy, beats, decide};

/// What would have been best for everyone, proved exactly, beside what the robot decides
/// (exit code 1 if the largest welfare is not proved)
#[derive(Debug, Args)]
pub(super) struct Optimum {
    /// Folder of the rules (disposition activation and ethical implications)
    #[arg(long, value_name = "DIR")]
    rules: PathBuf,
    /// User folders: the user being served, then those who interrupt, in order of arrival
    #[arg(value_name = "USER_DIR", required = true)]
    users: Vec<PathBuf>,
    #[command(flatten)]
    goals: GoalOptions,
    /// How long it takes to serve each user, in whole units, in order of arrival
    /// [default: 1 for each]
    #[arg(long, value_name = "TIME", value_parser = clap::value_parser!(u32).range(1..))]
    service_time: Vec<u32>,
    /// How bilateral negotiations decide among several interrupters [default: published for
    /// one or two interrupters, condorcet for more]
    #[arg(long, value_name = "POLICY", value_parser = PossibleValuesParser::new(Policy::ALL.iter().map(|value| value.name())).try_map(|name| name.parse::<Policy>()))]
    policy: Option<Policy>,
    #[command(flatten)]
    options: ProtocolOptions,
    /// Print one JSON document instead of the tables
    #[arg(long)]
    json: bool,
}

impl Optimum {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let Present { rules, users, warnings } = Present::read(&self.rules, &self.users, &self.goals)?;
        if !self.service_time.is_empty() && self.service_time.len() != users.len() {
            return Err(CommandError::Arguments(format!(
                "--service-time: given {} times for {} users, expected once for each",
                self.service_time.len(),
                users.len()
            )));
        }
        let options = self.options.variant(users.first().is_some_and(|current| current.end_of_goal));
        let interrupters = users.len().saturating_sub(1);
        let policy = self.policy.unwrap_or(Policy::default_for(interrupters));
        let decision = if interrupters == 0 { None } else { Some(decide(&rules, &users, options, policy)?) };
        let rows = rules.rows();
        let activation = Activation::new(&rows)?;
        let present: Vec<selfneg_core::User<'_>> =
            users.iter().map(BoundUser::user).collect::<Result<_, _>>()?;
        let names: Vec<String> = users.iter().map(|user| user.name.clone()).collect();
        let times: Vec<u64> = self.service_time.iter().map(|&time| u64::from(time)).collect();
        let optimum = Optima::of(&Situation {
            names: &names,
            impacts: &Impacts::among(&present, activation, options.aggregation),
            options,
            decision: decision.as_ref(),
            beats: &beats(&rules, &users, options)?,
            times: &times,
        })?;
        let output = if self.json { json(&optimum.record())? } else { optimum.tell() };
        let status = if optimum.verified() { Status::Passed } else { Status::Failed };
        Ok(Report { output, warnings, status })
    }
}
