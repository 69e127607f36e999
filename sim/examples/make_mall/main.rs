//! Draws the images of the mall's maps: `cargo run -p selfneg-sim --example make_mall -- sim/maps/mall`.

use std::error::Error;
use std::path::PathBuf;

mod plan;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args_os().nth(1).ok_or("expected a folder")?);
    for (name, bytes) in plan::images() {
        std::fs::write(folder.join(name), bytes)?;
    }
    Ok(())
}
