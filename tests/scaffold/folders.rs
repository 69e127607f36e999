//! Rules and user folders of the published form, built in a temporary directory.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

/// The letters that stand for conditions in the smallest cases.
pub(crate) const LETTERS: &str = "abcdef";

/// A temporary rules folder with user folders in it.
pub(crate) struct Place {
    folder: TempDir,
}

impl Place {
    /// Rules in which each condition `a`, `b`, ... activates a disposition of its own, `da`,
    /// `db`, ..., and the goals `t1` and `t2` imply all of them.
    pub(crate) fn of_letters() -> Self {
        let activation: Vec<(String, Vec<String>)> =
            LETTERS.chars().map(|letter| (letter.to_string(), vec![format!("d{letter}")])).collect();
        let all: Vec<String> = LETTERS.chars().map(|letter| format!("d{letter}")).collect();
        let place = Self { folder: tempfile::tempdir().unwrap() };
        place.write("disposition_activation.json", &lists(&activation));
        place.write(
            "ethical_implications.json",
            &lists(&[("t1".to_owned(), all.clone()), ("t2".to_owned(), all)]),
        );
        place
    }

    /// A copy of the project's own example, to be spoiled.
    pub(crate) fn mall() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        let mall = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/mall");
        for file in ["disposition_activation.json", "ethical_implications.json"] {
            place.write(file, &fs::read_to_string(mall.join(file)).unwrap());
        }
        for user in ["Alice", "Bob"] {
            for file in ["ethic_profiles.json", "user_status.json", "context.json", "goal.json"] {
                let file = format!("{user}/{file}");
                place.write(&file, &fs::read_to_string(mall.join(&file)).unwrap());
            }
        }
        place
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn of(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// Writes a file, with the folders that lead to it.
    pub(crate) fn write(&self, file: &str, text: &str) -> &Self {
        self.write_bytes(file, text.as_bytes())
    }

    pub(crate) fn write_bytes(&self, file: &str, bytes: &[u8]) -> &Self {
        let file = self.path().join(file);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, bytes).unwrap();
        self
    }

    /// A user of whom the conditions `conditions` are true, in this order. `ranks` is
    /// written `"a1 c5"`: 1 for `da`, 5 for `dc`; all others are 0.
    pub(crate) fn user(&self, name: &str, conditions: &str, ranks: &str) -> &Self {
        let status: Vec<(String, &str)> =
            conditions.chars().map(|letter| (letter.to_string(), "true")).collect();
        self.user_with_status(name, &object(&status), ranks)
    }

    /// The same with a status as it is to be written.
    pub(crate) fn user_with_status(&self, name: &str, status: &str, ranks: &str) -> &Self {
        let ranks: Vec<(String, String)> = LETTERS
            .chars()
            .map(|letter| {
                let rank = ranks.split_whitespace().find_map(|one| one.strip_prefix(letter)).unwrap_or("0");
                (format!("d{letter}"), rank.to_owned())
            })
            .collect();
        self.write(&format!("{name}/ethic_profiles.json"), &object(&[("here".to_owned(), object(&ranks))]))
            .write(&format!("{name}/user_status.json"), status)
            .write(&format!("{name}/context.json"), r#"{"location": "here"}"#)
            .write(&format!("{name}/goal.json"), r#"{"goal": "t1"}"#)
    }
}

/// A JSON object with its entries in this order; the values are JSON already.
pub(crate) fn object<V: AsRef<str>>(entries: &[(String, V)]) -> String {
    let entries: Vec<String> =
        entries.iter().map(|(key, value)| format!("{key:?}: {}", value.as_ref())).collect();
    format!("{{{}}}", entries.join(", "))
}

/// A JSON object of lists of names, in this order.
pub(crate) fn lists(entries: &[(String, Vec<String>)]) -> String {
    let entries: Vec<(String, String)> =
        entries.iter().map(|(key, names)| (key.clone(), format!("{names:?}"))).collect();
    object(&entries)
}
