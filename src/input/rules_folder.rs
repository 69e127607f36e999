//! The rules folder: disposition activation and ethical implications.

use std::path::{Path, PathBuf};

use super::document::Document;
use super::error::InputError;

/// The robot's rules, by name and in the files' order.
#[derive(Clone, Debug)]
pub struct Rules {
    /// Condition -> dispositions that it activates.
    pub activation: Vec<(String, Vec<String>)>,
    /// Goal -> dispositions that it implies.
    pub implications: Vec<(String, Vec<String>)>,
    /// Where the activation comes from.
    pub activation_file: PathBuf,
    /// Where the implications come from.
    pub implications_file: PathBuf,
}

impl Rules {
    /// Reads `disposition_activation.json` and `ethical_implications.json` of a folder.
    ///
    /// # Errors
    /// [`InputError`] if either is not as expected.
    pub fn read(folder: &Path) -> Result<Self, InputError> {
        Self::of(
            &Document::read(folder.join("disposition_activation.json"))?,
            &Document::read(folder.join("ethical_implications.json"))?,
        )
    }

    /// Takes both files' texts instead; the names are for messages.
    ///
    /// # Errors
    /// [`InputError`] if either is not as expected.
    pub fn parse(activation: (&str, &str), implications: (&str, &str)) -> Result<Self, InputError> {
        Self::of(
            &Document::parse(activation.0.into(), activation.1)?,
            &Document::parse(implications.0.into(), implications.1)?,
        )
    }

    fn of(activation: &Document, implications: &Document) -> Result<Self, InputError> {
        Ok(Self {
            activation: lists(activation, "an object {condition: [disposition]}")?,
            implications: lists(implications, "an object {goal: [disposition]}")?,
            activation_file: activation.file.clone(),
            implications_file: implications.file.clone(),
        })
    }

    /// The goals that the rules list.
    #[must_use]
    pub fn goals(&self) -> Vec<String> {
        self.implications.iter().map(|(goal, _)| goal.clone()).collect()
    }
}

fn lists(document: &Document, expected: &'static str) -> Result<Vec<(String, Vec<String>)>, InputError> {
    let root = document.root();
    root.entries(expected)?
        .map(|(key, node)| Ok((key.to_owned(), node.strings("a list of dispositions")?)))
        .collect()
}
