//! The mall that comes with the crate.

use std::path::{Path, PathBuf};

use crate::building::Building;
use crate::error::BuildingError;

impl Building {
    /// A mall of our own making, 28 m x 18 m, with two floors and an elevator: entrance,
    /// information, bakery, grocery, pharmacy, flowers, bathroom, bookshop, shoes, offices, a
    /// charging station; upstairs food court, toys, bathroom upstairs, clinic, hairdresser,
    /// cinema, lounge. Its files are in `maps/mall/`; the images are drawn by the example
    /// `make_mall`.
    ///
    /// # Errors
    ///
    /// None as the crate comes: its tests read the files.
    pub fn mall() -> Result<Self, BuildingError> {
        Self::from_memory(include_str!("../maps/mall/mall.yaml"), |path: &Path| {
            let bytes: &[u8] = match path.to_str() {
                Some("ground.yaml") => include_bytes!("../maps/mall/ground.yaml"),
                Some("ground.pgm") => include_bytes!("../maps/mall/ground.pgm"),
                Some("upper.yaml") => include_bytes!("../maps/mall/upper.yaml"),
                Some("upper.pgm") => include_bytes!("../maps/mall/upper.pgm"),
                _ => {
                    let source = std::io::Error::from(std::io::ErrorKind::NotFound);
                    return Err(BuildingError::Io { path: PathBuf::from(path), source });
                }
            };
            Ok(bytes.to_vec())
        })
    }
}
