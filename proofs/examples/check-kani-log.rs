//! Fails unless a log of `cargo kani -p selfneg-proofs` shows that every harness was
//! verified with every cover satisfied: `cargo run --example check-kani-log -- FILE`.

use std::io::{self, Write};
use std::process::ExitCode;

use selfneg_proofs::harness::ALL;
use selfneg_proofs::kani_log::{Expected, problems};

fn main() -> io::Result<ExitCode> {
    let Some(path) = std::env::args().nth(1) else {
        writeln!(io::stderr(), "usage: check-kani-log FILE")?;
        return Ok(ExitCode::from(2));
    };
    let log = std::fs::read_to_string(&path)
        .map_err(|error| io::Error::new(error.kind(), format!("{path}: {error}")))?;
    let expected: Vec<Expected<'_>> =
        ALL.iter().map(|harness| Expected { name: harness.name, covers: harness.covers }).collect();
    let found = problems(&log, &expected);
    for problem in &found {
        writeln!(io::stderr(), "{path}: {problem}")?;
    }
    if !found.is_empty() {
        return Ok(ExitCode::FAILURE);
    }
    let covers: usize = expected.iter().map(|harness| harness.covers).sum();
    writeln!(io::stdout(), "{} harnesses verified, {covers} covers satisfied", expected.len())?;
    Ok(ExitCode::SUCCESS)
}
