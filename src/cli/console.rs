//! What is said to people, on stderr: lines broken between words where the terminal ends.
//!
//! A stderr that cannot be written to (a full disk, a pipe that was closed) must not end the work, so what happens there is
//! not looked at.

use std::io::{self, IsTerminal, Write};

/// Room before the rest of a line that was broken.
const INDENT: usize = 2;

/// Says a line or several.
pub fn say(text: &str) {
    let stderr = io::stderr();
    let columns = if stderr.is_terminal() { columns() } else { None };
    let text = columns.map_or_else(|| text.to_owned(), |columns| wrapped(text, columns));
    // Nobody is left to be told.
    let _ = writeln!(stderr.lock(), "{text}");
}

/// Width of the terminal, if stderr is one that tells.
pub fn columns() -> Option<usize> {
    #[cfg(unix)]
    {
        let size = rustix::termios::tcgetwinsize(io::stderr()).ok()?;
        (size.ws_col > 0).then_some(usize::from(size.ws_col))
    }
    #[cfg(not(unix))]
    None
}

/// The text with no line longer than `columns`, unless a word is.
fn wrapped(text: &str, columns: usize) -> String {
    let lines: Vec<String> = text.lines().map(|line| wrapped_line(line, columns)).collect();
    lines.join("\n")
}

fn wrapped_line(line: &str, columns: usize) -> String {
    let mut wrapped = String::new();
    let mut length = 0;
    // Words with the spaces before them: what is aligned by spaces stays so.
    for word in line.split_inclusive(' ') {
        let letters = word.trim_end().chars().count();
        if length > INDENT && length + letters > columns {
            let end = wrapped.trim_end().len();
            wrapped.truncate(end);
            wrapped += "\n";
            wrapped += &" ".repeat(INDENT);
            length = INDENT;
        }
        wrapped += word;
        length += word.chars().count();
    }
    wrapped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_between_words() {
        let text = "a line of words\nshort";
        assert_eq!(wrapped(text, 10), "a line of\n  words\nshort");
        assert_eq!(wrapped(text, 15), text);
        assert_eq!(wrapped("aligned   by   spaces", 80), "aligned   by   spaces");
        assert_eq!(
            wrapped("cannot write /a/path/that/is/long: no", 12),
            "cannot write\n  /a/path/that/is/long:\n  no"
        );
        assert_eq!(wrapped("ä ö ü ß", 7), "ä ö ü ß");
    }
}
