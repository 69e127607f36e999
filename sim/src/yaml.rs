//! Reads a YAML document into a small tree of bounded depth and size.
//!
//! Map and building files are plain: mappings, sequences, scalars. Anchors, aliases and a depth
//! over [`MAX_DEPTH`] are refused, so no input makes the reader recurse or grow without bound.

use saphyr_parser::{Event, Parser, ScalarStyle, Span};

use crate::error::YamlError;

/// Deepest nesting that is read.
pub(crate) const MAX_DEPTH: usize = 16;

/// Largest YAML text that is read, in bytes.
pub const MAX_BYTES: usize = 1 << 20;

#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) line: usize,
    pub(crate) value: Value,
}

#[derive(Clone, Debug)]
pub(crate) enum Value {
    Scalar(String),
    /// An empty plain scalar, `~` or `null`.
    Null,
    Sequence(Vec<Node>),
    Mapping(Vec<(String, Node)>),
}

enum Open {
    Sequence(usize, Vec<Node>),
    Mapping(usize, Vec<(String, Node)>, Option<String>),
}

/// The first document in `text`.
pub(crate) fn parse(text: &str) -> Result<Node, YamlError> {
    if text.len() > MAX_BYTES {
        return Err(YamlError::TooLong { bytes: text.len() });
    }
    let mut open: Vec<Open> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) =
            event.map_err(|e| YamlError::Syntax { line: e.marker().line(), what: e.info().to_owned() })?;
        if let Some(root) = take(&mut open, event, span)? {
            return Ok(root);
        }
    }
    Err(YamlError::Empty)
}

/// Takes one event; gives the root once it is complete.
fn take(open: &mut Vec<Open>, event: Event<'_>, span: Span) -> Result<Option<Node>, YamlError> {
    let line = span.start.line();
    let done = match event {
        Event::Alias(_) => return Err(YamlError::Anchor { line }),
        Event::Scalar(_, _, anchor, _) | Event::SequenceStart(anchor, _) | Event::MappingStart(anchor, _)
            if anchor != 0 =>
        {
            return Err(YamlError::Anchor { line });
        }
        Event::SequenceStart(..) | Event::MappingStart(..) if open.len() >= MAX_DEPTH => {
            return Err(YamlError::TooDeep { line });
        }
        Event::SequenceStart(..) => {
            open.push(Open::Sequence(line, Vec::new()));
            return Ok(None);
        }
        Event::MappingStart(..) => {
            open.push(Open::Mapping(line, Vec::new(), None));
            return Ok(None);
        }
        Event::Scalar(text, style, ..) => {
            if let Some(Open::Mapping(_, entries, key @ None)) = open.last_mut() {
                if entries.iter().any(|(k, _)| *k == *text) {
                    return Err(YamlError::DuplicateKey { line, key: text.into_owned() });
                }
                *key = Some(text.into_owned());
                return Ok(None);
            }
            let null = style == ScalarStyle::Plain && matches!(&*text, "" | "~" | "null");
            Node { line, value: if null { Value::Null } else { Value::Scalar(text.into_owned()) } }
        }
        Event::SequenceEnd | Event::MappingEnd => match open.pop() {
            Some(Open::Sequence(line, nodes)) => Node { line, value: Value::Sequence(nodes) },
            Some(Open::Mapping(line, entries, _)) => Node { line, value: Value::Mapping(entries) },
            None => return Ok(None),
        },
        Event::Nothing
        | Event::StreamStart
        | Event::StreamEnd
        | Event::DocumentStart(_)
        | Event::DocumentEnd => return Ok(None),
    };
    match open.last_mut() {
        None => return Ok(Some(done)),
        Some(Open::Sequence(_, nodes)) => nodes.push(done),
        Some(Open::Mapping(_, entries, key)) => match key.take() {
            Some(key) => entries.push((key, done)),
            None => return Err(YamlError::KeyNotScalar { line: done.line }),
        },
    }
    Ok(None)
}

impl Node {
    pub(crate) fn get(&self, key: &str) -> Result<Option<&Self>, YamlError> {
        match &self.value {
            Value::Mapping(entries) => Ok(entries.iter().find(|(k, _)| k == key).map(|(_, v)| v)),
            _ => Err(YamlError::Expected { line: self.line, what: "a mapping" }),
        }
    }

    pub(crate) fn require(&self, key: &'static str) -> Result<&Self, YamlError> {
        self.get(key)?.ok_or(YamlError::MissingKey { line: self.line, key })
    }

    pub(crate) fn text(&self) -> Result<&str, YamlError> {
        match &self.value {
            Value::Scalar(text) => Ok(text),
            _ => Err(YamlError::Expected { line: self.line, what: "a text" }),
        }
    }

    /// A finite number.
    pub(crate) fn number(&self) -> Result<f64, YamlError> {
        let error = YamlError::Expected { line: self.line, what: "a finite number" };
        match self.text().ok().and_then(|t| t.parse::<f64>().ok()) {
            Some(number) if number.is_finite() => Ok(number),
            _ => Err(error),
        }
    }

    pub(crate) fn sequence(&self) -> Result<&[Self], YamlError> {
        match &self.value {
            Value::Sequence(nodes) => Ok(nodes),
            Value::Null => Ok(&[]),
            _ => Err(YamlError::Expected { line: self.line, what: "a sequence" }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text in "[ -~\n\t]{0,200}") {
            let _ = parse(&text);
        }

        #[test]
        fn no_nesting_of_yaml_characters_makes_it_panic(text in "[\\[\\]{}:,\\-?&*!|>'\"#% \na]{0,120}") {
            let _ = parse(&text);
        }
    }

    #[test]
    fn deep_nesting_is_refused_not_followed() {
        for opening in ["[", "{a: ", "- ", "? "] {
            let error = parse(&opening.repeat(20_000)).unwrap_err();
            let refused = matches!(error, YamlError::TooDeep { .. } | YamlError::Syntax { .. });
            assert!(refused, "{opening:?}: {error}");
        }
    }

    #[test]
    fn anchors_and_duplicate_keys_are_refused() {
        assert!(matches!(parse("a: &x 1\nb: *x"), Err(YamlError::Anchor { line: 1 })));
        assert!(matches!(parse("a: 1\na: 2"), Err(YamlError::DuplicateKey { line: 2, .. })));
    }
}
