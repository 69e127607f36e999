//! `selfneg demo`: the paper's mall.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use selfneg_core::Options;

use super::{CommandError, Report, Status, json};
use crate::binding::{BoundRules, GoalChoice};
use crate::demo;
use crate::precedence::{Policy, decide};
use crate::record::DecisionRecord;
use crate::story;

/// The paper's mall: Bob interrupts while the robot serves Alice. Needs no input
#[derive(Debug, Args)]
pub(super) struct Demo {
    /// Folder to write decision.json into; made if need be
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
        let file = self.write("decision.json", &document)?;
        if self.json {
            return Ok(Report { output: document, warnings: Vec::new(), status: Status::Passed });
        }
        let mut output = String::from(
            "In a mall, Alice is with a small child and in urgency; Bob is elderly. Each has an\n\
             ethical profile: how strongly the robot, when it speaks for them, should give\n\
             precedence to whom (the paper's Table I).\n\n",
        );
        output.push_str(&story::tell(&decision, &users, &rules));
        let _ = writeln!(output, "\nThe decision is recorded in {}", file.display());
        Ok(Report { output, warnings: Vec::new(), status: Status::Passed })
    }

    /// Writes a whole file or leaves what was there.
    fn write(&self, name: &str, text: &str) -> Result<PathBuf, CommandError> {
        let file = self.out.join(name);
        let unwritable = |file: &Path| {
            let file = file.to_owned();
            move |source| CommandError::Unwritable { file, source }
        };
        fs::create_dir_all(&self.out).map_err(unwritable(&self.out))?;
        let part = self.out.join(format!(".{name}.part"));
        fs::write(&part, text).map_err(unwritable(&part))?;
        fs::rename(&part, &file).map_err(|source| {
            let _ = fs::remove_file(&part);
            unwritable(&file)(source)
        })?;
        Ok(file)
    }
}
