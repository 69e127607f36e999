//! `selfneg policies`: how often a policy for many users serves somebody who is beaten.

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use clap::Args;
use selfneg_proofs::sweep::Domain;
use serde::Serialize;

use super::options::ProtocolOptions;
use super::{CommandError, Report, Status, json, rank_range};
use crate::policies::{Served, Triples};
use crate::precedence::Policy;
use crate::regret::RegretError;

/// How often the policies for three users serve somebody whom another of them beats, over all
/// triples of a small domain or a sample of a large one
#[derive(Debug, Args)]
pub(super) struct Policies {
    /// How many dispositions there are, each activated by one condition
    #[arg(long, value_name = "N", default_value_t = 3)]
    dispositions: usize,
    /// The ranks that a user may give
    #[arg(long, value_name = "A..=B", default_value = "1..=5", value_parser = rank_range::parse)]
    ranks: RangeInclusive<u8>,
    /// Draw so many random triples instead of going through all
    #[arg(long, value_name = "TRIPLES", value_parser = clap::value_parser!(u64).range(1..))]
    sample: Option<u64>,
    /// Which random triples
    #[arg(long, value_name = "SEED", default_value_t = 0, requires = "sample")]
    seed: u64,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    options: ProtocolOptions,
}

#[derive(Serialize)]
struct Document {
    triples: u64,
    sampled: bool,
    seed: Option<u64>,
    variant: String,
    policies: Vec<PolicyRecord>,
}

#[derive(Serialize)]
struct PolicyRecord {
    policy: &'static str,
    agreements: u64,
    beaten: u64,
    beaten_agreements: u64,
    beaten_fallbacks: u64,
}

impl Policies {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let mut options = self.options.variant(false);
        if options.willingness > 0 {
            return Err(CommandError::Arguments(
                "--willingness: only the real current user has it, and here every two users negotiate; expected 0"
                    .to_owned(),
            ));
        }
        // Without agreement the table is of first come, first served.
        options.fallback = selfneg_core::Fallback::FirstCome;
        let domain = Domain::one_to_one(self.dispositions, self.ranks.clone()).map_err(RegretError::from)?;
        let triples = match self.sample {
            None => Triples::swept(&domain, &options)?,
            Some(count) => Triples::sampled(&domain, &options, count, self.seed)?,
        };
        let served = Policy::ALL.map(|policy| triples.served_by(policy));
        let output = if self.json {
            json(&Document {
                triples: triples.total,
                sampled: self.sample.is_some(),
                seed: self.sample.map(|_| self.seed),
                variant: options.to_string(),
                policies: served.iter().map(record).collect(),
            })?
        } else {
            self.table(&triples, &served, &options.to_string())
        };
        Ok(Report { output, warnings: Vec::new(), status: Status::Passed })
    }

    fn table(&self, triples: &Triples, served: &[Served], variant: &str) -> String {
        let mut text = String::new();
        let which = match self.sample {
            None => "all".to_owned(),
            Some(_) => format!("random (seed {})", self.seed),
        };
        let _ = writeln!(
            text,
            "{} triples of users, {which}; {} dispositions, ranks {}..={}; variant {variant}.\n",
            triples.total,
            self.dispositions,
            self.ranks.start(),
            self.ranks.end()
        );
        let _ = writeln!(
            text,
            "{:10}  {:>14}  {:>28}  {:>28}",
            "policy", "agreements", "agreed on a beaten user", "fallback serves a beaten one"
        );
        for of in served {
            let share = |count: u64| format!("{count} ({})", percent(count, triples.total));
            let _ = writeln!(
                text,
                "{:10}  {:>14}  {:>28}  {:>28}",
                of.policy.name(),
                of.agreements,
                share(of.beaten_agreements),
                share(of.beaten_fallbacks)
            );
        }
        text.push_str(
            "\nBeaten: another of the three wins the negotiation of those two. Fallback: first come.\n",
        );
        text
    }
}

fn record(served: &Served) -> PolicyRecord {
    PolicyRecord {
        policy: served.policy.name(),
        agreements: served.agreements,
        beaten: served.beaten_agreements + served.beaten_fallbacks,
        beaten_agreements: served.beaten_agreements,
        beaten_fallbacks: served.beaten_fallbacks,
    }
}

/// Hundredths of a percent, rounded down.
fn percent(count: u64, of: u64) -> String {
    let hundredths = u128::from(count) * 10_000 / u128::from(of.max(1));
    format!("{}.{:02} %", hundredths / 100, hundredths % 100)
}
