//! `selfneg keygen`: keys for robot and auditor.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::key_files::{auditor_pair, random, robot_pair, write_new};
use super::{CommandError, Report, Status};
use crate::seal::{AuditorKey, RobotKey};

/// Make the keys that sign and seal traces
///
/// A robot signs with robot.key; whoever has robot.pub can check that nothing was changed. A
/// trace is sealed to auditor.pub; whoever has auditor.key can read what is personal. Give the
/// robot robot.key and auditor.pub, and nothing else. Keys that are there are never replaced.
#[derive(Debug, Args)]
pub(super) struct Keygen {
    /// Folder to write the keys into; made if need be
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Make only this pair
    #[arg(long, value_name = "WHOSE")]
    only: Option<Only>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Only {
    Robot,
    Auditor,
}

impl Keygen {
    pub(super) fn run(&self) -> Result<Report, CommandError> {
        let mut pairs = Vec::new();
        if self.only != Some(Only::Auditor) {
            let key = RobotKey::generate(&mut random).map_err(CommandError::Recording)?;
            pairs.push(robot_pair(&self.out, &key)?);
        }
        if self.only != Some(Only::Robot) {
            pairs.push(auditor_pair(&self.out, &AuditorKey::generate()));
        }
        write_new(&self.out, &pairs)?;
        let mut output = String::new();
        for pair in &pairs {
            for file in [&pair.private.0, &pair.public.0] {
                let what = match file.file_name().and_then(|name| name.to_str()) {
                    Some("robot.key") => "signs traces (simulate --sign); secret, for the robot alone",
                    Some("robot.pub") => "checks the robot's signatures; for every auditor",
                    Some("auditor.key") => {
                        "opens what is personal (unseal --identity); secret, never on the robot"
                    }
                    _ => "seals traces to the auditor (simulate --seal); for the robot",
                };
                let _ = writeln!(output, "{}: {what}", file.display());
            }
        }
        Ok(Report { output, warnings: Vec::new(), status: Status::Passed })
    }
}
