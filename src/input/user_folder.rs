//! The user folder: ethical profiles, status, context and goal of one user.

use std::path::{Path, PathBuf};

use selfneg_core::Rank;

use super::document::Document;
use super::error::InputError;

/// What a status says of one condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// It is true of the user.
    True,
    /// It is not.
    False,
    /// The user opted out: treated as not true, never disclosed.
    Withheld,
}

/// A user's ethical profiles: for each context label, a rank per disposition.
pub type EthicProfiles = Vec<(String, Vec<(String, Rank)>)>;

/// One user as the files describe it, by name and in the files' order.
#[derive(Clone, Debug)]
pub struct User {
    /// The folder's name.
    pub name: String,
    /// The active profile: the one of the context's location.
    pub profile: Vec<(String, Rank)>,
    /// Conditions in their order of disclosure.
    pub status: Vec<(String, Truth)>,
    /// The goal of `goal.json`, if there is such a file.
    pub goal: Option<String>,
    /// The context's location.
    pub location: String,
    /// Where all this comes from.
    pub files: UserFiles,
}

/// The four files that describe a user.
#[derive(Clone, Debug)]
pub struct UserFiles {
    /// `ethic_profiles.json`
    pub profiles: PathBuf,
    /// `user_status.json`
    pub status: PathBuf,
    /// `context.json`
    pub context: PathBuf,
    /// `goal.json`
    pub goal: PathBuf,
}

impl UserFiles {
    /// The files of a user folder.
    #[must_use]
    pub fn of_folder(folder: &Path) -> Self {
        Self {
            profiles: folder.join("ethic_profiles.json"),
            status: folder.join("user_status.json"),
            context: folder.join("context.json"),
            goal: folder.join("goal.json"),
        }
    }
}

/// A user folder's own name as it is given, or for `.` and the like the folder's real one.
///
/// # Errors
/// [`InputError`] if the path does not exist or has no name (`/`).
pub fn folder_name(folder: &Path) -> Result<String, InputError> {
    let real =
        folder.canonicalize().map_err(|source| InputError::Unreadable { file: folder.to_owned(), source })?;
    folder
        .file_name()
        .or(real.file_name())
        .map(|name| name.to_string_lossy().into_owned())
        .ok_or_else(|| InputError::NoFolderName { folder: folder.to_owned() })
}

impl User {
    /// Reads a user folder. `goal.json` may be missing.
    ///
    /// # Errors
    /// [`InputError`] if a file is not as expected.
    pub fn read(folder: &Path) -> Result<Self, InputError> {
        Self::read_files(folder_name(folder)?, UserFiles::of_folder(folder))
    }

    /// Reads a user whose files lie anywhere. The goal's may be missing.
    ///
    /// # Errors
    /// [`InputError`] if a file is not as expected.
    pub fn read_files(name: String, files: UserFiles) -> Result<Self, InputError> {
        let goal = if files.goal.exists() { Some(Document::read(files.goal.clone())?) } else { None };
        let profiles = Document::read(files.profiles.clone())?;
        let status = Document::read(files.status.clone())?;
        let context = Document::read(files.context.clone())?;
        Self::of(name, files, &profiles, &status, &context, goal.as_ref())
    }

    /// Takes the four files' texts instead, in the order of [`UserFiles`]; `folder` is for
    /// messages.
    ///
    /// # Errors
    /// [`InputError`] if a text is not as expected.
    pub fn parse(name: &str, folder: &Path, texts: [&str; 4]) -> Result<Self, InputError> {
        let files = UserFiles::of_folder(folder);
        let [profiles, status, context, goal] = texts;
        Self::of(
            name.to_owned(),
            files.clone(),
            &Document::parse(files.profiles, profiles)?,
            &Document::parse(files.status, status)?,
            &Document::parse(files.context, context)?,
            Some(&Document::parse(files.goal, goal)?),
        )
    }

    fn of(
        name: String,
        files: UserFiles,
        profiles: &Document,
        status: &Document,
        context: &Document,
        goal: Option<&Document>,
    ) -> Result<Self, InputError> {
        let location = required_text(context, "location", "the label of the user's ethical profile")?;
        let mut known = read_profiles(profiles)?;
        let Some(active) = known.iter().position(|(label, _)| *label == location) else {
            return Err(InputError::UnknownLocation {
                file: files.context,
                location,
                profiles: files.profiles,
                known: known.into_iter().map(|(label, _)| label).collect(),
            });
        };
        Ok(Self {
            name,
            profile: known.swap_remove(active).1,
            status: read_status(status)?,
            goal: goal.map(|document| required_text(document, "goal", "the goal's name")).transpose()?,
            location,
            files,
        })
    }

    /// The conditions that are true of the user, in their order of disclosure.
    pub fn true_conditions(&self) -> impl Iterator<Item = &str> {
        self.status.iter().filter(|(_, truth)| *truth == Truth::True).map(|(name, _)| name.as_str())
    }
}

fn read_profiles(document: &Document) -> Result<EthicProfiles, InputError> {
    let root = document.root();
    root.entries("an object {context label: {disposition: rank}}")?
        .map(|(label, profile)| {
            let ranks = profile
                .entries("an object {disposition: rank}")?
                .map(|(disposition, rank)| {
                    Ok((disposition.to_owned(), Rank(rank.byte("a rank: a whole number from 0 to 255")?)))
                })
                .collect::<Result<_, InputError>>()?;
            Ok((label.to_owned(), ranks))
        })
        .collect()
}

fn read_status(document: &Document) -> Result<Vec<(String, Truth)>, InputError> {
    let root = document.root();
    root.entries("an object {condition: true, false, or null if withheld}")?
        .map(|(condition, truth)| {
            let truth = match truth.boolean_or_null("true, false, or null if withheld")? {
                Some(true) => Truth::True,
                Some(false) => Truth::False,
                None => Truth::Withheld,
            };
            Ok((condition.to_owned(), truth))
        })
        .collect()
}

fn required_text(document: &Document, key: &str, expected: &'static str) -> Result<String, InputError> {
    let root = document.root();
    match root.get(key, "an object")? {
        Some(node) => node.string(expected),
        None => Err(document.missing(key, expected)),
    }
}
