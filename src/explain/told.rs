//! What is said to people: a question, its answer, and what is behind it.

use std::fmt::{Display, Write as _};

use serde::Serialize;

/// The width of the text on a terminal, in characters.
const WIDTH: usize = 92;

/// One decision in sentences.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Told {
    /// What people ask.
    pub question: String,
    /// The answer, the most important sentence first.
    pub answer: Vec<String>,
    /// What is behind it.
    pub sections: Vec<Section>,
}

/// Sentences about one thing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Section {
    /// About what.
    pub title: String,
    /// One thought each.
    pub sentences: Vec<String>,
}

impl Told {
    /// Adds a section, unless there is nothing to say.
    pub(super) fn section(&mut self, title: &str, sentences: Vec<String>) {
        if !sentences.is_empty() {
            self.sections.push(Section { title: title.to_owned(), sentences });
        }
    }

    /// For a terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        let _ = writeln!(text, "{}\n", self.question);
        wrap(&mut text, "  ", "  ", &self.answer.join(" "));
        for section in &self.sections {
            let _ = writeln!(text, "\n{}\n", section.title);
            for sentence in &section.sentences {
                wrap(&mut text, "  - ", "    ", sentence);
            }
        }
        text
    }
}

/// Breaks a paragraph into lines.
fn wrap(text: &mut String, first: &str, others: &str, paragraph: &str) {
    text.push_str(first);
    let mut used = first.len();
    for (nth, word) in paragraph.split(' ').enumerate() {
        let length = word.chars().count();
        if nth > 0 && used.saturating_add(length) >= WIDTH {
            text.push('\n');
            text.push_str(others);
            used = others.len();
        } else if nth > 0 {
            text.push(' ');
            used = used.saturating_add(1);
        }
        text.push_str(word);
        used = used.saturating_add(length);
    }
    text.push('\n');
}

/// `Alice`, `Alice and Bob`, `Alice, Bob and Carol`.
pub(super) fn listed<S: AsRef<str>>(names: &[S]) -> String {
    match names {
        [] => "nobody".to_owned(),
        [one] => one.as_ref().to_owned(),
        [others @ .., last] => {
            let others: Vec<&str> = others.iter().map(AsRef::as_ref).collect();
            format!("{} and {}", others.join(", "), last.as_ref())
        }
    }
}

/// `1 round`, `2 rounds`.
pub(super) fn counted(number: impl Display, what: &str) -> String {
    let number = format!("{number}");
    let plural = if number == "1" { "" } else { "s" };
    format!("{number} {what}{plural}")
}

/// Simulated time as minutes and seconds.
pub(super) fn clock(seconds: f64) -> String {
    let whole = std::time::Duration::try_from_secs_f64(seconds).unwrap_or_default().as_secs();
    format!("{:02}:{:02}", whole / 60, whole % 60)
}
