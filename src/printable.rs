//! Names of files, and words of their contents, as one line on a terminal.

/// The same in one line that nothing in it can end, reorder or colour: control characters, and
/// letters that nobody sees, are written as escapes. Quotation marks and backslashes, letters of
/// all languages and their accents stay as they are.
#[must_use]
pub fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for piece in text.split_inclusive(MARKS) {
        let letters = piece.strip_suffix(MARKS).unwrap_or(piece);
        line.extend(letters.escape_debug());
        line.push_str(piece.get(letters.len()..).unwrap_or_default());
    }
    line
}

/// What `escape_debug` would escape though it is harmless here.
const MARKS: [char; 3] = ['"', '\'', '\\'];

#[cfg(test)]
mod tests {
    use super::one_line;
    use proptest::prelude::*;

    #[test]
    fn what_can_be_read_stays_as_it_is() {
        for text in ["", "Zoë's \"folder\"\\läuft.mcap", "日本.mcap", "e\u{301}.mcap", "’"] {
            assert_eq!(one_line(text), text);
        }
    }

    #[test]
    fn what_moves_a_cursor_or_turns_words_around_is_shown() {
        assert_eq!(
            one_line("a\n\u{1b}[2J\u{202e}b\u{200b}\u{2028}'\r"),
            r"a\n\u{1b}[2J\u{202e}b\u{200b}\u{2028}'\r"
        );
    }

    proptest! {
        #[test]
        fn no_control_character_is_left(text in any::<String>()) {
            prop_assert!(!one_line(&text).chars().any(char::is_control));
        }
    }
}
