//! `selfneg regret`: the worst case over a whole domain.

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use clap::Args;
use selfneg_core::{Fallback, Options, TieRule};
use selfneg_model::exact::decimal;
use serde::Serialize;

use super::options::ProtocolOptions;
use super::{CommandError, Report, Status, json, progress, rank_range};
use crate::regret::{Progress, RegretRecord, RegretSurvey};

/// How much welfare the protocol loses at most: over all pairs of users with whole-number
/// ranks, and, proved by linear programmes, over all real-valued ranks (exit code 1 if the
/// two contradict each other or anything is not proved)
#[derive(Debug, Args)]
pub(super) struct Regret {
    /// How many dispositions there are, each activated by one condition (1 to 10)
    #[arg(long, value_name = "N", default_value_t = 6)]
    dispositions: usize,
    /// The ranks that a user may give
    #[arg(long, value_name = "A..=B", default_value = "1..=5", value_parser = rank_range::parse)]
    ranks: RangeInclusive<u8>,
    /// Compare this variant to those with other ties and the other fallback
    #[arg(long)]
    compare: bool,
    /// Print one JSON document instead of the table
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    options: ProtocolOptions,
}

#[derive(Serialize)]
struct Comparison {
    variants: Vec<RegretRecord>,
}

impl Regret {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let options = self.options.variant(false);
        let variants = if self.compare { compared(options) } else { vec![options] };
        let surveys = variants
            .into_iter()
            .map(|variant| self.survey(variant))
            .collect::<Result<Vec<RegretSurvey>, _>>()?;
        let output = match surveys.as_slice() {
            [survey] if self.json => json(&survey.record())?,
            [survey] => survey.tell(),
            all if self.json => {
                json(&Comparison { variants: all.iter().map(RegretSurvey::record).collect() })?
            }
            all => table(all),
        };
        let consistent = surveys.iter().all(RegretSurvey::consistent);
        let status = if consistent { Status::Passed } else { Status::Failed };
        Ok(Report { output, warnings: Vec::new(), status })
    }

    fn survey(&self, options: Options) -> Result<RegretSurvey, CommandError> {
        let bar = progress::bar(1000, "{bar:40} {msg} {elapsed}");
        let survey = RegretSurvey::of(self.dispositions, self.ranks.clone(), options, &|progress| {
            let (length, position, doing) = match progress {
                Progress::Sweep(thousandths) => (1000, thousandths, "whole ranks, swept"),
                Progress::Programmes { done, total } => {
                    let count = |count| u64::try_from(count).unwrap_or(u64::MAX);
                    (count(total), count(done), "real ranks, proved")
                }
            };
            bar.set_message(doing);
            bar.set_length(length);
            bar.set_position(position);
        });
        bar.finish_and_clear();
        Ok(survey?)
    }
}

/// The given variant under every tie and fallback.
fn compared(options: Options) -> Vec<Options> {
    let with =
        |&tie: &TieRule| Fallback::ALL.iter().map(move |&fallback| Options { tie, fallback, ..options });
    TieRule::ALL.iter().flat_map(with).collect()
}

fn table(surveys: &[RegretSurvey]) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{:55}  {:>15}  {:>11}  {:>11}  {:>10}",
        "variant", "pairs losing", "mean regret", "whole ranks", "real ranks"
    );
    for survey in surveys {
        let _ = writeln!(
            text,
            "{:55}  {:>15}  {:>11}  {:>11}  {:>10}",
            survey.options.to_string(),
            survey.losing(),
            decimal(&survey.mean(), 6),
            survey.whole_max(),
            survey.real_max_text()
        );
    }
    let pairs = surveys.first().map_or(0, |survey| survey.pairs);
    let _ = writeln!(
        text,
        "\nOf {pairs} pairs of users with whole-number ranks each; largest regret over whole and over real ranks."
    );
    text
}
