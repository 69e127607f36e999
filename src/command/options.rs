//! The protocol's options as arguments.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use selfneg_core::{Aggregation, Fallback, Options, QuitRule, TieRule};

/// Which variant of the protocol. The defaults are the published system.
#[derive(Debug, Args)]
#[command(next_help_heading = "Protocol options")]
pub(super) struct ProtocolOptions {
    /// When a user quits: in its turn once out of offers (published), or by the paper's
    /// formula, when it rejects an offer as deep as its own deepest
    #[arg(long, value_name = "RULE", default_value_t, value_parser = PossibleValuesParser::new(QuitRule::ALL.iter().map(|value| value.name())).try_map(|name| name.parse::<QuitRule>()))]
    quit: QuitRule,
    /// Whether two conditions that activate one disposition count twice (published) or once
    #[arg(long, value_name = "HOW", default_value_t, value_parser = PossibleValuesParser::new(Aggregation::ALL.iter().map(|value| value.name())).try_map(|name| name.parse::<Aggregation>()))]
    aggregation: Aggregation,
    /// When each would accept the other's offer of the same depth: the first sender wins
    /// (published), or nobody, or the offer whose receiver gains more
    #[arg(long, value_name = "RULE", default_value_t, value_parser = PossibleValuesParser::new(TieRule::ALL.iter().map(|value| value.name())).try_map(|name| name.parse::<TieRule>()))]
    tie: TieRule,
    /// Without agreement: the current user stays (published), or the user with more welfare
    #[arg(long, value_name = "RULE", default_value_t, value_parser = PossibleValuesParser::new(Fallback::ALL.iter().map(|value| value.name())).try_map(|name| name.parse::<Fallback>()))]
    fallback: Fallback,
    /// How much the current user, close to its goal, minds being interrupted: one more offer,
    /// worth N to itself [default: 0, or 1 if its status says "end of goal": true]
    #[arg(long, value_name = "N")]
    willingness: Option<u8>,
}

impl ProtocolOptions {
    /// The variant, for a current user whose status says `end_of_goal`.
    pub(super) fn variant(&self, end_of_goal: bool) -> Options {
        Options {
            quit: self.quit,
            aggregation: self.aggregation,
            tie: self.tie,
            fallback: self.fallback,
            willingness: self.willingness.unwrap_or(u8::from(end_of_goal)),
        }
    }
}
