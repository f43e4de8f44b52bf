//! Colours of words in tables: green for what was met, red for what was not,
//! yellow for what a reader should know. Text carries them as marks, which
//! [`shown`] turns into colours on its way out, so that every other escape sequence
//! is one of a file or a name. The streams that print it take colours out again
//! where nobody sees them (no terminal, `NO_COLOR`, `TERM=dumb`).

use std::fmt::Display;

use anstyle::{AnsiColor, Style};

use super::*;
use crate::plain::plain_but;

/// Characters that no text has (Unicode's noncharacters): where a colour ends, and
/// where each begins.
const END: char = '\u{fdd0}';
const GOOD: char = '\u{fdd1}';
const BAD: char = '\u{fdd2}';
const NOTABLE: char = '\u{fdd3}';
const FAINT: char = '\u{fdd4}';

fn is_mark(c: char) -> bool {
    (END..=FAINT).contains(&c)
}

fn style(mark: char) -> Style {
    match mark {
        GOOD => AnsiColor::Green.on_default(),
        BAD => AnsiColor::Red.on_default().bold(),
        NOTABLE => AnsiColor::Yellow.on_default(),
        _ => Style::new().dimmed(),
    }
}

fn marked(mark: char, text: impl Display) -> String {
    format!("{mark}{}{END}", plain(&text.to_string()))
}

/// What was met.
pub(super) fn good(text: impl Display) -> String {
    marked(GOOD, text)
}

/// What was not met, or failed.
pub(super) fn bad(text: impl Display) -> String {
    marked(BAD, text)
}

/// What a reader should know.
pub(super) fn notable(text: impl Display) -> String {
    marked(NOTABLE, text)
}

/// What says nothing either way.
pub(super) fn faint(text: impl Display) -> String {
    marked(FAINT, text)
}

/// Number of columns that a text takes, colours aside.
pub(super) fn width(text: &str) -> usize {
    text.chars().filter(|c| !is_mark(*c)).count()
}

/// A text as it is printed: our colours, and whatever else would control the
/// terminal by its code point.
pub(super) fn shown(text: &str) -> String {
    let text = plain_but(text, |c| c == '\n' || is_mark(c));
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            END => shown += &anstyle::Reset.render().to_string(),
            c if is_mark(c) => shown += &style(c).render().to_string(),
            c => shown.push(c),
        }
    }
    shown
}

/// The same without colours.
pub(super) fn colourless(text: &str) -> String {
    anstream::adapter::strip_str(&shown(text)).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_take_no_room() {
        for text in [good("within"), bad("outside"), notable("ä"), faint("-")] {
            assert!(shown(&text).contains('\x1b'), "law: it is coloured, got {text:?}");
        }
        assert_eq!((width(&bad("outside")), width("µm"), width("")), (7, 2, 0));
    }

    #[test]
    fn only_our_own_colours_reach_a_terminal() {
        let name = "\u{1b}[32mall is well\u{1b}]0;title\u{7}\u{202e}";
        let text = format!("{}\n{name} {}\n", bad(name), good("met"));
        let got = shown(&text);
        let escaped = "\\u001b[32mall is well\\u001b]0;title\\u0007\\u202e";
        let (red, green, end) =
            (style(BAD).render(), style(GOOD).render(), anstyle::Reset.render());
        let expected = format!("{red}{escaped}{end}\n{escaped} {green}met{end}\n");
        assert_eq!(got, expected, "law: colours are ours alone, all else is seen");
        let forged = bad("a\u{fdd0}b\u{fdd1}");
        assert_eq!(shown(&forged), format!("{red}a\\ufdd0b\\ufdd1{end}"), "law: nor by our marks");
    }
}
