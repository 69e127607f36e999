//! `selfneg demo`: the paper's mall.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use selfneg_core::Options;

use super::simulate::{play, told};
use super::{CommandError, Report, Status, json, key_files, report, write_whole};
use crate::audit::{self, Keys, Redecided};
use crate::binding::{BoundRules, GoalChoice};
use crate::demo;
use crate::precedence::{Policy, decide};
use crate::record::DecisionRecord;
use crate::seal::{Privacy, Seal};
use crate::story;

/// The paper's mall: Bob interrupts while the robot serves Alice. Needs no input
#[derive(Debug, Args)]
pub(super) struct Demo {
    /// Folder to write decision.json, trace.mcap, run.svg and report.html into, with the keys
    /// that sign and seal the trace; made if need be
    #[arg(long, value_name = "DIR", default_value = "selfneg-demo")]
    out: PathBuf,
    /// Print the decision as one JSON document instead of the story
    #[arg(long)]
    json: bool,
}

impl Demo {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let mut rules = BoundRules::new(demo::rules()?)?;
        let alice = rules.bind(&demo::alice()?, &GoalChoice::OwnFile)?;
        let bob = rules.bind(&demo::bob()?, &GoalChoice::OwnFile)?;
        let users = [alice, bob];
        let decision = decide(&rules, &users, Options::default(), Policy::Published)?;
        let document = json(&DecisionRecord::new(&decision, &users, &rules))?;
        let scenario = demo::scenario()?;
        let [decided, recorded, drawn, reported] =
            ["decision.json", "trace.mcap", "run.svg", "report.html"].map(|name| self.out.join(name));
        write_whole(&decided, &document)?;
        let (signer, auditor) = key_files::of_folder(&self.out)?;
        let keys = Keys {
            robots: vec![signer.public()],
            identities: key_files::auditor_keys(&[self.out.join("auditor.key")])?,
        };
        let seal = Seal {
            privacy: Privacy::Sealed(vec![auditor]),
            signer: Some(signer),
            random: Box::new(key_files::random),
        };
        let ran = play(&scenario, false, Some((&recorded, seal)))?;
        write_whole(&drawn, &ran.sketch.to_svg())?;
        let found = report::write(&recorded, &keys, &reported)?;
        let status = if found.status == audit::Status::Ok { Status::Passed } else { Status::Failed };
        if self.json {
            return Ok(Report { output: document, warnings: Vec::new(), status });
        }
        let mut output = told(&scenario, &ran);
        let _ = writeln!(output, "\nThe decision again, with nothing of the building:\n");
        output.push_str(&story::tell(&decision, &users, &rules));
        let _ = writeln!(
            output,
            "\nThe decision is in {}, the run is recorded in {} and drawn in {}\nThe trace is signed with {} and \
             sealed to {}",
            decided.display(),
            recorded.display(),
            drawn.display(),
            self.out.join("robot.key").display(),
            self.out.join("auditor.pub").display()
        );
        let _ = writeln!(
            output,
            "Audited with these keys it is {}: {} of {} decisions made again to the same rounds\nThe report, for \
             people, is {}",
            found.status,
            found.decisions.iter().filter(|decision| decision.redecided == Redecided::Same).count(),
            found.decisions.len(),
            reported.display()
        );
        if status != Status::Passed {
            let _ = write!(output, "\n{}", found.tell(&recorded.display().to_string()));
        }
        Ok(Report { output, warnings: Vec::new(), status })
    }
}
