//! Readers for the published package's folders.
//!
//! A *user folder* holds `ethic_profiles.json`, `user_status.json`, `context.json` and
//! `goal.json`; a *rules folder* holds `disposition_activation.json` and
//! `ethical_implications.json`. Key order is kept: in a status it is the order of
//! disclosure. Whatever is not as expected is an [`InputError`] that names the file, the
//! key and the expectation.

mod document;
mod error;
mod rules_folder;
mod user_folder;

pub use error::InputError;
pub use rules_folder::Rules;
pub use user_folder::{EthicProfiles, Truth, User, UserFiles, folder_name};
