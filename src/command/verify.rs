//! `selfneg verify`: every property under every variant.

use std::fmt::Write as _;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::Args;
use selfneg_proofs::sweep::Domain;

use super::{CommandError, Report, Status, json, progress, rank_range};
use crate::verify::counterexample::{self, Written};
use crate::verify::table::{by_subject, tell, to_json};
use crate::verify::{Request, Subject, Verification, VerifyError, verify};

/// Check every property of the protocol under every variant, and compare with what is expected
/// (exit code 1 if any verdict differs, either way)
///
/// Three engines run here. The sweep covers all ordered pairs of users of a domain, in classes
/// that count how many pairs they stand for: of the domain given, and of the published
/// activation (ten conditions, six dispositions) with ranks 1..=2, or 1..=5 with --thorough.
/// Enumeration runs every case of small domains, also for properties that compare two runs.
/// Random cases are large: up to 200 conditions a side; they are a sample. Kani is not run here.
#[derive(Debug, Args)]
pub(super) struct Verify {
    /// Check only these properties, see --list [default: all]
    #[arg(value_name = "PROPERTY")]
    properties: Vec<Subject>,
    /// Dispositions of the swept domain, with one condition each (1 to 16; 14 takes a gigabyte)
    #[arg(long, value_name = "N", default_value_t = 6)]
    dispositions: usize,
    /// Ranks of the swept domain
    #[arg(long, value_name = "A..=B", default_value = "1..=5", value_parser = rank_range::parse)]
    ranks: RangeInclusive<u8>,
    /// Sweep the published activation with the paper's ranks, and try ten times as many random
    /// cases: some four times as long
    #[arg(long)]
    thorough: bool,
    /// Random cases for each property and variant [default: 20, or 200 with --thorough]
    #[arg(long, value_name = "N")]
    random: Option<u32>,
    /// Where the random cases start
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write the smallest counterexample of each property that fails as folders into DIR, and
    /// say how to run it again
    #[arg(long, value_name = "DIR")]
    write: Option<PathBuf>,
    /// List the properties and what they say, and check nothing
    #[arg(long)]
    list: bool,
    /// Print one JSON document, with a row for each property and variant
    #[arg(long)]
    json: bool,
}

impl Verify {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        if self.list {
            return Ok(Report { output: list(), ..Report::default() });
        }
        let domain = Domain::one_to_one(self.dispositions, self.ranks.clone()).map_err(VerifyError::from)?;
        let mut subjects: Vec<Subject> = Vec::new();
        for &subject in &self.properties {
            if !subjects.contains(&subject) {
                subjects.push(subject);
            }
        }
        if subjects.is_empty() {
            subjects.extend(Subject::all());
        }
        let (shared_ranks, random) = if self.thorough { (1..=5, 200) } else { (1..=2, 20) };
        let request = Request {
            subjects,
            domain,
            shared_domain: Domain::published(shared_ranks).map_err(VerifyError::from)?,
            random_cases: self.random.unwrap_or(random),
            seed: self.seed,
        };
        let bar = progress::bar(0, "{bar:40} {pos}/{len} {elapsed} {msg}");
        let verification = verify(&request, |progress| {
            bar.set_length(progress.of);
            bar.set_position(progress.done);
            bar.set_message(progress.task);
        })?;
        bar.finish_and_clear();
        let written = self.write_counterexamples(&verification)?;
        let output = if self.json {
            json(&to_json(&verification, &written))?
        } else {
            let mut text = tell(&verification);
            for Written { name, statement, commands } in &written {
                let _ = writeln!(text, "\n{name} is refuted: {statement}");
                for command in commands {
                    let _ = writeln!(text, "  {command}");
                }
            }
            text
        };
        let status = if verification.is_as_expected() { Status::Passed } else { Status::Failed };
        Ok(Report { output, warnings: Vec::new(), status })
    }

    /// Writes a smallest counterexample of each property that fails.
    fn write_counterexamples(&self, verification: &Verification) -> Result<Vec<Written>, CommandError> {
        let mut all = Vec::new();
        let Some(folder) = &self.write else { return Ok(all) };
        for (subject, rows) in by_subject(&verification.rows) {
            let Some(found) = rows.iter().find_map(|row| row.counterexample()) else { continue };
            let folder = folder.join(subject.name().replace('/', "-"));
            let commands = counterexample::write(found, subject.compares_roles(), &folder)
                .map_err(|(file, source)| CommandError::Unwritable { file, source })?;
            all.push(Written { name: subject.name(), statement: subject.statement(), commands });
        }
        Ok(all)
    }
}

fn list() -> String {
    let mut text = String::new();
    for subject in Subject::all() {
        let _ = writeln!(text, "{}\n  {}", subject.name(), subject.statement());
    }
    text
}
