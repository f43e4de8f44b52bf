//! The text of a file as people see it: its comments, its lines and columns, and what is often typed
//! in place of JSON.

use std::borrow::Cow;
use std::io::Read;

use json_comments::CommentSettings;

/// A text with its comments, `// ...` and `/* ... */`, replaced by blanks: everything else stands
/// where it stood, so that lines and columns of faults are those of the file. A text whose
/// comments do not end is left as it is, for the parser to say where.
pub(super) fn without_comments(text: &[u8]) -> Cow<'_, [u8]> {
    if !text.contains(&b'/') {
        return Cow::Borrowed(text);
    }
    let mut bare = Vec::with_capacity(text.len());
    let mut stripped = CommentSettings::c_style().strip_comments(text);
    if stripped.read_to_end(&mut bare).is_err() || bare.len() != text.len() {
        return Cow::Borrowed(text);
    }
    for (bare, &byte) in bare.iter_mut().zip(text) {
        if byte == b'\n' {
            *bare = byte;
        }
    }
    Cow::Owned(bare)
}

/// The line of a number from 1.
pub(super) fn line(text: &[u8], number: usize) -> &[u8] {
    text.split(|byte| *byte == b'\n').nth(number.saturating_sub(1)).unwrap_or_default()
}

/// The column in characters, as editors count them, of one in bytes.
pub(super) fn column_shown(row: &[u8], column: usize) -> usize {
    String::from_utf8_lossy(&row[..column.min(row.len())]).chars().count().max(column.min(1))
}

/// What is not JSON but often typed, at a column in bytes from 1 where a line ceases to be any.
pub(super) fn hint(row: &[u8], column: usize) -> &'static str {
    let before = |back: usize| column.checked_sub(1 + back).and_then(|n| row.get(n)).copied();
    match (before(2), before(1), before(0)) {
        (Some(b'0'..=b'9'), Some(b','), Some(b'0'..=b'9')) => {
            "; decimals follow a point, as in 5.6"
        }
        (.., Some(b'\'')) => "; texts and names stand in double quotes",
        (.., Some(b'#')) => "; comments begin with //",
        _ => "",
    }
}
