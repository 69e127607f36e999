//! The `selfneg` program: prints what a command reports.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;
use selfneg::command::{Program, Status};

fn main() -> ExitCode {
    match Program::parse().run() {
        Ok(report) => {
            let warnings: String =
                report.warnings.iter().map(|warning| format!("warning: {warning}\n")).collect();
            show(&mut io::stderr(), &warnings);
            if !show(&mut io::stdout(), &report.output) {
                return ExitCode::from(2);
            }
            match report.status {
                Status::Passed => ExitCode::SUCCESS,
                Status::Failed => ExitCode::from(1),
            }
        }
        Err(error) => {
            show(&mut io::stderr(), &format!("error: {error}\n"));
            ExitCode::from(2)
        }
    }
}

/// Writes all of `text`. A reader who has closed the pipe has seen enough, which is not an
/// error; a full disk is.
fn show<W: Write>(to: &mut W, text: &str) -> bool {
    match to.write_all(text.as_bytes()).and_then(|()| to.flush()) {
        Ok(()) => true,
        Err(error) => error.kind() == io::ErrorKind::BrokenPipe,
    }
}
