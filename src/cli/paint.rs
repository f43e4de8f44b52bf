//! Colours of words in tables: green for what was met, red for what was not,
//! yellow for what a reader should know. Text carries them always; the streams
//! that print it take them out again where nobody sees them (no terminal,
//! `NO_COLOR`, `TERM=dumb`).

use std::fmt::Display;

use anstyle::{AnsiColor, Style};

fn painted(style: Style, text: impl Display) -> String {
    format!("{style}{text}{style:#}")
}

/// What was met.
pub(super) fn good(text: impl Display) -> String {
    painted(AnsiColor::Green.on_default(), text)
}

/// What was not met, or failed.
pub(super) fn bad(text: impl Display) -> String {
    painted(AnsiColor::Red.on_default().bold(), text)
}

/// What a reader should know.
pub(super) fn notable(text: impl Display) -> String {
    painted(AnsiColor::Yellow.on_default(), text)
}

/// What says nothing either way.
pub(super) fn faint(text: impl Display) -> String {
    painted(Style::new().dimmed(), text)
}

/// Number of columns that a text takes, colours aside.
pub(super) fn width(text: &str) -> usize {
    anstream::adapter::strip_str(text).map(|part| part.chars().count()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_take_no_room() {
        for text in [good("within"), bad("outside"), notable("ä"), faint("-")] {
            assert!(text.contains('\x1b'), "law: it is coloured, got {text:?}");
        }
        assert_eq!((width(&bad("outside")), width("µm"), width("")), (7, 2, 0));
    }
}
