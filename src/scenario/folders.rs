//! Where a scenario's rules, users and building come from.

use std::path::{Path, PathBuf};

use selfneg_sim::{Building, BuildingError};

use crate::input::{InputError, Rules, User};

/// The files that a scenario names.
pub trait Folders {
    /// The rules of a folder.
    ///
    /// # Errors
    /// As [`Rules::read`].
    fn rules(&self, folder: &Path) -> Result<Rules, InputError>;

    /// The user of a folder.
    ///
    /// # Errors
    /// As [`User::read`].
    fn user(&self, folder: &Path) -> Result<User, InputError>;

    /// The building of a building file.
    ///
    /// # Errors
    /// As [`Building::open`].
    fn building(&self, file: &Path) -> Result<Building, BuildingError>;
}

/// Files on disk, relative to a folder.
#[derive(Clone, Debug)]
pub struct OnDisk {
    /// What relative paths are relative to.
    pub base: PathBuf,
}

impl Folders for OnDisk {
    fn rules(&self, folder: &Path) -> Result<Rules, InputError> {
        Rules::read(&self.base.join(folder))
    }

    fn user(&self, folder: &Path) -> Result<User, InputError> {
        User::read(&self.base.join(folder))
    }

    fn building(&self, file: &Path) -> Result<Building, BuildingError> {
        Building::open(&self.base.join(file))
    }
}
