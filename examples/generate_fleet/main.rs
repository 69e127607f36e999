//! Writes the traces of a fleet: `cargo run --release --example generate_fleet -- 1000 out/`.

#[allow(unreachable_pub, reason = "shared with tests")]
mod run;

use std::error::Error;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::PathBuf;

use rayon::prelude::*;
use selfneg::trace::TraceWriter;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(number), Some(folder)) = (arguments.next(), arguments.next()) else {
        return Err("expected the number of traces, and the folder to write them to".into());
    };
    let number: u64 = number.to_str().and_then(|number| number.parse().ok()).ok_or("expected a number")?;
    let folder = PathBuf::from(folder);
    fs::create_dir_all(&folder)?;
    (1..=number).into_par_iter().try_for_each(|seed| {
        let write = || -> Result<(), Box<dyn Error>> {
            let file = File::create(folder.join(format!("robot-{seed:06}.mcap")))?;
            let mut writer = TraceWriter::plain(BufWriter::new(file))?;
            selfneg::run::run(&run::scenario(seed)?, &mut [&mut writer])?;
            Ok(())
        };
        write().map_err(|error| format!("trace {seed}: {error}"))
    })?;
    Ok(())
}
