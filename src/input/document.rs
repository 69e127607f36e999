//! A JSON document that keeps its key order and refuses duplicate keys.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::Number;

use super::error::InputError;

/// A parsed file. Objects have no duplicate key anywhere.
#[derive(Debug)]
pub(super) struct Document {
    pub(super) file: PathBuf,
    root: Value,
}

/// A value in a document and the keys that lead to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node<'a> {
    file: &'a Path,
    parent: Option<&'a Node<'a>>,
    /// `None` for the whole document and for the items of a list.
    key: Option<&'a str>,
    value: &'a Value,
}

#[derive(Debug)]
enum Value {
    Null,
    Bool(bool),
    Number(Number),
    String(String),
    Array(Vec<Value>),
    Object(Vec<(String, Value)>),
}

impl Document {
    pub(super) fn read(file: PathBuf) -> Result<Self, InputError> {
        let text = fs::read_to_string(&file)
            .map_err(|source| InputError::Unreadable { file: file.clone(), source })?;
        Self::parse(file, &text)
    }

    pub(super) fn parse(file: PathBuf, text: &str) -> Result<Self, InputError> {
        // Invisible in most editors, so the parser's own words would not help.
        if text.starts_with('\u{feff}') {
            let message = "begins with a byte order mark, expected UTF-8 without one".to_owned();
            return Err(InputError::NotJson { file, message });
        }
        let root = serde_json::from_str(text)
            .map_err(|error| InputError::NotJson { file: file.clone(), message: error.to_string() })?;
        let document = Self { file, root };
        document.root().refuse_duplicate_keys()?;
        Ok(document)
    }

    pub(super) fn root(&self) -> Node<'_> {
        Node { file: &self.file, parent: None, key: None, value: &self.root }
    }

    pub(super) fn missing(&self, key: &str, expected: &'static str) -> InputError {
        InputError::MissingKey { file: self.file.clone(), key: key.to_owned(), expected }
    }
}

impl<'a> Node<'a> {
    /// The entries of an object, in order.
    pub(super) fn entries(
        &'a self,
        expected: &'static str,
    ) -> Result<impl Iterator<Item = (&'a str, Node<'a>)>, InputError> {
        match self.value {
            Value::Object(entries) => {
                Ok(entries.iter().map(|(key, value)| (key.as_str(), self.child(Some(key), value))))
            }
            _ => Err(self.unexpected(expected)),
        }
    }

    /// The value under `key` of an object.
    pub(super) fn get(&'a self, key: &str, expected: &'static str) -> Result<Option<Node<'a>>, InputError> {
        Ok(self.entries(expected)?.find(|(name, _)| *name == key).map(|(_, node)| node))
    }

    pub(super) fn string(&self, expected: &'static str) -> Result<String, InputError> {
        match self.value {
            Value::String(text) => Ok(text.clone()),
            _ => Err(self.unexpected(expected)),
        }
    }

    pub(super) fn strings(&self, expected: &'static str) -> Result<Vec<String>, InputError> {
        let Value::Array(items) = self.value else { return Err(self.unexpected(expected)) };
        items
            .iter()
            .map(|item| match item {
                Value::String(text) => Ok(text.clone()),
                other => Err(self.child(None, other).unexpected("a disposition's name in quotes")),
            })
            .collect()
    }

    pub(super) fn byte(&self, expected: &'static str) -> Result<u8, InputError> {
        match self.value {
            Value::Number(number) => number.as_u64().and_then(|n| u8::try_from(n).ok()),
            _ => None,
        }
        .ok_or_else(|| self.unexpected(expected))
    }

    /// `None` for null.
    pub(super) fn boolean_or_null(&self, expected: &'static str) -> Result<Option<bool>, InputError> {
        match self.value {
            Value::Bool(truth) => Ok(Some(*truth)),
            Value::Null => Ok(None),
            _ => Err(self.unexpected(expected)),
        }
    }

    fn unexpected(&self, expected: &'static str) -> InputError {
        InputError::Unexpected {
            file: self.file.to_owned(),
            key: self.path(),
            expected,
            found: self.value.to_string(),
        }
    }

    fn child<'b>(&'b self, key: Option<&'b str>, value: &'b Value) -> Node<'b> {
        Node { file: self.file, parent: Some(self), key, value }
    }

    /// The keys that lead here, each followed by a colon and a space.
    fn path(&self) -> String {
        let mut path = self.parent.map(Node::path).unwrap_or_default();
        if let Some(key) = self.key {
            path.push_str(&named(key));
            path.push_str(": ");
        }
        path
    }

    fn refuse_duplicate_keys(&self) -> Result<(), InputError> {
        match self.value {
            Value::Object(entries) => {
                let mut seen = std::collections::HashSet::new();
                for (key, value) in entries {
                    let child = self.child(Some(key), value);
                    if !seen.insert(key) {
                        return Err(InputError::DuplicateKey {
                            file: self.file.to_owned(),
                            key: child.path(),
                        });
                    }
                    child.refuse_duplicate_keys()?;
                }
                Ok(())
            }
            Value::Array(items) => {
                items.iter().try_for_each(|item| self.child(None, item).refuse_duplicate_keys())
            }
            _ => Ok(()),
        }
    }
}

/// A key as messages show it: in quotes where it could not be told from the text around it.
fn named(key: &str) -> String {
    if key.trim().is_empty() || key.contains(char::is_control) { format!("{key:?}") } else { key.to_owned() }
}

/// As a person would name it in a message: scalars as written, the rest by kind.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => f.write_str("null"),
            Self::Bool(truth) => write!(f, "{truth}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::String(text) => write!(f, "the text {text:?}"),
            Self::Array(_) => f.write_str("a list"),
            Self::Object(_) => f.write_str("an object"),
        }
    }
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ValueVisitor)
    }
}

struct ValueVisitor;

impl<'de> Visitor<'de> for ValueVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, truth: bool) -> Result<Value, E> {
        Ok(Value::Bool(truth))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Value, E> {
        Ok(Value::Number(number.into()))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Value, E> {
        Ok(Value::Number(number.into()))
    }

    fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<Value, E> {
        Number::from_f64(number).map(Value::Number).ok_or_else(|| E::custom("number out of range"))
    }

    fn visit_str<E>(self, text: &str) -> Result<Value, E> {
        Ok(Value::String(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Value, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = seq.next_element()? {
            items.push(item);
        }
        Ok(Value::Array(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
        let mut entries = Vec::new();
        while let Some(key) = map.next_key::<String>()? {
            // The parser tells line and column; the key is ours to add.
            let value =
                map.next_value().map_err(|error| A::Error::custom(format!("{}: {error}", named(&key))))?;
            entries.push((key, value));
        }
        Ok(Value::Object(entries))
    }
}
