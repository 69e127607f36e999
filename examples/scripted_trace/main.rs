//! Writes the trace of a scripted run: `cargo run --example scripted_trace -- out.mcap`.

#[allow(unreachable_pub, reason = "shared with tests")]
mod run;

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

use selfneg::trace::TraceWriter;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).ok_or("expected the file to write")?;
    let mut writer = TraceWriter::plain(BufWriter::new(File::create(path)?))?;
    run::play(&mut writer)?;
    Ok(())
}
