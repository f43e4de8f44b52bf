//! The text of a file as people see it: its comments, its lines and columns, and what is often typed
//! in place of JSON.

use std::borrow::Cow;
use std::io::Read;

use json_comments::CommentSettings;

use super::Fault;

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

/// What is wrong with a text that is no JSON and, up to the end of a line, not UTF-8 either, as editors
/// save it in older encodings; none of other texts.
pub(super) fn encoding_fault(text: &[u8], last_line: usize) -> Option<Fault> {
    let at = std::str::from_utf8(text).err()?.valid_up_to();
    let rows: Vec<&[u8]> = text[..at].split(|byte| *byte == b'\n').collect();
    let row = rows.last().copied().unwrap_or_default();
    let column = String::from_utf8_lossy(row).chars().count() + 1;
    let found = format!("the byte 0x{:02X}", text[at]);
    let message = "this is not JSON: the text is not UTF-8";
    let fault = Fault::new(message, found, "the file saved as UTF-8, which editors offer");
    (rows.len() <= last_line).then(|| fault.at(format!("line {}, column {column}", rows.len())))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: a text in another encoding is said to be no UTF-8, with the place of its first such byte;
    /// one whose fault comes before is not.
    #[test]
    fn text_in_another_encoding_is_called_that() {
        let latin = b"{\n  \"name\": \"K\xf6rnung\",\n \"a\": \"\xb5\" }";
        let got = encoding_fault(latin, 2).expect("a fault").to_string();
        let expected = "line 2, column 13: this is not JSON: the text is not UTF-8 (found the byte \
                        0xF6; allowed: the file saved as UTF-8, which editors offer)";
        assert_eq!(got, expected);
        let after = "{\n \"Größe\": \"".as_bytes();
        let got = encoding_fault(&[after, b"\xe9"].concat(), 2).expect("a fault");
        assert_eq!(got.path, "line 2, column 12", "law: columns are of characters");
        assert_eq!(encoding_fault(latin, 1), None, "law: what ceases to be JSON before");
        assert_eq!(encoding_fault("{ \"a\": µ }".as_bytes(), 9), None, "law: of UTF-8 none");
    }
}
