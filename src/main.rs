//! The `selfneg` program: prints what a command reports.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;
use selfneg::command::{Program, Status};
use selfneg::printable::one_line;

fn main() -> ExitCode {
    let program = match Program::try_parse() {
        Ok(program) => program,
        Err(message) => {
            let asked_for = !message.use_stderr();
            return match seen(message.print()) {
                Ok(()) if asked_for => ExitCode::SUCCESS,
                Err(error) if asked_for => unwritten(&error),
                _ => ExitCode::from(2),
            };
        }
    };
    match program.run() {
        Ok(report) => {
            for warning in &report.warnings {
                complain("warning", warning);
            }
            let mut stdout = io::stdout();
            let written = stdout.write_all(report.output.as_bytes()).and_then(|()| stdout.flush());
            if let Err(error) = seen(written) {
                return unwritten(&error);
            }
            match report.status {
                Status::Passed => ExitCode::SUCCESS,
                Status::Failed => ExitCode::from(1),
                Status::Unusable => ExitCode::from(2),
            }
        }
        Err(error) => {
            complain("error", &error.to_string());
            ExitCode::from(2)
        }
    }
}

/// A reader who has closed the pipe has seen enough, which is not an error; a full disk is.
fn seen(written: io::Result<()>) -> io::Result<()> {
    written.or_else(|error| if error.kind() == io::ErrorKind::BrokenPipe { Ok(()) } else { Err(error) })
}

fn unwritten(error: &io::Error) -> ExitCode {
    complain("error", &format!("standard output: cannot be written: {error}"));
    ExitCode::from(2)
}

/// One line on standard error. Names come from files and may hold anything. If nobody takes the
/// line, there is nobody to tell.
fn complain(kind: &str, text: &str) {
    let line = format!("{kind}: {}\n", one_line(text));
    let _ = io::stderr().write_all(line.as_bytes());
}
