//! Writes the traces of a fleet, and the keys to audit them with:
//! `cargo run --release --example generate_fleet -- 1000 fleet/`, and then
//! `selfneg audit fleet --robot-key fleet/robot.pub --identity fleet/auditor.key --parquet tables`.

#[allow(unreachable_pub, reason = "shared with tests")]
mod run;

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use rayon::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(number), Some(folder)) = (arguments.next(), arguments.next()) else {
        return Err("expected the number of traces, and the folder to write them to".into());
    };
    let number: u64 = number.to_str().and_then(|number| number.parse().ok()).ok_or("expected a number")?;
    let folder = PathBuf::from(folder);
    fs::create_dir_all(&folder)?;
    let keys = run::Keys::generate()?;
    fs::write(folder.join("robot.pub"), keys.robot.public().to_pem()?)?;
    fs::write(folder.join("auditor.key"), keys.auditor.to_text().as_bytes())?;
    (1..=number).into_par_iter().try_for_each(|seed| {
        let write = || -> Result<(), Box<dyn Error>> {
            Ok(fs::write(folder.join(format!("robot-{seed:06}.mcap")), run::trace(seed, &keys)?)?)
        };
        write().map_err(|error| format!("trace {seed}: {error}"))
    })?;
    Ok(())
}
