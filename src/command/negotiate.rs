//! `selfneg negotiate`: one decision, with its transcript.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::options::ProtocolOptions;
use super::present::{Folders, Present};
use super::{CommandError, Report, Status, json};
use crate::precedence::{Policy, decide};
use crate::record::DecisionRecord;
use crate::story;

/// Decide who gets precedence, and tell how the negotiation went
#[derive(Debug, Args)]
pub(super) struct Negotiate {
    #[command(flatten)]
    folders: Folders,
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
        let Present { rules, users, warnings } = self.folders.read()?;
        let options = self.options.variant(users.first().is_some_and(|current| current.end_of_goal));
        let policy = self.policy.unwrap_or(Policy::default_for(self.folders.interrupters()));
        let decision = decide(&rules, &users, options, policy)?;
        let output = if self.json {
            json(&DecisionRecord::new(&decision, &users, &rules))?
        } else {
            story::tell(&decision, &users, &rules)
        };
        Ok(Report { output, warnings, status: Status::Passed })
    }
}
